//! Random hard problems from random starts: each is solved, and the answer holds from outside.

use crate::body::{Condensed, condensed};
use crate::cases::{Case, Solver};
use crate::check::violation;
use crate::laws::{Coefficient, Friction, Pressure};
use crate::random::Random;
use stickslip::contact::pressed::{NormalCondition, PressedWork};

pub const CONDITIONS: [NormalCondition; 3] = [
    NormalCondition::Bilateral,
    NormalCondition::Unilateral,
    NormalCondition::Compliance { exponent: 1.5 },
];

/// Random loads and gaps; the gaps close and open within the stage.
pub fn draw(
    random: &mut Random,
    body: &Condensed,
    coefficient: Coefficient,
    condition: NormalCondition,
    k: f64,
) -> Case {
    let pressure = match condition {
        NormalCondition::Bilateral => random.one_of(&[Pressure::Pressing, Pressure::Magnitude]),
        _ => Pressure::Pressing,
    };
    let friction = Friction {
        coefficient,
        pressure,
    };
    let mut case = Case::new(body, friction, condition, k);
    let free: Vec<f64> = case.r.iter().map(|_| random.between(-1.0, 1.0)).collect();
    case.set_free_velocity(&free);
    for node in 0..case.nodes() {
        if condition != NormalCondition::Bilateral {
            case.gap_base[node] = k * random.between(-0.5, 0.5);
        }
        case.slip_base[node] = random.between(0.0, 0.1);
    }
    if let NormalCondition::Compliance { .. } = condition {
        let c = body.weight * 10.0_f64.powf(random.between(0.0, 6.0)) / k.powf(1.5);
        case.stiffness = vec![c; case.nodes()];
    }
    case
}

/// What many solves took.
#[derive(Default)]
pub struct Tally {
    solves: usize,
    unsolved: usize,
    at_rounding: usize,
    iterations: usize,
    most: usize,
    with_sweeps: usize,
    with_frozen: usize,
    worst: f64,
}

impl Tally {
    pub fn run(&mut self, case: &Case, random: &mut Random, starts: usize) {
        for start in 0..starts {
            let size = [0.0, 1.0, 1.0, 0.01, 10.0, 1.0][start % 6];
            let mut found = case.random_start(random, size);
            let mut solver = Solver::new(case);
            let reached = solver.solve(case, &mut found);
            let work = solver.ws.work();
            self.solves += 1;
            self.unsolved += usize::from(!reached.converged);
            self.at_rounding += usize::from(reached.is_at_rounding);
            self.add(work);
            if reached.converged {
                self.worst = self.worst.max(violation(case, &found));
            }
        }
    }

    fn add(&mut self, work: PressedWork) {
        self.iterations += work.newton as usize;
        self.most = self.most.max(work.newton as usize);
        self.with_sweeps += usize::from(work.sweeps > 0);
        self.with_frozen += usize::from(work.frozen > 0);
    }

    pub fn print(&self, label: &str) {
        println!(
            "{label}: {} solves, {} unsolved, {} at rounding, Newton {:.2} ({}), sweeps in {}, frozen in {}, worst {:.1e}",
            self.solves,
            self.unsolved,
            self.at_rounding,
            self.iterations as f64 / self.solves as f64,
            self.most,
            self.with_sweeps,
            self.with_frozen,
            self.worst,
        );
    }
}

fn constant(cells: usize) {
    let mut random = Random::new(cells as u64);
    for k in [1e-6, 0.03, 10.0] {
        let body = condensed(&[cells, cells / 2], k);
        for condition in CONDITIONS {
            for mu in [0.3, 1.0, 2.0, 3.0, 5.0] {
                let mut tally = Tally::default();
                for _ in 0..4 {
                    let law = Coefficient::Constant(mu);
                    let case = draw(&mut random, &body, law, condition, k);
                    tally.run(&case, &mut random, 6);
                }
                tally.print(&format!("{cells} {condition:?} k {k} mu {mu}"));
            }
        }
    }
}

#[test]
fn exp_constant_8() {
    constant(8);
}
#[test]
fn exp_constant_16() {
    constant(16);
}
#[test]
fn exp_constant_32() {
    constant(32);
}
#[test]
fn exp_constant_64() {
    constant(64);
}

fn weakening(cells: usize) {
    let mut random = Random::new(cells as u64);
    for k in [1e-6, 0.03, 10.0] {
        let body = condensed(&[cells, cells / 2], k);
        for condition in CONDITIONS {
            for alpha in [1.0, 10.0, 100.0, 1e3, 1e4] {
                let mut tally = Tally::default();
                for _ in 0..4 {
                    let law = Coefficient::Decaying(0.5, 0.2, alpha);
                    let case = draw(&mut random, &body, law, condition, k);
                    tally.run(&case, &mut random, 6);
                }
                tally.print(&format!("{cells} {condition:?} k {k} alpha {alpha}"));
            }
        }
    }
}
#[test]
fn exp_weakening_8() {
    weakening(8);
}
#[test]
fn exp_weakening_16() {
    weakening(16);
}
#[test]
fn exp_weakening_32() {
    weakening(32);
}
