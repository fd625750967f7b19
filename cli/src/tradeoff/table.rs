//! What is printed: the reference, the settings measured, and what was not.

use super::clock::Budget;
use super::estimate::MEMORY;
use super::plan::Batch;
use super::point::{Group, Point, front, milestones};
use super::survey::{Survey, gigabytes};
use crate::closing::{RULED, trimmed, two_columns};
use comfy_table::{CellAlignment, Table};
use stickslip::tradeoff::{Level, MARGIN, Quantity, Reference, Setting};

/// The finest level, its uncertainty and the limit below which errors are not figures.
pub fn reference(name: &str, reference: &Reference) -> String {
    let differences = |levels: &[Level], place: fn(&Level) -> String| {
        let shown = levels.iter().map(|level| {
            let difference = level.difference.and_then(|d| d.of(Quantity::SlipRate));
            match difference {
                Some(d) => format!("{} ({d:.1e})", place(level)),
                None => place(level),
            }
        });
        shown.collect::<Vec<_>>().join(", ")
    };
    let mut rows = vec![
        (
            "meshes",
            format!(
                "{} nodes (difference in slip rate)",
                differences(reference.space(), |l| l.mesh_nodes.to_string())
            ),
        ),
        (
            "steps",
            format!(
                "{} s",
                differences(reference.time(), |l| l.step.to_string())
            ),
        ),
    ];
    for quantity in Quantity::ALL {
        let text = match reference.uncertainty(quantity) {
            None => "zero in the reference: not compared".to_owned(),
            Some(u) if u.is_infinite() => {
                "unknown: its levels do not approach each other".to_owned()
            }
            Some(u) => format!("{u:.1e}; errors are figures from {:.1e}", MARGIN * u),
        };
        rows.push((quantity.name(), text));
    }
    two_columns(&format!("{name}: reference, and what is left in it"), rows)
}

/// The settings; of the joint ones those that are well apart on the Pareto front of the slip rate.
pub fn settings(points: &[Point]) -> String {
    let front = front(points, &[Quantity::SlipRate]);
    let is_on_front = |p: &Point| front.iter().any(|on| std::ptr::eq(*on, p));
    let mut table = Table::new();
    table.load_style(RULED);
    table.set_header([
        "",
        "setting",
        "slip rate",
        "stress",
        "displ.",
        "force",
        "set-up s",
        "step us",
        "ms per s",
        "states",
        "contact",
        "model kB",
        "state kB",
        "iter.",
    ]);
    let named = milestones(points, Quantity::SlipRate);
    let is_named = |p: &Point| named.iter().any(|on| std::ptr::eq(*on, p));
    let shown = |p: &&Point| p.group != Group::Joint || is_named(p);
    for point in points.iter().filter(shown) {
        let mut row = vec![
            if is_on_front(point) { "*" } else { "" }.to_owned(),
            point.label(),
        ];
        row.extend(
            Quantity::ALL.map(|quantity| match point.verdict.of(quantity) {
                None => "-".to_owned(),
                Some(measured) => match measured.figure() {
                    Some(error) => format!("{error:.1e}"),
                    None => format!("<{:.1e}", measured.bound()),
                },
            }),
        );
        row.extend([
            format!("{:.4}", point.setup.as_secs_f64()),
            format!("{:.1}", 1e6 * point.per_step()),
            format!("{:.3}", 1e3 * point.cost()),
            point.states.to_string(),
            point.contact_nodes.to_string(),
            point.model_bytes.div_ceil(1024).to_string(),
            point.state_bytes.div_ceil(1024).to_string(),
            format!("{:.1}", point.iterations_per_step()),
        ]);
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let hidden = points.iter().filter(|p| !shown(p)).count();
    format!(
        "{}\n\
         Relative errors over the contact and the communication points that all settings share (stress: L1, others: L2). \
         \"<\": less than {MARGIN} times\nwhat is left in the reference; the bound adds that to the difference. Step: one \
         internal step; ms per s: steps of one second of the\nscene; one thread, fastest of a few. * on the Pareto front of the \
         error in slip rate and the cost per second{}.",
        trimmed(&table),
        match hidden {
            0 => String::new(),
            _ => format!(
                "; joint settings have friction to 1e-4 and are reduced to 1e-4 or the next\ntolerance that will do; {hidden} more of them, behind the front or close to a neighbour on it, are in the CSV only"
            ),
        }
    )
}

/// What did not fit, and what cannot be had.
pub fn left_out(survey: &Survey, budget: &Budget) -> String {
    let mut lines = vec![format!(
        "{} settings measured in {:.1} s of {}",
        survey.points.len(),
        budget.seconds_spent(),
        budget.words()
    )];
    let labels = |batches: &[Batch], more: fn(&Batch) -> String| {
        let label = |batch: &Batch| {
            let steps = match batch.ladders.is_empty() {
                true => "",
                false => " with its steps",
            };
            format!("{}{steps}{}", words(&batch.setting), more(batch))
        };
        batches.iter().map(label).collect::<Vec<_>>().join("; ")
    };
    if !survey.skipped.is_empty() {
        lines.push(format!(
            "not measured, because it did not fit the budget: {}",
            labels(&survey.skipped, |_| String::new())
        ));
    }
    if !survey.too_large.is_empty() {
        lines.push(format!(
            "not compiled, because by estimate it takes more than {}: {}",
            gigabytes(MEMORY),
            labels(&survey.too_large, |b| format!(
                " ({})",
                gigabytes(b.estimate.bytes)
            ))
        ));
    }
    for (setting, why) in &survey.refused {
        lines.push(format!("not to be had: {}: {why}", words(setting)));
    }
    lines.join("\n")
}

/// The changes of a setting.
fn words(setting: &Setting) -> String {
    let changes = setting.changes().iter().map(|(p, v)| format!("{p}={v}"));
    changes.collect::<Vec<_>>().join(" ")
}
