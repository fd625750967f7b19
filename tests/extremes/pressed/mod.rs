//! The second sweep: contact with a pressure and everything around it, judged by what must hold whatever the answer is.

mod case;
mod distance;
mod draw;
mod drive;
mod friction;
mod json;
mod judge;
mod run;
mod transform;
mod units;
mod within;

pub use judge::Judge;

use crate::table::{Outcome, Table};
use friction::Coefficient;
use run::run;

/// Draws, runs and judges scene `number`; what is wrong is printed.
pub fn judge(number: u64, is_shown: bool, table: &mut Table) {
    let case = draw::draw(number);
    if is_shown {
        println!("scene {number}: {}\n{:?}", case.json(), case.inputs());
    }
    let base = run(&case);
    if let (true, Some(refusal)) = (is_shown, &base.refusal) {
        println!("REFUSED {number} in {}: {}", refusal.phase, refusal.text);
    }
    let judge = Judge::of(&case, &base);
    let mut names: Vec<String> = case
        .extremes
        .iter()
        .map(|name| format!("extreme {name}"))
        .collect();
    names.push(format!("model {}", case.model));
    names.push(format!("scheme {}", case.scheme));
    names.push(format!("{} {}D", case.element, case.dimension()));
    for contact in &case.contacts {
        names.push(format!("condition {}", condition(&contact.condition)));
        names.push(format!(
            "friction {}",
            friction(contact.friction.coefficient())
        ));
        if !contact.foundation.is_empty() {
            names.push("moving foundation".into());
        }
    }
    for (name, applies) in [
        ("two contacts", case.contacts.len() == 2),
        (
            "driven part",
            matches!(case.held, case::Held::Driven { .. }),
        ),
        (
            "memory",
            case.materials.iter().any(|m| !m.memory.is_empty()),
        ),
        ("regions", case.materials.len() == 2),
        ("not linear", case.is_nonlinear()),
    ] {
        if applies {
            names.push(name.into());
        }
    }
    names.sort_unstable();
    names.dedup();
    table.add(&Outcome {
        names,
        is_ordinary: case.extremes.is_empty(),
        findings: &judge.findings,
        is_told: judge.is_told(),
        refusal: base
            .refusal
            .as_ref()
            .map(|r| format!("{:?} in {}", r.code, r.phase)),
        is_exact: false,
        sensitive: judge.sensitive,
    });
    let mut told = Vec::new();
    for finding in &judge.findings {
        if !told.contains(&finding.oracle) {
            told.push(finding.oracle);
            println!(
                "{} {number} {:?} {}D {} {}: {}: {:.1e} > {:.1e}: {}",
                if judge.is_told() { "TOLD" } else { "WRONG" },
                case.extremes,
                case.dimension(),
                case.model,
                case.scheme,
                finding.oracle,
                finding.error,
                finding.allowed,
                finding.detail
            );
        }
    }
}

fn condition(condition: &case::Condition) -> &'static str {
    match condition {
        case::Condition::Bilateral => "bilateral",
        case::Condition::Unilateral(_) => "unilateral",
        case::Condition::Compliance { .. } => "compliance",
    }
}

fn friction(coefficient: &Coefficient) -> &'static str {
    match coefficient {
        Coefficient::Number(_) => "number",
        Coefficient::Exponential { .. } => "exponential",
        Coefficient::Stribeck { .. } => "stribeck",
        Coefficient::Weakening { .. } => "slip_weakening",
        Coefficient::Creeping { .. } => "rate_and_state",
    }
}
