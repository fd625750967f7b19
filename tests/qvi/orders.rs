//! Errors of P1 to P7 against their exact solutions: those of an independent numpy script, and their orders.

use stickslip::qvi::examples::{Bar, all};
use stickslip::qvi::{Quadrature, Solver};

const COUNTS: [usize; 5] = [10, 20, 40, 80, 160];

/// Largest errors that the independent script has at N = 10, 20, 40, 80, 160, by trapezoid and rectangle.
const ERRORS: [[[f64; 5]; 2]; 6] = [
    [
        [
            1.443629e-03,
            3.614153e-04,
            9.029306e-05,
            2.257826e-05,
            5.644324e-06,
        ],
        [
            2.527733e-02,
            1.245554e-02,
            6.185000e-03,
            3.082166e-03,
            1.538543e-03,
        ],
    ],
    [
        [
            3.435122e-04,
            8.591416e-05,
            2.148079e-05,
            5.370339e-06,
            1.342594e-06,
        ],
        [
            5.445253e-02,
            2.663764e-02,
            1.317525e-02,
            6.552166e-03,
            3.267273e-03,
        ],
    ],
    [
        [
            1.195266e-03,
            2.977108e-04,
            7.435938e-05,
            1.858558e-05,
            4.646130e-06,
        ],
        [
            2.403264e-02,
            1.188359e-02,
            5.909601e-03,
            2.946834e-03,
            1.471434e-03,
        ],
    ],
    [
        [
            9.675720e-03,
            2.420948e-03,
            6.081530e-04,
            1.519954e-04,
            3.800601e-05,
        ],
        [
            6.816023e-02,
            3.242458e-02,
            1.587519e-02,
            7.817911e-03,
            3.879661e-03,
        ],
    ],
    [
        [
            1.165550e-04,
            2.915514e-05,
            7.289429e-06,
            1.822490e-06,
            4.556144e-07,
        ],
        [
            1.160319e-02,
            5.696255e-03,
            2.821662e-03,
            1.404575e-03,
            7.005690e-04,
        ],
    ],
    [
        [
            8.348632e-04,
            2.086724e-04,
            5.216540e-05,
            1.304118e-05,
            3.260284e-06,
        ],
        [
            3.959391e-02,
            1.976586e-02,
            9.874479e-03,
            4.935047e-03,
            2.466966e-03,
        ],
    ],
];

const RULES: [(Quadrature, f64); 2] = [(Quadrature::Trapezoid, 2.0), (Quadrature::Rectangle, 1.0)];

fn assert_near(found: f64, expected: f64, share: f64, what: &str) {
    let off = found / expected - 1.0;
    assert!(
        off.abs() < share,
        "{what}: {found:e} instead of {expected:e}"
    );
}

#[test]
fn errors_are_those_of_the_independent_script_and_fall_with_the_order_of_the_rule() {
    for (example, of_script) in all().unwrap().iter().zip(ERRORS) {
        for ((rule, order), of_script) in RULES.iter().zip(of_script) {
            let errors = COUNTS.map(|steps| example.error(rule, steps, Solver::Direct).unwrap());
            let what = format!("{} by {}", example.name, rule.name());
            for (found, expected) in errors.iter().zip(of_script) {
                assert_near(*found, expected, 0.02, &what);
            }
            let seen = (errors[3] / errors[4]).log2();
            assert_near(seen, *order, 0.03, &format!("order of {what}"));
        }
    }
}

#[test]
fn the_fixed_point_of_the_proof_gives_the_same_as_the_direct_solver() {
    for example in all().unwrap() {
        let rule = &Quadrature::Trapezoid;
        let [direct, proof] =
            [Solver::Direct, Solver::Lambda].map(|solver| example.error(rule, 20, solver).unwrap());
        assert!((direct - proof).abs() < 1e-10, "{}", example.name);
    }
}

#[test]
fn the_bar_has_the_errors_of_the_script_whatever_the_step_and_first_order_in_space() {
    let of_script = [1.255909e-01, 6.291658e-02, 3.147345e-02, 1.573862e-02];
    let mut before = f64::NAN;
    for (cells, expected) in [8, 16, 32, 64].into_iter().zip(of_script) {
        let bar = Bar::new(cells).unwrap();
        for steps in [8, 32] {
            let found = bar.error(&Quadrature::Trapezoid, steps).unwrap();
            assert_near(
                found,
                expected,
                1e-3,
                &format!("{cells} cells, {steps} steps"),
            );
            if cells > 16 {
                assert_near((before / found).log2(), 1.0, 0.03, "order in h");
            }
        }
        before = expected;
    }
}

#[test]
fn the_rectangle_adds_its_first_order_to_the_bar() {
    let bar = Bar::new(64).unwrap();
    let of_script = [1.130590e-01, 5.424907e-02, 2.751735e-02];
    for (steps, expected) in [4, 8, 16].into_iter().zip(of_script) {
        let found = bar.error(&Quadrature::Rectangle, steps).unwrap();
        assert_near(found, expected, 0.02, &format!("{steps} steps"));
    }
}
