//! Random contact problems with every law, solved from random starts: the law holds at every node, W decreases.

use crate::common::random::Random;
use crate::{draw, laws_in_pascal};
use faer::Mat;
use stickslip::contact::bounds::Bounds;
use stickslip::contact::law::{ChosenLaw, Given, Law, LawBounds, Role};
use stickslip::contact::solve::multiplicity::{self, MultiplicityWorkspace};
use stickslip::contact::solve::newton::linearisation::{Linearisation, block_len};
use stickslip::contact::solve::newton::{Workspace, solve};
use stickslip::contact::{ContactProblem, SlipPath};

const TOLERANCE: f64 = 1e-10;

/// A problem of random numbers: its matrix has eigenvalues over two decades.
struct Numbers {
    components: usize,
    s: Mat<f64>,
    r: Vec<f64>,
    weights: Vec<f64>,
    slip_base: Vec<f64>,
}

impl Numbers {
    fn draw(random: &mut Random, nodes: usize, components: usize) -> Numbers {
        let len = nodes * components;
        let b = Mat::from_fn(len, len, |_, _| random.between(-1.0, 1.0));
        let s = &b * b.transpose() + Mat::from_fn(len, len, |i, j| if i == j { 0.05 } else { 0.0 });
        let force = 10.0_f64.powf(random.between(-2.0, 1.0));
        Numbers {
            components,
            s,
            r: (0..len)
                .map(|_| force * random.between(-1.0, 1.0))
                .collect(),
            weights: (0..nodes).map(|_| random.between(0.5, 2.0)).collect(),
            slip_base: vec![0.0; nodes],
        }
    }

    fn problem<'a>(&'a self, law: &'a LawBounds<'a>) -> ContactProblem<'a> {
        ContactProblem {
            s: self.s.as_ref(),
            r: &self.r,
            components: self.components,
            weights: &self.weights,
            law,
            slip_base: &self.slip_base,
            theta_k: 0.1,
        }
    }

    fn slip(&self, node: usize) -> SlipPath {
        SlipPath {
            base: self.slip_base[node],
            per_rate: 0.1,
        }
    }

    fn y(&self, w: &[f64]) -> Vec<f64> {
        (0..w.len())
            .map(|i| (0..w.len()).map(|j| self.s[(i, j)] * w[j]).sum::<f64>() - self.r[i])
            .collect()
    }

    /// The step energy W.
    fn energy(&self, law: &LawBounds, w: &[f64]) -> f64 {
        let y = self.y(w);
        let smooth: f64 = (0..w.len()).map(|i| 0.5 * w[i] * (y[i] - self.r[i])).sum();
        let friction = w.chunks(self.components).enumerate().map(|(node, w)| {
            let rate = w.iter().map(|v| v * v).sum::<f64>().sqrt();
            self.weights[node] * law.evaluate(node, rate, self.slip(node)).potential
        });
        smooth + friction.sum::<f64>()
    }

    /// The largest violated force over the largest force at a node.
    fn violation(&self, law: &LawBounds, w: &[f64]) -> f64 {
        let y = self.y(w);
        // the forces that meet: without friction they cancel
        let (mut worst, mut scale) = (0.0_f64, self.r.iter().fold(0.0, |m: f64, r| m.max(r.abs())));
        for (node, w) in w.chunks(self.components).enumerate() {
            let norm = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
            let (rate, y) = (norm(w), &y[node * self.components..][..self.components]);
            let bound = self.weights[node] * law.evaluate(node, rate, self.slip(node)).bound;
            scale = scale.max(bound).max(norm(y));
            let violated = if rate == 0.0 {
                (norm(y) - bound).max(0.0)
            } else {
                let left: Vec<f64> = y.iter().zip(w).map(|(y, w)| y + bound * w / rate).collect();
                norm(&left)
            };
            worst = worst.max(violated);
        }
        worst / scale.max(f64::MIN_POSITIVE)
    }
}

fn solve_from(problem: &ContactProblem, w: &mut [f64]) -> (bool, usize) {
    let nodes = problem.weights.len();
    let mut blocks = vec![0.0; nodes * block_len(problem.components)];
    let mut at = Linearisation::fresh(&mut blocks, problem.theta_k);
    let mut ws = Workspace::factored(nodes, w.len());
    let found = solve(problem, TOLERANCE, 200, w, &mut at, &mut ws);
    (found.converged, found.iterations)
}

/// Contact nodes on a grid whose forces fall with their distance, as those of a body do.
fn on_a_grid(random: &mut Random, sides: [usize; 2]) -> (Numbers, Vec<[f64; 3]>) {
    let nodes = sides[0] * sides[1];
    let points: Vec<[f64; 3]> = (0..nodes)
        .map(|node| [(node % sides[0]) as f64, (node / sides[0]) as f64, 0.0])
        .collect();
    let numbers = Numbers::draw(random, nodes, 2);
    let between = |i: usize, j: usize| {
        let [a, b] = [points[i / 2], points[j / 2]];
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let s = Mat::from_fn(2 * nodes, 2 * nodes, |i, j| match i % 2 == j % 2 {
        true => (-0.7 * between(i, j)).exp() + if i == j { 0.05 } else { 0.0 },
        // across: weaker, and symmetric
        false => 0.1 * (-0.7 * between(i, j)).exp(),
    });
    (Numbers { s, ..numbers }, points)
}

#[test]
fn steps_without_factors_solve_the_same_problems() {
    let mut random = Random::new(5);
    for law in laws_in_pascal() {
        let (mut most, mut products) = (0, 0);
        for case in 0..12 {
            let (numbers, points) = on_a_grid(&mut random, [9 + case, 7]);
            let chosen = draw(law, &mut random, None);
            let bounds = chosen.bounds();
            let problem = numbers.problem(&bounds);
            let solved = |mut ws: Workspace| {
                let mut w = vec![0.0; numbers.r.len()];
                let mut blocks = vec![0.0; points.len() * block_len(2)];
                let mut at = Linearisation::fresh(&mut blocks, problem.theta_k);
                let found = solve(&problem, TOLERANCE, 200, &mut w, &mut at, &mut ws);
                assert!(found.converged, "{law:?} case {case}: {found:?}");
                (w, found.iterations, ws.work())
            };
            let (w, iterations, work) = solved(Workspace::iterative(&points));
            assert_eq!(work.factorizations, 0);
            let violation = numbers.violation(&bounds, &w);
            assert!(violation <= 1e-9, "{law:?} case {case}: {violation:e}");
            (most, products) = (most.max(iterations), products + work.products);
            let (factored, _, work) = solved(Workspace::factored(points.len(), w.len()));
            assert!(
                work.factorizations > 0 && work.products == 0 || factored.iter().all(|w| *w == 0.0)
            );
            // where the body follows any weakening there is one solution
            if bounds.weakening(problem.theta_k) * 2.0 < 0.05 {
                let largest = factored.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
                for (a, b) in w.iter().zip(&factored) {
                    assert!(
                        (a - b).abs() <= 1e-7 * largest,
                        "{law:?} case {case}: {a} {b}"
                    );
                }
            }
        }
        println!("{law:?}: most {most}, {products} products in 12 problems");
        assert!(most <= 60, "{law:?}: {most}");
    }
}

#[test]
fn random_problems_are_solved() {
    let mut random = Random::new(3);
    for law in laws_in_pascal() {
        let (mut total, mut most) = (0, 0);
        for case in 0..120 {
            let components = 1 + case % 2;
            let nodes = 4 + random.below(16);
            let numbers = Numbers::draw(&mut random, nodes, components);
            let fields = random.happens(0.5).then_some(nodes);
            let chosen = draw(law, &mut random, fields);
            let bounds = chosen.bounds();
            let problem = numbers.problem(&bounds);
            for start in 0..3 {
                let size = [0.0, 0.01, 10.0][start];
                let mut w: Vec<f64> = numbers
                    .r
                    .iter()
                    .map(|_| size * random.between(-1.0, 1.0))
                    .collect();
                let before = numbers.energy(&bounds, &w);
                let label = format!("{law:?} case {case} start {start}: {:?}", chosen.start());
                let (converged, iterations) = solve_from(&problem, &mut w);
                assert!(converged, "{label}: {iterations} iterations");
                let violation = numbers.violation(&bounds, &w);
                assert!(violation <= 1e-9, "{label}: {violation:e}");
                let after = numbers.energy(&bounds, &w);
                assert!(
                    after <= before + 1e-12 * (before.abs() + after.abs()),
                    "{label}: {before:e} {after:e}"
                );
                (total, most) = (total + iterations, most.max(iterations));
            }
        }
        println!(
            "{law:?}: mean {:.2}, most {most}",
            f64::from(total as u32) / 360.0
        );
        assert!(most <= 100, "{law:?}: {most}");
    }
}

/// One node, `w + g(|w|) = r` with a bound at rest above `r`: rest and fast slip are solutions, whichever was accepted.
#[test]
fn a_second_solution_is_found_where_the_bound_rises_again() {
    let law = |name: &str| -> Law { Law::find(Role::Bound, name).unwrap() };
    let number = Given::Number;
    let stribeck = |exponent: f64| {
        let given = [0.5, 0.1, 0.05, exponent, 0.3].map(number);
        ChosenLaw::new(law("stribeck"), &given, None).unwrap()
    };
    let table = [
        Given::Points(vec![0.0, 0.05, 0.1, 1.0]),
        Given::Points(vec![0.5, 0.1, 0.1, 0.6]),
        number(1.0),
        Given::Absent,
    ];
    let table = ChosenLaw::new(law("table"), &table, None).unwrap();
    let mut random = Random::new(1);
    for chosen in [stribeck(1.0), stribeck(2.5), table] {
        let bounds = chosen.bounds();
        let numbers = Numbers {
            s: Mat::from_fn(1, 1, |_, _| 1.0),
            r: vec![0.45],
            weights: vec![1.0],
            ..Numbers::draw(&mut random, 1, 1)
        };
        let problem = numbers.problem(&bounds);
        let mut slipping = [0.3];
        assert!(solve_from(&problem, &mut slipping).0);
        assert!(slipping[0] > 0.2, "{slipping:?}");
        for accepted in [[0.0], slipping] {
            assert!(numbers.violation(&bounds, &accepted) <= 1e-9);
            let mut ws = MultiplicityWorkspace::new(&[[0.0; 3]], 1);
            let extremes = |node| bounds.extremes(node);
            let found = multiplicity::test(&problem, extremes, TOLERANCE, 100, &accepted, &mut ws);
            assert_eq!(found.solutions, 2, "{:?}", chosen.start());
            assert!((found.gap - slipping[0]).abs() < 1e-9);
        }
        assert!(bounds.weakening(0.1) > 1.0);
    }
}
