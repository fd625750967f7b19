//! Text to JSON value, refusing what `serde_json::Value` would let pass (duplicate keys), and naming the JSON path at
//! which the text breaks.

use super::path::{Path, Segment};
use crate::message::cut;
use crate::refusal::Refusal;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;

/// Reads one JSON value, and nothing after it. A byte-order mark before it is skipped.
pub(super) fn parse(text: &str) -> Result<Value, Refusal> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut place = Place::default();
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = Strict(&mut place)
        .deserialize(&mut deserializer)
        .and_then(|value| deserializer.end().map(|()| value));
    value.map_err(|error| refusal(text, &place, &error))
}

/// Where the reader is. After an error: where the error is.
#[derive(Default)]
struct Place {
    path: Path,
    is_duplicate: bool,
}

fn refusal(text: &str, place: &Place, error: &serde_json::Error) -> Refusal {
    let position = format!("line {} column {}", error.line(), error.column());
    if place.is_duplicate {
        let found = format!("this key a second time ({position})");
        return Refusal::new(&place.path, found, "each key once");
    }
    let token = token_at(text, error.line(), error.column());
    if token.parse::<f64>().is_ok_and(|number| !number.is_finite()) {
        let found = format!("{} ({position})", cut(token));
        return Refusal::new(&place.path, found, "a finite number");
    }
    let message = error.to_string();
    let cause = message.split(" at line ").next().unwrap_or(&message);
    Refusal::new(
        &place.path,
        format!("invalid JSON at {position}: {cause}"),
        "valid JSON",
    )
}

/// The number or bare word that contains or ends at a position of the text (lines and columns from 1, columns in bytes).
fn token_at(text: &str, line: usize, column: usize) -> &str {
    let line = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let belongs = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-.".contains(byte);
    let (before, after) = line
        .as_bytes()
        .split_at(column.saturating_sub(1).min(line.len()));
    let start = before.len() - before.iter().rev().take_while(|b| belongs(b)).count();
    let end = before.len() + after.iter().take_while(|b| belongs(b)).count();
    line.get(start..end).unwrap_or_default()
}

/// Reads a value; on an error `Place` stays where it happened.
struct Strict<'a>(&'a mut Place);

impl<'de> DeserializeSeed<'de> for Strict<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Strict<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut array = Vec::new();
        loop {
            self.0.path.0.push(Segment::Index(array.len()));
            let Some(item) = items.next_element_seed(Strict(&mut *self.0))? else {
                break;
            };
            self.0.path.0.pop();
            array.push(item);
        }
        self.0.path.0.pop();
        Ok(array.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            self.0.path.0.push(Segment::Key(key.clone()));
            if object.contains_key(&key) {
                self.0.is_duplicate = true;
                return Err(A::Error::custom("duplicate key"));
            }
            let value = entries.next_value_seed(Strict(&mut *self.0))?;
            self.0.path.0.pop();
            object.insert(key, value);
        }
        Ok(object.into())
    }
}
