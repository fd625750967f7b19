//! Kernels: what they cost, and that all ways to sum the same history agree.

use nalgebra::{DMatrix, DVector};
use std::sync::Arc;
use stickslip::qvi::{
    Evolution, ExponentialTerm, HistoryOperator, Inequality, Kernel, LinearPhi, Matrix, Quadrature,
    SeparableTerm, Settings, SolveError, Solver, Space, Weights, fractional_kernel,
};

/// `2 u + S u = f` on two unknowns.
fn problem(kernel: Kernel) -> Inequality {
    let load = |t: f64| DVector::from_vec(vec![(3.0 * t).cos(), 1.0 - t]);
    let mut problem = Inequality::new(Space::euclidean(2), Matrix::multiple(2, 2.0), load);
    problem.histories = vec![HistoryOperator::new(kernel, DVector::zeros(2))];
    problem.phi = Box::new(LinearPhi(vec![Some(Matrix::multiple(2, 1.0))]));
    problem
}

/// u at the end of `steps` steps of size k, numbers kept, products with the kernel.
fn run(
    problem: &Inequality,
    rule: &Quadrature,
    (k, steps): (f64, usize),
) -> (DVector<f64>, usize, usize) {
    let mut run = Evolution::new(problem, rule, k, Settings::new(Solver::Direct)).unwrap();
    for _ in 0..=steps {
        run.advance().unwrap();
    }
    (run.u().clone(), run.numbers_kept(), run.kernel_products())
}

fn q(lag: f64) -> f64 {
    0.7 * (-lag / 0.3).exp() + 0.2 * (-lag / 2.0).exp()
}

fn terms() -> Vec<ExponentialTerm> {
    [(0.7, 0.3), (0.2, 2.0)]
        .map(|(weight, tau)| ExponentialTerm { weight, tau })
        .to_vec()
}

#[test]
fn all_ways_to_sum_a_history_agree() {
    let separable = Kernel::Separable(
        terms()
            .into_iter()
            .map(|ExponentialTerm { weight, tau }| {
                SeparableTerm::new(move |t| weight * (-t / tau).exp(), move |s| (s / tau).exp())
            })
            .collect(),
    );
    let kernels = [
        Kernel::Exponentials(terms()),
        separable,
        Kernel::Convolution(Arc::new(q)),
        Kernel::Scalar(Arc::new(|t, s| q(t - s))),
        Kernel::Matrix(Arc::new(|t, s| {
            DMatrix::from_diagonal_element(2, 2, q(t - s))
        })),
    ];
    for rule in [
        Quadrature::Trapezoid,
        Quadrature::Rectangle,
        Quadrature::RightRectangle,
    ] {
        // not a multiple of a block, and more than the largest power of two below it
        let all = kernels
            .clone()
            .map(|kernel| run(&problem(kernel), &rule, (0.01, 333)).0);
        assert!(all[0].amax() > 0.1);
        for other in &all[1..] {
            assert!((other - &all[0]).amax() < 1e-13, "{all:?}");
        }
    }
}

#[test]
fn a_history_costs_what_its_kernel_needs() {
    let sums = problem(Kernel::Exponentials(terms()));
    let fast = problem(Kernel::Convolution(Arc::new(q)));
    let full = problem(Kernel::Scalar(Arc::new(|t, s| q(t - s))));
    let cost = |problem: &Inequality, steps| {
        let (_, kept, products) = run(problem, &Quadrature::Trapezoid, (1e-3, steps));
        (kept, products)
    };
    for steps in [511, 2047] {
        let points = steps + 1;
        assert_eq!(cost(&sums, steps), (4, 4 * points));
        let (kept, products) = cost(&full, steps);
        assert!(kept == 2 * points + 64, "{kept}");
        assert!(
            products.abs_diff(points * points / 2) < points,
            "{products}"
        );
        let (_, products) = cost(&fast, steps);
        let log = points.ilog2() as usize;
        assert!(products < 3 * points * log * log, "{products}");
    }
}

#[test]
fn a_million_steps_with_thirty_terms_keep_thirty_vectors() {
    let steps = 1_000_000;
    let all = fractional_kernel(0.5, [1e-3, 1e4], 1e-3).unwrap();
    let terms = all[all.len() - 30..].to_vec();
    let problem = problem(Kernel::Exponentials(terms));
    let settings = Settings::new(Solver::Direct);
    let mut run = Evolution::new(&problem, &Quadrature::Product, 0.01, settings).unwrap();
    let (mut largest, mut least): (f64, f64) = (0.0, f64::INFINITY);
    for n in 0..=steps {
        let size = run.advance().unwrap().amax();
        if n > 100 {
            largest = largest.max(size);
            least = least.min(size);
        }
        assert_eq!(run.numbers_kept(), 60);
    }
    assert!(largest.is_finite() && least > 0.0 && largest > least);
    assert_eq!(run.kernel_products(), 60 * (steps + 1));
}

/// `exp(x^2) erfc(x)`, by its continued fraction or its series.
fn erfcx(x: f64) -> f64 {
    if x < 2.0 {
        let (mut term, mut sum) = (x, x);
        for n in 1..80 {
            let n = f64::from(n);
            term *= 2.0 * x * x / (2.0 * n + 1.0);
            sum += term;
        }
        return (x * x).exp() - 2.0 / std::f64::consts::PI.sqrt() * sum;
    }
    let mut fraction = x;
    for n in (1..200).rev() {
        fraction = x + 0.5 * f64::from(n) / fraction;
    }
    1.0 / (fraction * std::f64::consts::PI.sqrt())
}

/// `c D^(1/2) u + B u = F` for `t > 0` with c = B = F = 1, `u = 1 - erfcx(sqrt t)`, at t = 1, and the number of terms.
fn fractional(steps: usize, tolerance: f64) -> (f64, usize) {
    let k = 1.0 / steps as f64;
    let terms = fractional_kernel(0.5, [k / 100.0, 1.0], tolerance).unwrap();
    // int exp(-(t-s)/tau) u'(s) ds = u - int exp(-(t-s)/tau) u(s) ds / tau
    let stiffness: f64 = 1.0 + terms.iter().map(|term| term.weight).sum::<f64>();
    let count = terms.len();
    let kernel = terms
        .into_iter()
        .map(|ExponentialTerm { weight, tau }| ExponentialTerm {
            weight: -weight / tau,
            tau,
        });
    let load = |_: f64| DVector::from_element(1, 1.0);
    let mut problem = Inequality::new(Space::euclidean(1), Matrix::multiple(1, stiffness), load);
    let kernel = Kernel::Exponentials(kernel.collect());
    problem.histories = vec![HistoryOperator::new(kernel, DVector::zeros(1))];
    problem.phi = Box::new(LinearPhi(vec![Some(Matrix::multiple(1, 1.0))]));
    let (u, kept, _) = run(&problem, &Quadrature::Product, (k, steps));
    assert_eq!(kept, count);
    ((u[0] - (1.0 - erfcx(1.0))).abs(), count)
}

#[test]
fn a_fractional_kernel_as_a_sum_of_exponentials() {
    // weights are positive, and the sum is the kernel to the tolerance
    for tolerance in [5e-3, 1e-5] {
        let terms = fractional_kernel(0.5, [1e-4, 1.0], tolerance).unwrap();
        assert!(terms.iter().all(|term| term.weight > 0.0 && term.tau > 0.0));
        for i in 0..=80 {
            let t = 10.0_f64.powf(f64::from(i) / 20.0 - 4.0);
            let sum: f64 = terms.iter().map(|term| term.value(t)).sum();
            let exact = t.powf(-0.5) / std::f64::consts::PI.sqrt();
            assert!((sum / exact - 1.0).abs() < 2.0 * tolerance, "{t}: {sum}");
        }
    }
    for (steps, most) in [(50, 1.2e-3), (200, 2e-4), (3200, 4e-5)] {
        let (error, count) = fractional(steps, 1e-4);
        println!("{steps} steps, {count} terms: {error:.1e}");
        assert!(error < most, "{steps}: {error:e}");
        assert!(count < 80, "{count}");
    }
}

/// Gregory's weights of third order; they change with the row.
struct Gregory;

impl Weights for Gregory {
    fn weight(&self, k: f64, n: usize, j: usize) -> f64 {
        let weights: &[f64] = match n {
            0 => &[0.0],
            1 => &[0.5, 0.5],
            2 => &[1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0],
            3 => &[3.0 / 8.0, 9.0 / 8.0, 9.0 / 8.0, 3.0 / 8.0],
            _ => {
                let end = j.min(n - j);
                return k * [5.0 / 12.0, 13.0 / 12.0, 1.0][end.min(2)];
            }
        };
        k * weights[j]
    }
}

#[test]
fn any_quadrature_with_nonnegative_weights_will_do() {
    let rule = Quadrature::Weights(Arc::new(Gregory));
    let of = |steps: usize| {
        let problem = problem(Kernel::Convolution(Arc::new(q)));
        run(&problem, &rule, (1.0 / steps as f64, steps)).0
    };
    let errors = [16, 32, 64].map(|steps| (of(steps) - of(1024)).amax());
    let order = (errors[1] / errors[2]).log2();
    assert!(order > 2.7, "{errors:?}");
    // sums of the past need weights that stay
    let problem = problem(Kernel::Exponentials(terms()));
    let refused = Evolution::new(&problem, &rule, 0.1, Settings::new(Solver::Direct));
    assert!(matches!(refused.err(), Some(SolveError::Rule { .. })));
}

struct Negative;

impl Weights for Negative {
    fn weight(&self, _: f64, _: usize, _: usize) -> f64 {
        -1.0
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let sums = problem(Kernel::Exponentials(terms()));
    let full = problem(Kernel::Convolution(Arc::new(q)));
    let settings = || Settings::new(Solver::Direct);
    let new = |problem, rule, k| Evolution::new(problem, &rule, k, settings()).err();
    let negative = Quadrature::Weights(Arc::new(Negative));
    assert!(matches!(
        new(&full, negative, 0.1),
        Some(SolveError::Value { .. })
    ));
    assert!(matches!(
        new(&full, Quadrature::Product, 0.1),
        Some(SolveError::Rule { .. })
    ));
    assert!(matches!(
        new(&sums, Quadrature::Trapezoid, 0.0),
        Some(SolveError::Value { .. })
    ));
    let terms = vec![ExponentialTerm {
        weight: 1.0,
        tau: -1.0,
    }];
    let unstable = problem(Kernel::Exponentials(terms));
    assert!(matches!(
        new(&unstable, Quadrature::Trapezoid, 0.1),
        Some(SolveError::Value { .. })
    ));
    let mut wrong = problem(Kernel::constant(1.0));
    wrong.histories[0].start = DVector::zeros(3);
    assert!(matches!(
        new(&wrong, Quadrature::Trapezoid, 0.1),
        Some(SolveError::Shape { .. })
    ));
}
