//! Laws and fields that a scene writes out as formulas.

use crate::STILL;
use crate::common::random::Random;
use crate::common::{largest, paper, started, value, values};
use serde_json::json;
use stickslip::contact::SlipPath;
use stickslip::contact::law::{ChosenLaw, Given, Law, Role};
use stickslip::contact::pressed::PressedBounds;
use stickslip::{Error, compile};

fn law(role: Role, formula: &str, points: &[[f64; 3]]) -> ChosenLaw {
    let kind = Law::find(role, "expression").unwrap();
    let mut given = vec![Given::Formula(formula.to_owned())];
    if role != Role::Bound {
        given.extend([Given::Number(0.0), Given::Absent]);
    }
    ChosenLaw::new(kind, &given, Some(points)).unwrap()
}

/// A formula is the law that it writes out: values, derivatives, and the steepest fall as samples know it.
#[test]
fn a_formula_is_the_law_that_it_writes_out() {
    let role = Role::Coulomb { tension: false };
    let number = Given::Number;
    let pairs = [
        (
            "0.25 + (0.4 - 0.25) * exp(-3 * r)",
            "exponential",
            vec![number(0.4), number(0.25), number(3.0)],
        ),
        (
            "0.3 + 0.05 * exp(-(r / 0.1)^2) + 0.2 * r",
            "stribeck",
            [0.35, 0.3, 0.1, 2.0, 0.2].map(number).to_vec(),
        ),
        (
            "0.5 - 0.3 * min(s / 0.05, 1)",
            "slip_weakening",
            [0.5, 0.2, 0.05].map(number).to_vec(),
        ),
    ];
    let weights = [0.3];
    for (formula, name, mut given) in pairs {
        given.extend([number(0.0), Given::Absent]);
        let named = ChosenLaw::new(Law::find(role, name).unwrap(), &given, None).unwrap();
        let written = law(role, formula, &[[0.0; 3]]);
        assert!(written.needs_pressure() && !written.has_memory());
        assert!(written.start().is_empty() || written.start() == [0.0]);
        let per_rate = 0.02;
        let named = named.pressed(named.start(), &weights, per_rate);
        let written = written.pressed(written.start(), &weights, per_rate);
        let mut random = Random::new(31);
        for _ in 0..200 {
            let rate = 10.0_f64.powf(random.between(-6.0, 1.0));
            let force = random.between(-0.1, 1.0);
            let slip = SlipPath {
                base: random.between(0.0, 0.1),
                per_rate,
            };
            let (one, other) = (
                named.evaluate(0, rate, force, slip),
                written.evaluate(0, rate, force, slip),
            );
            for (a, b) in [
                (one.bound, other.bound),
                (one.by_rate, other.by_rate),
                (one.by_force, other.by_force),
            ] {
                assert!(
                    (a - b).abs() <= 1e-13 * (1.0 + a.abs()),
                    "{formula}: {one:?} {other:?}"
                );
            }
        }
        let (sharp, sampled) = (named.weakening(0, 2.0), written.weakening(0, 2.0));
        assert!(
            sharp > 0.0 && (sampled / sharp - 1.0).abs() < 2e-3,
            "{sampled} {sharp}"
        );
    }
}

/// Place and pressure count in both roles.
#[test]
fn formulas_know_place_and_pressure() {
    let points = [[0.1, 0.2, 0.3], [1.0, 2.0, 3.0]];
    let weights = [0.5, 2.0];
    let formula = "x + 10*y + 100*z + p / 7";
    for (role, times) in [
        (Role::Bound, [false, false]),
        (Role::Coulomb { tension: false }, [true, false]),
        (Role::Coulomb { tension: true }, [true, true]),
    ] {
        let chosen = law(role, formula, &points);
        let bounds = chosen.pressed(chosen.start(), &weights, 0.0);
        for (node, [x, y, z]) in points.into_iter().enumerate() {
            for force in [-1.5, 0.0, 3.0] {
                let [has_pressure, has_tension] = times;
                let pressing = if has_tension {
                    f64::abs(force)
                } else {
                    force.max(0.0)
                };
                let value = x + 10.0 * y + 100.0 * z + pressing / weights[node] / 7.0;
                let right = value
                    * if has_pressure {
                        pressing
                    } else {
                        weights[node]
                    };
                let found = bounds.evaluate(node, 0.2, force, STILL).bound;
                assert!(
                    (found - right).abs() <= 1e-14 * right,
                    "{role:?} {node} {force}"
                );
            }
        }
    }
}

/// How fast a law weakens is that of its worst node; before the nodes are known nothing is said of them, and nothing panics.
#[test]
fn the_steepest_fall_is_that_of_the_worst_node() {
    let points = [[0.1, 0.0, 0.0], [0.4, 0.0, 0.0], [0.2, 0.0, 0.0]];
    let chosen = law(Role::Bound, "0.5 + x * exp(-r)", &points);
    assert!((chosen.bounds().weakening(0.0) - 0.4).abs() < 1e-15);
    let kind = Law::find(Role::Bound, "expression").unwrap();
    let given = [Given::Formula("0.5 + x * exp(-r)".to_owned())];
    let unknown = ChosenLaw::new(kind, &given, None).unwrap();
    let bounds = unknown.pressed(unknown.start(), &[1.0, 1.0], 0.0);
    assert!(bounds.evaluate(1, 0.1, 1.0, STILL).bound.is_nan());
    let kind = Law::find(Role::Bound, "rate_and_state").unwrap();
    let mut given: Vec<Given> = [0.4, 0.02, 0.03, 1e-3, 0.01].map(Given::Number).to_vec();
    given[4] = Given::Expression("0.01 * x".to_owned());
    given.extend([Given::Choice(0), Given::Absent]);
    let unknown = ChosenLaw::new(kind, &given, None).unwrap();
    assert!(unknown.has_memory());
    assert!(unknown.initial_state(unknown.start(), 2).unwrap().is_nan());
}

/// A value below zero that only a step can meet is cut at zero on the way, and told; one that is no number is none.
#[test]
fn a_negative_value_is_cut_and_told() {
    let still = |base| SlipPath {
        base,
        per_rate: 0.0,
    };
    let chosen = law(Role::Bound, "0.5 - s", &[[0.0; 3]]);
    let bounds = chosen.pressed(chosen.start(), &[1.0], 0.0);
    assert!(chosen.has_formula());
    assert_eq!(bounds.evaluate(0, 0.1, 1.0, still(0.25)).bound, 0.25);
    assert_eq!(bounds.fault(0, 0.1, 1.0, still(0.25)), None);
    let found = bounds.evaluate(0, 0.1, 1.0, still(0.75));
    assert_eq!(
        (found.bound, found.by_rate, found.by_force),
        (0.0, 0.0, 0.0)
    );
    assert_eq!(bounds.fault(0, 0.1, 1.0, still(0.75)), Some(-0.25));
    let chosen = law(Role::Bound, "0.5 + 0 * ln(1 - s)", &[[0.0; 3]]);
    let bounds = chosen.pressed(chosen.start(), &[1.0], 0.0);
    let found = bounds.evaluate(0, 0.1, 1.0, still(2.0));
    assert!(found.bound.is_nan() && found.by_rate.is_nan() && found.by_force.is_nan());
    assert!(bounds.fault(0, 0.1, 1.0, still(2.0)).unwrap().is_nan());
}

/// Coefficients as formulas of the place are those at the contact nodes: the same steps as with the numbers themselves.
#[test]
fn expressions_of_the_place_are_evaluated_at_the_contact_nodes() {
    let written = json!({"law": "exponential", "a": {"expression": "0.002 + 0.002 * x"}, "b": {"expression": "1e-3"}, "alpha": 100.0});
    let scene = paper(8, &[("contact.friction", &written.to_string())]);
    let model = compile(&scene).unwrap();
    let x: Vec<f64> = model
        .contact()
        .points
        .iter()
        .map(|point| point[0])
        .collect();
    let numbers: Vec<f64> = x.iter().map(|x| 0.002 + 0.002 * x).collect();
    assert_eq!(x.len(), 8);
    let nodal = json!({"law": "exponential", "a": {"nodes": numbers}, "b": {"nodes": vec![1e-3; 8]}, "alpha": 100.0});
    let nodal = compile(&paper(8, &[("contact.friction", &nodal.to_string())])).unwrap();
    let mut simulators = [model, nodal].map(started);
    for _ in 0..8 {
        let all = simulators.each_mut().map(|simulator| {
            simulator.do_step(simulator.time(), 1.0 / 16.0).unwrap();
            (
                values(simulator, "contact.slip_rate"),
                values(simulator, "contact.tangential_stress"),
                values(simulator, "contact.friction.a"),
            )
        });
        assert_eq!(all[0], all[1]);
        assert_eq!(all[0].2, numbers);
    }
    assert!(value(&simulators[0], "contact.max_slip_rate") > 0.0);
}

/// What an expression gives at a node is checked like a number, when the nodes are known.
#[test]
fn expressions_with_wrong_values_are_refused_with_the_node() {
    let refused = |a: &str, b: &str| {
        let written = json!({"law": "exponential", "a": {"expression": a}, "b": {"expression": b}, "alpha": 1.0});
        let scene = paper(8, &[("contact.friction", &written.to_string())]);
        match compile(&scene).err().unwrap() {
            Error::Scene {
                path,
                found,
                allowed,
                ..
            } => (path, found, allowed),
            other => panic!("{other}"),
        }
    };
    let (path, found, allowed) = refused("1 - 1.5 * x", "0");
    assert_eq!(path, "contact.friction.a.expression");
    assert!(
        found.contains("at contact node") && found.starts_with('-') && allowed.contains(">= 0"),
        "{found} {allowed}"
    );
    let (path, found, _) = refused("1 / (x - x)", "0");
    assert!(
        path == "contact.friction.a.expression" && found.contains("inf at contact node 0"),
        "{found}"
    );
    let (path, found, allowed) = refused("0.5 + x", "1");
    assert_eq!(path, "contact.friction.a.expression");
    assert!(
        found.parse::<f64>().unwrap() < 1.0 && allowed.contains("at least b = 1"),
        "{found} {allowed}"
    );
}

/// A bound in Pa that is written out is the law itself in a whole scene, with the solver that its formula needs.
#[test]
fn a_scene_with_a_formula_moves_as_with_the_law() {
    let law = json!({"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 20.0});
    let written = json!({"law": "bound", "bound": {"kind": "expression", "formula": "0.001 + 0.002 * exp(-20 * r)"}});
    for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
        let mut simulators = [&law, &written].map(|friction| {
            let overrides = [
                ("contact.friction", friction.to_string()),
                ("time.scheme", scheme.to_owned()),
            ];
            let overrides = overrides
                .each_ref()
                .map(|(path, value)| (*path, value.as_str()));
            started(compile(&paper(8, &overrides)).unwrap())
        });
        for _ in 0..16 {
            let all = simulators.each_mut().map(|simulator| {
                simulator.do_step(simulator.time(), 1.0 / 32.0).unwrap();
                values(simulator, "contact.slip_rate")
            });
            let scale = largest(&all[0]);
            assert!(scale > 0.0);
            for (one, other) in all[0].iter().zip(&all[1]) {
                assert!(
                    (one - other).abs() <= 1e-7 * scale,
                    "{scheme}: {one:e} {other:e}"
                );
            }
        }
    }
}

/// A step that meets a negative value fails, says so, and leaves the state as it was.
#[test]
fn a_step_that_meets_a_negative_value_changes_nothing() {
    let written =
        json!({"law": "bound", "bound": {"kind": "expression", "formula": "0.002 - 0.2 * s"}});
    let scene = paper(8, &[("contact.friction", &written.to_string())]);
    let mut simulator = started(compile(&scene).unwrap());
    let mut steps = 0;
    let (before, error) = loop {
        let before = simulator.state().clone();
        match simulator.do_step(simulator.time(), 1.0 / 256.0) {
            Ok(()) => steps += 1,
            Err(error) => break (before, error),
        }
        assert!(
            steps < 200,
            "slip {:?}",
            values(&simulator, "contact.accumulated_slip")
        );
    };
    println!("after {steps} steps: {error}");
    let text = error.to_string();
    let is_named = text.contains("contact.friction.bound.formula at contact node");
    assert!(
        matches!(error, Error::Value { found, .. } if found < 0.0) && is_named,
        "{text}"
    );
    assert!(steps > 0);
    assert!(*simulator.state() == before);
    let slips = values(&simulator, "contact.accumulated_slip");
    assert!(
        largest(&slips) <= 0.01 && largest(&slips) > 1e-5,
        "{slips:?}"
    );
}
