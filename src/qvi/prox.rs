//! The proximal map of all that is not smooth in the frozen inequality,
//!
//! ```text
//! P(z) = argmin over x in K of |x - z|^2 / 2 + t sum_i c_i rho_i(x_i)
//! ```
//!
//! in closed form where K is the whole space, or a box and the parts have one component each; by Dykstra's alternating proximal maps
//! of both otherwise (Bauschke and Combettes, Pacific J. Optim. 4 (2008) 383-391).

use super::SolveError;
use super::functional::Part;
use super::set::{Restricted, Set};
use nalgebra::DVector;

/// Relative change at which the alternation stops, and most passes of it.
const TOLERANCE: f64 = 1e-15;
const PASSES: usize = 20_000;

/// Parts and set.
#[derive(Clone, Copy)]
pub(super) struct Nonsmooth<'a> {
    pub parts: &'a [Part],
    pub set: &'a dyn Set,
}

impl Nonsmooth<'_> {
    /// Components that parts or the set touch, ascending.
    pub fn touched(&self, dimension: usize) -> Vec<usize> {
        let mut is_touched = vec![false; dimension];
        let parts = self.parts.iter().flat_map(|part| part.components.clone());
        parts.for_each(|i| is_touched[i] = true);
        match self.set.restricted() {
            Restricted::All => is_touched.fill(true),
            Restricted::Components(of_set) => of_set.into_iter().for_each(|i| is_touched[i] = true),
        }
        (0..dimension).filter(|i| is_touched[*i]).collect()
    }

    fn prox_of_parts(&self, t: f64, coefficients: &[f64], z: &mut DVector<f64>) {
        for (part, coefficient) in self.parts.iter().zip(coefficients) {
            let components = &mut z.as_mut_slice()[part.components.clone()];
            part.shape.prox(t * coefficient, components);
        }
    }

    /// P, in place.
    ///
    /// # Errors
    /// [`SolveError::InnerNotConverged`].
    pub fn prox(
        &self,
        t: f64,
        coefficients: &[f64],
        z: &mut DVector<f64>,
    ) -> Result<(), SolveError> {
        let is_free = matches!(self.set.restricted(), Restricted::Components(c) if c.is_empty());
        let is_split = self.set.is_box() && self.parts.iter().all(|p| p.components.len() == 1);
        if is_free || is_split {
            self.prox_of_parts(t, coefficients, z);
            self.set.project(z);
            return Ok(());
        }
        if coefficients.iter().all(|c| *c == 0.0) {
            self.set.project(z);
            return Ok(());
        }
        self.alternate(t, coefficients, z)
    }

    fn alternate(
        &self,
        t: f64,
        coefficients: &[f64],
        z: &mut DVector<f64>,
    ) -> Result<(), SolveError> {
        let scale = z.amax().max(f64::MIN_POSITIVE);
        let (mut p, mut q) = (z.clone() * 0.0, z.clone() * 0.0);
        let mut change = f64::INFINITY;
        for _ in 0..PASSES {
            let before = z.clone();
            let mut y = &*z + &p;
            self.prox_of_parts(t, coefficients, &mut y);
            p += &*z - &y;
            let mut x = &y + &q;
            self.set.project(&mut x);
            q += &y - &x;
            change = (&x - &y).amax().max((&x - &before).amax());
            z.copy_from(&x);
            if change <= TOLERANCE * scale {
                return Ok(());
            }
        }
        // digits that rounding takes from the alternation are no failure
        if change <= 1e3 * TOLERANCE * scale {
            return Ok(());
        }
        Err(SolveError::InnerNotConverged {
            change,
            iterations: PASSES,
        })
    }
}
