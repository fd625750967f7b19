//! A run of a scene on its own signals, as far as errors and work need it.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::ports::Quantity as Port;
use crate::scene::Scene;
use crate::simulator::Simulator;
use crate::simulator::drive::Drive;
use std::sync::Arc;

/// What a master sees of the contact and the body at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Instant {
    /// Time, s.
    pub time: f64,
    /// Slip rate of the contact nodes, components inner, m/s.
    pub slip_rate: Vec<f64>,
    /// Tangential stress at the contact nodes, components inner, Pa.
    pub tangential_stress: Vec<f64>,
    /// Work-conjugate displacements of the loads, then the displacements of the probes, m.
    pub displacement: Vec<f64>,
    /// Tangential force of the foundation on the body, one value per component, N.
    pub force: Vec<f64>,
}

impl Instant {
    /// The fields in the order of [`super::Quantity::ALL`].
    pub fn fields(&self) -> [&[f64]; 4] {
        [
            &self.slip_rate,
            &self.tangential_stress,
            &self.displacement,
            &self.force,
        ]
    }
}

/// Operations of a run; the same on every machine. Multiplications are counted, not measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Work {
    /// Internal steps, those that were undone apart.
    pub steps: u64,
    /// Friction iterations, those of undone steps and of the error estimate included.
    pub iterations: u64,
    /// Multiplications of the steps, of undone steps and of the error estimate too: the model of the body twice per stage,
    /// the contact operator once per iteration.
    pub multiplications: f64,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The start and every instant asked for.
    pub instants: Vec<Instant>,
    pub work: Work,
    /// End of the run, s.
    pub until: f64,
}

/// Runs a compiled scene on its signals and keeps every communication point whose number is a multiple of `stride`, the
/// start and the end.
///
/// # Errors
/// Those of the simulator; [`Error::Unstable`] for results that are not finite or an explicit scheme beyond its limit.
pub fn run(scene: &Scene, model: &Arc<Model>, stride: u64) -> Result<Trajectory> {
    let mut simulator = Simulator::new(Arc::clone(model));
    let iterations = model.ports().find("solver.iterations")?.reference;
    let mut drive = Drive::start(scene, &mut simulator)?;
    let mut instants = vec![instant(drive.simulator())?];
    let (until, count) = (drive.points().until, drive.points().count);
    let mut work = Work::default();
    let mut passed = 0;
    while let Some(simulator) = drive.step()? {
        let mut value = [0.0];
        simulator.get(iterations, &mut value)?;
        work.iterations += value[0] as u64;
        if drive.passed() > passed {
            passed = drive.passed();
            if passed % stride == 0 || passed == count {
                instants.push(instant(drive.simulator())?);
            }
        }
    }
    work.steps = simulator.internal_steps();
    let contact = model.contact().len() as f64;
    work.multiplications = simulator.stage_solves() as f64 * model.stage_multiplications() as f64
        + work.iterations as f64 * contact * contact;
    Ok(Trajectory {
        instants,
        work,
        until,
    })
}

fn instant(simulator: &Simulator) -> Result<Instant> {
    let mut displacement = Vec::new();
    for port in simulator.model().ports().outputs() {
        if let Port::LoadDisplacement(_) | Port::ProbeDisplacement(_) = port.quantity {
            let mut values = vec![0.0; port.len()];
            simulator.get(port.reference, &mut values)?;
            displacement.extend(values);
        }
    }
    let found = Instant {
        time: simulator.time(),
        slip_rate: simulator.get_by_name("contact.slip_rate")?,
        tangential_stress: simulator.get_by_name("contact.tangential_stress")?,
        displacement,
        force: simulator.get_by_name("contact.force")?,
    };
    let mut values = found.slip_rate.iter().chain(&found.tangential_stress);
    if values.all(|v| v.is_finite()) {
        Ok(found)
    } else {
        Err(Error::Value {
            what: format!("the results at time {}", found.time),
            found: f64::NAN,
            allowed: "finite numbers: the scheme may be unstable at this step",
        })
    }
}
