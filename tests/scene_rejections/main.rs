//! Every mistake in a scene is one error that names the JSON path, what was found and what is allowed; and no text
//! makes the reader panic.

mod body;
mod refusal;

use proptest::prelude::*;
use refusal::*;
use stickslip::scene::{example, example_names, json_schema};
use stickslip::{Error, Scene};

#[test]
#[rustfmt::skip] // one row, one mistake
fn keys() {
    assert_edits_refused(
        "kazmi2014",
        &[
            (r#""element": "p1","#, r#""elemnt": "p1","#, "elemnt", "unknown key \"elemnt\"", "clamped, contact, contacts, driven, element"),
            (r#""alpha": 100"#, r#""alhpa": 100"#, "contact.friction.alhpa", "unknown key \"alhpa\"", "a, alpha, b, law"),
            (r#""size""#, r#""sizes""#, "mesh.sizes", "unknown key", "cells, grading, kind, periodic, refine, regions, size"),
            (r#""mu1""#, r#""nu1""#, "material.viscosity.nu1", "unknown key", "law, mu1, mu2"),
            (r#""young""#, r#""Young""#, "material.elasticity.Young", "unknown key", "young"),
            (r#""direction""#, r#""dir""#, "loads[0].dir", "unknown key", "direction"),
            (r#""at""#, r#""here""#, "probes[0].here", "unknown key", "at, name"),
            (r#""model""#, r#""a.b""#, "fidelity[\"a.b\"]", "unknown key", "model"),
            (r#", "alpha": 100.0"#, "", "contact.friction.alpha", "nothing", "a number >= 0 (Decay, s/m"),
            (r#", "step": 0.03125"#, "", "time.step", "nothing", "a number > 0 (Largest internal step, s"),
            (r#""kind": "rectangle", "#, "", "mesh.kind", "nothing", r#""rectangle", "box""#),
            (r#""law": "exponential", "#, "", "contact.friction.law", "nothing", r#""frictionless", "tresca""#),
            (r#""clamped": ["left"],"#, "", "clamped", "[]", "an array of at least 1"),
            (r#""kind": "traction", "#, "", "loads[0].kind", "nothing", r#""traction", "body_force""#),
            (r#""alpha": 100"#, r#""a": 1, "alpha": 100"#, "contact.friction.a", "a second time", "each key once"),
            (r#""name": "tip""#, r#""name": "tip", "name": "tip""#, "probes[0].name", "(line 9 column", "once"),
        ],
    );
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn types_and_names() {
    assert_edits_refused(
        "kazmi2014",
        &[
            (r#""alpha": 100.0"#, r#""alpha": "fast""#, "contact.friction.alpha", "\"fast\"", "a number"),
            (r#""alpha": 100.0"#, r#""alpha": null"#, "contact.friction.alpha", "null", "a number"),
            ("[32, 16]", "[32.5, 16]", "mesh.cells[0]", "32.5", "an integer >= 1"),
            ("[32, 16]", "[32, -16]", "mesh.cells[1]", "-16", "an integer >= 1"),
            ("[32, 16]", "[32, 4294967296]", "mesh.cells[1]", "4294967296", "an integer"),
            ("[32, 16]", "[32, 16, 8]", "mesh.cells", "[32,16,8]", "an array of 2"),
            ("[1.0, 0.5]", "1.0", "mesh.size", "1.0", "an array of 2, each a number > 0"),
            (r#"["left"]"#, r#""left""#, "clamped", "\"left\"", "an array"),
            (r#"["left"]"#, "[1]", "clamped[0]", "1", "a string"),
            (r#""tip""#, "7", "probes[0].name", "7", "a string"),
            (r#"{"press": -0.3}"#, r#"{"press": "x"}"#, "run.signals.press", "\"x\"", "a number"),
            (r#"{"press": -0.3}"#, r#"{"press": [[0, 1, 2]]}"#, "run.signals.press[0]", "[0,1,2]", "an array of 2"),
            (r#"{"press": -0.3}"#, r#"{"press": []}"#, "run.signals.press", "[]", "an array of at least 1"),
            (r#"{"press": -0.3}"#, "[]", "run.signals", "[]", "an object"),
            (r#""model": "reduced""#, r#""multiplicity_test": 1"#, "fidelity.multiplicity_test", "1", "true or false"),
            (r#""model": "reduced""#, r#""work_limit": 0"#, "fidelity.work_limit", "0", ">= 1"),
            (r#""model": "reduced""#, r#""work_limit": 9, "multiplicity_test": true"#, "fidelity.work_limit", "9 beside fidelity.multiplicity_test", "one of the two"),
            (r#""model": "reduced""#, r#""work_limit": 9, "solver": {"kind": "fixed_point"}"#, "fidelity.work_limit", "9 beside fidelity.solver.kind", "one of the two"),
            (r#""model": "reduced""#, r#""model": "cheap""#, "fidelity.model", "\"cheap\"", r#""full", "condensed""#),
            (r#""model": "reduced""#, r#""solver": {}"#, "fidelity.solver.kind", "nothing", r#""newton", "fixed_point""#),
            (r#""model": "reduced""#, r#""solver": "newton""#, "fidelity.solver", "\"newton\"", "an object with \"kind\""),
            (r#""model": "reduced""#, r#""solver": {"kind": "newton", "stop": 1}"#, "fidelity.solver.stop", "unknown", "max"),
            (r#""rectangle""#, r#""disk""#, "mesh.kind", "\"disk\"", r#""rectangle", "box""#),
            (r#""rectangle""#, "3", "mesh.kind", "3", r#""rectangle", "box""#),
            (r#""exponential""#, r#""coulom""#, "contact.friction.law", "\"coulom\"", r#""tresca""#),
            (r#""kazmi2014"}"#, r#""plane"}"#, "material.elasticity.convention", "\"plane\"", r#""plane_strain""#),
            (r#""trapezoid""#, r#""simpson""#, "time.scheme", "\"simpson\"", r#""tr_bdf2""#),
            (r#""consistent""#, r#""rest""#, "time.start", "\"rest\"", r#""consistent", "zero""#),
            (r#""p1""#, r#""p3""#, "element", "\"p3\"", r#""p1", "p2""#),
            (r#""schema_version": 1"#, r#""schema_version": 2, "new": 0"#, "schema_version", "2", "1"),
        ],
    );
    assert_refused("[]", ("$", "[]", "an object"));
    assert_refused("{}", ("schema_version", "nothing", "1"));
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn syntax() {
    assert_edits_refused(
        "kazmi2014",
        &[
            ("100.0", "1e999", "contact.friction.alpha", "1e999 (line 7 column", "a finite number"),
            ("100.0", "-1e999", "contact.friction.alpha", "-1e999", "a finite number"),
            ("100.0", "NaN", "contact.friction.alpha", "NaN (line 7", "a finite number"),
            ("100.0", "-Infinity", "contact.friction.alpha", "Infinity", "a finite number"),
            ("[32, 16]", "[32, 1e400]", "mesh.cells[1]", "1e400 (line 2", "a finite number"),
            ("[32, 16]", "[32, ]", "mesh.cells[1]", "invalid JSON at line 2 column", "valid JSON"),
            (r#""tip""#, "tip", "probes[0].name", "invalid JSON at line 9 column", "valid JSON"),
        ],
    );
    let text = text_of("kazmi2014");
    assert_refused(
        "",
        ("$", "invalid JSON at line 1 column 0: EOF", "valid JSON"),
    );
    assert_refused(&text[..text.len() - 3], ("$", "EOF", "valid JSON"));
    assert_refused(
        &format!("{text} x"),
        ("$", "line 13 column 2: trailing characters", "valid JSON"),
    );
    assert_refused(
        &"[".repeat(100_000),
        (&"[0]".repeat(127), "recursion limit", "valid JSON"),
    );
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn ranges() {
    let solver = |solver: &str| format!(r#""solver": {solver}"#);
    let newton = solver(r#"{"kind": "newton", "max_iterations": 0}"#);
    let fixed = |tolerance| {
        solver(&format!(
            r#"{{"kind": "fixed_point", "tolerance": {tolerance}}}"#
        ))
    };
    let model = r#""model": "reduced""#;
    assert_edits_refused(
        "kazmi2014",
        &[
            ("[1.0, 0.5]", "[1.0, 0]", "mesh.size[1]", "0", "> 0"),
            ("[1.0, 0.5]", "[-1.0, 1]", "mesh.size[0]", "-1.0", "> 0"),
            ("[32, 16]", "[0, 16]", "mesh.cells[0]", "0", ">= 1"),
            ("0.3, \"conv", "0.5, \"conv", "material.elasticity.poisson", "0.5", "> -1 < 0.5"),
            ("0.3, \"conv", "-1, \"conv", "material.elasticity.poisson", "-1", "> -1 < 0.5"),
            (r#""young": 1.0"#, r#""young": 0"#, "material.elasticity.young", "0", "> 0 (Young's modulus E, Pa"),
            (r#""mu2": 0.1"#, r#""mu2": 0"#, "material.viscosity.mu2", "0", "> 0"),
            (r#""alpha": 100.0"#, r#""alpha": -1"#, "contact.friction.alpha", "-1", ">= 0"),
            (r#""b": 0.001"#, r#""b": -1e-3"#, "contact.friction.b", "-0.001", ">= 0"),
            (r#""a": 0.003"#, r#""a": -1e-3"#, "contact.friction.a", "-0.001", ">= 0"),
            (r#""step": 0.03125"#, r#""step": 0.03125, "tolerance": 0"#, "time.tolerance", "0", ">= 1e-9"),
            (r#""step": 0.03125"#, r#""step": 0.03125, "tolerance": 0.5"#, "time.tolerance", "0.5", "<= 0.1"),
            (r#""step": 0.03125"#, r#""step": 0.03125, "error_estimate": 1"#, "time.error_estimate", "1", "true or false"),
            (r#""step": 0.03125"#, r#""step": 0"#, "time.step", "0", "> 0"),
            ("1e-8", "1e-13", "fidelity.tolerance", "1e-13", ">= 1e-12 <= 0.1"),
            ("1e-8", "0.2", "fidelity.tolerance", "0.2", "<= 0.1"),
            ("1e-10", "1e-15", "fidelity.friction_tolerance", "1e-15", ">= 1e-14"),
            ("1e-10", "0.1", "fidelity.friction_tolerance", "0.1", "<= 0.01"),
            (model, r#""target_error": 0"#, "fidelity.target_error", "0", "> 0 < 1"),
            (model, r#""target_error": 1"#, "fidelity.target_error", "1", "> 0 < 1"),
            (model, r#""target_error": "1 %""#, "fidelity.target_error", "1 %", "Relative error"),
            (model, &newton, "fidelity.solver.max_iterations", "0", ">= 1"),
            (model, &fixed("0"), "fidelity.solver.tolerance", "0", "> 0 < 1"),
            (model, &fixed("1"), "fidelity.solver.tolerance", "1", "> 0 < 1"),
            (r#""run": {"#, r#""history": {"capacity": 1000001}, "run": {"#, "history.capacity", "1000001", "<= 1000000"),
            (r#""until": 1.0"#, r#""until": 0"#, "run.until", "0", "> 0 (End of the run, s"),
            (r#""until": 1.0"#, r#""step": 0"#, "run.step", "0", "> 0"),
        ],
    );
    assert_edits_refused(
        "seal",
        &[("8e4", "-1", "contact.friction.bound", "-1", ">= 0")],
    );
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn names_and_signals() {
    let word = "a letter or underscore";
    let signals = r#"{"press": -0.3}"#;
    assert_edits_refused(
        "kazmi2014",
        &[
            (r#""tip""#, r#""press""#, "probes[0].name", "the same as loads[0].name", "no other load, probe, contact or motion"),
            (r#""tip""#, r#""""#, "probes[0].name", "\"\"", word),
            (r#""tip""#, r#""2nd""#, "probes[0].name", "2nd", word),
            (r#""tip""#, r#""the tip""#, "probes[0].name", "the tip", word),
            (r#""tip""#, r#""a.b""#, "probes[0].name", "a.b", word),
            (r#""tip""#, r#""é""#, "probes[0].name", "é", word),
            (r#""tip""#, r#""contact""#, "probes[0].name", "contact", "other than contact, energy, solver, time"),
            (r#""tip""#, r#""energy""#, "probes[0].name", "energy", "other than"),
            (r#""name": "press""#, r#""name": "solver""#, "loads[0].name", "solver", "other than"),
            (r#""name": "press""#, r#""name": "time""#, "loads[0].name", "time", "other than"),
            (signals, r#"{"pres": 1}"#, "run.signals.pres", "unknown input \"pres\"", "press"),
            (signals, r#"{"press": [[0, 1], [0, 2], [0, 3]]}"#, "run.signals.press[2][0]", "0", "for a jump 0 twice"),
            (signals, r#"{"press": [[0, 1], [2, 2], [1, 2]]}"#, "run.signals.press[2][0]", "1", "increase: > 2"),
        ],
    );
    assert_edits_refused(
        "kazmi2014",
        &[(r#""a": 0.003"#, r#""a": 5e-4"#, "contact.friction.a", "0.0005", "at least b = 0.001")],
    );
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn overrides() {
    let set = |path: &str, value: &str| {
        let overrides = [(path.to_owned(), value.to_owned())];
        Scene::with_overrides(text_of("kazmi2014"), "test.json", &overrides)
    };
    let edited = |old: &str, new: &str| {
        Scene::from_json(&text_of("kazmi2014").replace(old, new), "test.json")
    };
    assert_eq!(set("contact.friction.alpha", "50"), edited("100.0", "50"));
    assert_eq!(
        set("loads[0].start", "-0.1"),
        edited(r#""start": -0.3"#, r#""start": -0.1"#)
    );
    assert_eq!(
        set("fidelity.model", "full"),
        edited("\"reduced\"", "\"full\"")
    );
    assert_eq!(set("run.step", "0.5").map(|s| s.run.step), Ok(Some(0.5)));
    // Sections that the scene may omit can be reached nevertheless.
    assert_eq!(
        set("history.capacity", "3").map(|s| s.history.capacity),
        Ok(3)
    );
    assert!(set("fidelity.solver", r#"{"kind": "fixed_point"}"#).is_ok());

    for (path, value, at, found, allowed) in [
        ("contact.fricton.alpha", "50", "contact.fricton.alpha", "nothing at contact.fricton", "friction"),
        ("contact.friction.alhpa", "50", "contact.friction.alhpa", "unknown key", "alpha"),
        ("loads[1].start", "0", "loads[1].start", "nothing at loads[1]", "an index below 1"),
        ("loads.start", "0", "loads.start", "at loads", "an object with the key start"),
        ("mesh[0]", "0", "mesh[0]", "at mesh", "an array"),
        ("time.step.x", "0", "time.step.x", "0.03125 at time.step", "an object"),
        ("loads[", "0", "loads[", "malformed path", "dots"),
        ("", "0", "", "malformed path", "dots"),
        ("contact.friction.alpha", "1e999", "contact.friction.alpha", "\"1e999\"", "a number"),
        ("mesh.cells", "[0, 1]", "mesh.cells[0]", "0", ">= 1"),
    ] {
        assert_scene_error(set(path, value), at, found, allowed);
    }
}

/// The explicit scheme has neither step control nor error estimate; switching the estimate off is no request.
#[test]
fn explicit_scheme_has_no_step_control() {
    let text = |more: &str| {
        let time = format!(r#""step": 0.03125, "scheme": "rectangle"{more}"#);
        let text = text_of("kazmi2014").replace(r#""scheme": "trapezoid", "#, "");
        text.replace(r#""step": 0.03125"#, &time)
    };
    for (more, path) in [
        (r#", "tolerance": 1e-3"#, "time.tolerance"),
        (r#", "error_estimate": true"#, "time.error_estimate"),
    ] {
        assert_refused(&text(more), (path, "rectangle", "tr_bdf2"));
    }
    for more in ["", r#", "error_estimate": false"#, r#", "tolerance": null"#] {
        assert!(Scene::from_json(&text(more), "test.json").is_ok(), "{more}");
    }
}

#[test]
fn a_target_and_a_tolerance_do_not_both_choose_the_steps() {
    let text = text_of("kazmi2014").replace(
        r#""step": 0.03125"#,
        r#""step": 0.03125, "tolerance": 1e-3"#,
    );
    assert!(Scene::from_json(&text, "test.json").is_ok());
    let text = text.replace(
        r#""model": "reduced""#,
        r#""model": "reduced", "target_error": 0.1"#,
    );
    let expected = (
        "fidelity.target_error",
        "beside time.tolerance",
        "without time.tolerance",
    );
    assert_refused(&text, expected);
}

#[test]
fn scenes_changed_in_rust_are_validated_alike() {
    let mut scene = Scene::from_json(text_of("kazmi2014"), "test.json").expect("valid");
    assert_eq!(scene.validate("test.json"), Ok(()));
    scene.time.step = f64::NAN;
    let result = scene.validate("test.json").map(|()| scene);
    assert_scene_error(result, "time.step", "null", "a number > 0");
}

#[test]
fn examples_are_accepted_and_read_back_equal() {
    assert_eq!(example_names().next(), Some("kazmi2014"));
    assert_eq!(example("unknown"), None);
    for name in example_names() {
        let scene = Scene::from_json(text_of(name), name).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.name, name);
        assert_eq!(
            Scene::from_json(&scene.to_json(), name).as_ref(),
            Ok(&scene)
        );
    }
}

#[test]
fn schema_accepts_the_examples_and_refuses_unknown_keys() {
    let schema = serde_json::from_str(&json_schema()).expect("JSON");
    let validator = jsonschema::validator_for(&schema).expect("a JSON Schema");
    for name in example_names() {
        let mut scene: serde_json::Value = serde_json::from_str(text_of(name)).expect("JSON");
        assert!(validator.is_valid(&scene), "{name}");
        let parsed = Scene::from_json(text_of(name), name).expect("valid");
        assert!(
            validator.is_valid(&serde_json::to_value(parsed).expect("JSON")),
            "{name}"
        );
        scene["contact"]["friction"]["alhpa"] = 1.into();
        assert!(!validator.is_valid(&scene), "{name}");
    }
}

proptest! {
    /// Damaged text is accepted or refused, never a panic; and what is accepted reads back equal.
    #[test]
    fn mutations_never_panic(
        which in 0..4_usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_usize, "[ -~]{0,3}|[0-9]{1,3}|1e999|null|\\[\\]|é"), 1..4),
    ) {
        let mut text = example_names().nth(which).map(text_of).unwrap_or_default().to_owned();
        for (place, removed, inserted) in edits {
            let mut chars: Vec<char> = text.chars().collect();
            let start = place.index(chars.len().max(1)).min(chars.len());
            let end = (start + removed).min(chars.len());
            chars.splice(start..end, inserted.chars());
            text = chars.into_iter().collect();
        }
        match Scene::from_json(&text, "scene") {
            Ok(scene) => prop_assert_eq!(Scene::from_json(&scene.to_json(), "scene"), Ok(scene)),
            Err(error) => prop_assert!(matches!(error, Error::Scene { .. }), "{:?}", error),
        }
    }
}
