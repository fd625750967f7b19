//! What a solve spends: no memory, no factorization where nothing has changed; and what it remembers: only the saved points.

use crate::body::condensed;
use crate::cases::{Case, Found, Solver};
use crate::hard::{CONDITIONS, draw};
use crate::laws::Coefficient;
use crate::random::Random;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use stickslip::contact::pressed::{PressedPoint, is_plausible, solve};

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: forwards to the system allocator; only counts.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const K: f64 = 0.05;

fn cases(random: &mut Random, law: Coefficient) -> Vec<Case> {
    let bodies = [condensed(&[16, 8], K), condensed(&[4, 3, 2], K)];
    let pairs = bodies
        .iter()
        .flat_map(|body| CONDITIONS.map(|condition| (body, condition)));
    pairs
        .map(|(body, condition)| draw(random, body, law, condition, K))
        .collect()
}

#[test]
fn a_solve_allocates_nothing() {
    let mut random = Random::new(41);
    let mut all: Vec<Case> = [
        Coefficient::Constant(0.5),
        Coefficient::Decaying(0.5, 0.2, 100.0),
        Coefficient::Creeping(0.03, 1e-6),
    ]
    .iter()
    .flat_map(|law| cases(&mut random, *law))
    .collect();
    // friction so strong that the ways back are taken
    let body = condensed(&[16, 8], 10.0);
    let strong = Coefficient::Constant(5.0);
    all.extend((0..12).map(|_| draw(&mut random, &body, strong, CONDITIONS[0], 10.0)));
    let (mut sweeps, mut frozen) = (0, 0);
    for case in all {
        let mut solver = Solver::new(&case);
        for size in [0.0, 1.0, 10.0, 1.0] {
            let mut found = case.random_start(&mut random, size);
            let before = COUNT.with(Cell::get);
            let reached = solver.solve(&case, &mut found);
            assert_eq!(COUNT.with(Cell::get) - before, 0);
            assert!(reached.converged);
        }
        let work = solver.ws.work();
        (sweeps, frozen) = (sweeps + work.sweeps, frozen + work.frozen);
    }
    println!("sweeps {sweeps}, frozen {frozen}");
    assert!(sweeps > 0 && frozen > 0);
}

/// Loads that change nothing but numbers, with a constant coefficient: one step each with the factor of the first solve.
#[test]
fn unchanged_statuses_take_no_factorization() {
    let mut random = Random::new(42);
    for case in cases(&mut random, Coefficient::Constant(0.4)) {
        let is_rigid = case.stiffness.is_empty();
        if !is_rigid || case.components == 2 {
            continue;
        }
        let (mut case, mut solver, mut found) = (case.clone(), Solver::new(&case), case.start());
        assert!(solver.solve(&case, &mut found).converged);
        let r = case.r.clone();
        let gaps = case.gap_base.clone();
        let made = solver.ws.work().factorizations;
        assert!(made > 0);
        for step in 1..40 {
            // the problem is homogeneous: the same nodes slip and are open
            let factor = 1.0 + 0.1 * f64::from(step);
            case.r
                .iter_mut()
                .zip(&r)
                .for_each(|(new, old)| *new = factor * old);
            let gap_base = case.gap_base.iter_mut().zip(&gaps);
            gap_base.for_each(|(new, old)| *new = factor * old);
            let before = solver.ws.work();
            let reached = solver.solve(&case, &mut found);
            assert!(reached.converged);
            assert_eq!(reached.iterations, 1, "step {step}");
            let work = solver.ws.work();
            assert_eq!(work.factorizations, made);
            assert_eq!(work.solves, before.solves + 1);
            assert_eq!(work.sweeps + work.frozen + work.raised, 0);
        }
    }
}

/// Solves that continue from saved points have the bits of those that never stopped, whatever the workspace did before.
#[test]
fn only_the_points_are_remembered() {
    let mut random = Random::new(43);
    for law in [
        Coefficient::Constant(0.5),
        Coefficient::Decaying(0.5, 0.3, 3.0),
        Coefficient::Creeping(0.03, 1e-6),
    ] {
        for mut case in cases(&mut random, law) {
            let free: Vec<f64> = case.r.clone();
            let mut solver = Solver::new(&case);
            let mut found = case.start();
            let mut saved: Vec<(Vec<f64>, Found)> = vec![];
            let course: Vec<f64> = (0..12).map(|_| random.between(0.8, 1.2)).collect();
            let load = |case: &mut Case, factor: f64| {
                case.r
                    .iter_mut()
                    .zip(&free)
                    .for_each(|(r, f)| *r = factor * f);
            };
            for factor in &course {
                saved.push((solver.points.clone(), found.clone()));
                load(&mut case, *factor);
                assert!(solver.solve(&case, &mut found).converged);
                assert!(is_plausible(&solver.points, case.components));
            }
            for from in [0, 5, 9] {
                // a workspace that has seen other things
                let mut other = Solver::new(&case);
                load(&mut case, 3.0);
                assert!(other.solve(&case, &mut case.start()).converged);
                let (points, mut again) = saved[from].clone();
                other.points = points;
                for factor in &course[from..] {
                    load(&mut case, *factor);
                    assert!(other.solve(&case, &mut again).converged);
                }
                assert_eq!(again, found);
                assert_eq!(other.points, solver.points);
            }
        }
    }
}

/// Points of several step sizes stand side by side.
#[test]
fn step_sizes_keep_points_of_their_own() {
    let mut random = Random::new(44);
    let case = cases(&mut random, Coefficient::Constant(0.4)).remove(0);
    let mut solver = Solver::new(&case);
    let mut found = case.start();
    assert!(solver.solve(&case, &mut found).converged);
    let made = solver.ws.work().factorizations;
    let mut other = case.clone();
    other.theta_k = 2.0 * K;
    assert!(solver.solve(&other, &mut other.start()).converged);
    assert!(solver.ws.work().factorizations > made);
    let made = solver.ws.work().factorizations;
    // back to the first size, with another load
    let mut loaded = case.clone();
    loaded.r.iter_mut().for_each(|r| *r *= 1.01);
    let mut again = found.clone();
    let mut at = PressedPoint::of(&mut solver.points, K, K);
    let reached = loaded.with(|problem| {
        let Found {
            velocity,
            force,
            reaction,
        } = &mut again;
        solve(
            problem,
            1e-10,
            100,
            velocity,
            force,
            reaction,
            &mut at,
            &mut solver.ws,
        )
    });
    assert!(reached.converged);
    assert_eq!(solver.ws.work().factorizations, made);
}
