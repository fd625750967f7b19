//! Scenes at the edges of what 64-bit numbers can express, judged by what must hold whatever the answer is, and by a solution
//! of the discrete problem in 96 digits. See docs/extremes.md.
//!
//! A fixed few scenes run with the tests. The long sweep: `EXTREMES=20000 cargo test --release --test extremes -- --nocapture`;
//! `EXTREMES_FROM` is the number of its first scene, and `EXTREMES_SHOW=1` prints every scene and every refusal.

mod case;
mod compare;
mod draw;
mod exact;
mod judge;
mod pressed;
mod random;
mod run;
mod table;
mod transform;
mod within;

use draw::draw;
use judge::Judge;
use run::run;
use table::{Outcome, Table};

/// Scenes of the sweep in the test command.
const FEW: u64 = 80;
/// The same of the scenes with pressure.
const FEW_PRESSED: u64 = 60;

fn number(variable: &str, default: u64) -> u64 {
    let text = std::env::var(variable).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn no_extreme_scene_is_answered_wrongly() {
    let (first, count) = (number("EXTREMES_FROM", 0), number("EXTREMES", FEW));
    let is_shown = std::env::var("EXTREMES_SHOW").is_ok();
    let mut table = Table::default();
    for i in first..first + count {
        let case = draw(i);
        if is_shown {
            println!("scene {i}: {}\n{:?}", case.json(), case.loads);
        }
        let base = run(&case);
        if let (true, Some(refusal)) = (is_shown, &base.refusal) {
            println!("REFUSED {i} in {}: {}", refusal.phase, refusal.text);
        }
        let judge = Judge::of(&case, &base);
        let mut names = vec![
            format!("model {}", case.model),
            format!("scheme {}", case.scheme),
        ];
        names.push(format!("{} {}D", case.element, case.dimension()));
        names.extend(case.extremes.iter().map(|name| format!("extreme {name}")));
        table.add(&Outcome {
            names,
            is_ordinary: case.extremes.is_empty(),
            findings: &judge.findings,
            is_told: judge.is_told(),
            refusal: base
                .refusal
                .as_ref()
                .map(|r| format!("{:?} in {}", r.code, r.phase)),
            is_exact: judge.exact.is_ok(),
            sensitive: judge.sensitive,
        });
        let mut told = Vec::new();
        for finding in &judge.findings {
            if !told.contains(&finding.oracle) {
                told.push(finding.oracle);
                println!(
                    "{} {i} {:?} {}D {} {} {:?}: {}: {:.1e} > {:.1e}: {}",
                    if judge.is_told() { "TOLD" } else { "WRONG" },
                    case.extremes,
                    case.dimension(),
                    case.model,
                    case.scheme,
                    case.law,
                    finding.oracle,
                    finding.error,
                    finding.allowed,
                    finding.detail
                );
            }
        }
    }
    println!("{table}");
    assert_eq!(table.wrong(), 0, "{table}");
    assert_eq!(table.refused_ordinary(), 0, "{table}");
    // a sweep that is refused shows nothing
    assert!(table.refused() <= count / 3, "{table}");
}

#[test]
fn no_extreme_scene_with_pressure_is_answered_wrongly() {
    let (first, count) = (number("EXTREMES_FROM", 0), number("EXTREMES", FEW_PRESSED));
    let is_shown = std::env::var("EXTREMES_SHOW").is_ok();
    let mut table = Table::default();
    for i in first..first + count {
        pressed::judge(i, is_shown, &mut table);
    }
    println!("{table}");
    assert_eq!(table.wrong(), 0, "{table}");
    // `reduced` may be out of reach of its tolerance
    assert!(table.refused_ordinary() <= count / 100, "{table}");
    assert!(table.refused() <= count / 3, "{table}");
}
