//! Sets and convex functions: the inequality itself, tried with many v.

use nalgebra::{DMatrix, DVector};
use stickslip::qvi::{
    Bounds, Coefficients, Cone, HalfSpace, HistoryOperator, Inequality, Kernel, LinearPhi, Matrix,
    NonlinearOperator, Norm, Part, PositivePart, Projection, Quadrature, Sampler, Set, Settings,
    Solver, Space, SparseSymmetric, Whole, solve,
};

const BOUND: f64 = 0.7;

fn operator() -> DMatrix<f64> {
    DMatrix::from_row_slice(
        4,
        4,
        &[
            3.0, 1.0, 0.0, 0.2, -0.5, 2.0, 0.4, 0.0, 0.3, 0.0, 2.5, -1.0, 0.0, 0.1, 1.0, 1.5,
        ],
    )
}

fn load(t: f64) -> DVector<f64> {
    DVector::from_vec(vec![1.0 - 3.0 * t, 2.0, -2.0 + t, 3.0 * t])
}

/// `A u + int u` with the bound on two parts, of which one has two components.
fn problem(set: Box<dyn Set>, is_nonlinear: bool) -> Inequality {
    let matrix = operator();
    let mut problem = match is_nonlinear {
        false => Inequality::new(Space::euclidean(4), Matrix::Dense(matrix), load),
        true => {
            let of = move |u: &DVector<f64>| &matrix * u;
            Inequality::new(
                Space::euclidean(4),
                NonlinearOperator::new([1.0, 4.0], of),
                load,
            )
        }
    };
    problem.histories = vec![HistoryOperator::new(
        Kernel::constant(1.0),
        DVector::zeros(4),
    )];
    problem.phi = Box::new(LinearPhi(vec![Some(Matrix::multiple(4, 1.0))]));
    problem.parts = vec![
        Part {
            components: 0..2,
            shape: Box::new(Norm),
        },
        Part {
            components: 3..4,
            shape: Box::new(PositivePart),
        },
    ];
    problem.j = Box::new(Coefficients::new(
        0.0,
        |_: &[DVector<f64>], c: &mut [f64]| c.iter_mut().for_each(|c| *c += BOUND),
    ));
    problem.set = set;
    problem
}

fn nonsmooth(v: &DVector<f64>) -> f64 {
    BOUND * (v[0].hypot(v[1]) + v[3].max(0.0))
}

#[test]
fn solutions_satisfy_the_inequality_for_every_set() {
    let sets: [fn() -> Box<dyn Set>; 5] = [
        || Box::new(Whole),
        || {
            let lower = DVector::from_vec(vec![-0.1, f64::NEG_INFINITY, -0.2, 0.0]);
            let upper = DVector::from_vec(vec![0.2, 0.3, f64::INFINITY, 0.5]);
            Box::new(Bounds::new(lower, upper).unwrap())
        },
        || {
            let normal = DVector::from_vec(vec![1.0, 0.0, -1.0, 2.0]);
            Box::new(HalfSpace::new(normal, 0.1).unwrap())
        },
        || Box::new(Cone::new(0.5).unwrap()),
        // the ball of radius 1/4 around (0.2, 0, 0, 0)
        || {
            Box::new(Projection(|v: &mut DVector<f64>| {
                v[0] -= 0.2;
                let length = v.norm();
                if length > 0.25 {
                    *v *= 0.25 / length;
                }
                v[0] += 0.2;
            }))
        },
    ];
    let mut answers = Vec::new();
    for set in sets {
        let k = 0.25;
        let runs = [false, true].map(|is_nonlinear| {
            let problem = problem(set(), is_nonlinear);
            let settings = Settings::new(Solver::Direct);
            solve(&problem, &Quadrature::Trapezoid, (1.0, 4), settings).unwrap()
        });
        let (u, other) = (&runs[0].u, &runs[1].u);
        for (u, other) in u.iter().zip(other) {
            assert!((u - other).amax() < 1e-10, "{u} {other}");
        }
        let set = set();
        let mut sampler = Sampler::new(7);
        let mut sum = DVector::zeros(4);
        for (n, u) in u.iter().enumerate() {
            // the trapezoid
            let history = match n {
                0 => DVector::zeros(4),
                _ => &sum + u * (0.5 * k),
            };
            sum += u * if n == 0 { 0.5 * k } else { k };
            let rest = operator() * u + history - load(n as f64 * k);
            let mut nearest = u.clone();
            set.project(&mut nearest);
            assert!((&nearest - u).amax() < 1e-10, "{u} is not in K");
            let mut least = f64::INFINITY;
            for _ in 0..2000 {
                let mut v = u + sampler.vector(4);
                set.project(&mut v);
                let size = (&v - u).norm();
                if size > 1e-9 {
                    let found = rest.dot(&(&v - u)) + nonsmooth(&v) - nonsmooth(u);
                    least = least.min(found / size);
                }
            }
            assert!(least > -1e-8, "{least}");
        }
        answers.push(u[4].clone());
    }
    // the sets matter
    for (i, a) in answers.iter().enumerate() {
        assert!(answers[..i].iter().all(|b| (a - b).amax() > 1e-3));
    }
}

#[test]
fn sparse_and_dense_matrices_give_the_same() {
    let (col_ptr, row_idx) = (vec![0, 2, 4, 5], vec![0, 1, 1, 2, 2]);
    let values = vec![2.0, -1.0, 2.0, -1.0, 1.5];
    let sparse = Matrix::Sparse(SparseSymmetric::new(col_ptr, row_idx, values).unwrap());
    let runs = [sparse.clone(), Matrix::Dense(sparse.to_dense())].map(|matrix| {
        let load = |t: f64| DVector::from_vec(vec![1.0, t, 2.0 - 3.0 * t]);
        let mut problem = Inequality::new(Space::euclidean(3), matrix.clone(), load);
        problem.histories = vec![HistoryOperator::new(
            Kernel::constant(1.0),
            DVector::zeros(3),
        )];
        problem.phi = Box::new(LinearPhi(vec![Some(matrix)]));
        problem.parts = vec![Part::friction(2..3)];
        problem.j = Box::new(Coefficients::new(
            0.0,
            |_: &[DVector<f64>], c: &mut [f64]| c[0] += 0.5,
        ));
        let settings = Settings::new(Solver::Direct);
        solve(&problem, &Quadrature::Trapezoid, (1.0, 16), settings).unwrap()
    });
    for (a, b) in runs[0].u.iter().zip(&runs[1].u) {
        assert!((a - b).amax() < 1e-12);
    }
    let rests = runs[0].u.iter().filter(|u| u[2] == 0.0).count();
    assert!(rests > 0 && rests < 17, "{rests}");
}
