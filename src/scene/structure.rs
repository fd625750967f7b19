//! Checks a JSON value against the schema of the scene types: keys, types, names and ranges.
//!
//! serde alone would lose the path of a mistake inside a tagged enum (it buffers the object), and cannot say what is
//! allowed. The schema generated from the same types knows both. Only the keywords that it uses are understood.

use super::path::{Path, Segment};
use super::types::Scene;
use crate::message::cut;
use crate::refusal::{Refusal, shown};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// What editors find the schema of a file by; not a part of a scene.
pub(super) const SCHEMA_KEY: &str = "$schema";

/// The JSON Schema of the scene types.
pub(super) struct Structure(Arc<Value>);

// A library has no global state; the fuzzer, which reads scenes by the million, makes the schema once.
#[cfg(fuzzing)]
thread_local! {
    static MADE: Arc<Value> = Arc::new(Structure::generate());
}

impl Structure {
    pub fn of_scenes() -> Structure {
        #[cfg(fuzzing)]
        return Structure(MADE.with(Arc::clone));
        #[cfg(not(fuzzing))]
        Structure(Arc::new(Structure::generate()))
    }

    fn generate() -> Value {
        let mut schema = schemars::schema_for!(Scene).to_value();
        if let Some(members) = schema["properties"].as_object_mut() {
            let meaning = "Where editors find this schema; without effect.";
            let member = json!({"description": meaning, "type": "string"});
            members.insert(SCHEMA_KEY.to_owned(), member);
        }
        schema
    }

    pub fn schema(&self) -> &Value {
        &self.0
    }

    /// Refuses the first thing in `value` that the schema does not allow.
    pub fn check(&self, value: &Value) -> Result<(), Refusal> {
        // Before all else: in a scene of another version every other complaint would mislead.
        if let Some(version) = value.get("schema_version") {
            let schema = &self.0["properties"]["schema_version"];
            self.walk(version, schema, &Path::default().key("schema_version"))?;
        }
        self.walk(value, &self.0, &Path::default())
    }

    /// Default of an optional object that is a plain member (not inside a tagged enum or an array).
    pub fn default_object(&self, path: &[Segment]) -> Option<&Value> {
        let mut schema: &Value = &self.0;
        let mut default = None;
        for segment in path {
            let Segment::Key(key) = segment else {
                return None;
            };
            let member = self.resolve(schema).get("properties")?.get(key)?;
            default = member.get("default");
            schema = member;
        }
        default.filter(|value| value.is_object())
    }

    fn resolve<'a>(&'a self, schema: &'a Value) -> &'a Value {
        let reference = schema.get("$ref").and_then(Value::as_str);
        reference
            .and_then(|reference| self.0.pointer(reference.trim_start_matches('#')))
            .unwrap_or(schema)
    }

    fn walk(&self, value: &Value, place: &Value, path: &Path) -> Result<(), Refusal> {
        let schema = self.resolve(place);
        if let Some(variants) = branches(schema, "oneOf") {
            return self.walk_enum(value, variants, path);
        }
        if let Some(variants) = branches(schema, "anyOf") {
            return match self.alternative(value, variants) {
                Some(variant) => self.walk(value, variant, path),
                None => Err(self.refuse(value, place, path)),
            };
        }
        if !has_type(value, schema) || !in_range(value, schema) {
            return Err(self.refuse(value, place, path));
        }
        match value {
            Value::Object(object) => self.walk_object(object, schema, path),
            Value::Array(items) => match schema.get("items") {
                Some(schema) => items
                    .iter()
                    .enumerate()
                    .try_for_each(|(i, item)| self.walk(item, schema, &path.index(i))),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    /// The alternative that a value is meant to be: of several kinds of objects the one whose first key it has.
    fn alternative<'a>(&self, value: &Value, variants: &'a [Value]) -> Option<&'a Value> {
        let of_type = || {
            let all = variants.iter();
            all.filter(|v| has_type(value, self.resolve(v)))
        };
        match value {
            Value::Object(object) if of_type().count() > 1 => of_type().find(|v| {
                let key = first_key(self.resolve(v));
                key.is_some_and(|key| object.contains_key(key))
            }),
            // lists of numbers and lists of lists are told apart by their first item
            Value::Array(items) => {
                let fits = |v: &&Value| {
                    let own = self.resolve(v).get("items");
                    let first = items.first().zip(own);
                    first.is_some_and(|(item, own)| has_type(item, self.resolve(own)))
                };
                of_type().find(fits).or_else(|| of_type().next())
            }
            _ => of_type().next(),
        }
    }

    /// An enum: names, or objects that a tag tells apart.
    fn walk_enum(&self, value: &Value, variants: &[Value], path: &Path) -> Result<(), Refusal> {
        let tag = variants.first().and_then(tag_of);
        let (found, path) = match (tag, value) {
            (Some(tag), Value::Object(object)) => (object.get(tag), path.key(tag)),
            (Some(_), _) => {
                return Err(Refusal::new(
                    path,
                    shown(value),
                    self.describe_variants(variants),
                ));
            }
            (None, _) => (Some(value), path.clone()),
        };
        let variant = variants
            .iter()
            .find(|v| found.is_some() && name_of(v, tag) == found);
        match variant {
            Some(variant) => match (tag, value, path.0.split_last()) {
                (Some(_), Value::Object(object), Some((_, outer))) => {
                    self.walk_object(object, variant, &Path(outer.to_vec()))
                }
                _ => Ok(()),
            },
            None => Err(Refusal::new(
                path,
                found.map_or_else(|| "nothing".to_owned(), shown),
                names(variants, tag),
            )),
        }
    }

    fn walk_object(
        &self,
        object: &Map<String, Value>,
        schema: &Value,
        path: &Path,
    ) -> Result<(), Refusal> {
        let no_members = Map::new();
        let members = schema
            .get("properties")
            .and_then(Value::as_object)
            .unwrap_or(&no_members);
        let others = schema
            .get("additionalProperties")
            .filter(|others| others.is_object());
        // Unknown before missing: a misspelt key is both, and the first says more.
        if others.is_none()
            && let Some(key) = object.keys().find(|key| !members.contains_key(*key))
        {
            let keys: Vec<&str> = members.keys().map(String::as_str).collect();
            let found = format!("the unknown key {:?}", cut(key));
            return Err(Refusal::new(
                path.key(key),
                found,
                format!("the keys {}", keys.join(", ")),
            ));
        }
        let required = schema.get("required").and_then(Value::as_array);
        for key in required.into_iter().flatten().filter_map(Value::as_str) {
            if !object.contains_key(key) {
                let allowed = members.get(key).map(|member| self.describe(member));
                return Err(Refusal::new(
                    path.key(key),
                    "nothing",
                    allowed.unwrap_or_default(),
                ));
            }
        }
        for (key, value) in object {
            if let Some(schema) = members.get(key).or(others) {
                self.walk(value, schema, &path.key(key))?;
            }
        }
        Ok(())
    }

    fn refuse(&self, value: &Value, schema: &Value, path: &Path) -> Refusal {
        Refusal::new(path, shown(value), self.describe(schema))
    }

    /// What a schema allows, in words; the first sentence of its description carries the unit or meaning.
    fn describe(&self, place: &Value) -> String {
        let schema = self.resolve(place);
        if let Some(only) = schema.get("const") {
            return shown(only);
        }
        if let Some(names) = branches(schema, "enum") {
            return names.iter().map(shown).collect::<Vec<_>>().join(", ");
        }
        if let Some(variants) = branches(schema, "oneOf") {
            return self.describe_variants(variants);
        }
        if let Some(variants) = branches(schema, "anyOf") {
            let variants: Vec<String> = variants.iter().map(|v| self.describe(v)).collect();
            return variants.join("; or ");
        }
        let mut text = match types(schema).next() {
            Some("object") => match schema.get("properties").and_then(Value::as_object) {
                Some(members) => {
                    let keys: Vec<&str> = members.keys().map(String::as_str).collect();
                    return format!("an object with the keys {}", keys.join(", "));
                }
                None => return "an object".to_owned(),
            },
            Some("array") => {
                let (least, most) = (schema.get("minItems"), schema.get("maxItems"));
                let count = match (least, most) {
                    (Some(least), Some(most)) if least == most => format!(" of {least}"),
                    (Some(least), _) => format!(" of at least {least}"),
                    _ => " of any number".to_owned(),
                };
                let item = schema.get("items").map(|item| self.describe(item));
                format!("an array{count}, each {}", item.unwrap_or_default())
            }
            Some("integer") => "an integer".to_owned(),
            Some("boolean") => "true or false".to_owned(),
            Some(other) => format!("a {other}"),
            None => "any value".to_owned(),
        };
        for (keyword, sign, _) in BOUNDS {
            if let Some(bound) = schema.get(keyword) {
                text += &format!(" {sign} {bound}");
            }
        }
        match place.get("description").and_then(Value::as_str) {
            Some(meaning) => {
                let meaning = meaning.split_whitespace().collect::<Vec<_>>().join(" ");
                let sentence = meaning.split(". ").next().unwrap_or_default();
                format!("{text} ({})", sentence.trim_end_matches('.'))
            }
            None => text,
        }
    }

    fn describe_variants(&self, variants: &[Value]) -> String {
        match variants.first().and_then(tag_of) {
            Some(tag) => format!("an object with {tag:?}: {}", names(variants, Some(tag))),
            None => names(variants, None),
        }
    }
}

/// Keyword, sign and test of every bound of a number.
type Bound = (&'static str, &'static str, fn(f64, f64) -> bool);
const BOUNDS: [Bound; 4] = [
    ("exclusiveMinimum", ">", |value, bound| value > bound),
    ("minimum", ">=", |value, bound| value >= bound),
    ("exclusiveMaximum", "<", |value, bound| value < bound),
    ("maximum", "<=", |value, bound| value <= bound),
];

fn branches<'a>(schema: &'a Value, keyword: &str) -> Option<&'a [Value]> {
    schema
        .get(keyword)
        .and_then(Value::as_array)
        .map(Vec::as_slice)
}

fn types(schema: &Value) -> impl Iterator<Item = &str> {
    let (one, many) = match schema.get("type") {
        Some(Value::Array(many)) => (None, many.as_slice()),
        one => (one, [].as_slice()),
    };
    one.into_iter().chain(many).filter_map(Value::as_str)
}

fn has_type(value: &Value, schema: &Value) -> bool {
    let mut types = types(schema).peekable();
    types.peek().is_none()
        || types.any(|name| match name {
            "null" => value.is_null(),
            "boolean" => value.is_boolean(),
            "integer" => integer(value).is_some(),
            "number" => value.is_number(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            _ => false,
        })
}

/// The bounds of a number, the length of an array, the value of a constant or of an enum without documented names.
fn in_range(value: &Value, schema: &Value) -> bool {
    let bound = |keyword| schema.get(keyword).and_then(Value::as_f64);
    let within = |number: f64| {
        BOUNDS
            .iter()
            .all(|(keyword, _, holds)| bound(*keyword).is_none_or(|bound| holds(number, bound)))
    };
    let length = value.as_array().map(|items| items.len() as f64);
    let is_only = |only: &Value| match (integer(only), integer(value)) {
        (Some(only), Some(value)) => only == value,
        _ => only == value,
    };
    schema.get("const").is_none_or(is_only)
        && branches(schema, "enum").is_none_or(|names| names.contains(value))
        && value.as_f64().is_none_or(within)
        && length.is_none_or(|n| bound("minItems").is_none_or(|least| n >= least))
        && length.is_none_or(|n| bound("maxItems").is_none_or(|most| n <= most))
}

/// A 32-bit integer, however it is written: 32 or 32.0.
fn integer(value: &Value) -> Option<u32> {
    let whole = |n: f64| {
        let is_whole = n.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&n);
        (is_whole && n.is_sign_positive()).then_some(n as u32)
    };
    match value.as_u64() {
        Some(n) => u32::try_from(n).ok(),
        None => value.as_f64().and_then(whole),
    }
}

/// Writes integers as such that were written like 32.0: types that expect an integer read nothing else.
pub(super) fn write_integers(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() => {
            if let Some(whole) = integer(value) {
                *value = whole.into();
            }
        }
        Value::Array(items) => items.iter_mut().for_each(write_integers),
        Value::Object(members) => members.values_mut().for_each(write_integers),
        _ => {}
    }
}

/// The key whose constant tells the variants of an enum apart.
fn tag_of(variant: &Value) -> Option<&str> {
    let members = variant.get("properties")?.as_object()?;
    let tag = members
        .iter()
        .find(|(_, member)| member.get("const").is_some());
    tag.map(|(key, _)| key.as_str())
}

/// The key by which objects of a schema are known: the tag of an enum, or the first key that is required.
fn first_key(schema: &Value) -> Option<&str> {
    match branches(schema, "oneOf") {
        Some(variants) => variants.first().and_then(tag_of),
        None => schema.get("required")?.get(0)?.as_str(),
    }
}

fn name_of<'a>(variant: &'a Value, tag: Option<&str>) -> Option<&'a Value> {
    match tag {
        Some(tag) => variant.get("properties")?.get(tag)?.get("const"),
        None => variant.get("const"),
    }
}

fn names(variants: &[Value], tag: Option<&str>) -> String {
    let names: Vec<String> = variants
        .iter()
        .filter_map(|variant| name_of(variant, tag))
        .map(shown)
        .collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A schema keyword that the walk ignores would be a rule that is documented but not enforced.
    #[test]
    fn every_keyword_of_the_schema_is_understood() {
        let structure = Structure::of_scenes();
        let definitions = structure.0["$defs"].as_object().expect("definitions");
        definitions
            .values()
            .chain([structure.schema()])
            .for_each(assert_understood);
    }

    fn assert_understood(schema: &Value) {
        for (keyword, content) in schema.as_object().into_iter().flatten() {
            match keyword.as_str() {
                "$schema" | "$defs" | "$ref" | "title" | "description" | "default" | "format" => {}
                "type" | "const" | "enum" | "required" | "minItems" | "maxItems" => {}
                "minimum" | "maximum" | "exclusiveMinimum" | "exclusiveMaximum" => {}
                "items" | "additionalProperties" => assert_understood(content),
                "properties" => {
                    let members = content.as_object().expect("an object");
                    members.values().for_each(assert_understood);
                }
                "anyOf" => content
                    .as_array()
                    .into_iter()
                    .flatten()
                    .for_each(assert_understood),
                "oneOf" => {
                    let variants = content.as_array().expect("an array");
                    let tag = variants.first().and_then(tag_of);
                    for variant in variants {
                        assert!(name_of(variant, tag).is_some(), "no name: {variant}");
                        assert_understood(variant);
                    }
                }
                other => panic!("the walk ignores {other}"),
            }
        }
    }
}
