//! Scratch of one simulator: rebuilt at will, never saved, never changes a result.

use super::body_newton::BodyNewton;
use super::finite::FiniteCheck;
use super::limit::WorkLimit;
use super::memory::Before;
use super::pressed::PressedScratch;
use super::relative::Relative;
use super::scheme::MAX_STAGES;
use super::velocity::Velocity;
use crate::body::{Scratch, StageCache};
use crate::contact::solve::fixed_point::FixedPointWorkspace;
use crate::contact::solve::multiplicity::MultiplicityWorkspace;
use crate::contact::solve::newton;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::state::State;

/// Where an input bends within a communication step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bend {
    pub input: usize,
    /// Fraction of the step, between 0 and 1.
    pub fraction: f64,
    pub value: f64,
}

/// Inputs at the two ends of a communication step, linear between them but for bends, and their derivatives by the inputs as set.
#[derive(Debug, Clone, Default)]
pub(crate) struct LoadCourse {
    pub start: Vec<f64>,
    pub end: Vec<f64>,
    pub start_by_input: Vec<f64>,
    pub end_by_input: Vec<f64>,
    /// Size of the communication step, s.
    pub size: f64,
    /// Ascending by input and fraction.
    pub bends: Vec<Bend>,
}

impl LoadCourse {
    pub fn new(loads: usize) -> LoadCourse {
        let zeros = vec![0.0; loads];
        LoadCourse {
            start: zeros.clone(),
            end: zeros.clone(),
            start_by_input: zeros.clone(),
            end_by_input: zeros,
            size: 0.0,
            bends: Vec::new(),
        }
    }

    /// Loads at a fraction of the communication step.
    pub fn at(&self, fraction: f64, loads: &mut [f64]) {
        let ends = self.start.iter().zip(&self.end);
        for (load, (from, to)) in loads.iter_mut().zip(ends) {
            *load = if fraction == 1.0 {
                *to
            } else {
                from + (to - from) * fraction
            };
        }
        for bends in self.bends.chunk_by(|a, b| a.input == b.input) {
            let input = bends[0].input;
            let (start, end) = ((0.0, self.start[input]), (1.0, self.end[input]));
            let next = bends.partition_point(|bend| bend.fraction < fraction);
            let at = |i: usize| bends.get(i).map(|bend| (bend.fraction, bend.value));
            let before = next.checked_sub(1).and_then(at).unwrap_or(start);
            let after = at(next).unwrap_or(end);
            let share = (fraction - before.0) / (after.0 - before.0);
            loads[input] = match share {
                1.0 => after.1,
                _ => before.1 + (after.1 - before.1) * share,
            };
        }
    }
}

/// Explicit part of a stage.
pub(crate) struct Explicit {
    pub displacement: Vec<f64>,
    pub accumulated_slip: Vec<f64>,
    pub normal_displacement: Vec<f64>,
    pub drive_displacement: Vec<f64>,
}

impl Explicit {
    pub fn new(model: &Model) -> Explicit {
        Explicit {
            displacement: vec![0.0; model.states()],
            accumulated_slip: vec![0.0; model.contact().node_count()],
            normal_displacement: vec![0.0; State::sizes(model).normal()],
            drive_displacement: vec![0.0; model.motions().drives.len()],
        }
    }

    /// What holds with a step of size 0: the position of a state.
    pub fn follow(&mut self, state: &State) {
        let main = &state.main;
        self.displacement.copy_from_slice(&main.displacement);
        self.accumulated_slip
            .copy_from_slice(&main.accumulated_slip);
        self.normal_displacement
            .copy_from_slice(&main.normal_displacement);
        self.drive_displacement
            .copy_from_slice(&state.drive_displacement);
    }
}

/// Scratch of the control.
pub(crate) struct ControlWorkspace {
    /// The state before the pair.
    pub kept: State,
    /// Error of the displacement of the body.
    pub body: Vec<f64>,
    /// Error of the slip.
    pub contact: Vec<f64>,
    /// What the second step of a pair started from, where a step solves for its end: the scratch of its start is then used up.
    pub middle: Option<Velocity>,
    /// Pairs refused so far.
    pub refused: u64,
}

impl ControlWorkspace {
    pub fn new(model: &Model) -> ControlWorkspace {
        ControlWorkspace {
            kept: State::without_history(model),
            body: vec![0.0; model.states()],
            contact: vec![0.0; model.contact().len()],
            middle: (!model.tableau().ends_with_stage()).then(|| Velocity::new(model)),
            refused: 0,
        }
    }
}

pub(crate) struct Workspace {
    pub stages: StageCache,
    pub scratch: Scratch,
    pub newton: newton::Workspace,
    pub fixed_point: FixedPointWorkspace,
    pub multiplicity: MultiplicityWorkspace,
    /// The start of the step, then its stages.
    pub velocities: [Velocity; MAX_STAGES + 1],
    pub mean: Velocity,
    pub explicit: Explicit,
    /// Inputs over the communication step.
    pub course: LoadCourse,
    /// Inputs at the instant of the stage.
    pub load: Vec<f64>,
    /// What moves with the body or under it, in a stage.
    pub relative: Relative,
    /// Whether the velocity followed a jump at the beginning of the communication step.
    pub has_settled: bool,
    /// Displacements of the foundations towards the body at the beginning and at the end of the internal step.
    pub approach: [Approach; 2],
    /// Scratch of the solver with pressure, where there is one.
    pub pressed: Option<PressedScratch>,
    /// Scratch of the body's own iterations, where its laws are not linear.
    pub nonlinear: Option<BodyNewton>,
    /// What the memory of the friction law begins with in the stage that is solved.
    pub before: Before,
    /// What foundations that relax add to the force of a depth in that stage (see `PressedProblem::relaxing`).
    pub relaxing: Vec<[f64; 2]>,
    pub condensed_load: Vec<f64>,
    /// Displacement of the last iterate of the fixed point.
    pub last_iterate: Vec<f64>,
    /// Scratch of the step control, where there is one.
    pub control: Option<ControlWorkspace>,
    pub finite: FiniteCheck,
    /// Friction iterations that are left to the communication step.
    pub limit: WorkLimit,
}

impl Workspace {
    pub fn new(model: &Model) -> Workspace {
        let contact = model.contact();
        let len = contact.len();
        let loads = vec![0.0; model.interpolations().len()];
        // the solvers without pressure are not needed with it
        let (own_points, own_len) = match contact.has_normal {
            true => (&contact.points[..1], contact.components),
            false => (&contact.points[..], len),
        };
        let own_nodes = own_points.len();
        Workspace {
            stages: StageCache::new(
                model.body(),
                model.sizes_kept(),
                contact.has_normal,
                &contact.pins,
            ),
            scratch: model.body().scratch(),
            newton: newton::Workspace::new(own_points, own_len),
            fixed_point: FixedPointWorkspace::new(own_nodes, own_len),
            multiplicity: MultiplicityWorkspace::new(own_points, own_len),
            relative: Relative::new(model),
            has_settled: false,
            approach: [Approach::NONE; 2],
            pressed: contact.has_normal.then(|| PressedScratch::new(model)),
            nonlinear: BodyNewton::new(model),
            before: Before::new(model),
            relaxing: vec![[0.0; 2]; model.relaxing_nodes()],
            velocities: std::array::from_fn(|_| Velocity::new(model)),
            mean: Velocity::new(model),
            explicit: Explicit::new(model),
            course: LoadCourse::new(loads.len()),
            load: loads,
            condensed_load: vec![0.0; contact.force_len()],
            last_iterate: vec![0.0; model.states()],
            finite: FiniteCheck::new(model),
            limit: WorkLimit::default(),
            control: (model.tolerance().is_some()).then(|| ControlWorkspace::new(model)),
        }
    }
}
