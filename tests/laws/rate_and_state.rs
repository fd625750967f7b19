//! Rate-and-state friction against a fine integration of its state, and of a block on a spring.

use stickslip::contact::SlipPath;
use stickslip::contact::law::{ChosenLaw, Given, Law, Memory, MemoryPath, Role};
use stickslip::contact::pressed::PressedBounds;

const MU0: f64 = 0.4;
const A: f64 = 0.02;
const V0: f64 = 0.001;
const D_C: f64 = 0.01;
const AGING: usize = 0;
const SLIP: usize = 1;

fn law(b: f64, evolution: usize) -> ChosenLaw {
    let role = Role::Coulomb { tension: false };
    let kind = Law::find(role, "rate_and_state").unwrap();
    let mut given: Vec<Given> = [MU0, A, b, V0, D_C].map(Given::Number).to_vec();
    given.extend([Given::Choice(evolution), Given::Absent]);
    given.extend([Given::Number(0.0), Given::Absent]);
    ChosenLaw::new(kind, &given, None).unwrap()
}

/// The rate of `ln theta`.
fn ln_state_rate(evolution: usize, ln_state: f64, rate: f64) -> f64 {
    if evolution == AGING {
        (-ln_state).exp() - rate / D_C
    } else if rate == 0.0 {
        0.0
    } else {
        -rate / D_C * (ln_state + (rate / D_C).ln())
    }
}

/// One step of the classical Runge-Kutta method.
fn runge_kutta(y: f64, t: f64, h: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    let k1 = f(t, y);
    let k2 = f(t + 0.5 * h, y + 0.5 * h * k1);
    let k3 = f(t + 0.5 * h, y + 0.5 * h * k2);
    let k4 = f(t + h, y + h * k3);
    y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
}

/// The state after a stage is that of the differential equation, from rest to rates that forget within the stage, at both ends
/// of a series.
#[test]
fn the_state_is_the_solution_at_a_constant_rate() {
    let mut worst = 0.0_f64;
    for evolution in [AGING, SLIP] {
        let chosen = law(0.03, evolution);
        assert!(chosen.has_memory() && chosen.needs_pressure());
        assert_eq!(chosen.initial_state(chosen.start(), 0), Some(D_C / V0));
        for state in [0.01, 1.0, 300.0] {
            for length in [1e-3, 0.1] {
                for rate in [0.0, 1e-160, 1e-30, 1e-7, 1e-4, 0.01, 0.049, 0.051, 0.3, 2.0] {
                    let path = MemoryPath {
                        state,
                        length,
                        rate_base: 0.0,
                        rate_share: 1.0,
                    };
                    let found = chosen.advance(chosen.start(), 0, path, rate);
                    let steps = 20_000;
                    let h = length / f64::from(steps);
                    let f = |_: f64, y: f64| ln_state_rate(evolution, y, rate);
                    let end = (0..steps).fold(f64::ln(state), |y, _| runge_kutta(y, 0.0, h, f));
                    let error = (found.ln() - end).abs();
                    assert!(
                        error < 1e-10,
                        "{evolution} {state} {length} {rate:e}: {error:e}"
                    );
                    worst = worst.max(error);
                    // half a stage twice
                    let half = MemoryPath {
                        length: 0.5 * length,
                        ..path
                    };
                    let middle = chosen.advance(chosen.start(), 0, half, rate);
                    let half = MemoryPath {
                        state: middle,
                        ..half
                    };
                    let twice = chosen.advance(chosen.start(), 0, half, rate);
                    assert!((twice / found - 1.0).abs() < 1e-13);
                }
            }
        }
    }
    println!("largest error of ln theta {worst:e}");
    assert!(worst > 0.0);
}

/// Where the law weakens at steady slip (a < b), a stage resists more the faster it slips up to a rate, and less beyond it.
#[test]
fn steady_slip_is_followed_up_to_a_rate() {
    for evolution in [AGING, SLIP] {
        for length in [0.01, 0.3] {
            for (b, is_averaged) in [(0.03, false), (0.05, false), (0.05, true)] {
                let chosen = law(b, evolution);
                let share = if is_averaged { 0.5 } else { 1.0 };
                let limit = chosen.steady_limit(length, share);
                let expected = -f64::ln(1.0 - A / (b * share)) * D_C / length;
                assert!((limit / expected - 1.0).abs() < 1e-12);
                let slope = |rate: f64| {
                    let (states, rates) = ([D_C / rate], [rate]);
                    let memory = Memory {
                        states: &states,
                        rates: &rates,
                        length,
                        is_averaged,
                    };
                    let bounds = chosen.pressed(chosen.start(), &[1.0], 0.0);
                    let still = SlipPath {
                        base: 0.0,
                        per_rate: 0.0,
                    };
                    let bound = bounds.remembering(memory).evaluate(0, rate, 1.0, still);
                    bound.by_rate
                };
                assert!(slope(0.999 * limit) > 0.0 && slope(1.001 * limit) < 0.0);
            }
        }
    }
    // averaged with the rate before, half of the weakening is left
    assert_eq!(law(0.03, AGING).steady_limit(0.1, 0.5), f64::INFINITY);
    assert_eq!(law(0.01, SLIP).steady_limit(0.1, 1.0), f64::INFINITY);
}

/// The coefficient is the textbook's, also where the argument of its asinh would overflow, and its derivative never NaN.
#[test]
fn the_coefficient_is_the_regularised_logarithm() {
    let value = |a: f64, rate: f64, state: f64| {
        let role = Role::Coulomb { tension: false };
        let kind = Law::find(role, "rate_and_state").unwrap();
        let mut given: Vec<Given> = [MU0, a, 0.03, V0, D_C].map(Given::Number).to_vec();
        given.extend([Given::Choice(AGING), Given::Absent]);
        given.extend([Given::Number(0.0), Given::Absent]);
        let chosen = ChosenLaw::new(kind, &given, None).unwrap();
        let states = [state];
        let memory = Memory {
            states: &states,
            rates: &[],
            length: 0.0,
            is_averaged: false,
        };
        let still = SlipPath {
            base: 0.0,
            per_rate: 0.0,
        };
        let bounds = chosen
            .pressed(chosen.start(), &[1.0], 0.0)
            .remembering(memory);
        bounds.evaluate(0, rate, 1.0, still)
    };
    for state in [0.01, 1.0, 1e5] {
        for rate in [0.0, 1e-300, 1e-12, 1e-5, 1e-3, 0.1, 10.0] {
            let found = value(A, rate, state);
            let u = rate / (2.0 * V0) * ((MU0 + 0.03 * (V0 * state / D_C).ln()) / A).exp();
            let right = A * u.asinh();
            assert!(
                (found.bound - right).abs() <= 1e-14 * right,
                "{rate:e} {state:e}"
            );
            assert!(found.by_rate > 0.0 && found.by_rate.is_finite());
        }
        // mu0 / a = 40000: the logarithm itself
        for rate in [1e-12, 1e-3, 10.0] {
            let found = value(1e-5, rate, state);
            let right = MU0 + 0.03 * (V0 * state / D_C).ln() + 1e-5 * f64::ln(rate / V0);
            assert!((found.bound - right).abs() <= 1e-14, "{rate:e} {state:e}");
            assert!((found.by_rate * rate / 1e-5 - 1.0).abs() < 1e-12);
        }
        let at_rest = value(1e-5, 0.0, state);
        assert!(at_rest.bound == 0.0 && at_rest.by_rate.is_finite());
    }
    // steady slip with the reference rate
    assert!((value(A, V0, D_C / V0).bound - MU0).abs() < 1e-6);
}

/// Drive, spring and viscosity of a block under unit pressure: `eta r + mu(r) = K (t V(t) - x)`.
const K: f64 = 2.0;
const ETA: f64 = 0.05;

fn pulled(t: f64) -> f64 {
    0.02 * t + 0.004 * (3.0 * t).sin()
}

fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-80.0_f64, 2.0_f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle.exp()) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    (0.5 * (low + high)).exp()
}

/// Slip after two seconds of a block, by steps of backward Euler or the trapezoid.
fn slider(chosen: &ChosenLaw, steps: u32, is_averaged: bool) -> f64 {
    let k = 2.0 / f64::from(steps);
    let (mut x, mut state, mut rate) = (-0.2, 5.0, 0.0);
    let solve = |known: f64, theta_k: f64, memory: Memory| {
        let bounds = chosen
            .pressed(chosen.start(), &[1.0], theta_k)
            .remembering(memory);
        let slip = SlipPath {
            base: 0.0,
            per_rate: theta_k,
        };
        root(|r| ETA * r + bounds.evaluate(0, r, 1.0, slip).bound - K * (known - theta_k * r))
    };
    for step in 0..=steps {
        // the step with number 0 makes the start consistent
        let length = if step == 0 { 0.0 } else { k };
        let theta_k = if is_averaged { 0.5 * length } else { length };
        let base = x + (length - theta_k) * rate;
        let (states, rates) = ([state], [rate]);
        let memory = Memory {
            states: &states,
            rates: &rates,
            length,
            is_averaged,
        };
        let r = solve(pulled(k * f64::from(step)) - base, theta_k, memory);
        state = chosen.advance(chosen.start(), 0, memory.path(0), r);
        x = base + theta_k * r;
        rate = r;
    }
    x
}

/// Second order of the trapezoid and first of backward Euler, towards the same trajectory.
#[test]
fn a_block_on_a_spring_converges_with_the_order_of_the_scheme() {
    for evolution in [AGING, SLIP] {
        let chosen = law(0.03, evolution);
        let fine = slider(&chosen, 12_800, true);
        let error = |steps, is_averaged| (slider(&chosen, steps, is_averaged) - fine).abs();
        let order = |is_averaged| {
            let (coarse, finer) = (error(200, is_averaged), error(400, is_averaged));
            println!("{evolution} {is_averaged}: {coarse:e} {finer:e}");
            (coarse / finer).log2()
        };
        let (second, first) = (order(true), order(false));
        assert!(second > 1.8 && second < 2.3, "{evolution}: {second}");
        assert!(first > 0.8 && first < 1.3, "{evolution}: {first}");
        assert!(fine > -0.19, "{fine}");
    }
}
