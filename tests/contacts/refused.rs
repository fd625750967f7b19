//! What several contacts cannot be.

use super::*;

#[test]
fn what_is_not_possible_is_refused_by_name() {
    let foot = |part: &str, name: &str| json!({"name": name, "part": part, "friction": {"law": "tresca", "bound": 0.01}});
    let rejected = |value: Value| match compile(&value) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{value}"),
    };
    let with = |key: &str, change: Value| {
        let mut foot = foot("b", "foot_b");
        foot[key] = change;
        scene(json!([first_foot(), foot]), &[])
    };
    let gives = json!([{"name": "foot_a", "part": "a", "friction": {"law": "frictionless"}, "condition": {"kind": "compliance", "stiffness": 1.0}},
        {"name": "foot_b", "part": "b", "friction": {"law": "frictionless"}, "condition": {"kind": "unilateral"}}]);
    let midpoint = [("time", json!({"step": 0.1, "scheme": "midpoint"}))];
    for (value, path, found) in [
        (
            with("part", json!("a")),
            "contacts[1].part",
            "a second time",
        ),
        (
            with("part", json!("half")),
            "contacts[1].part",
            "shares the node at [0.25, 0.0] with contacts[0].part",
        ),
        (
            with("name", json!("foot_a")),
            "contacts[1].name",
            "the same as contacts[0].name",
        ),
        (
            with("name", json!("contact")),
            "contacts[1].name",
            "contact",
        ),
        (
            with("name", json!("push")),
            "contacts[1].name",
            "the same as loads[0].name",
        ),
        (with("name", json!("2")), "contacts[1].name", "\"2\""),
        (
            with("tangent", json!([0, 1])),
            "contacts[1].tangent",
            "not normal to the contact",
        ),
        (
            with("friction", json!({"law": "tresca", "bound": -1})),
            "contacts[1].friction.bound",
            "-1",
        ),
        (
            with(
                "friction",
                json!({"law": "tresca", "bound": {"nodes": [1.0, 2.0]}}),
            ),
            "contacts[1].friction.bound.nodes",
            "contact node: 4",
        ),
        (
            with("condition", json!({"kind": "unilateral"})),
            "contacts[1].friction",
            "without pressure",
        ),
        (scene(json!([]), &[]), "contact", "nothing"),
        (scene(gives, &midpoint), "time.scheme", "gives way"),
        (
            scene(json!([first_foot()]), &[("contact", foot("b", "contact"))]),
            "contacts",
            "a list beside contact",
        ),
        (
            scene(json!([first_foot()]), &[("clamped", json!(["left", "a"]))]),
            "clamped[1]",
            "which is contacts[0].part",
        ),
    ] {
        let text = rejected(value);
        assert!(
            text.contains(&format!("at {path}")) && text.contains(found),
            "{text}"
        );
    }
}

fn first_foot() -> Value {
    json!({"name": "foot_a", "part": "a", "friction": {"law": "tresca", "bound": 0.01}})
}

/// A part that turns around a corner has no normal there.
#[test]
fn a_bent_part_is_to_be_split() {
    let mut mesh = feet();
    let corner: Vec<u32> = [&mesh.parts["bottom"][..], &mesh.parts["right"]].concat();
    mesh.parts.insert("corner".into(), corner);
    let value = scene(
        json!({"part": "corner", "friction": {"law": "tresca", "bound": 0.01}}),
        &[("loads", json!([]))],
    );
    let error = Compilation::on_mesh(&read(&value).unwrap(), mesh)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("at contact.part") && error.contains("bends by 90 degrees at [1.0, 0.0]"),
        "{error}"
    );
}
