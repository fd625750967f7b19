//! The closing table of a run: what was compiled, what guarantees it, what it cost and how well it was solved.

use crate::course::{Effort, Frame, Multiplicity};
use comfy_table::{LineStyle, Table, TableStyle, presets};
use serde_json::{Value, json};
use std::time::Duration;
use stickslip::Model;
use stickslip::fem::ContactPart;
use stickslip::message::{escaped, number};
use stickslip::model::Summary;
use stickslip::scene::ModelKind;
use stickslip::tradeoff::{Quantity, Selection, Verdict};

/// What is watched along the way.
pub struct Closing {
    setup: Duration,
    /// Largest energy turned over so far, J.
    turnover: f64,
    /// Largest error of the energy balance, J.
    balance: f64,
    /// Least and most of the contact that stuck, by nodes.
    stick: (f64, f64),
    /// Largest slip rate, m/s, and when.
    fastest: (f64, f64),
    end: f64,
}

impl Closing {
    pub fn new(setup: Duration) -> Closing {
        Closing {
            setup,
            turnover: 0.0,
            balance: 0.0,
            stick: (1.0, 0.0),
            fastest: (0.0, 0.0),
            end: 0.0,
        }
    }

    /// Takes a communication point into account.
    pub fn watch(&mut self, frame: &Frame) {
        let e = &frame.energy;
        let turned = e
            .external_work
            .abs()
            .max(e.elastic + e.viscous + e.friction);
        self.turnover = self.turnover.max(turned);
        self.balance = self.balance.max(e.balance_error.abs());
        let share = frame.stick.iter().sum::<f64>() / frame.stick.len().max(1) as f64;
        self.stick = (self.stick.0.min(share), self.stick.1.max(share));
        let components = frame.slip_rate.len() / frame.stick.len().max(1);
        let rates = frame.slip_rate.chunks(components.max(1));
        let rate = rates
            .map(|w| w.iter().map(|v| v * v).sum::<f64>().sqrt())
            .fold(0.0, f64::max);
        if rate > self.fastest.0 {
            self.fastest = (rate, frame.time);
        }
        self.end = frame.time;
    }

    /// Energy balance relative to the energy turned over.
    fn relative_balance(&self) -> f64 {
        if self.turnover > 0.0 {
            self.balance / self.turnover
        } else {
            self.balance
        }
    }

    /// What the table says, as JSON; numbers that are not known are null.
    pub fn json(&self, model: &Model, effort: &Effort) -> Value {
        let (summary, c) = (model.summary(), model.certificate());
        let errors = summary.reduction.as_ref().map(|record| record.achieved);
        json!({
            "name": summary.name,
            "version": env!("CARGO_PKG_VERSION"),
            "scene": serde_json::to_value(model.scene()).unwrap_or_default(),
            "model": {
                "kind": kind(summary.kind),
                "dimension": summary.dimension,
                "mesh_nodes": summary.mesh_nodes,
                "mesh_cells": summary.mesh_cells,
                "contact_nodes": model.contact().node_count(),
                "free_dofs": summary.free_dofs,
                "states": model.states(),
                "reduction_error": errors,
                "fallback": summary.fallback,
                "lost_digits": summary.lost_digits,
                "fingerprint": format!("{:016x}", model.fingerprint()),
            },
            "certificate": {
                "is_step_unique": c.is_step_unique(),
                "is_theorem_satisfied": c.is_theorem_satisfied(),
                "largest_pressure": c.coulomb.as_ref().map(|_| c.largest_pressure()).filter(|p| p.is_finite()),
                "stability_limit": model.stability_limit(),
            },
            "set_up_seconds": self.setup.as_secs_f64(),
            "stepping_seconds": effort.stepping.as_secs_f64(),
            "end": self.end,
            "internal_steps": effort.internal_steps,
            "refused_pairs": effort.refused_pairs,
            "communication_steps": effort.iterations.len(),
            "mean_iterations": effort.mean_iterations(),
            "most_iterations": effort.most_iterations(),
            "friction_residual": effort.residual,
            "steps_at_rounding": effort.at_rounding,
            "steps_with_lost_digits": effort.lossy,
            "steps_with_several_solutions": effort.multiplicity.map(|found| found.steps),
            "error_estimate": effort.error_estimate,
            "energy_balance_error": self.relative_balance(),
            "energy_turned_over": self.turnover,
            "stick_fraction": [self.stick.0, self.stick.1],
            "largest_slip_rate": self.fastest.0,
            "largest_slip_rate_at": self.fastest.1,
        })
    }

    pub fn table(&self, model: &Model, effort: &Effort) -> String {
        let summary = model.summary();
        let mut rows = compiled(summary, model);
        rows.extend(certificate(model));
        let per_step = effort.stepping.as_secs_f64() / effort.internal_steps.max(1) as f64;
        rows.push((
            "set-up",
            format!("{:.2} ms", 1e3 * self.setup.as_secs_f64()),
        ));
        rows.push((
            "steps",
            format!(
                "{} to t = {} s, {:.4} ms each ({:.2} ms in all)",
                effort.internal_steps,
                number(self.end),
                1e3 * per_step,
                1e3 * effort.stepping.as_secs_f64()
            ),
        ));
        if let Some(tolerance) = model.scene().time.tolerance {
            rows.push((
                "step control",
                format!(
                    "tolerance {tolerance:e}; {} pairs of steps undone",
                    effort.refused_pairs
                ),
            ));
        }
        rows.push((
            "friction iterations",
            format!(
                "mean {:.2} per step, most {} in a communication step",
                effort.mean_iterations(),
                effort.most_iterations()
            ),
        ));
        rows.push((
            "friction residual",
            match effort.at_rounding {
                0 => format!("{:.1e} at most", effort.residual),
                steps => format!(
                    "{:.1e} at most; in {steps} steps rounding allows for no tolerance of {:.1e}",
                    effort.residual,
                    model.scene().fidelity.friction_tolerance
                ),
            },
        ));
        if effort.truncated > 0 {
            rows.push((
                "work limit",
                format!(
                    "ended {} of {} communication steps before the friction law held to {:.1e}",
                    effort.truncated,
                    effort.iterations.len(),
                    model.scene().fidelity.friction_tolerance
                ),
            ));
        }
        if effort.lossy > 0 {
            rows.push((
                "lost digits",
                format!(
                    "in {} of {} communication steps displacement and slip lost up to {:.1e} to rounding, by estimate: stress and \
                     energies may be off by some times that, beyond the tolerance of {:.1e}; backward_euler keeps the digits",
                    effort.lossy,
                    effort.iterations.len(),
                    effort.lost_digits,
                    model.scene().fidelity.tolerance
                ),
            ));
        }
        if let Some(found) = effort.multiplicity {
            rows.push(("several solutions", several(found, effort.iterations.len())));
        }
        if let Some(estimate) = effort.error_estimate {
            rows.push((
                "error in time",
                format!("{estimate:.1e} of the largest slip rate, at most, by estimate"),
            ));
        }
        rows.push((
            "energy balance",
            format!(
                "{:.1e} of the energy turned over, {:.3e} J",
                self.relative_balance(),
                self.turnover
            ),
        ));
        rows.push((
            "contact",
            format!(
                "{:.0} % to {:.0} % of the nodes stick; fastest slip {:.3e} m/s at t = {} s",
                100.0 * self.stick.0,
                100.0 * self.stick.1,
                self.fastest.0,
                number(self.fastest.1)
            ),
        ));
        two_columns(&summary.name, rows)
    }
}

/// What the test for several solutions found in that many communication steps.
fn several(found: Multiplicity, steps: usize) -> String {
    match found.steps {
        0 => format!("none seen in {steps} communication steps"),
        count => format!(
            "seen in {count} of {steps} communication steps, slip rates up to {:.3e} m/s apart; the run follows one of them",
            found.gap
        ),
    }
}

/// How many contact nodes there are, and of several contacts on which.
fn contact_nodes(model: &Model) -> String {
    let contact = model.contact();
    let count = contact.node_count().to_string();
    if contact.parts.len() == 1 {
        return count;
    }
    let of = |part: &ContactPart| format!("{} on {}", part.nodes.len(), part.name);
    let parts: Vec<String> = contact.parts.iter().map(of).collect();
    format!("{count}: {}", parts.join(", "))
}

/// What was compiled.
pub fn compiled(summary: &Summary, model: &Model) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        (
            "mesh",
            format!(
                "{} nodes, {} cells, {}D",
                summary.mesh_nodes, summary.mesh_cells, summary.dimension
            ),
        ),
        (
            "dofs",
            format!(
                "{} free ({} counted with contact multipliers)",
                summary.free_dofs, summary.dofs_with_multipliers
            ),
        ),
        ("contact nodes", contact_nodes(model)),
        (
            "model",
            format!(
                "{}, {} states, {} kB",
                kind(summary.kind),
                model.states(),
                summary.bytes.div_ceil(1024)
            ),
        ),
    ];
    if let Some(record) = &summary.reduction {
        let shifts: Vec<_> = record.shifts.iter().map(|s| format!("{s:.3}")).collect();
        rows.push((
            "reduction",
            format!(
                "shifts {} 1/s; relative error {:.1e}",
                shifts.join(", "),
                record.achieved
            ),
        ));
    }
    if let Some(why) = &summary.fallback {
        rows.push(("auto", format!("no reduced model: {why}")));
    }
    rows.push((
        "rounding",
        format!(
            "{:.1e} of the response of the body, by estimate (fidelity.tolerance {:.1e})",
            summary.lost_digits,
            model.scene().fidelity.tolerance
        ),
    ));
    if let Some(selection) = &summary.selection {
        rows.push(("target error", target(selection)));
    }
    rows
}

/// What was picked for a target, and what was measured of it.
fn target(selection: &Selection) -> String {
    let error = |quantity: Quantity| {
        let measured = Verdict::from(selection).of(quantity)?;
        Some(match measured.figure() {
            Some(error) => format!("{} {error:.1e}", quantity.name()),
            None => format!("{} below {:.1e}", quantity.name(), measured.bound()),
        })
    };
    let errors: Vec<_> = Quantity::ALL.into_iter().filter_map(error).collect();
    let changes: Vec<_> = selection
        .changes
        .iter()
        .map(|(p, v)| format!("{p}={v}"))
        .collect();
    format!(
        "{}: picked {} of {} settings; errors: {}",
        selection.target,
        changes.join(" "),
        selection.tried,
        errors.join(", ")
    )
}

/// The certificate in two rows, and the stability limit where there is one.
pub fn certificate(model: &Model) -> Vec<(&'static str, String)> {
    let c = model.certificate();
    let verdict = |holds: bool, relation: &str| {
        let word = if holds { "unique" } else { "not guaranteed" };
        format!("{word}: {relation}")
    };
    let (product, sign) = (
        c.c0_squared * c.l_g,
        if c.is_theorem_satisfied() { "<" } else { ">=" },
    );
    let sharp = if c.is_step_unique() { ">" } else { "<=" };
    if let Some(coulomb) = &c.coulomb {
        let relation = match c.largest_pressure() {
            f64::INFINITY => format!("mu_max c = {} < 1", figure(coulomb.strength(), 4)),
            0.0 => format!("mu_max c = {}", figure(coulomb.strength(), 4)),
            pressure => format!("at pressures below {} Pa only", figure(pressure, 4)),
        };
        let at = number(model.largest_step());
        let text = verdict(c.is_step_unique(), &format!("{relation} at {at} s"));
        return vec![("step", text)];
    }
    let mut rows = vec![
        (
            "Theorem 5.3",
            verdict(
                c.is_theorem_satisfied(),
                &format!(
                    "c0² L_g = {} {sign} m_A = {} Pa s",
                    figure(product, 4),
                    figure(c.m_a, 4)
                ),
            ),
        ),
        (
            "step",
            verdict(
                c.is_step_unique(),
                &format!(
                    "{} {sharp} L_g = {} Pa s/m at {} s",
                    figure(c.sharp_step, 4),
                    figure(c.l_g, 4),
                    number(model.largest_step())
                ),
            ),
        ),
    ];
    if let Some(limit) = model.stability_limit() {
        rows.push(("stability limit", format!("{} s", figure(limit, 6))));
    }
    rows
}

/// The stability limit of an explicit scheme whose step is beyond it, s.
pub fn exceeded_limit(model: &Model) -> Option<f64> {
    let limit = model.stability_limit();
    limit.filter(|limit| model.largest_step() > *limit)
}

/// Name of a kind of model, as scenes write it.
fn kind(kind: ModelKind) -> &'static str {
    match kind {
        ModelKind::Full => "full",
        ModelKind::Condensed => "condensed",
        ModelKind::Reduced => "reduced",
        ModelKind::Auto => "auto",
    }
}

/// A figure with a number of decimals, or with an exponent where these would show nothing of it or too much.
pub fn figure(value: f64, decimals: usize) -> String {
    if value == 0.0 || (1e-3..1e7).contains(&value.abs()) {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.decimals$e}")
    }
}

/// A table of names and values under a title.
pub fn two_columns(title: &str, rows: Vec<(&'static str, String)>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    for (name, value) in rows {
        table.add_row(vec![name.to_owned(), value]);
    }
    format!("{}\n{}", escaped(title), trimmed(&table))
}

/// Lines above and below the header and at the end.
pub const RULED: TableStyle = TableStyle::new()
    .top_border(RULE)
    .header_separator(RULE)
    .bottom_border(RULE);
const RULE: LineStyle = LineStyle::none().fill('─').junction('─');

/// The lines of a table without trailing blanks.
pub fn trimmed(table: &Table) -> String {
    let lines: Vec<_> = table.lines().map(|l| l.trim_end().to_owned()).collect();
    lines.join("\n")
}
