//! P1 to P6: the solution is chosen, the load follows.

use super::Example;
use crate::qvi::{
    Bounds, Coefficients, HalfSpace, HistoryOperator, Inequality, Kernel, LinearPhi, Matrix,
    NonlinearOperator, Part, SeparableTerm, SolveError, Space,
};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

fn number(value: f64) -> DVector<f64> {
    DVector::from_element(1, value)
}

fn times(factor: f64, n: usize) -> Box<LinearPhi> {
    Box::new(LinearPhi(vec![Some(Matrix::multiple(n, factor))]))
}

/// P1: `m u + kappa (1/2 + int u) = f`.
pub fn linear(m: f64, kappa: f64) -> Example {
    let exact = |t: f64| (2.0 * t).cos() + t;
    let load = move |t: f64| {
        let integral = (2.0 * t).sin() / 2.0 + t * t / 2.0;
        number(m * exact(t) + kappa * (0.5 + integral))
    };
    let mut problem = Inequality::new(Space::euclidean(1), Matrix::multiple(1, m), load);
    problem.histories = vec![HistoryOperator::new(Kernel::constant(1.0), number(0.5))];
    problem.phi = times(kappa, 1);
    Example {
        name: "P1",
        text: "linear, q = 1",
        problem,
        exact: Box::new(move |t| number(exact(t))),
    }
}

/// P2: `q = [[1 + t s, 0], [t - s, 1]]`, `R = [[1, t], [0, 2]]`.
pub fn two_times() -> Example {
    let a = DMatrix::from_row_slice(2, 2, &[3.0, 1.0, -1.0, 2.0]);
    let b = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.2, 1.0]);
    let r = |t: f64| DMatrix::from_row_slice(2, 2, &[1.0, t, 0.0, 2.0]);
    let exact = |t: f64| DVector::from_vec(vec![t, t * t]);
    let start = DVector::from_vec(vec![0.3, -0.2]);
    let load = {
        let (a, b, start) = (a.clone(), b.clone(), start.clone());
        move |t: f64| {
            let first = t.powi(2) / 2.0 + t * t.powi(3) / 3.0;
            let second = t * t.powi(2) / 2.0;
            let integral = DVector::from_vec(vec![first, second]);
            &a * exact(t) + &b * (r(t) * (integral + &start))
        }
    };
    let mut problem = Inequality::new(Space::euclidean(2), Matrix::Dense(a), load);
    // 1 + t s on the first component, t - s from the first to the second, 1 on the second
    let unit = |i: usize, j: usize| {
        let mut matrix = DMatrix::zeros(2, 2);
        matrix[(i, j)] = 1.0;
        matrix
    };
    let kernel = Kernel::Separable(vec![
        SeparableTerm::new(|_| 1.0, |_| 1.0),
        SeparableTerm::new(|t| t, |s| s).times(unit(0, 0)),
        SeparableTerm::new(|t| t, |_| 1.0).times(unit(1, 0)),
        SeparableTerm::new(|_| -1.0, |s| s).times(unit(1, 0)),
    ]);
    problem.histories = vec![HistoryOperator::new(kernel, start).with_factor(r)];
    problem.phi = Box::new(LinearPhi(vec![Some(Matrix::Dense(b))]));
    Example {
        name: "P2",
        text: "kernel of two times, R(t), A not symmetric",
        problem,
        exact: Box::new(exact),
    }
}

/// P3: `u + 2 int u + g(|u|) sgn u = f`, `g(r) = 0.3 exp(-decay r) + 0.1`; `beta = 0.3 decay`, to be compared with `m = 1`.
pub fn friction_of_rate(decay: f64) -> Example {
    let (m, kappa, at_rest, least) = (1.0, 2.0, 0.4, 0.1);
    let g = move |r: f64| (at_rest - least) * (-decay * r).exp() + least;
    let exact = |t: f64| (t - 0.5).max(0.0).powi(2);
    let load = move |t: f64| {
        let friction = if t > 0.5 {
            g(exact(t))
        } else {
            at_rest * t / 0.5
        };
        number(m * exact(t) + kappa * (t - 0.5).max(0.0).powi(3) / 3.0 + friction)
    };
    let mut problem = Inequality::new(Space::euclidean(1), Matrix::multiple(1, m), load);
    problem.histories = vec![HistoryOperator::new(Kernel::constant(1.0), number(0.0))];
    problem.phi = times(kappa, 1);
    problem.parts = Part::each(1);
    let beta = (at_rest - least) * decay;
    problem.j = Box::new(Coefficients::new(
        beta,
        move |at: &[DVector<f64>], c: &mut [f64]| {
            c[0] += g(at[0][0].abs());
        },
    ));
    Example {
        name: "P3",
        text: "stick, then friction that weakens with the rate",
        problem,
        exact: Box::new(move |t| number(exact(t))),
    }
}

/// P4: `K = [0, inf)`, `q = exp(-(t - s))`; the load has the reaction of K.
pub fn one_sided() -> Result<Example, SolveError> {
    let (m, kappa, w) = (1.0, 1.5, 2.0 * PI);
    let history = move |t: f64| {
        let f = |s: f64| s.exp() * ((w * s).sin() - w * (w * s).cos()) / (1.0 + w * w);
        let (mut sum, mut j) = (0.0, 0.0);
        while j < t {
            sum += f(t.min(j + 0.5)) - f(j);
            j += 1.0;
        }
        (-t).exp() * sum
    };
    let exact = move |t: f64| (w * t).sin().max(0.0);
    let load = move |t: f64| number(m * exact(t) + kappa * history(t) - (-(w * t).sin()).max(0.0));
    let mut problem = Inequality::new(Space::euclidean(1), Matrix::multiple(1, m), load);
    problem.histories = vec![HistoryOperator::new(Kernel::exponential(1.0), number(0.0))];
    problem.phi = times(kappa, 1);
    problem.set = Box::new(Bounds::new(number(0.0), number(f64::INFINITY))?);
    Ok(Example {
        name: "P4",
        text: "K = [0, inf), exponential kernel",
        problem,
        exact: Box::new(move |t| number(exact(t))),
    })
}

/// P5: `A u = m u + (L - m) u / sqrt(1 + |u|^2)` with exactly these constants, `phi = sum |y_i| |v_i|`.
pub fn nonlinear() -> Example {
    let (m, l) = (1.0, 3.0);
    let a = move |u: &DVector<f64>| u * (m + (l - m) / (1.0 + u.norm_squared()).sqrt());
    let directions = || DVector::from_vec(vec![1.0, -0.5, 0.25]);
    let start = || DVector::from_vec(vec![0.1, 0.1, -0.1]);
    let exact = move |t: f64| directions() * (1.0 + 0.5 * t.sin());
    let load = move |t: f64| {
        let history = directions() * (t + 0.5 * (1.0 - t.cos())) + start();
        let bound = history.abs().component_mul(&directions().map(f64::signum));
        a(&exact(t)) + bound
    };
    let operator = NonlinearOperator::new([m, l], a);
    let mut problem = Inequality::new(Space::euclidean(3), operator, load);
    problem.histories = vec![HistoryOperator::new(Kernel::constant(1.0), start())];
    problem.parts = Part::each(3);
    problem.phi = Box::new(Coefficients::new(
        1.0,
        |y: &[DVector<f64>], c: &mut [f64]| {
            c.iter_mut()
                .zip(y[0].iter())
                .for_each(|(c, y)| *c += y.abs());
        },
    ));
    Example {
        name: "P5",
        text: "nonlinear A, history in the bound",
        problem,
        exact: Box::new(exact),
    }
}

/// P6: `u_1 + u_2 <= 1` with friction on u_1.
pub fn half_space() -> Result<Example, SolveError> {
    let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 0.5, 0.5, 1.5]);
    let (kappa, bound) = (0.8, 0.2);
    let exact = |t: f64| {
        let second = if t < 0.5 {
            0.9 - t
        } else {
            0.4 - (t - 0.5) - 2.0 * (t - 0.5).powi(2)
        };
        DVector::from_vec(vec![t + 0.1, second])
    };
    let integral = |t: f64| {
        let second = if t < 0.5 {
            0.9 * t - t * t / 2.0
        } else {
            let s = t - 0.5;
            0.325 + 0.4 * s - s * s / 2.0 - 2.0 * s.powi(3) / 3.0
        };
        DVector::from_vec(vec![t * t / 2.0 + 0.1 * t, second])
    };
    let load = {
        let matrix = matrix.clone();
        move |t: f64| {
            let friction = DVector::from_vec(vec![bound, 0.0]);
            let reaction = DVector::from_element(2, (0.5 - t).max(0.0));
            &matrix * exact(t) + kappa * integral(t) + friction + reaction
        }
    };
    let mut problem = Inequality::new(Space::euclidean(2), Matrix::Dense(matrix), load);
    problem.histories = vec![HistoryOperator::new(
        Kernel::constant(1.0),
        DVector::zeros(2),
    )];
    problem.phi = times(kappa, 2);
    problem.parts = vec![Part::friction(0..1)];
    problem.j = Box::new(Coefficients::new(
        0.0,
        move |_: &[DVector<f64>], c: &mut [f64]| c[0] += bound,
    ));
    problem.set = Box::new(HalfSpace::new(DVector::from_element(2, 1.0), 1.0)?);
    Ok(Example {
        name: "P6",
        text: "half-space, friction",
        problem,
        exact: Box::new(exact),
    })
}
