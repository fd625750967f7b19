//! A foundation that remembers penetration: as an instance of the class, and where the body leaves it.

use crate::common::{relative, scene, value};
use nalgebra::DVector;
use serde_json::{Value, json};
use stickslip::qvi::{
    Evolution, HistoryOperator, Inequality, Kernel, LinearPhi, Matrix, Quadrature, Settings,
    Solver, Space,
};
use stickslip::simulator::drive::Drive;
use stickslip::{Scene, Simulator, compile};

const YOUNG: f64 = 2.0;
const VISCOSITY: f64 = 0.3;
const HEIGHT: f64 = 0.5;
const STIFFNESS: f64 = 5.0;
/// Weights, Pa/m, and times, s.
const TERMS: [(f64, f64); 2] = [(10.0, 0.3), (4.0, 0.05)];

/// A column without lateral effects (poisson 0, mu1 0) above a foundation that gives way, rises and falls.
fn column(scheme: &str, k: f64, exponent: f64, gap: f64, rise: Value) -> Value {
    let kernel = TERMS.map(|(weight, tau)| json!({"weight": weight, "tau": tau}));
    json!({"schema_version": 1, "name": "column",
        "mesh": {"kind": "rectangle", "size": [0.3, HEIGHT], "cells": [3, 5]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.0, "mu2": VISCOSITY},
                     "elasticity": {"law": "isotropic", "young": YOUNG, "poisson": 0.0, "convention": "plane_strain"}},
        "clamped": ["top"],
        "contact": {"part": "bottom", "friction": {"law": "frictionless"},
                    "condition": {"kind": "compliance", "stiffness": STIFFNESS, "exponent": exponent, "gap": gap,
                                  "memory": {"kernel": kernel}},
                    "foundation": [{"kind": "approach", "name": "rise"}]},
        "time": {"scheme": scheme, "step": k, "force": true},
        "fidelity": {"model": "condensed", "friction_tolerance": 1e-12},
        "run": {"until": 2.0, "signals": {"rise": rise}}})
}

/// Times, pressures, and displacements of the bottom towards the top.
fn run(text: &Value) -> Vec<[f64; 3]> {
    let scene = scene(text);
    let gap = text["contact"]["condition"]["gap"].as_f64().unwrap();
    let mut simulator = Simulator::new(compile(&scene).unwrap());
    let mut drive = Drive::start(&scene, &mut simulator).unwrap();
    let mut rows = Vec::new();
    while let Some(simulator) = drive.step().unwrap() {
        let rise = value(simulator, "rise");
        rows.push([
            simulator.time(),
            value(simulator, "contact.pressure"),
            value(simulator, "contact.gap") - gap + rise,
        ]);
    }
    rows
}

#[test]
fn a_foundation_that_is_pressed_is_an_instance() {
    // pressed from the beginning, by 0.02
    let (gap, speed, k) = (-0.02, 0.1, 0.03125);
    let text = column(
        "trapezoid",
        k,
        1.0,
        gap,
        json!([[0.0, 0.0], [2.0, 2.0 * speed]]),
    );
    let rows = run(&text);
    let load = move |t: f64| {
        let pressed = STIFFNESS * (speed * t - gap);
        let remembered = TERMS.map(|(weight, tau)| {
            let faded = (-t / tau).exp();
            weight * (speed * tau * (1.0 - faded) - gap * faded)
        });
        DVector::from_element(1, pressed + remembered.iter().sum::<f64>())
    };
    let multiple = |value| Matrix::multiple(1, value);
    let mut problem = Inequality::new(Space::euclidean(1), multiple(VISCOSITY / HEIGHT), load);
    let none = || DVector::zeros(1);
    problem.histories = vec![HistoryOperator::new(Kernel::constant(1.0), none())];
    let mut phi = vec![Some(multiple(YOUNG / HEIGHT + STIFFNESS))];
    for (weight, tau) in TERMS {
        problem.histories.push(HistoryOperator {
            rule: Some(Quadrature::Mean),
            ..HistoryOperator::new(Kernel::exponential(tau), none())
        });
        phi.push(Some(multiple(weight)));
    }
    problem.phi = Box::new(LinearPhi(phi));
    let settings = Settings::new(Solver::Direct);
    let mut evolution = Evolution::new(&problem, &Quadrature::Trapezoid, k, settings).unwrap();
    evolution.advance().unwrap();
    let displacements = rows.iter().map(|_| {
        evolution.advance().unwrap();
        evolution.histories()[0][0]
    });
    let of_class: Vec<f64> = displacements.collect();
    let of_component: Vec<f64> = rows.iter().map(|row| row[2]).collect();
    assert_eq!(of_class.len(), 64);
    assert!(relative(&of_component, &of_class) < 1e-10);
    // and it relaxes: what the branches bear falls behind the depth
    let [time, pressure, moved] = rows[63];
    let depth = speed * time - gap - moved;
    let all: f64 = TERMS.iter().map(|(weight, _)| weight * depth).sum();
    assert!(pressure < STIFFNESS * depth + 0.5 * all && pressure > STIFFNESS * depth);
}

/// Heights of the foundation over time: pressed, held, taken away faster than it recovers, pressed again.
const RISE: [[f64; 2]; 5] = [[0.0, 0.0], [0.4, 0.1], [0.9, 0.1], [1.0, 0.03], [2.0, 0.12]];

fn rise(t: f64) -> [f64; 2] {
    let piece = RISE
        .windows(2)
        .find(|pair| t < pair[1][0])
        .unwrap_or(&RISE[3..5]);
    let slope = (piece[1][1] - piece[0][1]) / (piece[1][0] - piece[0][0]);
    [piece[0][1] + slope * (t - piece[0][0]), slope]
}

/// The column by small steps of its own equations (the midpoint rule): pressure and displacement at multiples of `every`.
fn by_small_steps(exponent: f64, gap: f64, every: f64) -> Vec<[f64; 2]> {
    let per = 4000;
    let dt = every / f64::from(per);
    // displacement, deformation of the foundation, its branches
    let mut x = [0.0; 4];
    let mut is_pressed = true;
    let pressure = |x: &[f64; 4]| {
        STIFFNESS * x[1].max(0.0).powf(exponent) + TERMS[0].0 * x[2] + TERMS[1].0 * x[3]
    };
    let rates = |t: f64, x: &[f64; 4], is_pressed: bool| {
        let force = if is_pressed {
            pressure(x).max(0.0)
        } else {
            0.0
        };
        let moved = (force * HEIGHT - YOUNG * x[0]) / VISCOSITY;
        let relaxed = TERMS[0].0 * x[2] / TERMS[0].1 + TERMS[1].0 * x[3] / TERMS[1].1;
        let slope = exponent * STIFFNESS * x[1].max(0.0).powf(exponent - 1.0);
        let deformed = match is_pressed {
            true => rise(t)[1] - moved,
            false => relaxed / (slope + TERMS[0].0 + TERMS[1].0),
        };
        [
            moved,
            deformed,
            deformed - x[2] / TERMS[0].1,
            deformed - x[3] / TERMS[1].1,
        ]
    };
    let mut rows = Vec::new();
    for n in 0..(2.0 / dt).round() as u32 {
        let t = f64::from(n) * dt;
        let depth = rise(t)[0] - gap - x[0];
        if is_pressed && (depth < 0.0 || pressure(&x) < 0.0) {
            is_pressed = false;
            x[1] = x[1].max(0.0);
        } else if !is_pressed && depth >= x[1] {
            is_pressed = true;
        }
        let at = |x: &[f64; 4], by: f64, rates: [f64; 4]| -> [f64; 4] {
            std::array::from_fn(|i| x[i] + by * rates[i])
        };
        let middle = at(&x, 0.5 * dt, rates(t, &x, is_pressed));
        x = at(&x, dt, rates(t + 0.5 * dt, &middle, is_pressed));
        if (n + 1) % per == 0 {
            let force = if is_pressed {
                pressure(&x).max(0.0)
            } else {
                0.0
            };
            rows.push([force, x[0]]);
        }
    }
    rows
}

#[test]
fn a_foundation_that_is_left_recovers_without_pulling() {
    let signal = json!(RISE);
    for exponent in [1.0, 1.5] {
        let gap = 0.01;
        let every = 1.0 / 64.0;
        let reference = by_small_steps(exponent, gap, every);
        let largest = reference
            .iter()
            .fold(0.0_f64, |largest, row| largest.max(row[0]));
        let error = |scheme: &str, per: usize| {
            let rows = run(&column(
                scheme,
                every / per as f64,
                exponent,
                gap,
                signal.clone(),
            ));
            let at = rows.iter().skip(per - 1).step_by(per);
            assert_eq!(at.clone().count(), reference.len());
            let errors = at.zip(&reference).map(|(row, exact)| {
                assert!(row[1] >= 0.0);
                let moved = (row[2] - exact[1]).abs() * YOUNG / HEIGHT;
                (row[1] - exact[0]).abs().max(moved) / largest
            });
            errors.fold(0.0, f64::max)
        };
        // with a phase in which nothing presses, that ends
        let off: Vec<bool> = reference.iter().map(|row| row[0] == 0.0).collect();
        assert!(
            off.windows(2).filter(|pair| pair[0] && !pair[1]).count() >= 2,
            "{off:?}"
        );
        for (scheme, most, ratio) in [
            ("tr_bdf2", 4e-3, 2.5),
            ("midpoint", 4e-3, 2.0),
            ("backward_euler", 5e-2, 1.7),
        ] {
            let errors = [error(scheme, 2), error(scheme, 4), error(scheme, 8)];
            assert!(errors[0] < most, "{scheme} {exponent}: {errors:?}");
            assert!(
                errors[0] > ratio * ratio * errors[2],
                "{scheme} {exponent}: {errors:?}"
            );
        }
    }
}

#[test]
fn a_memory_of_penetration_is_written_as_it_is_read() {
    let text = column("tr_bdf2", 0.01, 1.5, 0.0, json!([[0.0, 0.0], [1.0, 0.1]]));
    let scene = scene(&text);
    let written = serde_json::to_value(&scene).unwrap();
    assert_eq!(
        written["contact"]["condition"],
        text["contact"]["condition"]
    );
    for (wrong, place) in [
        (json!({"kernel": []}), "kernel"),
        (
            json!({"kernel": [{"weight": -1.0, "tau": 1.0}]}),
            "kernel[0].weight",
        ),
        (
            json!({"kernel": [{"weight": 1.0, "tau": 0.0}]}),
            "kernel[0].tau",
        ),
        (json!({"kernel": [{"weight": 1.0}]}), "kernel[0]"),
    ] {
        let mut text = text.clone();
        text["contact"]["condition"]["memory"] = wrong;
        let error = Scene::from_json(&text.to_string(), "scene")
            .unwrap_err()
            .to_string();
        assert!(error.contains(place), "{error}");
    }
}
