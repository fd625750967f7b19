//! Scenes at the edges of what floating point can express, judged by what must hold whatever the answer is.
//!
//! `EXTREMES=20000 cargo test --release --test extremes -- --nocapture` sweeps as many scenes; without the variable a fixed
//! few. `EXTREMES_FROM` is the number of the first.

mod case;
mod compare;
mod draw;
mod exact;
mod oracles;
mod random;
mod run;

use draw::draw;
use oracles::Judge;
use run::run;
use std::collections::BTreeMap;

fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable)
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(default)
}

#[test]
fn no_extreme_scene_is_answered_wrongly() {
    let (first, count) = (number("EXTREMES_FROM", 0), number("EXTREMES", 60));
    let (mut right, mut sensitive) = (0, 0);
    let mut refused: BTreeMap<String, u64> = BTreeMap::new();
    let mut exact: BTreeMap<String, u64> = BTreeMap::new();
    let mut wrong: BTreeMap<String, u64> = BTreeMap::new();
    for i in first..first + count {
        let case = draw(i);
        if std::env::var("EXTREMES_SHOW").is_ok() {
            println!("{}\n{:?}", case.json(), case.loads);
        }
        let base = run(&case);
        if let Some(refusal) = &base.refusal {
            *refused
                .entry(format!("{:?} in {}", refusal.code, refusal.phase))
                .or_default() += 1;
            if std::env::var("EXTREMES_REFUSALS").is_ok() {
                println!(
                    "REFUSED {i} {:?} {} {}: {}",
                    case.extremes, case.model, case.scheme, refusal.text
                );
            }
        }
        let judge = Judge::judge(&case, &base);
        sensitive += judge.sensitive;
        *exact.entry(format!("{:?}", judge.exact)).or_default() += 1;
        if judge.findings.is_empty() {
            right += 1;
            continue;
        }
        let mut seen = Vec::new();
        for finding in &judge.findings {
            if seen.contains(&finding.oracle) {
                continue;
            }
            seen.push(finding.oracle);
            *wrong.entry(finding.oracle.into()).or_default() += 1;
            println!(
                "WRONG {i} {:?} {}D {} {} {:?} ft {:.0e}: {}: {:.1e} > {:.1e}: {}",
                case.extremes,
                case.dimension(),
                case.model,
                case.scheme,
                case.law,
                case.friction_tolerance,
                finding.oracle,
                finding.error,
                finding.allowed,
                finding.detail
            );
        }
    }
    println!(
        "{count} scenes, {right} without a finding, {sensitive} comparisons too sensitive\nexact {exact:#?}\nrefused {refused:#?}\nwrong {wrong:#?}"
    );
    assert!(wrong.is_empty(), "{wrong:?}");
}
