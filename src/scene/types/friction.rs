//! The friction of a scene: one of the laws, with the coefficients that it declares.
//!
//! Schema, reading and writing follow from [`crate::contact::law::LAWS`]; nothing here knows a law by name.

use crate::contact::law::{BOUND, CONSTANT, Coefficient, Extent, Form, Given, LAWS, Law};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// Key of a coefficient that is given node by node.
const NODES: &str = "nodes";

/// Friction law of the contact and its coefficients, in the order in which the law declares them.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    pub law: Law,
    pub coefficients: Vec<Given>,
}

impl JsonSchema for Friction {
    fn schema_name() -> Cow<'static, str> {
        "Friction".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let of = |form| LAWS.iter().filter(move |law| law.form() == form);
        let mut laws: Vec<Value> = of(Form::Law).map(|law| variant(*law, "law")).collect();
        let kinds: Vec<Value> = of(Form::Kind).map(|law| variant(*law, "kind")).collect();
        let number = coefficient(&CONSTANT.coefficients()[0]);
        laws.push(json!({
            "description": "A bound of one of several kinds.",
            "type": "object",
            "properties": {
                "law": {"type": "string", "const": BOUND},
                BOUND: {"description": "Bound, Pa: a number, or a function of the slip rate.",
                        "anyOf": [number["anyOf"][0], {"oneOf": kinds}]},
            },
            "required": ["law", BOUND],
            "additionalProperties": false,
        }));
        let mut schema = Schema::default();
        let text = "Friction bound g as a function of the slip rate r >= 0 (m/s).";
        schema.insert("description".into(), text.into());
        schema.insert("oneOf".into(), laws.into());
        schema
    }
}

/// Schema of a law: its name under `tag`, and its coefficients.
fn variant(law: Law, tag: &str) -> Value {
    let mut members = Map::new();
    members.insert(tag.into(), json!({"type": "string", "const": law.name()}));
    let mut required = vec![tag];
    for declared in law.coefficients() {
        members.insert(declared.name.into(), coefficient(declared));
        if declared.default.is_none() {
            required.push(declared.name);
        }
    }
    json!({
        "description": law.text(),
        "type": "object",
        "properties": members,
        "required": required,
        "additionalProperties": false,
    })
}

/// Schema of a coefficient: a number or one per node, or the points of a curve.
fn coefficient(declared: &Coefficient) -> Value {
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
    let list = json!({"type": "array", "items": number, "minItems": 1});
    let mut schema = match declared.extent {
        Extent::Points => list,
        Extent::Nodes => {
            number.insert("description".into(), declared.text.into());
            json!({"anyOf": [number, {
                "description": "One number per contact node.",
                "type": "object",
                "properties": {NODES: list},
                "required": [NODES],
                "additionalProperties": false,
            }]})
        }
    };
    schema["description"] = declared.text.into();
    if let Some(default) = declared.default {
        schema["default"] = default.into();
    }
    schema
}

impl<'de> Deserialize<'de> for Friction {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Friction, D::Error> {
        let value = Value::deserialize(from)?;
        read(&value).ok_or_else(|| D::Error::custom("no friction law with its coefficients"))
    }
}

/// The friction that a value writes, if it does.
fn read(value: &Value) -> Option<Friction> {
    let members = value.as_object()?;
    let name = members.get("law")?.as_str()?;
    if name != BOUND {
        return read_law(Law::find(Form::Law, name)?, members);
    }
    match members.get(BOUND)? {
        Value::Object(kind) if members.len() == 2 => {
            read_law(Law::find(Form::Kind, kind.get("kind")?.as_str()?)?, kind)
        }
        number if members.len() == 2 => Some(Friction {
            law: CONSTANT,
            coefficients: vec![Given::Number(number.as_f64()?)],
        }),
        _ => None,
    }
}

fn read_law(law: Law, members: &Map<String, Value>) -> Option<Friction> {
    let declared = law.coefficients();
    let is_known = |key: &String| declared.iter().any(|c| c.name == *key);
    let others = members.keys().filter(|key| !is_known(key)).count();
    let given = |declared: &Coefficient| match members.get(declared.name) {
        Some(value) => read_given(declared.extent, value),
        None => declared.default.map(Given::Number),
    };
    // the tag is the only other key
    (others == 1).then_some(Friction {
        law,
        coefficients: declared.iter().map(given).collect::<Option<_>>()?,
    })
}

fn read_given(extent: Extent, value: &Value) -> Option<Given> {
    let list = |value: &Value| -> Option<Vec<f64>> {
        let items = value.as_array().filter(|items| !items.is_empty())?;
        items.iter().map(Value::as_f64).collect()
    };
    match (extent, value) {
        (Extent::Points, _) => list(value).map(Given::Points),
        (Extent::Nodes, Value::Object(members)) if members.len() == 1 => {
            list(members.get(NODES)?).map(Given::Nodes)
        }
        (Extent::Nodes, _) => value.as_f64().map(Given::Number),
    }
}

impl Serialize for Friction {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.law.form() {
            Form::Law => Tagged("law", self).serialize(to),
            Form::Kind => {
                let mut map = to.serialize_map(Some(2))?;
                map.serialize_entry("law", BOUND)?;
                map.serialize_entry(BOUND, &Tagged("kind", self))?;
                map.end()
            }
        }
    }
}

/// A law beside its coefficients, under this tag.
struct Tagged<'a>(&'static str, &'a Friction);

impl Serialize for Tagged<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Tagged(tag, Friction { law, coefficients }) = self;
        let mut map = to.serialize_map(Some(1 + coefficients.len()))?;
        map.serialize_entry(tag, law.name())?;
        for (declared, given) in law.coefficients().iter().zip(coefficients) {
            match given {
                Given::Number(value) => map.serialize_entry(declared.name, value)?,
                Given::Points(values) => map.serialize_entry(declared.name, values)?,
                Given::Nodes(values) => {
                    map.serialize_entry(declared.name, &json!({ NODES: values }))?
                }
            }
        }
        map.end()
    }
}
