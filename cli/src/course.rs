//! The course of a scene: its simulator, stepped from communication point to communication point on the scene's signals.

use crate::failure::Failure;
use std::ops::Range;
use std::time::{Duration, Instant};
use stickslip::simulator::drive::Drive;
use stickslip::{Scene, Simulator};

/// The contact and the energies at one communication point. Contact arrays go node by node, components inner.
#[derive(Debug, Clone)]
pub struct Frame {
    pub time: f64,
    pub slip_rate: Vec<f64>,
    pub slip: Vec<f64>,
    pub accumulated_slip: Vec<f64>,
    pub tangential_stress: Vec<f64>,
    /// 1 where a node sticks.
    pub stick: Vec<f64>,
    /// Names and values of what the contact has along its normal: pressure, gap, status; as far as the scene has them.
    pub normal: Vec<(&'static str, Vec<f64>)>,
    pub energy: Energy,
}

/// Ports along the normal that a scene may have.
pub const NORMAL: [&str; 3] = ["contact.pressure", "contact.gap", "contact.status"];

impl Frame {
    /// The same of some of the contact nodes, which can open or not.
    pub fn of_nodes(&self, nodes: Range<usize>, can_open: bool) -> Frame {
        let c = self.slip_rate.len() / self.stick.len();
        let field = |values: &[f64]| values[nodes.start * c..nodes.end * c].to_vec();
        let nodal = |values: &[f64]| values[nodes.clone()].to_vec();
        let [pressure, ..] = NORMAL;
        let normal = self.normal.iter();
        let normal = normal.filter(|(name, _)| can_open || *name == pressure);
        Frame {
            time: self.time,
            slip_rate: field(&self.slip_rate),
            slip: field(&self.slip),
            accumulated_slip: nodal(&self.accumulated_slip),
            tangential_stress: field(&self.tangential_stress),
            stick: nodal(&self.stick),
            normal: normal
                .map(|(name, values)| (*name, nodal(values)))
                .collect(),
            energy: self.energy,
        }
    }

    /// Values of a port along the normal.
    pub fn normal(&self, name: &str) -> &[f64] {
        let known = self.normal.iter().find(|(known, _)| *known == name);
        known.map_or(&[], |(_, values)| values)
    }
}

/// Energies since the start, J.
#[derive(Debug, Clone, Copy)]
pub struct Energy {
    pub external_work: f64,
    pub elastic: f64,
    pub viscous: f64,
    pub friction: f64,
    pub balance_error: f64,
}

/// What the steps took.
#[derive(Debug, Clone, Default)]
pub struct Effort {
    /// Friction iterations of every communication step.
    pub iterations: Vec<f64>,
    /// Internal steps in all.
    pub internal_steps: u64,
    /// Pairs of internal steps that were undone.
    pub refused_pairs: u64,
    /// Largest friction residual.
    pub residual: f64,
    /// Communication steps in which rounding kept the friction law from holding to the tolerance.
    pub at_rounding: u64,
    /// Communication steps that the limit of work ended.
    pub truncated: u64,
    /// Communication steps in which displacement and slip lost more digits than the tolerance allows.
    pub lossy: u64,
    /// Largest share that was lost in one of them.
    pub lost_digits: f64,
    /// What the test for several solutions found, where it is on.
    pub multiplicity: Option<Multiplicity>,
    /// Largest estimate of the error in time, where there is one.
    pub error_estimate: Option<f64>,
    /// Time spent in steps.
    pub stepping: Duration,
}

/// What the test for several solutions found in a run.
#[derive(Debug, Clone, Copy, Default)]
pub struct Multiplicity {
    /// Communication steps in which an internal step had several solutions.
    pub steps: u64,
    /// Largest difference between solutions of one internal step, m/s.
    pub gap: f64,
}

impl Effort {
    /// Mean iterations per internal step.
    pub fn mean_iterations(&self) -> f64 {
        self.iterations.iter().sum::<f64>() / self.internal_steps.max(1) as f64
    }

    /// Most iterations of one communication step.
    pub fn most_iterations(&self) -> f64 {
        self.iterations.iter().copied().fold(0.0, f64::max)
    }
}

/// Steps the scene, from its start or (a simulator that has been restored) from where it stands, and shows every communication point, the first
/// one included, to `observe`.
pub fn follow(
    scene: &Scene,
    source_name: &str,
    simulator: &mut Simulator,
    mut observe: impl FnMut(&Simulator, &Frame) -> Result<(), Failure>,
) -> Result<Effort, Failure> {
    let failed = Failure::of(source_name);
    let mut effort = Effort::default();
    if scene.fidelity.multiplicity_test {
        effort.multiplicity = Some(Multiplicity::default());
    }
    let before = simulator.internal_steps();
    let mut drive = match simulator.is_initialized() {
        true => Drive::resume(scene, simulator),
        false => Drive::start(scene, simulator),
    }
    .map_err(&failed)?;
    observe(
        drive.simulator(),
        &frame(drive.simulator()).map_err(&failed)?,
    )?;
    loop {
        let start = Instant::now();
        let Some(simulator) = drive.step().map_err(&failed)? else {
            break;
        };
        effort.stepping += start.elapsed();
        if let Some(found) = &mut effort.multiplicity {
            let (solutions, gap) = simulator.solutions();
            found.steps += u64::from(solutions > 1.0);
            found.gap = found.gap.max(gap);
        }
        let scalar = |name| Ok(simulator.get_by_name(name)?[0]);
        effort
            .iterations
            .push(scalar("solver.iterations").map_err(&failed)?);
        let residual = scalar("solver.residual").map_err(&failed)?;
        effort.residual = effort.residual.max(residual);
        effort.at_rounding += u64::from(simulator.residual_at_rounding().is_some());
        effort.truncated += u64::from(simulator.truncated_residual().is_some());
        if let Some(lost) = simulator.lost_digits() {
            effort.lossy += 1;
            effort.lost_digits = effort.lost_digits.max(lost);
        }
        if let Ok(estimate) = scalar("solver.error_estimate") {
            effort.error_estimate = Some(effort.error_estimate.unwrap_or(0.0).max(estimate));
        }
        observe(simulator, &frame(simulator).map_err(&failed)?)?;
    }
    effort.internal_steps = simulator.internal_steps() - before;
    effort.refused_pairs = simulator.refused_pairs();
    Ok(effort)
}

fn frame(simulator: &Simulator) -> stickslip::Result<Frame> {
    let get = |name: &str| simulator.get_by_name(name);
    let one = |name: &str| Ok(get(name)?[0]);
    Ok(Frame {
        time: simulator.time(),
        slip_rate: get("contact.slip_rate")?,
        slip: get("contact.slip")?,
        accumulated_slip: get("contact.accumulated_slip")?,
        tangential_stress: get("contact.tangential_stress")?,
        stick: get("contact.stick")?,
        normal: NORMAL
            .iter()
            .filter_map(|name| Some((*name, get(name).ok()?)))
            .collect(),
        energy: Energy {
            external_work: one("energy.external_work")?,
            elastic: one("energy.elastic")?,
            viscous: one("energy.viscous_dissipation")?,
            friction: one("energy.friction_dissipation")?,
            balance_error: one("energy.balance_error")?,
        },
    })
}
