//! What a simulator tells about its solver: solutions found, iterates, work done.

use super::Simulator;
use crate::contact::solve::newton::Work;
use crate::state::report;
use crate::time::lost_digits;

impl Simulator {
    /// Most solutions of one internal step of the last communication step that the multiplicity test found (0 when it is
    /// off), and the largest difference between them, m/s.
    pub fn solutions(&self) -> (f64, f64) {
        let report = &self.state.report;
        (report[report::SOLUTIONS], report[report::SOLUTION_GAP])
    }

    /// The residual of the last communication step where rounding kept the friction law from holding to
    /// `fidelity.friction_tolerance`: the largest force by which it is violated at a node, over the forces that meet there.
    pub fn residual_at_rounding(&self) -> Option<f64> {
        let report = &self.state.report;
        (report[report::ENDING] == report::AT_ROUNDING).then_some(report[report::RESIDUAL])
    }

    /// The residual of the last communication step where `fidelity.work_limit` ended a friction problem at its best iterate: the
    /// largest force by which the friction law is violated at a node, over the bound there.
    pub fn truncated_residual(&self) -> Option<f64> {
        let report = &self.state.report;
        (report[report::ENDING] == report::TRUNCATED).then_some(report[report::RESIDUAL])
    }

    /// How much of displacement and slip the last communication step has lost to rounding, relative and by estimate, where that
    /// is beyond the tolerance of the body (two times `fidelity.tolerance`): stresses and energies that follow from them may be
    /// off by some times as much. Steps of trapezoid and TR-BDF2 lose digits that are millions of relaxation times long and
    /// follow a jump of the loads.
    pub fn lost_digits(&self) -> Option<f64> {
        lost_digits::beyond_tolerance(&self.model, &self.state)
    }

    /// Keeps the iterates of the fixed-point solver from now on; steps then allocate.
    pub fn keep_iterates(&mut self) {
        self.workspace.fixed_point.keep_trace();
    }

    /// Iterates of the last stage that the fixed-point solver solved: slip rates (m/s) and forces on the foundation (N).
    /// Empty unless kept.
    pub fn iterates(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        self.workspace.fixed_point.iterates()
    }

    /// Work done so far by the default friction solver, with pressure or without.
    pub fn friction_work(&self) -> Work {
        let Some(pressed) = &self.workspace.pressed else {
            return self.workspace.newton.work();
        };
        let work = pressed.workspace.work();
        Work {
            factorizations: work.factorizations,
            solves: work.solves,
            products: 0,
        }
    }

    /// Internal steps since the start of the simulation; part of the state.
    pub fn internal_steps(&self) -> u64 {
        self.state.steps
    }

    /// Stages solved so far by this simulator, those of refused steps, error estimates and derivatives included.
    pub fn stage_solves(&self) -> u64 {
        self.workspace.stages.solves()
    }

    /// Pairs of internal steps that the step control has refused so far.
    pub fn refused_pairs(&self) -> u64 {
        let control = self.workspace.control.as_ref();
        control.map_or(0, |control| control.refused)
    }

    /// Iterations of Newton's method on the body so far, one linearised stage each; 0 where all laws are linear.
    pub fn body_iterations(&self) -> u64 {
        let newton = self.workspace.nonlinear.as_ref();
        newton.map_or(0, |newton| newton.iterations)
    }

    /// Halvings of its steps so far.
    pub fn body_halvings(&self) -> u64 {
        let newton = self.workspace.nonlinear.as_ref();
        newton.map_or(0, |newton| newton.halvings)
    }

    /// Stage factorizations made so far: one per step size that was not among the last few; where laws are not linear one per point
    /// of their tangents.
    pub fn factorizations(&self) -> u64 {
        self.workspace.stages.factorizations
    }
}
