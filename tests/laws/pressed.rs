//! Bounds as nodal forces under normal forces: Coulomb's law from the coefficient of any kind, and the bounds in Pa.

use crate::common::paper;
use crate::common::random::Random;
use crate::draw;
use stickslip::contact::SlipPath;
use stickslip::contact::bounds::Bounds;
use stickslip::contact::law::{ChosenLaw, Given, Law, Memory, Role};
use stickslip::contact::pressed::PressedBounds;
use stickslip::{Error, Scene};

const NODES: usize = 5;
/// Growth of the accumulated slip by the slip rate, s.
const PER_RATE: f64 = 0.1;

fn coulomb_laws() -> impl Iterator<Item = Law> {
    [false, true].into_iter().flat_map(|tension| {
        let role = Role::Coulomb { tension };
        let kinds = Law::all().into_iter();
        let kinds = kinds.filter(|law| law.role() == Role::Bound);
        let named = kinds.filter_map(move |law| Law::find(role, law.name()));
        named.chain([Law::constant(role)])
    })
}

/// `omega min(cap, cohesion + mu P)` with mu from the law itself, at pressures, tensions and none.
#[test]
fn coulombs_bound_is_made_of_coefficient_pressure_cohesion_and_cap() {
    let mut random = Random::new(17);
    let (mut capped, mut cohesive, mut pulled) = (0, 0, 0);
    for law in coulomb_laws().filter(|law| law.kind().has_potential()) {
        let own = law.kind().coefficients().len();
        let Role::Coulomb { tension } = law.role() else {
            panic!("{law:?}")
        };
        for case in 0..60 {
            let chosen = draw(law, &mut random, (case % 2 == 0).then_some(NODES));
            assert!(chosen.needs_pressure());
            let weights: Vec<f64> = (0..NODES).map(|_| random.between(0.01, 2.0)).collect();
            let (mu, bounds) = (
                chosen.bounds(),
                chosen.pressed(chosen.start(), &weights, PER_RATE),
            );
            for (node, weight) in weights.iter().copied().enumerate() {
                let slip = SlipPath {
                    base: random.between(0.0, 1.0),
                    per_rate: PER_RATE,
                };
                let of = |place: usize| {
                    let place = chosen.places()[place];
                    let values = &chosen.start()[place.range()];
                    let at = if values.len() > 1 { node } else { 0 };
                    values.get(at).copied()
                };
                let cohesion = of(own).unwrap();
                let cap = of(own + 1).unwrap_or(f64::INFINITY);
                let rate = 10.0_f64.powf(random.between(-3.0, 0.5));
                for pressure in [0.0, -0.3, 0.01, 0.5, -2.0, random.between(-1.0, 3.0)] {
                    let force = pressure * weight;
                    let found = bounds.evaluate(node, rate, force, slip);
                    let pressing = if tension {
                        pressure.abs()
                    } else {
                        pressure.max(0.0)
                    };
                    let one = mu.evaluate(node, rate, slip);
                    let free = cohesion + one.bound * pressing;
                    let expected = weight * free.min(cap);
                    let label = format!("{law:?} {case} {pressure:e}: {:?}", chosen.start());
                    assert!(
                        (found.bound - expected).abs() <= 2e-15 * expected,
                        "{label}: {} {expected}",
                        found.bound
                    );
                    if free > cap {
                        assert_eq!((found.by_rate, found.by_force), (0.0, 0.0), "{label}");
                        capped += 1;
                    }
                    cohesive += usize::from(pressure < 0.0 && !tension && found.bound > 0.0);
                    pulled += usize::from(pressure < 0.0 && tension && found.by_force < 0.0);
                    let fall = bounds.weakening(node, force);
                    assert!(-found.by_rate <= fall * (1.0 + 1e-12), "{label}");
                    assert!(fall <= weight * pressing * mu.weakening(PER_RATE) * (1.0 + 1e-12));
                }
            }
        }
    }
    assert!(
        capped > 100 && cohesive > 100 && pulled > 100,
        "{capped} {cohesive} {pulled}"
    );
}

/// Derivatives by rate and force are those of the bound, wherever it has some.
#[test]
fn derivatives_of_pressed_bounds_are_differences() {
    let mut random = Random::new(23);
    let in_pascal = Law::all().into_iter();
    let in_pascal = in_pascal.filter(|law| !matches!(law.role(), Role::Coulomb { .. }));
    for law in coulomb_laws().chain(in_pascal) {
        let (mut rates, mut forces) = (0, 0);
        for case in 0..200 {
            let chosen = draw(law, &mut random, None);
            let weights = [random.between(0.01, 2.0)];
            let (states, before) = ([random.between(0.01, 10.0)], [random.between(0.0, 0.1)]);
            let memory = Memory {
                states: &states,
                rates: &before,
                length: if random.happens(0.2) { 0.0 } else { PER_RATE },
                is_averaged: random.happens(0.5),
            };
            let bounds = chosen
                .pressed(chosen.start(), &weights, PER_RATE)
                .remembering(memory);
            let slip = SlipPath {
                base: random.between(0.0, 0.3),
                per_rate: PER_RATE,
            };
            let rate = 10.0_f64.powf(random.between(-2.5, 0.3));
            let force = random.between(-1.0, 2.0);
            let at = |rate: f64, force: f64| bounds.evaluate(0, rate, force, slip);
            let label = format!("{law:?} {case}: {:?}", chosen.start());
            let here = at(rate, force);
            let fall = bounds.weakening(0, force);
            assert!(
                -here.by_rate <= fall * (1.0 + 1e-9),
                "{label}: {fall:e} {here:?}"
            );
            // the two sides agree where no kink is near
            let is_smooth = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-4 * (a.abs() + size);
            let d = 1e-5 * rate;
            let (low, high) = (at(rate - d, force), at(rate + d, force));
            let size = here.bound / rate;
            if is_smooth(low.by_rate, high.by_rate, size) {
                let difference = (high.bound - low.bound) / (2.0 * d);
                assert!(
                    (here.by_rate - difference).abs() <= 1e-8 * size + 1e-6 * here.by_rate.abs(),
                    "{label}: by rate {:e} {difference:e}",
                    here.by_rate
                );
                rates += usize::from(here.by_rate != 0.0);
            }
            let d = 1e-6;
            let (low, high) = (at(rate, force - d), at(rate, force + d));
            if is_smooth(low.by_force, high.by_force, 0.0) {
                let difference = (high.bound - low.bound) / (2.0 * d);
                assert!(
                    (here.by_force - difference).abs() <= 1e-8 * (1.0 + here.bound),
                    "{label}: by force {:e} {difference:e}",
                    here.by_force
                );
                forces += usize::from(here.by_force != 0.0);
            }
        }
        let has_pressure = matches!(law.role(), Role::Coulomb { .. }) || law.name() == "expression";
        let has_slope = !["tresca", "frictionless"].contains(&law.name());
        assert_eq!(rates > 20, has_slope, "{law:?}: {rates}");
        assert_eq!(forces > 50, has_pressure, "{law:?}: {forces}");
    }
}

/// A bound in Pa is the same number times the weight, whatever presses.
#[test]
fn bounds_in_pascal_do_not_feel_the_pressure() {
    let mut random = Random::new(29);
    for law in crate::laws_in_pascal() {
        let chosen = draw(law, &mut random, Some(NODES));
        assert!(!chosen.needs_pressure());
        let weights = [0.1, 0.2, 0.3, 0.4, 0.5];
        let (plain, bounds) = (
            chosen.bounds(),
            chosen.pressed(chosen.start(), &weights, PER_RATE),
        );
        for (node, weight) in weights.into_iter().enumerate() {
            let slip = SlipPath {
                base: 0.1,
                per_rate: PER_RATE,
            };
            for (rate, force) in [(0.0, -1.0), (0.02, 0.0), (0.7, 3.0)] {
                let found = bounds.evaluate(node, rate, force, slip);
                let one = plain.evaluate(node, rate, slip);
                assert_eq!(found.bound, weight * one.bound, "{law:?}");
                assert_eq!(found.by_rate, weight * one.slope, "{law:?}");
                assert_eq!(found.by_force, 0.0);
                assert!(bounds.weakening(node, force) <= weight * plain.weakening(PER_RATE));
            }
        }
    }
}

fn friction(text: &str) -> Result<Scene, Error> {
    let overrides = [("contact.friction".to_owned(), text.to_owned())];
    let text = paper(8, &[]).to_json();
    Scene::with_overrides(&text, "test.json", &overrides)
}

/// What is wrong with Coulomb's law is named by its place.
#[test]
#[rustfmt::skip] // one row, one mistake
fn mistakes_are_named_by_their_path() {
    let with = |coefficient: &str| format!(r#"{{"law": "coulomb", "coefficient": {coefficient}}}"#);
    let beside = |more: &str| format!(r#"{{"law": "coulomb", "coefficient": 0.3, {more}}}"#);
    let rows = [
        (r#"{"law": "coulomb"}"#.to_owned(), "contact.friction.coefficient", "nothing", "a number >= 0"),
        (with("-0.1"), "contact.friction.coefficient", "-0.1", ">= 0"),
        (with("true"), "contact.friction.coefficient", "true", "kind"),
        (with("\"x\""), "contact.friction.coefficient", "\"x\"", "kind"),
        (with(r#"{"nodes": [0.1, -0.2]}"#), "contact.friction.coefficient.nodes[1]", "-0.2", ">= 0"),
        (with(r#"{"nodes": []}"#), "contact.friction.coefficient.nodes", "[]", "at least 1"),
        (with(r#"{"nodez": [0.1]}"#), "contact.friction.coefficient", "nodez", "stribeck"),
        (with(r#"{"kind": "rate"}"#), "contact.friction.coefficient.kind", "rate", "stribeck"),
        (with(r#"{"kind": "exponential", "static": 0.3, "kinetic": 0.1}"#), "contact.friction.coefficient.decay", "nothing", "s/m"),
        (with(r#"{"kind": "exponential", "static": 0.3, "kinetic": 0.4, "decay": 1}"#), "contact.friction.coefficient.static", "0.3", "at least kinetic = 0.4"),
        (with(r#"{"kind": "exponential", "static": 0.3, "kinetic": 0.1, "decay": 1, "x": 1}"#), "contact.friction.coefficient.x", "unknown key", "decay"),
        (with(r#"{"kind": "stribeck", "static": 0.3, "kinetic": 0.1, "velocity": 1, "exponent": 0.9}"#), "contact.friction.coefficient.exponent", "0.9", ">= 1"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [0.1]}"#), "contact.friction.coefficient.value", "1 numbers", "as many as rates: 2"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [[0.1], [0.2]]}"#), "contact.friction.coefficient.value", "2 rows", "without slip"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [0.1, 0.2], "slip": [0, 1]}"#), "contact.friction.coefficient.value", "2 numbers", "rows of numbers"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [[0.1, 0.2], [0.1]], "slip": [0, 1]}"#), "contact.friction.coefficient.value[1]", "1 numbers", "first row: 2"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [[0.1], [0.1]], "slip": [0, 1]}"#), "contact.friction.coefficient.value[0]", "1 numbers", "slips: 2"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [[0.1, 0.1]], "slip": [0, 1]}"#), "contact.friction.coefficient.value", "1 rows", "rates: 2"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [[0.1, 0.1], [0.1, -1]], "slip": [0, 1]}"#), "contact.friction.coefficient.value[1][1]", "-1", ">= 0"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [[0.1, 0.1], [0.1, 1]], "slip": [1, 1]}"#), "contact.friction.coefficient.slip[1]", "1", "slips that increase: more than 1"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": [0.1, [0.1]]}"#), "contact.friction.coefficient.value[1]", "[0.1]", "a number"),
        (with(r#"{"kind": "table", "rate": [0, 1], "value": []}"#), "contact.friction.coefficient.value", "[]", "at least 1"),
        (with(r#"{"kind": "slip_weakening", "static": 0.3, "dynamic": 0.1, "distance": 0}"#), "contact.friction.coefficient.distance", "0", "> 0"),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0, "b": 0.03, "rate": 1e-3, "distance": 0.01, "evolution": "aging"}"#), "contact.friction.coefficient.a", "0", "> 0"),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": -0.03, "rate": 1e-3, "distance": 0.01, "evolution": "aging"}"#), "contact.friction.coefficient.b", "-0.03", "> 0"),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.03, "rate": 0, "distance": 0.01, "evolution": "aging"}"#), "contact.friction.coefficient.rate", "0", "> 0"),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.03, "rate": 1e-3, "distance": 0, "evolution": "aging"}"#), "contact.friction.coefficient.distance", "0", "> 0"),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.03, "rate": 1e-3, "distance": 0.01, "evolution": "ageing"}"#), "contact.friction.coefficient.evolution", "ageing", "\"aging\", \"slip\""),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.03, "rate": 1e-3, "distance": 0.01}"#), "contact.friction.coefficient.evolution", "nothing", "aging"),
        (with(r#"{"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.03, "rate": 1e-3, "distance": 0.01, "evolution": "slip", "initial_state": 0}"#), "contact.friction.coefficient.initial_state", "0", "> 0"),
        (with(r#"{"kind": "expression"}"#), "contact.friction.coefficient.formula", "nothing", "a string"),
        (with(r#"{"kind": "expression", "formula": 0.3}"#), "contact.friction.coefficient.formula", "0.3", "a string"),
        (with(r#"{"kind": "expression", "formula": "0.3 + q"}"#), "contact.friction.coefficient.formula", "the unknown name \"q\" at character 7", "r s p x y z"),
        (with(r#"{"kind": "expression", "formula": "0.3 +"}"#), "contact.friction.coefficient.formula", "the end at character 6", "a number"),
        (with(r#"{"kind": "expression", "formula": "0.5 - r"}"#), "contact.friction.coefficient.formula", "the value -0.0", "a value >= 0"),
        (with(r#"{"kind": "expression", "formula": "ln(r)"}"#), "contact.friction.coefficient.formula", "the value -inf for r = 0,", "a value >= 0"),
        (with(r#"{"kind": "expression", "formula": "0.3 + sqrt(r)"}"#), "contact.friction.coefficient.formula", "an infinite slope for r = 0,", "finite slopes"),
        (with(r#"{"kind": "expression", "formula": "0.3 * p^(-1/3)"}"#), "contact.friction.coefficient.formula", "the value inf for r = 0, s = 0, p = 0", "a value >= 0"),
        (with(r#"{"expression": "0.3 + r"}"#), "contact.friction.coefficient.expression", "the unknown name \"r\" at character 7", "x y z"),
        (with(r#"{"expression": ""}"#), "contact.friction.coefficient.expression", "the end at character 1", "a number"),
        (with(r#"{"expression": 1}"#), "contact.friction.coefficient.expression", "1", "a string"),
        (with(r#"{"expression": "x", "nodes": [1]}"#), "contact.friction.coefficient.expression", "unknown key", "nodes"),
        (beside(r#""cohesion": {"expression": "1 +* x"}"#), "contact.friction.cohesion.expression", "\"*\" at character 4", "a number"),
        (beside(r#""cohesion": -1"#), "contact.friction.cohesion", "-1", "Pa"),
        (beside(r#""cap": -1"#), "contact.friction.cap", "-1", "Pa"),
        (beside(r#""cap": null"#), "contact.friction.cap", "null", "a number"),
        (beside(r#""tension": 1"#), "contact.friction.tension", "1", "true or false"),
        (beside(r#""bound": 1"#), "contact.friction.bound", "unknown key", "tension"),
        (r#"{"law": "bound", "bound": 1, "tension": true}"#.to_owned(), "contact.friction.tension", "unknown key", "bound"),
        (r#"{"law": "tresca", "bound": 1, "cap": 2}"#.to_owned(), "contact.friction.cap", "unknown key", "bound"),
    ];
    for (text, path, found, allowed) in rows {
        let error = friction(&text).expect_err(&text);
        let Error::Scene { path: at, found: what, allowed: may, .. } = &error else { panic!("{error}") };
        assert_eq!(at, path, "{text}: {error}");
        assert!(what.contains(found) && may.contains(allowed), "{text}: {error}");
    }
}

/// Coulomb's law reads back equal and is written as the scene has it.
#[test]
fn coulombs_law_reads_back_as_it_was_written() {
    for text in [
        r#"{"law":"coulomb","coefficient":0.3,"cohesion":0.0}"#,
        r#"{"law":"coulomb","coefficient":{"nodes":[0.1,0.2,0.3]},"cohesion":0.0,"cap":2.0}"#,
        r#"{"law":"coulomb","coefficient":{"kind":"stribeck","static":0.4,"kinetic":{"nodes":[0.1,0.2]},"velocity":0.01,"exponent":1.0,"viscous":0.0},"cohesion":{"nodes":[1.0,2.0]},"cap":10.0,"tension":true}"#,
        r#"{"law":"coulomb","coefficient":{"kind":"table","rate":[0.0,1.0],"value":[0.3,0.2],"scale":1.0},"cohesion":0.0,"tension":true}"#,
        r#"{"law":"coulomb","coefficient":{"kind":"table","rate":[0.0,1.0],"value":[[0.3,0.2,0.1],[0.3,0.4,0.5]],"scale":1.0,"slip":[0.0,0.1,0.3]},"cohesion":0.0}"#,
        r#"{"law":"coulomb","coefficient":{"kind":"rate_and_state","coefficient":0.4,"a":{"nodes":[0.02,0.03]},"b":0.03,"rate":0.001,"distance":0.01,"evolution":"slip","initial_state":2.0},"cohesion":0.0}"#,
        r#"{"law":"bound","bound":{"kind":"rate_and_state","coefficient":0.4,"a":0.02,"b":0.03,"rate":0.001,"distance":0.01,"evolution":"aging"}}"#,
        r#"{"law":"coulomb","coefficient":{"expression":"0.3 + 0.1 * x"},"cohesion":{"expression":"y"},"cap":10.0}"#,
        r#"{"law":"coulomb","coefficient":{"kind":"expression","formula":"0.3 + 0.2 * exp(-r / 0.01) * (1 + x)"},"cohesion":0.0}"#,
        r#"{"law":"bound","bound":{"kind":"expression","formula":"min(1e5, 0.1 * p) / (1 + s)"}}"#,
        r#"{"law":"bound","bound":{"kind":"slip_weakening","static":0.4,"dynamic":{"nodes":[0.1,0.2]},"distance":2.0}}"#,
        r#"{"law":"bound","bound":{"kind":"exponential","static":0.4,"kinetic":0.1,"decay":2.0}}"#,
    ] {
        let scene = friction(text).unwrap();
        let written = serde_json::to_string(&scene.contacts()[0].friction).unwrap();
        assert_eq!(written, text);
        assert_eq!(Scene::from_json(&scene.to_json(), "again").unwrap(), scene);
    }
    let short = friction(r#"{"law": "coulomb", "coefficient": 0.3, "tension": false}"#).unwrap();
    assert_eq!(
        short,
        friction(r#"{"law": "coulomb", "coefficient": 0.3, "cohesion": 0}"#).unwrap()
    );
    // fields of different lengths, and of a length that the mesh has not
    let error = friction(
        r#"{"law": "coulomb", "coefficient": {"nodes": [0.1, 0.2]}, "cohesion": {"nodes": [0.1]}}"#,
    );
    let text = error.unwrap_err().to_string();
    assert!(
        text.contains("contact.friction.cohesion.nodes") && text.contains("contact node: 2"),
        "{text}"
    );
}

/// Names, units and paths of the coefficients follow from the role, and a set of them is checked when it is complete.
#[test]
fn coefficients_of_coulombs_law_have_their_own_units_and_paths() {
    let role = Role::Coulomb { tension: false };
    let law = Law::find(role, "stribeck").unwrap();
    let paths: Vec<(String, &str)> = (0..7).map(|i| (law.path(i), law.unit(i))).collect();
    let expected = [
        ("contact.friction.coefficient.static", "1"),
        ("contact.friction.coefficient.kinetic", "1"),
        ("contact.friction.coefficient.velocity", "m/s"),
        ("contact.friction.coefficient.exponent", "1"),
        ("contact.friction.coefficient.viscous", "s/m"),
        ("contact.friction.cohesion", "Pa"),
        ("contact.friction.cap", "Pa"),
    ];
    assert_eq!(paths, expected.map(|(path, unit)| (path.to_owned(), unit)));
    assert_eq!(Law::constant(role).path(0), "contact.friction.coefficient");
    assert_eq!(
        Law::find(Role::Bound, "stribeck").unwrap().unit(4),
        "Pa.s/m"
    );

    let number = Given::Number;
    let exponential = Law::find(role, "exponential").unwrap();
    let given = [
        number(0.4),
        number(0.2),
        number(3.0),
        number(0.0),
        Given::Absent,
    ];
    let chosen = ChosenLaw::new(exponential, &given, None).unwrap();
    assert_eq!(chosen.start().len(), 4);
    chosen.check(&[0.1, 0.05, 3.0, 0.0]).unwrap();
    for (values, named) in [
        ([0.1, 0.2, 3.0, 0.0], "contact.friction.coefficient.static"),
        ([0.3, 0.2, -1.0, 0.0], "contact.friction.coefficient.decay"),
        ([0.3, 0.2, 3.0, -1.0], "contact.friction.cohesion"),
        ([0.3, 0.2, 3.0, f64::NAN], "contact.friction.cohesion"),
    ] {
        let error = chosen.check(&values).unwrap_err();
        assert!(
            matches!(error, Error::Value { .. }) && error.to_string().contains(named),
            "{error}"
        );
    }
}
