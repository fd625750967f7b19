//! What a search for other solutions of a stage finds, whichever solver searches.

/// Solutions that differ by less than this share of the largest velocity are one.
const SAME: f64 = 1e-6;

/// What a search has found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multiplicity {
    /// Different solutions, the accepted one included.
    pub solutions: usize,
    /// Largest difference in contact velocity to the accepted one, m/s.
    pub gap: f64,
}

impl Multiplicity {
    /// The accepted solution alone.
    pub const ONE: Multiplicity = Multiplicity {
        solutions: 1,
        gap: 0.0,
    };

    /// Counts a solution that was found beside the `accepted` one and `others`.
    pub fn count<'a>(
        &mut self,
        found: &[f64],
        accepted: &[f64],
        mut others: impl Iterator<Item = &'a [f64]>,
    ) {
        let all = found.iter().chain(accepted);
        let scale = all.fold(0.0, |m: f64, v| m.max(v.abs()));
        let gap = difference(found, accepted);
        let is_new =
            gap > SAME * scale && others.all(|other| difference(found, other) > SAME * scale);
        self.solutions += usize::from(is_new);
        self.gap = self.gap.max(gap);
    }
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
}
