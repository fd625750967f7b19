//! Two tangential directions: no axis is preferred.

use crate::body::condensed;
use crate::cases::{Case, Found, Solver, difference};
use crate::hard::{CONDITIONS, draw};
use crate::laws::Coefficient;
use crate::random::Random;
use faer::Mat;

/// Turns the tangential frame of every node by an angle of its own.
struct Turn(Vec<[f64; 2]>);

impl Turn {
    fn draw(random: &mut Random, nodes: usize) -> Turn {
        let angles = (0..nodes).map(|_| random.between(0.0, 6.0).sin_cos());
        Turn(angles.map(|(sin, cos)| [cos, sin]).collect())
    }

    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let nodes = x.chunks(3).zip(&self.0);
        nodes
            .flat_map(|(x, [c, s])| [c * x[0] + s * x[1], c * x[1] - s * x[0], x[2]])
            .collect()
    }

    fn matrix(&self, a: &Mat<f64>) -> Mat<f64> {
        let n = a.nrows();
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|j| self.apply(&(0..n).map(|i| a[(i, j)]).collect::<Vec<_>>()))
            .collect();
        let rows: Vec<Vec<f64>> = (0..n)
            .map(|i| self.apply(&(0..n).map(|j| columns[j][i]).collect::<Vec<_>>()))
            .collect();
        Mat::from_fn(n, n, |i, j| rows[i][j])
    }
}

fn solved(case: &Case) -> Found {
    let (mut solver, mut found) = (Solver::new(case), case.start());
    solver.tolerance = 1e-13;
    let reached = solver.solve(case, &mut found);
    assert!(reached.converged, "{reached:?}");
    found
}

#[test]
fn a_turned_frame_turns_the_solution() {
    let mut random = Random::new(21);
    let k = 0.05;
    let body = condensed(&[4, 4, 2], k);
    for condition in CONDITIONS {
        for law in [
            Coefficient::Constant(0.4),
            Coefficient::Decaying(0.5, 0.3, 1.0),
            Coefficient::Creeping(0.03, 1e-6),
        ] {
            let case = draw(&mut random, &body, law, condition, k);
            let turn = Turn::draw(&mut random, case.nodes());
            let mut turned = case.clone();
            turned.s = turn.matrix(&case.s);
            turned.r = turn.apply(&case.r);
            let compliance = turn.matrix(&body.c);
            turned.yielding = (0..case.r.len()).map(|i| compliance[(i, i)]).collect();
            let (found, other) = (solved(&case), solved(&turned));
            let apart = difference(&turn.apply(&found.velocity), &other.velocity)
                .max(difference(&turn.apply(&found.force), &other.force));
            println!("{condition:?} {law:?}: {apart:e}");
            assert!(apart < 1e-11, "{condition:?} {law:?}: {apart:e}");
            // both directions take part
            let nodes = || found.force.chunks(3);
            assert!(nodes().any(|f| f[0] != 0.0) && nodes().any(|f| f[1] != 0.0));
        }
    }
}

/// Forces along one axis only: nothing moves along the other, as if the contact had one direction.
#[test]
fn a_plane_problem_stays_in_its_plane() {
    let mut random = Random::new(22);
    let body = condensed(&[16, 8], 0.05);
    for condition in CONDITIONS {
        let law = Coefficient::Decaying(0.5, 0.3, 1.0);
        let plane = draw(&mut random, &body, law, condition, 0.05);
        let nodes = plane.nodes();
        let mut space = plane.clone();
        space.components = 2;
        // the second direction resists by itself
        let place = |i: usize| [2 * (i / 3), usize::MAX, 2 * (i / 3) + 1][i % 3];
        space.s = Mat::from_fn(3 * nodes, 3 * nodes, |i, j| match (place(i), place(j)) {
            (usize::MAX, usize::MAX) => f64::from(u8::from(i == j)),
            (usize::MAX, _) | (_, usize::MAX) => 0.0,
            (i, j) => plane.s[(i, j)],
        });
        let spread = |x: &[f64], other: f64| -> Vec<f64> {
            x.chunks(2).flat_map(|x| [x[0], other, x[1]]).collect()
        };
        space.r = spread(&plane.r, 0.0);
        space.yielding = spread(&plane.yielding, 1.0);
        let (flat, deep) = (solved(&plane), solved(&space));
        assert!(difference(&spread(&flat.velocity, 0.0), &deep.velocity) < 1e-11);
        assert!(difference(&spread(&flat.force, 0.0), &deep.force) < 1e-11);
    }
}
