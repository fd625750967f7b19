//! Numbers at the ends of their range, and what are none: a scaled solution, or a clear word that there is none.

use crate::body::condensed;
use crate::cases::{Case, Solver, difference};
use crate::check::violation;
use crate::hard::{CONDITIONS, draw};
use crate::laws::Coefficient;
use crate::random::Random;
use stickslip::contact::pressed::NormalCondition;

const K: f64 = 0.05;

/// All velocities, forces and gaps times `factor`; matrix and step stay.
fn scaled(case: &Case, factor: f64) -> Case {
    let mut scaled = case.clone();
    let scale = |x: &mut Vec<f64>| x.iter_mut().for_each(|x| *x *= factor);
    scale(&mut scaled.r);
    scale(&mut scaled.gap_base);
    scale(&mut scaled.slip_base);
    if let NormalCondition::Compliance { exponent } = scaled.condition {
        let stiffness = factor.powf(1.0 - exponent);
        scaled.stiffness.iter_mut().for_each(|c| *c *= stiffness);
    }
    match &mut scaled.friction.coefficient {
        Coefficient::Decaying(_, _, alpha) => *alpha /= factor,
        Coefficient::Creeping(_, velocity) => *velocity *= factor,
        _ => {}
    }
    scaled
}

#[test]
fn scaled_forces_scale_the_solution() {
    let mut random = Random::new(31);
    for body in [condensed(&[12, 6], K), condensed(&[3, 3, 2], K)] {
        for condition in CONDITIONS {
            for law in [
                Coefficient::Constant(0.4),
                Coefficient::Decaying(0.5, 0.3, 1.0),
                Coefficient::Creeping(0.03, 1e-6),
            ] {
                let case = draw(&mut random, &body, law, condition, K);
                let mut found = case.start();
                assert!(case.solve(&mut found).converged);
                for factor in [1e-280, 1e-200, 1e-100, 1e-20, 1e20, 1e100, 1e200, 1e280] {
                    let other = scaled(&case, factor);
                    let mut again = other.start();
                    let reached = other.solve(&mut again);
                    let label = format!("{condition:?} {law:?} {factor:e}: {reached:?}");
                    let numbers = || {
                        again
                            .velocity
                            .iter()
                            .chain(&again.force)
                            .chain(&again.reaction)
                    };
                    assert!(numbers().all(|x| x.is_finite()), "{label}");
                    assert!(reached.converged, "{label}");
                    if reached.converged {
                        let back: Vec<f64> = again.force.iter().map(|f| f / factor).collect();
                        assert!(difference(&back, &found.force) < 1e-8, "{label}");
                        let back: Vec<f64> = again.velocity.iter().map(|v| v / factor).collect();
                        assert!(difference(&back, &found.velocity) < 1e-8, "{label}");
                    }
                }
            }
        }
    }
}

/// A stiff or soft body: the matrix times a factor, and the time step with it.
#[test]
fn stiff_and_soft_bodies_are_solved() {
    let mut random = Random::new(32);
    let body = condensed(&[12, 6], K);
    for condition in CONDITIONS {
        let case = draw(&mut random, &body, Coefficient::Constant(0.4), condition, K);
        let mut found = case.start();
        assert!(case.solve(&mut found).converged);
        for factor in [1e-150, 1e-12, 1e12, 1e150] {
            let mut other = case.clone();
            for j in 0..case.r.len() {
                for i in 0..case.r.len() {
                    other.s[(i, j)] *= factor;
                }
                other.r[j] *= factor;
                other.yielding[j] /= factor;
            }
            other.stiffness.iter_mut().for_each(|c| *c *= factor);
            let mut again = other.start();
            let reached = other.solve(&mut again);
            assert!(reached.converged, "{condition:?} {factor:e} {reached:?}");
            assert!(difference(&again.velocity, &found.velocity) < 1e-8);
        }
    }
}

#[test]
fn what_is_no_number_is_not_accepted() {
    let mut random = Random::new(33);
    let body = condensed(&[6, 3], K);
    for condition in CONDITIONS {
        let law = Coefficient::Decaying(0.5, 0.3, 10.0);
        let case = draw(&mut random, &body, law, condition, K);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for at in [0, 3, 11] {
                let mut broken = case.clone();
                broken.r[at] = bad;
                let start = case.random_start(&mut random, 1.0);
                let mut found = start.clone();
                let reached = broken.solve(&mut found);
                assert!(!reached.converged, "{condition:?} load {bad} {reached:?}");
                assert_eq!(
                    (&found.velocity, &found.force),
                    (&start.velocity, &start.force)
                );
            }
            // a start may be anything: the solve says so, or finds the solution
            let mut found = case.random_start(&mut random, 1.0);
            found.velocity[3] = bad;
            found.force[4] = bad;
            if case.solve(&mut found).converged {
                assert!(violation(&case, &found) < 1e-9);
            }
            let mut broken = case.clone();
            broken.gap_base[2] = f64::NAN;
            assert!(!broken.solve(&mut case.start()).converged, "{condition:?}");
        }
    }
}

/// Nothing at all is solved at once.
#[test]
fn a_body_without_loads_rests() {
    let body = condensed(&[6, 3], K);
    let mut random = Random::new(34);
    for condition in CONDITIONS {
        let mut case = draw(&mut random, &body, Coefficient::Constant(0.4), condition, K);
        case.r.fill(0.0);
        case.gap_base.fill(0.0);
        let mut found = case.start();
        let reached = case.solve(&mut found);
        assert!(reached.converged && reached.iterations == 0);
        assert_eq!(found, case.start());
    }
}

/// An iteration less than needed is an answer without convergence, and more are never taken.
#[test]
fn iterations_are_counted_and_bounded() {
    use stickslip::contact::pressed::{PressedPoint, PressedWorkspace, solve};
    let mut random = Random::new(35);
    let body = condensed(&[12, 6], K);
    for condition in CONDITIONS {
        let case = draw(&mut random, &body, Coefficient::Constant(3.0), condition, K);
        let mut most = 0;
        for limit in 0..200 {
            let mut found = case.start();
            let mut points = Solver::new(&case).points;
            let mut at = PressedPoint::of(&mut points, K, K);
            let mut ws = PressedWorkspace::new(case.nodes(), 1);
            let reached = case.with(|problem| {
                let (v, f, r) = (&mut found.velocity, &mut found.force, &mut found.reaction);
                solve(problem, 1e-10, limit, v, f, r, &mut at, &mut ws)
            });
            assert!(reached.iterations <= limit);
            if reached.converged {
                most = limit;
                break;
            }
            assert!(reached.residual > 1e-10);
        }
        assert!(most > 1);
    }
}
