//! Rules of what the body starts with; whether it fits the clamped parts and the contact, the mesh knows.

use super::super::types::Scene;
use crate::expression::PlaceValue;
use crate::message::cut;
use crate::refusal::{Refusal, Verdict, ensure};

pub(super) fn check_initial(scene: &Scene, dimension: Option<usize>) -> Verdict {
    let path = "initial.displacement";
    let given = &scene.initial.displacement;
    let count = given.len();
    let is_possible = match dimension {
        Some(dimension) => count == dimension,
        None => matches!(count, 2 | 3),
    };
    ensure(given.is_empty() || is_possible, || {
        let dimension = dimension.map_or("2 or 3".to_owned(), |d| d.to_string());
        let allowed = format!("{dimension} components, one per dimension");
        Refusal::new(path, format!("{count} components"), allowed)
    })?;
    for (component, value) in given.iter().enumerate() {
        if let PlaceValue::Formula(formula) = value {
            formula.parse().map_err(|fault| {
                let path = format!("{path}[{component}].expression");
                let text = cut(&formula.expression);
                let found = format!("{text:?}: {} at character {}", fault.found, fault.position);
                Refusal::new(path, found, fault.allowed)
            })?;
        }
    }
    Ok(())
}
