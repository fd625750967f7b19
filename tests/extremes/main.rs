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
mod random;
mod run;
mod table;
mod transform;
mod within;

use draw::draw;
use judge::Judge;
use run::run;
use table::Table;

/// Scenes of the sweep in the test command.
const FEW: u64 = 80;

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
        table.add(&judge);
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
