//! Which matrix a Newton step takes where W is not convex.

/// Share of the weakening of the bound that is in the matrix, and whether nodes that stick are freed, which makes the body
/// softer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt {
    pub weakening: f64,
    pub frees_near: bool,
}

/// What is tried in turn until the matrix is positive definite. Just above where it would be singular, steps are long along the
/// shape in which W is not convex; no weakening at all is the frozen-bound problem.
const IN_PLANE: &[Attempt] = &[
    attempt(1.0, true),
    attempt(1.0, false),
    attempt(0.95, false),
    attempt(0.8, false),
    attempt(0.0, true),
];
/// With two components the curvature across the slip direction changes so much that the matrix is refactored in almost every
/// step, so freeing sticking nodes in advance would only add correction terms that are never used.
const IN_SPACE: &[Attempt] = &[
    attempt(1.0, false),
    attempt(0.95, false),
    attempt(0.8, false),
    attempt(0.0, false),
];

const fn attempt(weakening: f64, frees_near: bool) -> Attempt {
    Attempt {
        weakening,
        frees_near,
    }
}

/// The attempts of a problem, and which of them the matrix is.
pub struct Attempts {
    list: &'static [Attempt],
    at: usize,
}

impl Attempts {
    /// For so many components per node, 1 or 2.
    pub fn new(components: usize) -> Attempts {
        let list = if components == 1 { IN_PLANE } else { IN_SPACE };
        Attempts { list, at: 0 }
    }

    /// The matrix is the first one of a solve.
    pub fn begin(&mut self) {
        self.at = 0;
    }

    pub fn current(&self) -> Attempt {
        self.list[self.at]
    }

    /// At a new point the whole weakening is tried again; whether nodes are freed stays as it was found.
    pub fn begin_anew(&mut self) {
        let whole = self.list.iter().rposition(|a| a.weakening == 1.0);
        self.at = self.at.min(whole.unwrap_or(0));
    }

    /// The present attempt has failed. Whether there is another.
    pub fn advance(&mut self) -> bool {
        let is_left = self.at + 1 < self.list.len();
        self.at += usize::from(is_left);
        is_left
    }

    /// Whether the matrix is above the second variation of W.
    pub fn is_majorised(&self) -> bool {
        self.current().weakening < 1.0
    }
}
