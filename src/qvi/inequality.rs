//! The inequality (2.1) with its data.

use super::functional::{Functional, Nothing, Part};
use super::{HistoryOperator, Operator, Set, SolveError, Space, Whole};
use nalgebra::DVector;

/// Find `u(t) in K` such that for all `v in K`
///
/// ```text
/// (A u, v - u) + phi(S u, v) - phi(S u, u) + j(u, v) - j(u, u) >= (f(t), v - u)                  (2.1)
/// ```
pub struct Inequality {
    /// X.
    pub space: Space,
    /// A.
    pub operator: Box<dyn Operator>,
    /// The history operators; `S u` is the list of their values.
    pub histories: Vec<HistoryOperator>,
    /// phi.
    pub phi: Box<dyn Functional>,
    /// j.
    pub j: Box<dyn Functional>,
    /// The parts of v whose convex functions the coefficients of phi and j multiply.
    pub parts: Vec<Part>,
    /// K.
    pub set: Box<dyn Set>,
    /// f, as a covector, by the time.
    pub load: Box<dyn Fn(f64) -> DVector<f64>>,
}

impl Inequality {
    /// `A u = f(t)` on the whole space; the fields add the rest.
    pub fn new(
        space: Space,
        operator: impl Operator + 'static,
        load: impl Fn(f64) -> DVector<f64> + 'static,
    ) -> Inequality {
        Inequality {
            space,
            operator: Box::new(operator),
            histories: Vec::new(),
            phi: Box::new(Nothing),
            j: Box::new(Nothing),
            parts: Vec::new(),
            set: Box::new(Whole),
            load: Box::new(load),
        }
    }

    /// Number of unknowns.
    pub fn dimension(&self) -> usize {
        self.space.dimension()
    }

    /// Whether the pieces fit each other.
    ///
    /// # Errors
    /// [`SolveError::Shape`] for a matrix of another size than the space, [`SolveError::Value`] for parts that overlap or leave the
    /// space.
    pub fn check(&self) -> Result<(), SolveError> {
        let n = self.dimension();
        if let Some(matrix) = self.operator.matrix() {
            let (rows, columns) = matrix.shape();
            SolveError::check_shape("rows of A", n, rows)?;
            SolveError::check_shape("columns of A", n, columns)?;
        }
        SolveError::check_shape("components of f", n, (self.load)(0.0).len())?;
        let mut is_taken = vec![false; n];
        for (i, part) in self.parts.iter().enumerate() {
            for component in part.components.clone() {
                match is_taken.get_mut(component) {
                    Some(taken) if !*taken => *taken = true,
                    _ => {
                        return Err(SolveError::Value {
                            what: format!("a component of part {i}"),
                            found: component as f64,
                            allowed: "a component of the space that is in no other part",
                        });
                    }
                }
            }
        }
        Ok(())
    }
}
