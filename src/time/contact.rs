//! The contact of a stage, solved with pressure or without.

use super::limit::WorkLimit;
use super::memory::{Span, remembering};
use super::pressed::{Level, PressedStage};
use super::workspace::Workspace;
use super::{penetration, slip_memory, uniqueness};
use crate::body::Stage;
use crate::contact::law::{ContactBounds, PressedBoundsOf};
use crate::contact::multiplicity::Multiplicity;
use crate::contact::problem::norm;
use crate::contact::solve::newton::linearisation::Linearisation;
use crate::contact::solve::{fixed_point, multiplicity, newton};
use crate::contact::{ContactProblem, SlipPath};
use crate::error::Error;
use crate::model::{Model, SolverSettings};
use crate::state::{Instant, State, report};

/// What a friction solver says of a stage.
pub(super) struct Solved {
    pub iterations: usize,
    pub residual: f64,
    pub node: usize,
    pub converged: bool,
    pub is_at_rounding: bool,
    /// Whether the limit of work has ended the solve at its best iterate.
    pub is_truncated: bool,
    /// Why the solution is none.
    pub fault: Option<Error>,
}

/// Solves the contact of the stage that was predicted last, into `ws.velocities[index]`, with the solver that the scene needs.
pub(super) fn solve(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, level, span): (f64, Level, Span),
    index: usize,
) -> Solved {
    let Some(pressed) = &mut ws.pressed else {
        return solve_without_pressure(model, state, ws, (theta_k, span), index);
    };
    let settings = model.solver();
    let weights = &model.contact().weights;
    // at a start the state is the one there
    ws.before.take(&ws.velocities[index.saturating_sub(1)]);
    let slip_stage = slip_memory::stage(model, span.length, theta_k);
    let law = model
        .friction()
        .pressed(&state.coefficients, weights, slip_stage);
    penetration::set_lines(
        model,
        &ws.velocities[index.saturating_sub(1)],
        span.length,
        &mut ws.relaxing,
    );
    let bounds = remembering(law, ws.before.memory(model, span.length));
    let at = PressedStage {
        model,
        stage: ws.stages.current(),
        load: &ws.condensed_load,
        bounds: &bounds,
        theta_k,
        level,
        relaxing: &ws.relaxing,
        slip: &ws.explicit.accumulated_slip,
        displacement: &ws.explicit.normal_displacement,
    };
    let (velocity, points) = (&mut ws.velocities[index], &mut state.main.pressed_point);
    let most = ws.limit.share(settings.max_iterations());
    let limits = (settings.tolerance(), most);
    let found = pressed.solve(&at, velocity, points, limits);
    ws.limit.spend(found.iterations);
    let mut is_searched = model.has_multiplicity_test();
    if model.asks_uniqueness() && found.converged {
        let (values, instant) = (&state.coefficients, &velocity.instant);
        let load = uniqueness::load_with_pressure(model, values, theta_k, &bounds, instant);
        is_searched = uniqueness::note(model, &mut state.report, load);
    }
    if is_searched && found.converged {
        let limits = (settings.tolerance(), settings.max_iterations());
        let others = pressed.search(&at, limits);
        note_multiplicity(&mut state.report, others.unwrap_or(Multiplicity::ONE));
    }
    let fault = match model.friction().has_formula() {
        true => fault_of_formula(&at, &bounds, &velocity.instant),
        false => None,
    };
    Solved {
        iterations: found.iterations,
        residual: found.residual,
        node: found.node,
        converged: found.converged,
        is_at_rounding: found.is_at_rounding,
        is_truncated: is_truncated(&ws.limit, found.converged, found.residual),
        fault,
    }
}

/// The first node of a solution where a formula gives no value that friction can have.
fn fault_of_formula(
    at: &PressedStage,
    bounds: &PressedBoundsOf,
    solution: &Instant,
) -> Option<Error> {
    let components = at.model.contact().components;
    let mut rates = solution.slip_rate.chunks_exact(components).map(norm);
    let (node, found) = (0..at.slip.len()).find_map(|node| {
        let slip = SlipPath {
            base: at.slip[node],
            per_rate: at.theta_k,
        };
        let found = bounds.fault(node, rates.next()?, solution.normal_force[node], slip);
        found.map(|found| (node, found))
    })?;
    let parts = at.model.friction().parts().iter();
    let part = parts.rev().find(|part| node >= part.nodes.start)?;
    let (path, own) = (part.law.path(0), node - part.nodes.start);
    Some(Error::Value {
        what: format!("the value of {path} at contact node {own}"),
        found,
        allowed: "a finite number >= 0",
    })
}

/// The contact problem without pressure of a stage.
pub(super) fn problem<'a>(
    model: &'a Model,
    (stage, theta_k): (&'a Stage, f64),
    load: &'a [f64],
    bounds: &'a ContactBounds,
    slip: &'a [f64],
) -> ContactProblem<'a> {
    ContactProblem {
        s: stage.s.as_ref(),
        r: load,
        components: model.contact().components,
        weights: &model.contact().weights,
        law: bounds,
        slip_base: slip,
        theta_k,
    }
}

fn solve_without_pressure(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, span): (f64, Span),
    index: usize,
) -> Solved {
    let body = model.body();
    let slip_stage = slip_memory::stage(model, span.length, theta_k);
    let bounds = (model.friction()).in_stage(&state.coefficients, slip_stage);
    let stage = ws.stages.current();
    let slip = &ws.explicit.accumulated_slip;
    let contact = problem(model, (stage, theta_k), &ws.condensed_load, &bounds, slip);
    let velocity = &mut ws.velocities[index];
    let solution = match model.solver() {
        SolverSettings::Newton {
            tolerance,
            max_iterations,
        } => newton::solve(
            &contact,
            *tolerance,
            ws.limit.share(*max_iterations),
            &mut velocity.instant.slip_rate,
            &mut Linearisation::of(&mut state.main.linearisation, theta_k),
            &mut ws.newton,
        ),
        SolverSettings::FixedPoint(settings) => {
            let (trial, scratch) = (&mut velocity.instant.velocity, &mut ws.scratch);
            let (last, explicit) = (&mut ws.last_iterate, &ws.explicit.displacement);
            let relative = &mut ws.relative;
            last.copy_from_slice(&state.main.displacement);
            fixed_point::solve(
                &contact,
                *settings,
                &state.main.instant.force,
                &mut velocity.instant.slip_rate,
                &mut ws.newton,
                &mut ws.fixed_point,
                |w, force| {
                    body.correct(stage, relative.of_body(w), force, trial, scratch);
                    let size = model.strain_norm(last);
                    for (i, w) in trial.iter_mut().enumerate() {
                        let displacement = explicit[i] + theta_k * *w;
                        *w = displacement - last[i];
                        last[i] = displacement;
                    }
                    (model.strain_norm(trial), size)
                },
            )
        }
    };
    ws.limit.spend(solution.iterations);
    let is_truncated = is_truncated(&ws.limit, solution.converged, solution.residual);
    if solution.converged || is_truncated {
        let accepted = ws.newton.accepted();
        contact.forces(accepted, &mut velocity.instant.force);
        for (reaction, y) in velocity.instant.reaction.iter_mut().zip(&accepted.y) {
            *reaction = -y;
        }
    }
    Solved {
        iterations: solution.iterations,
        residual: solution.residual,
        node: solution.node,
        converged: solution.converged,
        is_at_rounding: solution.is_at_rounding,
        is_truncated,
        fault: None,
    }
}

/// Whether a solve that has not converged ends where it is, because there is a limit of work.
fn is_truncated(limit: &WorkLimit, converged: bool, residual: f64) -> bool {
    limit.is_given() && !converged && residual.is_finite()
}

/// Takes note of whether the stage has one solution, and of others, where the scene asks.
pub(super) fn test_uniqueness(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, span): (f64, Span),
    index: usize,
) {
    if ws.pressed.is_some() {
        return;
    }
    let mut is_searched = model.has_multiplicity_test();
    if model.asks_uniqueness() {
        let load = uniqueness::load_without_pressure(model, &state.coefficients, theta_k);
        is_searched = uniqueness::note(model, &mut state.report, load);
    }
    if is_searched {
        test_multiplicity(model, state, ws, (theta_k, span), index);
    }
}

/// Takes note of other solutions of the stage.
fn test_multiplicity(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, span): (f64, Span),
    index: usize,
) {
    let settings = model.solver();
    let slip_stage = slip_memory::stage(model, span.length, theta_k);
    let bounds = (model.friction()).in_stage(&state.coefficients, slip_stage);
    let at = (ws.stages.current(), theta_k);
    let slip = &ws.explicit.accumulated_slip;
    let found = multiplicity::test(
        &problem(model, at, &ws.condensed_load, &bounds, slip),
        |node| bounds.extremes(node),
        settings.tolerance(),
        settings.max_iterations(),
        &ws.velocities[index].instant.slip_rate,
        &mut ws.multiplicity,
    );
    note_multiplicity(&mut state.report, found);
}

fn note_multiplicity(entry: &mut [f64], found: Multiplicity) {
    entry[report::SOLUTIONS] = entry[report::SOLUTIONS].max(found.solutions as f64);
    entry[report::SOLUTION_GAP] = entry[report::SOLUTION_GAP].max(found.gap);
}
