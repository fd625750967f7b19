//! Constants: computed where matrices are given, checked by samples where they are declared.

use nalgebra::{DMatrix, DVector};
use stickslip::qvi::examples::{Bar, all};
use stickslip::qvi::{
    Coefficients, Constants, Inequality, Iterations, Matrix, NonlinearOperator, Origin, Part,
    Record, Solver, Space, Warning,
};

#[test]
fn constants_of_the_bar_are_those_of_its_data() {
    let bar = Bar::new(16).unwrap();
    let constants = Constants::of(&bar.problem, 1.0).unwrap();
    for (found, expected) in [
        (constants.m, 1.0),
        (constants.lipschitz, 1.0),
        (constants.alpha, 2.0),
        (constants.beta, 0.4),
        (constants.c1, 1.0),
    ] {
        assert!((found.value - expected).abs() < 1e-9, "{constants:?}");
    }
    assert_eq!(constants.m.origin, Origin::Computed);
    assert_eq!(constants.beta.origin, Origin::Declared);
    // |v(1)| <= |v| is sharp: no sample contradicts beta
    let record = Record::of(
        &bar.problem,
        (1.0, 0.1),
        Solver::Direct,
        &Iterations::default(),
    );
    assert_eq!(record.unwrap().warnings, []);
}

#[test]
fn no_sample_contradicts_the_constants_of_the_examples() {
    for example in all().unwrap() {
        let none = Iterations::default();
        let record = Record::of(&example.problem, (1.0, 0.1), Solver::Direct, &none).unwrap();
        assert_eq!(record.warnings, [], "{}", example.name);
    }
}

#[test]
fn constants_are_those_of_the_inner_product() {
    let gram = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 3.0]);
    let space = Space::with_product(Matrix::Dense(gram.clone())).unwrap();
    let zero = |_: f64| DVector::zeros(2);
    let problem = Inequality::new(space, Matrix::Dense(&gram * 2.5), zero);
    let constants = Constants::of(&problem, 1.0).unwrap();
    assert!((constants.m.value - 2.5).abs() < 1e-12);
    assert!((constants.lipschitz.value - 2.5).abs() < 1e-12);
}

#[test]
fn constants_that_are_declared_too_well_are_contradicted() {
    let zero = |_: f64| DVector::zeros(2);
    let wrong = NonlinearOperator::new([1.0, 2.0], |u: &DVector<f64>| u * 0.5);
    let mut problem = Inequality::new(Space::euclidean(2), wrong, zero);
    problem.parts = Part::each(2);
    problem.j = Box::new(Coefficients::new(
        0.1,
        |at: &[DVector<f64>], c: &mut [f64]| c[0] += (1.0 - 0.5 * at[0][0].abs()).max(0.0),
    ));
    let record = Record::of(&problem, (1.0, 0.1), Solver::Direct, &Iterations::default()).unwrap();
    let contradicted: Vec<_> = record
        .warnings
        .iter()
        .filter_map(|warning| match warning {
            Warning::Contradicted { what, .. } => Some(*what),
            _ => None,
        })
        .collect();
    assert_eq!(contradicted, ["m of (2.3)", "beta of (2.5)"]);
}
