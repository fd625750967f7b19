//! The schema of friction: laws, and the kinds once for both uses.

use super::{EXPRESSION, Friction, KERNEL, MEMORY, NODES, TAU, TENSION, WEIGHT};
use crate::contact::law::{Coefficient, Extent, FrictionLaw, KINDS, LAWS, Law, Omitted, Role};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

impl JsonSchema for Friction {
    fn schema_name() -> Cow<'static, str> {
        "Friction".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let shared = generator.definitions_mut();
        let own = LAWS.iter().map(|law| variant(*law, "law", shared));
        let mut laws: Vec<Value> = own.collect();
        let kinds = KINDS.iter().map(|kind| variant(*kind, "kind", shared));
        let kinds = json!({
            "description": "A function of slip rate, accumulated slip or a state. Its values are Pa in a bound, and have no unit in a coefficient.",
            "oneOf": kinds.collect::<Vec<_>>(),
        });
        shared.insert(KINDS_SHARED.into(), kinds);
        laws.extend(
            Role::OF_KINDS
                .iter()
                .filter_map(|role| of_kinds(*role, shared)),
        );
        let mut schema = Schema::default();
        let text = "Friction: a bound g of the tangential stress as a function of the slip rate r >= 0 (m/s), or Coulomb's law.";
        schema.insert("description".into(), text.into());
        schema.insert("oneOf".into(), laws.into());
        schema
    }
}

/// Where the schema of scenes has what laws share.
const KINDS_SHARED: &str = "FrictionKind";
const EXPRESSION_SHARED: &str = "FrictionExpression";
const NODES_SHARED: &str = "FrictionNodes";

type Shared = Map<String, Value>;

fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{name}") })
}

/// Schema of a role of the kinds.
fn of_kinds(role: Role, shared: &mut Shared) -> Option<Value> {
    let [name, key] = role.words()?;
    let (text, meaning) = match role {
        Role::Own | Role::Bound => (
            "A bound of one of several kinds.",
            "Bound, Pa: a number, one per node, or a function of the slip rate.",
        ),
        Role::Coulomb { .. } => (
            "Coulomb's law: the bound is `min(cap, cohesion + coefficient * pressure)`.",
            "Coefficient of friction: a number, one per node, or a function of the slip rate.",
        ),
    };
    let mut value = field(Law::constant(role).coefficient(0), meaning, shared);
    value.push(reference(KINDS_SHARED));
    let mut members = Map::new();
    members.insert("law".into(), json!({"type": "string", "const": name}));
    members.insert(key.into(), json!({"description": meaning, "anyOf": value}));
    insert_coefficients(&mut members, role.coefficients(), shared);
    if let Role::Coulomb { .. } = role {
        let meaning = "Whether the bound is that of the magnitude of the pressure, so that tension counts too; default: only compression counts.";
        let choice = json!({"type": "boolean", "description": meaning, "default": false});
        members.insert(TENSION.into(), choice);
    }
    members.insert(MEMORY.into(), memory());
    Some(json!({
        "description": text,
        "type": "object",
        "properties": members,
        "required": ["law", key],
        "additionalProperties": false,
    }))
}

/// Schema of the memory of slip.
fn memory() -> Value {
    let positive = |text: &str| json!({"type": "number", "format": "double", "exclusiveMinimum": 0, "description": text});
    let term = json!({
        "type": "object",
        "properties": {
            WEIGHT: positive("Weight of the term, without unit; positive."),
            TAU: positive("Time over which the term forgets, s; positive, default: it does not forget."),
        },
        "required": [WEIGHT],
        "additionalProperties": false,
    });
    json!({
        "description": "Fading memory of slip: the law takes `int sum weight exp(-(t - s)/tau) |slip rate| ds` (m) in place of the accumulated slip.",
        "type": "object",
        "properties": {KERNEL: list(term)},
        "required": [KERNEL],
        "additionalProperties": false,
    })
}

/// Schema of a law or kind: its name under `tag`, and its coefficients without those of a role.
fn variant(law: &dyn FrictionLaw, tag: &str, shared: &mut Shared) -> Value {
    let mut members = Map::new();
    members.insert(tag.into(), json!({"type": "string", "const": law.name()}));
    let declared = law.coefficients();
    insert_coefficients(&mut members, declared, shared);
    let needed = declared.iter().filter(|c| c.omitted == Omitted::Refused);
    let required: Vec<&str> = [tag].into_iter().chain(needed.map(|c| c.name)).collect();
    json!({
        "description": law.text(),
        "type": "object",
        "properties": members,
        "required": required,
        "additionalProperties": false,
    })
}

fn insert_coefficients(
    members: &mut Map<String, Value>,
    declared: &[Coefficient],
    shared: &mut Shared,
) {
    for declared in declared {
        members.insert(declared.name.into(), coefficient(declared, shared));
    }
}

/// Schema of a number of a coefficient.
fn number(declared: &Coefficient) -> Map<String, Value> {
    let mut number = Map::new();
    number.insert("type".into(), "number".into());
    number.insert("format".into(), "double".into());
    let bound = match declared.range.is_open {
        true => "exclusiveMinimum",
        false => "minimum",
    };
    let least = declared.range.least;
    let is_whole = least.fract() == 0.0;
    let least = if is_whole {
        json!(least as i64)
    } else {
        json!(least)
    };
    number.insert(bound.into(), least);
    number
}

fn list(item: impl Into<Value>) -> Value {
    json!({"type": "array", "items": item.into(), "minItems": 1})
}

/// Schemas of a field: a number that means `text`, one per node, a formula.
fn field(declared: &Coefficient, text: &str, shared: &mut Shared) -> Vec<Value> {
    let mut own = number(declared);
    let relation = match declared.range.is_open {
        true => "Above",
        false => "From",
    };
    let nodes = format!("{NODES_SHARED}{relation}{}", declared.range.least);
    shared.entry(nodes.as_str()).or_insert_with(|| {
        json!({
            "description": "One number per contact node.",
            "type": "object",
            "properties": {NODES: list(own.clone())},
            "required": [NODES],
            "additionalProperties": false,
        })
    });
    shared.entry(EXPRESSION_SHARED).or_insert_with(|| {
        let text = "Formula of x, y, z (m), e.g. `0.3 + 0.1 * x`.";
        json!({
            "description": "A formula of x, y, z (m), evaluated at the contact nodes.",
            "type": "object",
            "properties": {EXPRESSION: {"type": "string", "description": text}},
            "required": [EXPRESSION],
            "additionalProperties": false,
        })
    });
    own.insert("description".into(), text.into());
    vec![own.into(), reference(&nodes), reference(EXPRESSION_SHARED)]
}

/// Schema of a coefficient: a number or one per node, or the points of a curve.
fn coefficient(declared: &Coefficient, shared: &mut Shared) -> Value {
    let text = meaning(declared);
    let mut schema = match declared.extent {
        Extent::Points => list(number(declared)),
        Extent::Choice(words) => json!({"type": "string", "enum": words}),
        Extent::Formula => json!({"type": "string"}),
        Extent::Grid => {
            let row = list(number(declared));
            json!({"anyOf": [row, list(row.clone())]})
        }
        Extent::Nodes => json!({"anyOf": field(declared, &text, shared)}),
    };
    schema["description"] = text.into();
    if let Omitted::Means(default) = declared.omitted {
        schema["default"] = default.into();
    }
    schema
}

/// What a coefficient means, with its unit as a bound in words: `Pa.s/m` is `Pa s/m`.
fn meaning(declared: &Coefficient) -> String {
    let unit = declared.unit.in_bound().replace('.', " ");
    declared.text.replace("{}", &unit)
}
