//! Courses in time of a body on a moving foundation, by backward Euler: what the solver meets in a simulation.

use crate::body::{Body, Factor};
use crate::cases::{Case, Found, Solver};
use crate::check::violation;
use crate::hard::CONDITIONS;
use crate::laws::{Coefficient, Friction, Pressure};
use stickslip::contact::pressed::NormalCondition;

/// A body in the course of time.
pub struct Course {
    body: Body,
    factor: Factor,
    pub case: Case,
    u: Vec<f64>,
    k: f64,
    time: f64,
    pub found: Found,
}

impl Course {
    pub fn new(cells: &[usize], friction: Friction, condition: NormalCondition, k: f64) -> Course {
        let body = Body::new(cells);
        let factor = body.factor(k);
        let condensed = body.condensed(&factor);
        let mut case = Case::new(&condensed, friction, condition, k);
        if let NormalCondition::Compliance { .. } = condition {
            case.stiffness = vec![100.0 * body.weight; case.nodes()];
        }
        Course {
            u: vec![0.0; body.len],
            found: case.start(),
            body,
            factor,
            case,
            k,
            time: 0.0,
        }
    }

    /// Loads and places of the step to the next time: the body is pressed more and less, the foundation moves to and fro and
    /// drops away from it at times.
    pub fn prepare(&mut self) {
        self.time += self.k;
        let t = self.time;
        let press = 0.3 + 0.2 * (7.0 * t).sin();
        let mut free = self.body.elastic(&self.u);
        free.iter_mut().for_each(|f| *f = -*f);
        for i in &self.body.opposite {
            free[*i] -= press * self.body.weight;
        }
        self.factor.solve(&mut free);
        let (d, drive) = (self.body.dimension, 0.3 * (5.0 * t).cos());
        let ports = self.body.ports.iter().enumerate();
        let moved: Vec<f64> = ports
            .map(|(i, port)| free[*port] - if i % d == 0 { drive } else { 0.0 })
            .collect();
        self.case.set_free_velocity(&moved);
        for node in 0..self.case.nodes() {
            let port = self.body.ports[node * d + d - 1];
            let lift = match self.case.condition {
                NormalCondition::Bilateral => 0.0,
                _ => 0.05 * (3.0 * t).sin(),
            };
            self.case.gap_base[node] = self.u[port] - lift;
        }
    }

    /// Moves the body by a step with the forces found.
    pub fn advance(&mut self) {
        let mut w = self.body.elastic(&self.u);
        w.iter_mut().for_each(|f| *f = -*f);
        let press = 0.3 + 0.2 * (7.0 * self.time).sin();
        for i in &self.body.opposite {
            w[*i] -= press * self.body.weight;
        }
        let d = self.body.dimension;
        for (i, port) in self.body.ports.iter().enumerate() {
            let sign = if i % d == d - 1 { 1.0 } else { -1.0 };
            w[*port] += sign * self.found.force[i];
        }
        self.factor.solve(&mut w);
        for (u, w) in self.u.iter_mut().zip(&w) {
            *u += self.k * w;
        }
        for node in 0..self.case.nodes() {
            let v = &self.found.velocity[node * d..][..d - 1];
            let rate = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            self.case.slip_base[node] += self.k * rate;
        }
    }
}

/// What a course took.
struct Effort {
    newton: f64,
    /// Most Newton steps of a step, the first one among them, which starts from nothing.
    most: u64,
    factorizations: f64,
}

fn run(
    cells: &[usize],
    coefficient: Coefficient,
    condition: NormalCondition,
    steps: u32,
) -> Effort {
    let label = format!("{cells:?} {coefficient:?} {condition:?}");
    let pressure = Pressure::Pressing;
    let friction = Friction {
        coefficient,
        pressure,
    };
    let mut course = Course::new(cells, friction, condition, 2.0 / f64::from(steps));
    let mut solver = Solver::new(&course.case);
    // as many as a scene allows by default
    solver.iterations = 200;
    let (mut worst, mut most, mut open, mut slipping) = (0.0_f64, 0, 0, 0);
    let d = cells.len();
    for step in 0..steps {
        course.prepare();
        let before = solver.ws.work().newton;
        let reached = solver.solve(&course.case, &mut course.found);
        assert!(reached.converged, "{label}, step {step}: {reached:?}");
        most = most.max(solver.ws.work().newton - before);
        worst = worst.max(violation(&course.case, &course.found));
        let Found {
            velocity, force, ..
        } = &course.found;
        open += force.chunks(d).filter(|f| f[d - 1] == 0.0).count();
        slipping += velocity.chunks(d).filter(|v| v[0] != 0.0).count();
        course.advance();
    }
    let work = solver.ws.work();
    let mean = |count: u64| count as f64 / f64::from(steps);
    let share = |count: usize| mean(count as u64) / course.case.nodes() as f64;
    println!(
        "{label}: Newton {:.2} ({most}), factorizations {:.2}, solves {:.2}, sweeps {}, frozen {}, worst {worst:.1e}, open {:.2}, slipping {:.2}",
        mean(work.newton),
        mean(work.factorizations),
        mean(work.solves),
        work.sweeps,
        work.frozen,
        share(open),
        share(slipping),
    );
    assert!(worst < 1e-9, "{label}: {worst:e}");
    if condition == NormalCondition::Unilateral {
        assert!(
            open > 0 && share(open) < 0.5,
            "{label}: some nodes open, some do not"
        );
    }
    Effort {
        newton: mean(work.newton),
        most,
        factorizations: mean(work.factorizations),
    }
}

const BODIES: [&[usize]; 4] = [&[8, 4], &[16, 8], &[32, 16], &[4, 4, 2]];

/// Constant friction: fronts between stick and slip, and the edges of open parts, move over some nodes in a step. Few steps take
/// more than a border of the factor that is there.
#[test]
fn constant_friction_takes_few_iterations() {
    let plane: &[&[usize]] = &[&[8, 4], &[16, 8], &[32, 16], &[64, 32]];
    for (cells, limits) in plane
        .iter()
        .map(|cells| (*cells, [2.8, 8.0, 0.55]))
        .chain([(&[4, 4, 2][..], [8.0, 11.0, 1.5])])
    {
        for mu in [0.3, 1.0] {
            for condition in [NormalCondition::Bilateral, NormalCondition::Unilateral] {
                let effort = run(cells, Coefficient::Constant(mu), condition, 96);
                let found = [effort.newton, effort.most as f64, effort.factorizations];
                let is_within = found.iter().zip(&limits).all(|(a, b)| a <= b);
                assert!(is_within, "{cells:?} {mu} {condition:?}: {found:?}");
            }
        }
    }
}

/// Laws that fall so fast that steps have several solutions and jumps between them; `PRESSED=1` for the largest bodies too.
#[test]
fn jumps_are_followed() {
    let large: [&[usize]; 2] = [&[64, 32], &[8, 8, 3]];
    let count = if std::env::var("PRESSED").is_ok() {
        2
    } else {
        0
    };
    for cells in BODIES.iter().chain(&large[..count]) {
        for alpha in [5.0, 20.0, 100.0, 1000.0] {
            for condition in CONDITIONS {
                let coefficient = Coefficient::Decaying(0.5, 0.2, alpha);
                let effort = run(cells, coefficient, condition, 128);
                assert!(effort.newton < 40.0, "{}", effort.newton);
            }
        }
    }
}

#[test]
fn other_laws_are_followed() {
    for cells in BODIES {
        for coefficient in [
            Coefficient::Decaying(0.5, 0.2, 2.0),
            Coefficient::Decaying(0.5, 0.2, 20.0),
            Coefficient::Creeping(0.02, 1e-8),
            Coefficient::Weakening(0.5, 0.2, 0.1),
        ] {
            for condition in CONDITIONS {
                let effort = run(cells, coefficient, condition, 64);
                assert!(effort.newton < 20.0, "{}", effort.newton);
            }
        }
    }
}
