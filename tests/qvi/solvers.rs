//! The fixed point of the proof and the direct solver, within the conditions of the theory and outside of them.

use nalgebra::{DMatrix, DVector};
use stickslip::qvi::examples::{friction_of_rate, linear};
use stickslip::qvi::{
    Coefficients, Evolution, HistoryOperator, Inequality, Kernel, LinearPhi, Matrix, Part,
    Quadrature, Record, Sampler, Settings, SolveError, Solver, Space, Verdict, Warning, solve,
};

fn matrix(sampler: &mut Sampler, n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |_, _| sampler.between(-1.0, 1.0))
}

/// An inequality of four unknowns with everything that enters the constants.
fn random(sampler: &mut Sampler) -> Inequality {
    let n = 4;
    let root = matrix(sampler, n);
    let skew = matrix(sampler, n);
    let a = &root * root.transpose()
        + (&skew - skew.transpose()) * 0.5
        + DMatrix::from_diagonal_element(n, n, 0.5);
    let gram = matrix(sampler, n);
    let gram = &gram * gram.transpose() + DMatrix::identity(n, n);
    let b = matrix(sampler, n);
    let r = matrix(sampler, n);
    let direction = sampler.vector(n).normalize();
    let space = Space::with_product(Matrix::Dense(gram.clone())).unwrap();
    let load = move |t: f64| &direction * (3.0 + (5.0 * t).sin());
    let mut problem = Inequality::new(space, Matrix::Dense(a), load);
    let tau = sampler.between(0.1, 2.0);
    let start = DVector::from_fn(n, |_, _| sampler.between(-1.0, 1.0));
    let history = HistoryOperator::new(Kernel::exponential(tau), start);
    problem.histories = vec![history.with_factor(move |t| &r * (1.0 + 0.2 * t))];
    problem.phi = Box::new(LinearPhi(vec![Some(Matrix::Dense(b))]));
    problem.parts = Part::each(n);
    // |v|^2 <= |v|_G^2, as G is at least the identity
    let fall = sampler.between(0.01, 0.1);
    problem.j = Box::new(Coefficients::new(
        fall,
        move |at: &[DVector<f64>], c: &mut [f64]| {
            for (c, u) in c.iter_mut().zip(at[0].iter()) {
                *c += 0.3 + fall * (-u.abs()).exp();
            }
        },
    ));
    problem
}

#[test]
fn the_contraction_of_theorem_3_1_stays_below_its_bound() {
    let mut sampler = Sampler::new(20);
    let mut nearest: f64 = 0.0;
    let mut count = 0;
    while count < 50 {
        let problem = random(&mut sampler);
        let k = sampler.between(0.01, 0.3);
        let rule = &Quadrature::Trapezoid;
        let mut settings = Settings::new(Solver::Lambda);
        settings.tolerance = 1e-12;
        let mut run = Evolution::new(&problem, rule, k, settings).unwrap();
        if run.advance().is_err() {
            continue;
        }
        let mut is_solved = true;
        for _ in 0..4 {
            is_solved &= run.advance().is_ok();
        }
        let record = Record::of(&problem, (5.0 * k, k), Solver::Lambda, run.iterations()).unwrap();
        if record.conditions.contraction != Verdict::Holds {
            continue;
        }
        count += 1;
        assert!(is_solved, "{record:?}");
        let (seen, bound) = (record.contraction, record.conditions.factor);
        assert!(seen <= bound * (1.0 + 1e-5), "{seen} above {bound}");
        let of_proof = record.conditions.factor_of_proof;
        assert!(bound <= of_proof, "{bound} above {of_proof}");
        let is_warned = record.warnings.iter().any(|w| {
            matches!(
                w,
                Warning::ContractionAboveBound { .. } | Warning::Contradicted { .. }
            )
        });
        assert!(!is_warned, "{:?}", record.warnings);
        nearest = nearest.max(seen / bound);
    }
    assert!(
        nearest > 0.2,
        "the bound is not a bound of anything: {nearest}"
    );
}

#[test]
fn the_last_weight_halves_the_factor_of_the_proof() {
    let example = linear(2.0, 3.0);
    let run = solve(
        &example.problem,
        &Quadrature::Trapezoid,
        (1.0, 10),
        Settings::new(Solver::Lambda),
    )
    .unwrap();
    assert!((run.iterations.contraction - 0.075).abs() < 1e-6);
    let record = Record::of(
        &example.problem,
        (1.0, 0.1),
        Solver::Lambda,
        &run.iterations,
    )
    .unwrap();
    assert!((record.conditions.factor - 0.075).abs() < 1e-12);
    assert!((record.conditions.factor_of_proof - 0.15).abs() < 1e-12);
    assert_eq!(record.conditions.step, Verdict::Holds);
    assert_eq!(record.warnings, []);
}

/// Errors and iterations for `k kappa / m = 30 / N`.
fn beyond(steps: usize, rule: Quadrature, solver: Solver) -> Result<(f64, usize), SolveError> {
    let example = linear(1.0, 30.0);
    let run = solve(&example.problem, &rule, (1.0, steps), Settings::new(solver))?;
    let errors = run.times.iter().zip(&run.u);
    let errors = errors.map(|(t, u)| (u - (example.exact)(*t)).amax());
    Ok((errors.fold(0.0, f64::max), run.iterations.most))
}

#[test]
fn beyond_the_condition_the_fixed_point_slows_down_stalls_and_diverges_and_the_direct_solver_does_not()
 {
    let trapezoid = || Quadrature::Trapezoid;
    // k kappa / m = 1.5: above (3.6), below twice of it
    let (error, most) = beyond(20, trapezoid(), Solver::Lambda).unwrap();
    assert!((80..=120).contains(&most), "{most}");
    let (direct, _) = beyond(20, trapezoid(), Solver::Direct).unwrap();
    assert!((error - direct).abs() < 1e-10);
    let stalled = beyond(15, trapezoid(), Solver::Lambda).unwrap_err();
    assert!(
        matches!(stalled, SolveError::NotConverged { contraction, .. } if (contraction - 1.0).abs() < 1e-6),
        "{stalled}"
    );
    let diverged = beyond(14, trapezoid(), Solver::Lambda).unwrap_err();
    assert!(
        matches!(diverged, SolveError::Diverged { contraction, .. } | SolveError::NotConverged { contraction, .. } if contraction > 1.05),
        "{diverged}"
    );
    // one solution all the same; the independent script's error
    let (direct, most) = beyond(5, trapezoid(), Solver::Direct).unwrap();
    assert!(
        (0.01..0.03).contains(&direct) && most <= 2,
        "{direct}, {most}"
    );
    for (steps, of_script) in [(15, 0.07), (14, 0.27), (10, 51.0)] {
        let (error, _) = beyond(steps, Quadrature::Rectangle, Solver::Lambda).unwrap();
        assert!((error / of_script - 1.0).abs() < 0.1, "{steps}: {error}");
    }
}

#[test]
fn a_run_outside_of_the_conditions_is_warned_of() {
    let example = linear(1.0, 30.0);
    let rule = &Quadrature::Trapezoid;
    let run = solve(
        &example.problem,
        rule,
        (1.0, 20),
        Settings::new(Solver::Lambda),
    )
    .unwrap();
    let record = Record::of(
        &example.problem,
        (1.0, 0.05),
        Solver::Lambda,
        &run.iterations,
    )
    .unwrap();
    assert_eq!(record.conditions.step, Verdict::Fails);
    assert_eq!(record.conditions.contraction, Verdict::Holds);
    assert!(matches!(
        record.warnings[..],
        [Warning::StepBeyondProof { .. }]
    ));
    let direct = record
        .conditions
        .with_direct(&example.problem, &[0.025])
        .unwrap();
    assert!((direct.implicit_m.unwrap() - 1.75).abs() < 1e-12);
}

#[test]
fn a_history_of_negative_sign_makes_one_size_of_step_singular() {
    // k = 2 m / |kappa|
    let example = linear(1.0, -8.0);
    let at = |steps| {
        let settings = Settings::new(Solver::Direct);
        solve(
            &example.problem,
            &Quadrature::Trapezoid,
            (1.0, steps),
            settings,
        )
    };
    assert_eq!(at(4).unwrap_err(), SolveError::Singular);
    assert!(at(400).is_ok());
}

#[test]
fn several_solutions_exist_where_the_bound_falls_faster_than_the_operator_rises() {
    // decay -> loads between which there are several solutions at rest
    for (decay, [low, high]) in [(5.0, [0.381, 0.4]), (10.0, [0.310, 0.4])] {
        let count = |load: f64| {
            let mut problem = friction_of_rate(decay).problem;
            problem.load = Box::new(move |_| DVector::from_element(1, load));
            let settings = Settings {
                most_iterations: 20_000,
                ..Settings::new(Solver::Direct)
            };
            let mut run = Evolution::new(&problem, &Quadrature::Trapezoid, 0.1, settings).unwrap();
            run.solutions(&[DVector::from_element(1, 10.0)], 1e-6)
        };
        assert_eq!(count(low - 2e-3).len(), 1, "{decay}");
        let several = count(0.5 * (low + high));
        assert!(several.len() >= 2, "{decay}: {several:?}");
        assert_eq!(count(low + 1.5e-3).len(), 2, "{decay}");
        assert_eq!(count(high - 1e-3).len(), 2, "{decay}");
        assert_eq!(count(high + 2e-3).len(), 1, "{decay}");
        // every one of them satisfies u + g(u) sgn u = f or rests within the bound
        let f = 0.5 * (low + high);
        for u in several {
            let u = u[0];
            let bound = 0.3 * (-decay * u).exp() + 0.1;
            assert!(if u == 0.0 {
                f <= 0.4
            } else {
                (u + bound - f).abs() < 1e-9
            });
        }
    }
    // one where beta < m
    let mut problem = friction_of_rate(2.0).problem;
    problem.load = Box::new(|_| DVector::from_element(1, 0.39));
    let settings = Settings::new(Solver::Direct);
    let mut run = Evolution::new(&problem, &Quadrature::Trapezoid, 0.1, settings).unwrap();
    assert_eq!(
        run.solutions(&[DVector::from_element(1, 10.0)], 1e-6).len(),
        1
    );
    let weak = friction_of_rate(5.0);
    let record = Record::of(&weak.problem, (1.0, 0.1), Solver::Direct, run.iterations()).unwrap();
    assert_eq!(record.conditions.uniqueness, Verdict::Fails);
    assert!(matches!(
        record.warnings[0],
        Warning::SeveralSolutions { .. }
    ));
}
