//! One node with three solutions in closed form.

use crate::cases::{Case, Found, Solver, difference};
use crate::check::violation;
use crate::laws::{Coefficient, Friction, Pressure};
use faer::Mat;
use stickslip::contact::pressed::{NormalCondition, PressedMultiplicity, PressedWorkspace, index};

/// Compliances 1 and 0.4, coupled by 0.5, free velocities (1, 0.1).
fn case(mu: f64) -> Case {
    let [tt, tn, nn] = [1.0, 0.5, 0.4];
    let determinant = tt * nn - tn * tn;
    // the port of the pressure is minus the one of the normal force, so the coupling of S has the sign of C_tn
    let s = Mat::from_fn(2, 2, |i, j| match (i, j) {
        (0, 0) => nn / determinant,
        (1, 1) => tt / determinant,
        _ => -tn / determinant,
    });
    let mut case = Case {
        components: 1,
        s,
        r: vec![],
        yielding: vec![tt, nn],
        weights: vec![1.0],
        slip_base: vec![0.0],
        friction: Friction {
            coefficient: Coefficient::Constant(mu),
            pressure: Pressure::Pressing,
        },
        theta_k: 1.0,
        condition: NormalCondition::Unilateral,
        stiffness: vec![],
        gap_base: vec![0.0],
        gap_rate: 1.0,
    };
    case.set_free_velocity(&[1.0, 0.1]);
    case
}

fn found(velocity: [f64; 2], force: [f64; 2]) -> Found {
    Found {
        velocity: velocity.to_vec(),
        force: force.to_vec(),
        reaction: vec![0.0; 2],
    }
}

/// r = 1 - lam + 0.5 p, w = 0.1 - 0.5 lam + 0.4 p: open, slipping and sticking.
fn solutions() -> [Found; 3] {
    [
        found([1.0, 0.1], [0.0, 0.0]),
        found([0.5, 0.0], [1.0, 1.0]),
        found([0.0, 0.0], [7.0 / 3.0, 8.0 / 3.0]),
    ]
}

#[test]
fn three_solutions_are_kept_where_they_are() {
    let case = case(1.0);
    for solution in solutions() {
        let mut again = solution.clone();
        let reached = case.solve(&mut again);
        assert!(
            reached.converged && reached.iterations == 0,
            "{solution:?} {reached:?}"
        );
        assert!(difference(&again.velocity, &solution.velocity) < 1e-15);
        assert!(difference(&again.force, &solution.force) < 1e-15);
        assert!(violation(&case, &again) < 1e-15);
    }
}

#[test]
fn the_sign_of_the_determinant_tells_of_the_others() {
    let case = case(1.0);
    let mut ws = PressedWorkspace::new(1, 1);
    let signs = solutions().map(|at| case.with(|p| index(p, &at.velocity, &at.force, &mut ws)));
    assert_eq!(signs, [1.0, -1.0, 1.0]);
}

/// Whichever of the three is accepted, the search tells of the others; where there is one, it finds one.
#[test]
fn a_search_finds_the_other_solutions() {
    let mut search = PressedMultiplicity::new(1, 1);
    let limits = (1e-12, 1000);
    let strong = case(1.0);
    let gaps = [1.0, 0.5, 1.0];
    for ((at, gap), is_least) in solutions().iter().zip(gaps).zip([false, true, false]) {
        let found = strong.with(|p| search.search(p, limits, &at.velocity, &at.force));
        // from the middle one, both extreme ones and the sign of the determinant; from an extreme one, the other
        assert_eq!(found.solutions, if is_least { 3 } else { 2 }, "{at:?}");
        assert!((found.gap - gap).abs() < 1e-9, "{found:?}");
    }
    let weak = case(0.7);
    let open = &solutions()[0];
    let found = weak.with(|p| search.search(p, limits, &open.velocity, &open.force));
    assert_eq!(found.solutions, 1);
    assert!(found.gap < 1e-9);
}

/// From starts all around, one of the three is found, and each of the two stable ones from its side.
#[test]
fn every_start_leads_to_a_solution() {
    let case = case(1.0);
    let mut hits = [0; 3];
    for i in -20..=20 {
        for j in -20..=20 {
            let mut at = found(
                [0.1 * f64::from(i), 0.1 * f64::from(j)],
                [0.2 * f64::from(j), 0.2 * f64::from(i)],
            );
            let reached = case.solve(&mut at);
            assert!(reached.converged, "{i} {j}: {reached:?}");
            let which = solutions()
                .iter()
                .position(|s| difference(&at.force, &s.force) < 1e-9);
            hits[which.unwrap()] += 1;
        }
    }
    println!("open, slipping, sticking: {hits:?}");
    assert!(hits[0] > 0 && hits[2] > 0);
}

#[test]
fn below_the_threshold_only_the_open_solution_is_left() {
    let case = case(0.7);
    let mut solver = Solver::new(&case);
    for mut at in solutions() {
        let reached = solver.solve(&case, &mut at);
        assert!(reached.converged, "{reached:?}");
        assert!(difference(&at.velocity, &[1.0, 0.1]) < 1e-14, "{at:?}");
        assert_eq!(at.force, [0.0, 0.0]);
        assert!(violation(&case, &at) < 1e-14);
    }
}
