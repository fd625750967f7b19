//! A search for other solutions of a stage, from two sides: the solution that sticks wherever it is closed, and the one without
//! friction. Where strong friction or a bound that weakens leaves several solutions, these lead to the extreme ones.
//!
//! The sign of the determinant at the accepted solution tells more: a negative one proves that there are at least three.

use super::linearisation::{PressedPoint, points_len};
use super::problem::PressedProblem;
use super::replaced::Frozen;
use super::solve::{PressedWorkspace, index, solve};
use crate::contact::multiplicity::Multiplicity;

/// A bound that no force within a body reaches, as a multiple of the forces that load its contact.
const HOLDING: f64 = 100.0;

/// Scratch of the search.
pub struct PressedMultiplicity {
    candidates: [Vec<f64>; 2],
    force: Vec<f64>,
    reaction: Vec<f64>,
    bounds: Vec<f64>,
    points: Vec<f64>,
    workspace: PressedWorkspace,
}

impl PressedMultiplicity {
    /// For `nodes` nodes of `components` tangential components each.
    pub fn new(nodes: usize, components: usize) -> PressedMultiplicity {
        let zeros = vec![0.0; nodes * (components + 1)];
        PressedMultiplicity {
            candidates: [zeros.clone(), zeros.clone()],
            force: zeros.clone(),
            reaction: zeros,
            bounds: vec![0.0; nodes],
            points: vec![0.0; points_len(nodes, components)],
            workspace: PressedWorkspace::new(nodes, components),
        }
    }

    /// Looks for solutions other than that of these velocities and forces. Allocates nothing.
    pub fn search(
        &mut self,
        problem: &PressedProblem,
        (tolerance, max_iterations): (f64, usize),
        velocity: &[f64],
        force: &[f64],
    ) -> Multiplicity {
        let mut found = Multiplicity::ONE;
        let PressedMultiplicity {
            candidates,
            force: candidate_force,
            reaction,
            bounds,
            points,
            workspace,
        } = self;
        let holding = HOLDING * problem.r.iter().map(|r| r.abs()).sum::<f64>();
        for (at, bound) in [holding, 0.0].into_iter().enumerate() {
            let (before, rest) = candidates.split_at_mut(at);
            let candidate = &mut rest[0];
            candidate.fill(0.0);
            candidate_force.fill(0.0);
            bounds.fill(bound);
            let mut solve = |problem: &PressedProblem| {
                let mut point = PressedPoint::fresh(points, problem);
                solve(
                    problem,
                    tolerance,
                    max_iterations,
                    candidate,
                    candidate_force,
                    reaction,
                    &mut point,
                    workspace,
                )
            };
            let frozen = Frozen(bounds);
            // wherever that leads, it is a start
            solve(&PressedProblem {
                bounds: &frozen,
                ..*problem
            });
            if solve(problem).converged {
                let others = before.iter().map(Vec::as_slice);
                found.count(candidate, velocity, others);
            }
        }
        if index(problem, velocity, force, workspace) < 0.0 {
            found.solutions = found.solutions.max(3);
        }
        found
    }
}
