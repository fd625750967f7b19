//! `PATH=VALUE` overrides of the command line, applied to the JSON value before its structure is checked.

use super::parse::parse;
use super::path::{Path, Segment};
use super::structure::Structure;
use crate::message::cut;
use crate::refusal::{Refusal, shown};
use serde_json::Value;

/// Puts `text` (JSON if it parses, else a string) at `path`.
///
/// The last key of the path may be new: whether the scene knows it is for the structure check to say. An object that
/// the scene may omit (`fidelity`) is filled in with its default.
pub(super) fn apply(
    value: &mut Value,
    structure: &Structure,
    path: &str,
    text: &str,
) -> Result<(), Refusal> {
    let Some(Path(segments)) = Path::parse(path) else {
        let allowed = "keys separated by dots, array indices in brackets: loads[0].start";
        return Err(Refusal::new(cut(path), "a malformed path", allowed));
    };
    let new = parse(text).unwrap_or_else(|_| Value::from(text));
    let mut here = value;
    for (depth, segment) in segments.iter().enumerate() {
        let parent = Path(segments[..depth].to_vec());
        let is_last = depth + 1 == segments.len();
        here = match (segment, here) {
            (Segment::Key(key), Value::Object(object)) => {
                if !object.contains_key(key) {
                    let default = structure.default_object(&segments[..=depth]);
                    match default {
                        _ if is_last => object.insert(key.clone(), Value::Null),
                        Some(default) => object.insert(key.clone(), default.clone()),
                        None => {
                            let found = format!("nothing at {}", parent.key(key));
                            let keys: Vec<&str> = object.keys().map(String::as_str).collect();
                            let allowed = format!("the present keys {}", cut(&keys.join(", ")));
                            return Err(Refusal::new(cut(path), found, allowed));
                        }
                    };
                }
                object.entry(key.as_str()).or_insert(Value::Null)
            }
            (Segment::Index(index), Value::Array(items)) => {
                let count = items.len();
                match items.get_mut(*index) {
                    Some(item) => item,
                    None => {
                        let found = format!("nothing at {}", parent.index(*index));
                        let allowed = format!("an index below {count}");
                        return Err(Refusal::new(cut(path), found, allowed));
                    }
                }
            }
            (segment, other) => {
                let allowed = match segment {
                    Segment::Key(key) => format!("an object with the key {}", cut(key)),
                    Segment::Index(_) => "an array".to_owned(),
                };
                let found = format!("{} at {parent}", shown(other));
                return Err(Refusal::new(cut(path), found, allowed));
            }
        };
    }
    *here = new;
    Ok(())
}
