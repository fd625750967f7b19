//! Relative errors of a run against a reference.
//!
//! With the instants t_n that all settings have, the start among them, the error of a quantity q is
//!
//! ```text
//! ( sum_n |q(t_n) - q*(t_n)|^p / sum_n |q*(t_n)|^p )^(1/p)
//! ```
//!
//! | quantity | p | norm at an instant |
//! |---|---|---|
//! | slip rate | 2 | discrete L2 over the contact: sqrt(sum_i omega_i \|q_i\|^2) at the reference's contact nodes, omega_i their weights |
//! | tangential stress | 1 | discrete L1 over the contact: sum_i omega_i \|q_i\| |
//! | displacement | 2 | Euclidean, over the work-conjugate displacements of the loads and the components of the probes |
//! | force | 2 | Euclidean, over the tangential components |
//!
//! The stress jumps where the slip changes its direction. A jump that is off by a distance d is an error of the order of d in
//! L1, and of its square root in L2.

use super::surface::{Kind, Surface, Transfer};
use super::trajectory::{Instant, Trajectory};
use crate::error::{Error, Result};

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    SlipRate,
    TangentialStress,
    Displacement,
    Force,
}

impl Quantity {
    /// All of them, in the order of tables.
    pub const ALL: [Quantity; 4] = [
        Quantity::SlipRate,
        Quantity::TangentialStress,
        Quantity::Displacement,
        Quantity::Force,
    ];

    /// Those that a target bounds. The stress is not among them: it jumps where the slip changes its direction, and a jump
    /// that is off by a fraction of a cell is an error of the order of that fraction of a cell, however smooth the rest.
    pub const JUDGED: [Quantity; 3] = [Quantity::SlipRate, Quantity::Displacement, Quantity::Force];

    /// The exponent p of its error: see the module.
    fn power(self) -> f64 {
        match self {
            Quantity::TangentialStress => 1.0,
            _ => 2.0,
        }
    }

    /// Name as in sentences and, with underscores, in tables.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::SlipRate => "slip rate",
            Quantity::TangentialStress => "tangential stress",
            Quantity::Displacement => "displacement",
            Quantity::Force => "friction force",
        }
    }
}

/// One relative error per quantity; `None` where the reference vanishes (no friction, no slip) or has no such output.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors([Option<f64>; 4]);

impl Errors {
    /// The error of one quantity.
    pub fn of(&self, quantity: Quantity) -> Option<f64> {
        self.0[quantity as usize]
    }

    /// The largest of them; 0 for an empty set.
    pub fn worst(&self) -> f64 {
        self.0.iter().flatten().copied().fold(0.0, f64::max)
    }

    /// Combines quantity by quantity what both have.
    pub fn zip(&self, other: &Errors, combine: impl Fn(f64, f64) -> f64) -> Errors {
        Errors(std::array::from_fn(|i| {
            Some(combine(self.0[i]?, other.0[i]?))
        }))
    }
}

/// Errors of `run`, computed on `surface`, against `reference`, computed on `fine`.
///
/// # Errors
/// [`Error::Value`] when the reference lacks an instant of the run.
pub fn errors(
    (run, surface): (&Trajectory, &Surface),
    (reference, fine): (&Trajectory, &Surface),
) -> Result<Errors> {
    let kinematic = surface.transfer(&fine.contact, Kind::Kinematic)?;
    let stress = surface.transfer(&fine.contact, Kind::Static)?;
    let transfers = [Some(&kinematic), Some(&stress), None, None];
    let weights = fine.contact.weights.as_slice();
    let weights = [weights, weights, &[], &[]];
    let mut error = [0.0; 4];
    let mut scale = [0.0; 4];
    for own in &run.instants {
        let exact = same_instant(reference, own.time)?;
        for (i, (own, exact)) in own.fields().into_iter().zip(exact.fields()).enumerate() {
            let power = Quantity::ALL[i].power();
            error[i] += sum_of_powers(&difference(own, exact, transfers[i]), weights[i], power);
            scale[i] += sum_of_powers(exact, weights[i], power);
        }
    }
    Ok(Errors(Quantity::ALL.map(|quantity| {
        let i = quantity as usize;
        (scale[i] > 0.0).then(|| (error[i] / scale[i]).powf(1.0 / quantity.power()))
    })))
}

/// The instant of a run at a time, up to rounding.
fn same_instant(run: &Trajectory, time: f64) -> Result<&Instant> {
    let slack = 1e-9 * run.until;
    let after = run.instants.partition_point(|i| i.time < time - slack);
    run.instants
        .get(after)
        .filter(|i| (i.time - time).abs() <= slack)
        .ok_or(Error::Value {
            what: "an instant of the run".to_owned(),
            found: time,
            allowed: "the instants of the reference",
        })
}

fn difference(own: &[f64], exact: &[f64], transfer: Option<&Transfer>) -> Vec<f64> {
    let moved = transfer.map(|t| t.apply(own));
    let own = moved.as_deref().unwrap_or(own);
    own.iter().zip(exact).map(|(a, b)| a - b).collect()
}

/// `sum_i weight_i |v_i|^power`, components inner; without weights one vector of weight 1.
fn sum_of_powers(values: &[f64], weights: &[f64], power: f64) -> f64 {
    let components = match weights.len() {
        0 => values.len().max(1),
        nodes => values.len() / nodes,
    };
    let weight = |node: usize| weights.get(node).copied().unwrap_or(1.0);
    let nodes = values.chunks(components.max(1)).enumerate();
    let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    nodes
        .map(|(node, v)| weight(node) * square(v).powf(0.5 * power))
        .sum()
}
