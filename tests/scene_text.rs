//! Scene texts as editors, shells and programs write them; and what errors show of them.

use serde_json::Value;
use stickslip::scene::{Signal, example, json_schema};
use stickslip::{Error, Scene, compile};

fn text() -> &'static str {
    example("kazmi2014").unwrap()
}

fn scene(text: &str) -> Scene {
    Scene::from_json(text, "scene.json").unwrap_or_else(|error| panic!("{error}"))
}

/// What is said of a scene that is refused when it is read or, by its mesh, when it is compiled.
fn message(text: &str) -> String {
    Scene::from_json(text, "scene.json")
        .and_then(|scene| compile(&scene))
        .map(drop)
        .unwrap_err()
        .to_string()
}

/// RFC 8259, 8.1: a parser may skip the mark that Windows editors and shells put first.
#[test]
fn a_byte_order_mark_is_skipped() {
    assert_eq!(scene(&format!("\u{feff}{}", text())), scene(text()));
    // one, and only at the start
    assert!(message(&format!("\u{feff}\u{feff}{}", text())).contains("invalid JSON"));
    assert!(message(&text().replace("\"mesh\"", "\u{feff}\"mesh\"")).contains("invalid JSON"));
}

/// In JSON Schema a number without a fraction is an integer, however it is written.
#[test]
fn integers_may_be_written_with_a_point() {
    let validator = {
        let schema: Value = serde_json::from_str(&json_schema()).unwrap();
        jsonschema::validator_for(&schema).unwrap()
    };
    let cells = "[32, 16]";
    for (old, new) in [
        (cells, "[32.0, 16.0]"),
        (cells, "[3.2e1, 16]"),
        (cells, "[320E-1, 1.6e+1]"),
        ("\"schema_version\": 1", "\"schema_version\": 1.0"),
        (
            "\"fidelity\": {",
            "\"history\": {\"capacity\": 16.0}, \"fidelity\": {",
        ),
    ] {
        let changed = text().replace(old, new);
        assert!(changed != text() && validator.is_valid(&serde_json::from_str(&changed).unwrap()));
        assert_eq!(scene(&changed), scene(text()), "{new}");
    }
    let set = |path: &str, value: &str| {
        let overrides = [(path.to_owned(), value.to_owned())];
        Scene::with_overrides(text(), "x", &overrides)
    };
    assert_eq!(
        set("mesh.cells", "[8.0, 4]").unwrap(),
        set("mesh.cells", "[8, 4]").unwrap()
    );
    let solver = r#"{"kind": "newton", "max_iterations": 50.0}"#;
    assert!(set("fidelity.solver", solver).is_ok());
    for wrong in [
        "[32.5, 16]",
        "[-32.0, 16]",
        "[0.0, 16]",
        "[4294967296.0, 16]",
        "[1e300, 16]",
        "[1e-300, 16]",
    ] {
        let error = set("mesh.cells", wrong).unwrap_err().to_string();
        assert!(
            error.contains("at mesh.cells[0]") && error.contains("an integer >= 1"),
            "{error}"
        );
    }
    // numbers stay numbers, to the bit
    let start = set("loads[0].start", "-0.0").unwrap().loads[0].start;
    assert_eq!(start.to_bits(), (-0.0_f64).to_bits());
    assert_eq!(set("run.until", "3.0").unwrap().run.until, 3.0);
    let signals = r#"{"press": [[0.0, 1.0], [1.0, 2.5]]}"#;
    let expected = Signal::Table(vec![[0.0, 1.0], [1.0, 2.5]]);
    assert_eq!(
        set("run.signals", signals).unwrap().run.signals["press"],
        expected
    );
}

/// Editors find the schema of a file by it.
#[test]
fn a_schema_may_be_named() {
    let named = text().replacen('{', "{ \"$schema\": \"./scene.schema.json\",", 1);
    assert_eq!(scene(&named), scene(text()));
    let schema: Value = serde_json::from_str(&json_schema()).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    assert!(validator.is_valid(&serde_json::from_str(&named).unwrap()));
    let wrong = named.replace("\"./scene.schema.json\"", "1");
    assert!(!validator.is_valid(&serde_json::from_str(&wrong).unwrap()));
    assert!(
        message(&wrong).contains("found 1; allowed: a string"),
        "{}",
        message(&wrong)
    );
    // at the top alone
    let deep = text().replace("\"contact\": {", "\"contact\": {\"$schema\": \"x\", ");
    assert!(
        message(&deep).contains("unknown key \"$schema\""),
        "{}",
        message(&deep)
    );
}

/// A message is one line, without characters that a terminal obeys, and shows no more than 80 characters of what it found.
#[test]
fn messages_are_short_and_plain() {
    let evil = "na\u{202e}me\u{1b}[31m\u{7}\u{200f}\u{85}\u{2028}";
    let long = format!("-{}", "x".repeat(100_000));
    let escaped = |text: &str| serde_json::to_string(text).unwrap();
    let mut messages = Vec::new();
    for word in [evil, long.as_str()] {
        let key = escaped(word);
        for (old, new) in [
            ("\"mesh\"", key.clone()),
            ("\"part\": \"bottom\"", format!("\"part\": {key}")),
            ("\"clamped\": [\"left\"]", format!("\"clamped\": [{key}]")),
            (
                "\"clamped\": [\"left\"]",
                format!("\"clamped\": [\"left\", {key}]"),
            ),
            ("\"press\": -0.3", format!("{key}: 1")),
            ("\"name\": \"press\"", format!("\"name\": {key}")),
            ("\"name\": \"tip\"", format!("\"name\": {key}")),
            ("\"trapezoid\"", key.clone()),
            ("\"reduced\"", key.clone()),
            ("-0.3}", format!("{{{key}: 1}}}}")),
            ("[1.0, 0.0]", format!("[{key}]")),
            ("0.03125", format!("0.03125, {key}: 1")),
        ] {
            let changed = text().replacen(old, &new, 1);
            assert!(changed != text(), "{old}");
            messages.push(message(&changed));
        }
        messages.push(message(&key));
        messages.push(
            Scene::from_json(text(), word)
                .map(|_| ())
                .err()
                .map_or(String::new(), |e| e.to_string()),
        );
        messages.push(
            Scene::from_json("{", word)
                .unwrap_err()
                .to_string()
                .replace(&long, "x"),
        );
        for path in [
            word.to_owned(),
            format!("contact.{word}.x"),
            format!("{word}[0].x"),
            format!("{word}["),
        ] {
            let set = [(path, "1".to_owned())];
            messages.push(
                Scene::with_overrides(text(), "x", &set)
                    .unwrap_err()
                    .to_string(),
            );
        }
        let model = compile(
            &Scene::with_overrides(
                text(),
                "x",
                &[("mesh.cells".to_owned(), "[2,1]".to_owned())],
            )
            .unwrap(),
        )
        .unwrap();
        messages.push(model.ports().find(word).unwrap_err().to_string());
    }
    // numbers of any length
    let digits = format!("1{}", "0".repeat(5000));
    messages.push(message(&text().replace("100.0", &digits)));
    messages.push(message(
        &text().replace("[1.0, 0.5]", &format!("[{}]", "1.0,".repeat(3000) + "1")),
    ));
    for message in messages {
        assert!(
            message.chars().count() < 700,
            "{}: {}",
            message.len(),
            &message[..300]
        );
        let is_plain = |c: char| !c.is_control() && !('\u{200b}'..='\u{202e}').contains(&c);
        assert!(message.chars().all(is_plain), "{message:?}");
    }
    assert!(message("{\"na\u{202e}me\":1}").contains("na\\u{202e}me"));
}

/// A number is shown as a user would write it.
#[test]
fn numbers_are_shown_in_their_shortest_form() {
    for (old, new, expected) in [
        (
            "[1.0, 0.0]",
            "[1e300, 0.0]",
            "found [1e300, 0.0]; allowed: a point of the body",
        ),
        (
            "[1.0, 0.5]",
            "[1e-300, 0.5]",
            "no normal at [3.125e-302, 0.0, 0.0]",
        ),
        (
            "\"a\": 0.003",
            "\"a\": 1e-300",
            "found 1e-300; allowed: at least b = 0.001",
        ),
        (
            "\"b\": 0.001",
            "\"b\": 1e300",
            "found 0.003; allowed: at least b = 1e300",
        ),
        ("\"mu1\": 0.05", "\"mu1\": -1e300", "-1e300"),
        (
            "\"press\": -0.3",
            "\"press\": [[1e300, 1], [1, 1]]",
            "increase: > 1e300, or for a jump 1e300 twice",
        ),
    ] {
        let changed = text().replacen(old, new, 1);
        assert!(changed != text(), "{old}");
        let message = message(&changed);
        assert!(
            message.contains(expected) && message.len() < 300,
            "{message}"
        );
    }
    let error = Error::Step {
        what: "x",
        expected: 1e300,
        found: -1e-300,
    };
    assert_eq!(error.to_string(), "x: expected 1e300, found -1e-300");
    let error = Error::Value {
        what: "x".into(),
        found: 1e22,
        allowed: "less",
    };
    assert_eq!(error.to_string(), "x: found 1e22, allowed: less");
}
