//! The estimated error in time over the true one: equal steps, against steps at least sixteen times smaller.

use super::{Outcome, common};
use common::{pad_course, paper_course, seal_course, swinging_course};
use serde_json::{Map, Value, json};

/// Internal steps per communication step.
const PARTS: [u32; 4] = [4, 8, 16, 32];

pub fn measure(course: &str) -> Outcome {
    let course = match course {
        "paper" => paper_course(),
        "swinging" => swinging_course(),
        "pad" => pad_course(),
        "seal" => seal_course(),
        other => return Err(format!("no course {other}").into()),
    };
    let fine = course.run_equal(16 * PARTS[PARTS.len() - 1], &[]);
    let mut ratios = Map::new();
    for parts in PARTS {
        let run = course.run_equal(parts, &[("time.error_estimate", "true")]);
        let found = run.effectivities(&fine);
        let range = [f64::INFINITY, f64::NEG_INFINITY];
        let range = found
            .iter()
            .fold(range, |[low, high], &e| [low.min(e), high.max(e)]);
        let largest = common::largest(&run.errors(&fine));
        ratios.insert(
            parts.to_string(),
            json!({"lowest": range[0], "highest": range[1], "points": found.len(), "error": largest}),
        );
    }
    Ok(Value::Object(ratios))
}
