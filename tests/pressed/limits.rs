//! Limits in which the answer is known otherwise.

use crate::body::{Condensed, condensed};
use crate::cases::{Case, Found, Solver, difference};
use crate::check::violation;
use crate::hard::{CONDITIONS, draw};
use crate::laws::{Coefficient, Friction, Pressure};
use crate::random::Random;
use faer::Mat;
use stickslip::contact::ContactProblem;
use stickslip::contact::bounds::FrozenBounds;
use stickslip::contact::pressed::NormalCondition;
use stickslip::contact::solve::newton::linearisation::{Linearisation, block_len};
use stickslip::contact::solve::newton::{self, Workspace};

const K: f64 = 0.05;

fn bodies() -> Vec<Condensed> {
    vec![condensed(&[16, 8], K), condensed(&[4, 3, 2], K)]
}

fn solved(case: &Case, tolerance: f64) -> Found {
    let (mut solver, mut found) = (Solver::new(case), case.start());
    solver.tolerance = tolerance;
    let reached = solver.solve(case, &mut found);
    assert!(reached.converged, "{reached:?}");
    assert!(violation(case, &found) < 1e-9);
    found
}

/// Without friction no tangential force acts, whatever the law is called.
#[test]
fn no_coefficient_is_no_friction() {
    let mut random = Random::new(11);
    for body in &bodies() {
        for condition in CONDITIONS {
            let mut case = draw(&mut random, body, Coefficient::Constant(0.0), condition, K);
            let found = solved(&case, 1e-13);
            let d = case.components + 1;
            assert!(
                found
                    .force
                    .chunks(d)
                    .all(|f| f[..d - 1].iter().all(|f| *f == 0.0))
            );
            assert!(found.force.chunks(d).any(|f| f[d - 1] > 0.0));
            assert!(
                found
                    .velocity
                    .chunks(d)
                    .all(|v| v[..d - 1].iter().all(|v| *v != 0.0))
            );
            case.friction.coefficient = Coefficient::Decaying(0.0, 0.0, 50.0);
            assert!(difference(&solved(&case, 1e-13).velocity, &found.velocity) < 1e-13);
        }
    }
}

/// A bound that does not depend on the pressure, in bilateral contact: the problem of the solver without normal ports.
#[test]
fn a_given_bound_gives_what_the_tangential_solver_finds() {
    let mut random = Random::new(12);
    for body in &bodies() {
        let (mut slipping, mut sticking) = (0, 0);
        for bound in [1e-3, 0.02, 0.3, 3.0] {
            let mut case = draw(
                &mut random,
                body,
                Coefficient::Constant(0.5),
                CONDITIONS[0],
                K,
            );
            case.friction.pressure = Pressure::Given(bound);
            let found = solved(&case, 1e-13);
            let (c, d) = (case.components, case.components + 1);
            let ports: Vec<usize> = (0..case.r.len()).filter(|i| i % d < c).collect();
            let s = Mat::from_fn(ports.len(), ports.len(), |i, j| {
                case.s[(ports[i], ports[j])]
            });
            let r: Vec<f64> = ports.iter().map(|i| case.r[*i]).collect();
            let weights = vec![1.0; case.nodes()];
            let bounds = vec![0.5 * bound; case.nodes()];
            let problem = ContactProblem {
                s: s.as_ref(),
                r: &r,
                components: c,
                weights: &weights,
                law: &FrozenBounds(&bounds),
                slip_base: &case.slip_base,
                theta_k: K,
            };
            let mut w = vec![0.0; ports.len()];
            let mut blocks = vec![0.0; case.nodes() * block_len(c)];
            let mut at = Linearisation::fresh(&mut blocks, K);
            let mut ws = Workspace::factored(case.nodes(), w.len());
            assert!(newton::solve(&problem, 1e-13, 200, &mut w, &mut at, &mut ws).converged);
            let tangential: Vec<f64> = ports.iter().map(|i| found.velocity[*i]).collect();
            let apart = difference(&tangential, &w);
            println!("bound {bound}: {apart:e}");
            assert!(apart < 1e-12);
            slipping += w.iter().filter(|w| **w != 0.0).count();
            sticking += w.iter().filter(|w| **w == 0.0).count();
        }
        assert!(slipping > 0 && sticking > 0);
    }
}

/// The stiffer the foundation yields, the nearer to a rigid one.
#[test]
fn a_stiff_foundation_tends_to_a_rigid_one() {
    let mut random = Random::new(13);
    for body in &bodies() {
        for mu in [0.0, 0.4] {
            let law = Coefficient::Constant(mu);
            let mut case = draw(&mut random, body, law, NormalCondition::Unilateral, K);
            let rigid = solved(&case, 1e-13);
            case.condition = NormalCondition::Compliance { exponent: 1.0 };
            let apart = [1e4, 1e6, 1e8].map(|c| {
                case.stiffness = vec![c * body.weight; case.nodes()];
                let yielding = solved(&case, 1e-13);
                difference(&yielding.force, &rigid.force)
                    .max(difference(&yielding.velocity, &rigid.velocity))
            });
            println!("apart {apart:?}");
            assert!(apart[0] < 0.1);
            for pair in apart.windows(2) {
                assert!((0.005..0.02).contains(&(pair[1] / pair[0])), "{apart:?}");
            }
        }
    }
}

/// Nodes under tension carry friction where its bound follows the magnitude of the force, and none where it follows pressure.
#[test]
fn tension_has_friction_only_by_its_magnitude() {
    let mut random = Random::new(14);
    for body in &bodies() {
        let mut case = draw(
            &mut random,
            body,
            Coefficient::Constant(0.3),
            CONDITIONS[0],
            K,
        );
        let d = case.components + 1;
        case.friction.pressure = Pressure::Pressing;
        let pressing = solved(&case, 1e-12);
        let length = |f: &[f64]| f[..d - 1].iter().map(|f| f * f).sum::<f64>().sqrt();
        let mut pulled = 0;
        for f in pressing.force.chunks(d).filter(|f| f[d - 1] < 0.0) {
            pulled += 1;
            assert_eq!(length(f), 0.0);
        }
        assert!(pulled > 0);
        case.friction.pressure = Pressure::Magnitude;
        let both = solved(&case, 1e-12);
        let mut slipping = 0;
        for (f, v) in both.force.chunks(d).zip(both.velocity.chunks(d)) {
            if f[d - 1] < 0.0 && length(v) > 0.0 {
                slipping += 1;
                assert!((length(f) / (-0.3 * f[d - 1]) - 1.0).abs() < 1e-12);
            }
        }
        assert!(slipping > 0);
    }
}

/// Without growth of the gap the pressures of a yielding foundation are given.
#[test]
fn pressures_are_given_where_the_gap_does_not_move() {
    let mut random = Random::new(15);
    for body in &bodies() {
        let condition = NormalCondition::Compliance { exponent: 2.0 };
        let law = Coefficient::Decaying(0.4, 0.3, 1.0);
        let mut case = draw(&mut random, body, law, condition, K);
        case.gap_rate = 0.0;
        case.stiffness = vec![40.0; case.nodes()];
        let found = solved(&case, 1e-12);
        let d = case.components + 1;
        for (node, f) in found.force.chunks(d).enumerate() {
            let depth = (-case.gap_base[node]).max(0.0);
            assert!((f[d - 1] - 40.0 * depth * depth).abs() <= 1e-15);
        }
        assert!(found.force.iter().any(|f| *f > 0.0));
    }
}

/// A node that is away carries nothing, and the others do not notice that it is among them.
#[test]
fn nodes_that_are_away_carry_nothing() {
    let mut random = Random::new(16);
    for body in &bodies() {
        for condition in CONDITIONS {
            let law = Coefficient::Constant(0.3);
            let mut case = draw(&mut random, body, law, condition, K);
            case.gap_base[1] = f64::INFINITY;
            // a bound that does not ask for pressure
            case.friction.pressure = Pressure::Given(0.01);
            let found = solved(&case, 1e-12);
            let d = case.components + 1;
            assert!(found.force[d..2 * d].iter().all(|f| *f == 0.0));
            assert!(found.force[..d].iter().any(|f| *f != 0.0));
        }
    }
}

/// Friction depends on where the foundation is, not on what the coefficient is called.
#[test]
fn a_law_without_memory_does_not_see_the_slip() {
    let mut random = Random::new(17);
    let friction = Friction {
        coefficient: Coefficient::Weakening(0.4, 0.1, 0.02),
        pressure: Pressure::Pressing,
    };
    for body in &bodies() {
        let mut case = draw(
            &mut random,
            body,
            Coefficient::Constant(0.4),
            CONDITIONS[1],
            K,
        );
        let constant = solved(&case, 1e-13);
        case.slip_base.fill(0.0);
        case.friction = friction;
        case.theta_k = 0.0;
        // no slip yet, none within the stage
        assert!(difference(&solved(&case, 1e-13).force, &constant.force) < 1e-11);
        case.slip_base.fill(1.0);
        case.friction.coefficient = Coefficient::Constant(0.1);
        let last = solved(&case, 1e-13);
        case.friction = friction;
        assert!(difference(&solved(&case, 1e-13).force, &last.force) < 1e-11);
    }
}
