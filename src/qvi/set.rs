//! Closed convex sets K, by their projections (in the coordinates, Euclidean).

use super::SolveError;
use nalgebra::DVector;

/// Components that a set restricts.
#[derive(Debug, Clone, PartialEq)]
pub enum Restricted {
    Components(Vec<usize>),
    All,
}

/// K.
pub trait Set {
    /// Replaces a vector by the nearest point of K.
    fn project(&self, v: &mut DVector<f64>);

    /// The components that K restricts; the projection leaves the others as they are and does not look at them.
    fn restricted(&self) -> Restricted {
        Restricted::All
    }

    /// Whether K is a product of intervals, so that it is projected onto component by component.
    fn is_box(&self) -> bool {
        false
    }
}

/// The whole space.
#[derive(Debug, Clone, Copy)]
pub struct Whole;

impl Set for Whole {
    fn project(&self, _: &mut DVector<f64>) {}

    fn restricted(&self) -> Restricted {
        Restricted::Components(Vec::new())
    }

    fn is_box(&self) -> bool {
        true
    }
}

/// `lower <= v <= upper`, component by component; infinite bounds do not restrict.
#[derive(Debug, Clone)]
pub struct Bounds {
    lower: DVector<f64>,
    upper: DVector<f64>,
}

impl Bounds {
    /// # Errors
    /// [`SolveError::Shape`] for bounds of different lengths, [`SolveError::Value`] where a lower one is above the upper one or
    /// one is not a number.
    pub fn new(lower: DVector<f64>, upper: DVector<f64>) -> Result<Bounds, SolveError> {
        SolveError::check_shape("upper bounds of a box", lower.len(), upper.len())?;
        for (i, (low, high)) in lower.iter().zip(&upper).enumerate() {
            if low > high || low.is_nan() || high.is_nan() {
                return Err(SolveError::Value {
                    what: format!("lower bound {i} of a box"),
                    found: *low,
                    allowed: "a number that is not above the upper bound",
                });
            }
        }
        Ok(Bounds { lower, upper })
    }
}

impl Set for Bounds {
    fn project(&self, v: &mut DVector<f64>) {
        for ((v, low), high) in v.iter_mut().zip(&self.lower).zip(&self.upper) {
            *v = v.clamp(*low, *high);
        }
    }

    fn restricted(&self) -> Restricted {
        let bounds = self.lower.iter().zip(&self.upper).enumerate();
        let finite = bounds.filter(|(_, (low, high))| low.is_finite() || high.is_finite());
        Restricted::Components(finite.map(|(i, _)| i).collect())
    }

    fn is_box(&self) -> bool {
        true
    }
}

/// `normal . v <= bound`.
#[derive(Debug, Clone)]
pub struct HalfSpace {
    normal: DVector<f64>,
    bound: f64,
    square: f64,
}

impl HalfSpace {
    /// # Errors
    /// [`SolveError::Value`] for a normal without length.
    pub fn new(normal: DVector<f64>, bound: f64) -> Result<HalfSpace, SolveError> {
        let square = normal.norm_squared();
        if !(square > 0.0 && square.is_finite()) {
            return Err(SolveError::Value {
                what: "squared length of the normal of a half-space".to_owned(),
                found: square,
                allowed: "a positive number",
            });
        }
        Ok(HalfSpace {
            normal,
            bound,
            square,
        })
    }
}

impl Set for HalfSpace {
    fn project(&self, v: &mut DVector<f64>) {
        let excess = self.normal.dot(v) - self.bound;
        if excess > 0.0 {
            v.axpy(-excess / self.square, &self.normal, 1.0);
        }
    }

    fn restricted(&self) -> Restricted {
        let places = self.normal.iter().enumerate();
        Restricted::Components(places.filter(|(_, n)| **n != 0.0).map(|(i, _)| i).collect())
    }
}

/// The second-order cone `|(v_1, ..., v_d-1)| <= slope v_0`.
#[derive(Debug, Clone, Copy)]
pub struct Cone {
    slope: f64,
}

impl Cone {
    /// # Errors
    /// [`SolveError::Value`] for a slope that is not positive.
    pub fn new(slope: f64) -> Result<Cone, SolveError> {
        if slope > 0.0 && slope.is_finite() {
            Ok(Cone { slope })
        } else {
            Err(SolveError::Value {
                what: "slope of a cone".to_owned(),
                found: slope,
                allowed: "a positive number",
            })
        }
    }
}

impl Set for Cone {
    fn project(&self, v: &mut DVector<f64>) {
        let (axis, radius) = (v[0], v.rows(1, v.len() - 1).norm());
        if radius <= self.slope * axis {
            return;
        }
        if self.slope * radius <= -axis {
            v.fill(0.0);
            return;
        }
        // onto the edge (1, slope) of the half-plane of v and the axis
        let along = (axis + self.slope * radius) / (1.0 + self.slope * self.slope);
        v[0] = along;
        let scale = self.slope * along / radius;
        let last = v.len() - 1;
        v.rows_mut(1, last).scale_mut(scale);
    }
}

/// A set given by its projection.
pub struct Projection<F>(pub F);

impl<F: Fn(&mut DVector<f64>)> Set for Projection<F> {
    fn project(&self, v: &mut DVector<f64>) {
        (self.0)(v);
    }
}
