//! The grid lines of one axis, uniform or graded to both ends.
//!
//! With n cells on a length L and the exponent p, line i stands at `L/2 (2 i/n)^p` up to the middle and the others mirror
//! these. Towards a corner where the solution behaves as `r^alpha`, `p = 1/alpha` keeps linear elements at their order
//! (Babuska, Kellogg and Pitkaranta, Numer. Math. 33 (1979) 447-471); the cells in the middle are p times as long as uniform ones.

/// Places of the grid lines and of the middles between them, m, ascending.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lines {
    /// `n + 1` places, the first exactly 0 and the last exactly the length.
    pub at: Vec<f64>,
    /// `n` places.
    pub middles: Vec<f64>,
}

impl Lines {
    /// The length is positive, there are cells, and the exponent is at least 1: checked by [`super::Grid`].
    pub fn new(length: f64, cells: u32, exponent: f64) -> Lines {
        let n = f64::from(cells);
        if exponent == 1.0 {
            // One product and one quotient per coordinate: the last line lies exactly at the given length.
            let place = |i: f64| length * i / n;
            return Lines {
                at: (0..=cells).map(|i| place(f64::from(i))).collect(),
                middles: (0..cells).map(|i| place(f64::from(i) + 0.5)).collect(),
            };
        }
        let place = |i: u32| 0.5 * length * (2.0 * f64::from(i) / n).powf(exponent);
        let at: Vec<f64> = (0..=cells)
            .map(|i| {
                if i <= cells / 2 {
                    place(i)
                } else {
                    length - place(cells - i)
                }
            })
            .collect();
        Lines {
            middles: at
                .windows(2)
                .map(|ends| 0.5 * (ends[0] + ends[1]))
                .collect(),
            at,
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> u32 {
        self.middles.len() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_where_the_exponent_puts_them() {
        // L/2 (2 i/n)^2 with L = 3, n = 4: 0, 3/8, 3/2, mirrored
        let lines = Lines::new(3.0, 4, 2.0);
        assert_eq!(lines.at, [0.0, 0.375, 1.5, 2.625, 3.0]);
        assert_eq!(lines.middles, [0.1875, 0.9375, 2.0625, 2.8125]);
        // an odd number has its middle cell across the middle
        assert_eq!(Lines::new(2.0, 3, 2.0).at[1], (2.0f64 / 3.0).powi(2));
        assert_eq!(Lines::new(2.0, 1, 2.0).at, [0.0, 2.0]);
    }

    #[test]
    fn graded_lines_are_symmetric_and_end_exactly() {
        for (length, cells, exponent) in [(0.1, 7, 1.3), (0.3, 32, 2.0), (7.7, 12, 3.1)] {
            let at = Lines::new(length, cells, exponent).at;
            assert_eq!((at[0], at[cells as usize]), (0.0, length));
            assert!(at.windows(2).all(|ends| ends[0] < ends[1]));
            for (low, high) in at.iter().zip(at.iter().rev()) {
                assert!((low + high - length).abs() < 1e-15 * length);
            }
        }
    }
}
