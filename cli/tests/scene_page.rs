//! `docs/scene.md` describes every key of a scene: all property paths of the schema that the command prints stand on it.

mod common;

use common::Shell;
use serde_json::Value;
use std::collections::BTreeSet;

const PAGE: &str = include_str!("../../docs/scene.md");

#[test]
fn every_key_of_the_schema_stands_on_the_page() {
    let schema: Value = serde_json::from_str(&Shell::new().succeed(&["schema"])).expect("a schema");
    let mut paths = BTreeSet::new();
    collect(&schema, &schema, "", &mut paths);
    for known in ["time.step", "loads[].name", "mesh.refine[].to"] {
        assert!(paths.contains(known), "{known} is not among {paths:?}");
    }
    // what stands between backticks, line by line
    let told: Vec<&str> = PAGE
        .lines()
        .flat_map(|line| line.split('`').skip(1).step_by(2))
        .collect();
    let missing: Vec<&String> = paths
        .iter()
        .filter(|path| !told.iter().any(|told| is_told(told, path)))
        .collect();
    assert!(missing.is_empty(), "not in docs/scene.md: {missing:?}");
}

#[test]
fn a_star_stands_for_keys_between_its_neighbours() {
    assert!(is_told("time.step", "time.step"));
    assert!(!is_told("time.step", "time.steps"));
    assert!(is_told("a.*.nodes", "a.b.nodes") && is_told("a.*.nodes", "a.b.c.nodes"));
    assert!(!is_told("a.*.nodes", "a.nodes") && !is_told("a.*.nodes", "a.b.node"));
}

/// Whether words of the page name a path.
fn is_told(told: &str, path: &str) -> bool {
    match told.split_once('*') {
        None => told == path,
        Some((before, after)) => {
            path.starts_with(before)
                && path.ends_with(after)
                && path.len() > before.len() + after.len()
        }
    }
}

/// Paths of all properties: keys joined by `.`, `[]` for the items of a list.
fn collect(schema: &Value, node: &Value, path: &str, paths: &mut BTreeSet<String>) {
    if let Some(reference) = node["$ref"].as_str() {
        let place = reference.trim_start_matches('#');
        let target = schema.pointer(place).expect("a definition");
        collect(schema, target, path, paths);
    }
    let alternatives = ["oneOf", "anyOf", "allOf"]
        .iter()
        .filter_map(|key| node[*key].as_array());
    for alternative in alternatives.flatten() {
        collect(schema, alternative, path, paths);
    }
    for (key, property) in node["properties"].as_object().into_iter().flatten() {
        let own = match path {
            "" => key.clone(),
            _ => format!("{path}.{key}"),
        };
        collect(schema, property, &own, paths);
        paths.insert(own);
    }
    if node["items"].is_object() {
        collect(schema, &node["items"], &format!("{path}[]"), paths);
    }
}
