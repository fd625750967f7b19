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

/// How many times the usual number of problems is drawn: `PRESSED=20 cargo test ... --test pressed hard`.
fn times() -> usize {
    let times = std::env::var("PRESSED").ok();
    times.map_or(1, |times| times.parse().unwrap())
}

/// All laws of a kind, conditions and step sizes on one body; `draws` problems each, six starts.
fn solve_all(cells: &[usize], draws: usize, laws: &[(&str, Coefficient)], seed: u64) {
    let mut random = Random::new(seed + cells[0] as u64);
    for k in [1e-6, 0.03, 10.0] {
        let body = condensed(cells, k);
        for condition in CONDITIONS {
            for (name, law) in laws {
                let mut tally = Tally::default();
                for _ in 0..draws * times() {
                    let case = draw(&mut random, &body, *law, condition, k);
                    tally.run(&case, &mut random, 6);
                }
                let label = format!("{cells:?}, {condition:?}, k {k}, {name} {law:?}");
                tally.print(&label);
                assert_eq!(tally.unsolved, 0, "{label}");
                assert!(tally.worst < 1e-9, "{label}: {:e}", tally.worst);
            }
        }
    }
}

/// Bodies in the plane and in space, and how many problems are drawn on each.
const BODIES: [(&[usize], usize); 6] = [
    (&[8, 4], 4),
    (&[16, 8], 4),
    (&[32, 16], 2),
    (&[64, 32], 1),
    (&[3, 3, 2], 3),
    (&[5, 5, 3], 1),
];

#[test]
fn strong_friction_is_solved() {
    let laws = [0.0, 0.3, 1.0, 2.0, 3.0, 5.0].map(|mu| ("constant", Coefficient::Constant(mu)));
    for (cells, draws) in BODIES {
        solve_all(cells, draws, &laws, 1);
    }
}

#[test]
fn weakening_friction_is_solved() {
    let laws = [1.0, 10.0, 100.0, 1e3, 1e4]
        .map(|alpha| ("decaying", Coefficient::Decaying(0.5, 0.2, alpha)));
    for (cells, draws) in BODIES {
        solve_all(cells, draws, &laws, 2);
    }
}

#[test]
fn laws_without_rest_or_with_memory_are_solved() {
    let laws = [
        ("creeping", Coefficient::Creeping(0.02, 1e-9)),
        ("creeping from afar", Coefficient::Creeping(0.001, 1e-150)),
        ("steep", Coefficient::Creeping(0.3, 1e-9)),
        ("slip weakening", Coefficient::Weakening(0.5, 0.2, 0.05)),
    ];
    for (cells, draws) in BODIES {
        solve_all(cells, draws.min(2), &laws, 3);
    }
}
