//! `stickslip qvi`: the inequalities of the paper's class with exact solutions, their errors, orders and conditions.

use crate::console;
use crate::failure::Failure;
use std::fmt::Write;
use stickslip::qvi::examples::{Bar, Example, all};
use stickslip::qvi::{
    Inequality, Iterations, Quadrature, Record, Settings, SolveError, Solver, Verdict, solve,
};

const COUNTS: [usize; 5] = [10, 20, 40, 80, 160];
const CELLS: [usize; 4] = [8, 16, 32, 64];
const RULES: [Quadrature; 2] = [Quadrature::Trapezoid, Quadrature::Rectangle];

/// Prints the tables.
pub fn run() -> Result<(), Failure> {
    console::say(tables().map_err(Failure::Inequality)?.trim_end())
}

fn tables() -> Result<String, SolveError> {
    let mut text = String::from(
        "Largest error over the points of N steps on [0, 1], and the order between the last two.\n\n",
    );
    let examples = all()?;
    row(
        &mut text,
        "",
        &COUNTS.map(|count| format!("N = {count}")),
        "order",
    );
    for example in &examples {
        for rule in &RULES {
            errors(&mut text, example, rule)?;
        }
    }
    let about = examples.iter().map(|e| format!("{} {}", e.name, e.text));
    let _ = writeln!(text, "\n{}", about.collect::<Vec<_>>().join("\n"));
    bar(&mut text)?;
    text.push_str(
        "\nConditions for k = 0.1 by the trapezoid, with the fixed point of Theorem 3.1:\n\n",
    );
    let names = ["m", "L", "alpha", "beta", "c1"].map(str::to_owned);
    row(&mut text, "", &names, "(2.6)  (3.6)  k <     factor  seen");
    for example in &examples {
        conditions(&mut text, example.name, &example.problem)?;
    }
    Ok(text)
}

fn row(text: &mut String, name: &str, cells: &[String], last: &str) {
    let cells: String = cells.iter().map(|cell| format!("{cell:>11}")).collect();
    let _ = writeln!(text, "{name:<14}{cells}   {last}");
}

fn errors(text: &mut String, example: &Example, rule: &Quadrature) -> Result<(), SolveError> {
    let errors = COUNTS
        .iter()
        .map(|count| example.error(rule, *count, Solver::Direct))
        .collect::<Result<Vec<_>, _>>()?;
    let cells: Vec<_> = errors.iter().map(|error| format!("{error:.3e}")).collect();
    let order = (errors[3] / errors[4]).log2();
    let name = format!("{} {}", example.name, rule.name());
    row(text, &name, &cells, &format!("{order:.3}"));
    Ok(())
}

/// P7: space against time.
fn bar(text: &mut String) -> Result<(), SolveError> {
    text.push_str(
        "\nP7 bar with friction at its end: error in the norm of the strains, N = 8 and 32\n\n",
    );
    row(
        text,
        "",
        &CELLS.map(|cells| format!("h = 1/{cells}")),
        "order in h",
    );
    for (rule, steps) in [
        (&RULES[0], 8),
        (&RULES[0], 32),
        (&RULES[1], 8),
        (&RULES[1], 32),
    ] {
        let errors = CELLS
            .iter()
            .map(|cells| Bar::new(*cells)?.error(rule, steps))
            .collect::<Result<Vec<_>, _>>()?;
        let cells: Vec<_> = errors.iter().map(|error| format!("{error:.3e}")).collect();
        let order = (errors[2] / errors[3]).log2();
        let name = format!("{}, {steps}", rule.name());
        row(text, &name, &cells, &format!("{order:.3}"));
    }
    Ok(())
}

fn conditions(text: &mut String, name: &str, problem: &Inequality) -> Result<(), SolveError> {
    let solver = Solver::Lambda;
    let run = solve(problem, &RULES[0], (1.0, 10), Settings::new(solver))?;
    let iterations: &Iterations = &run.iterations;
    let record = Record::of(problem, (1.0, 0.1), solver, iterations)?;
    let c = &record.constants;
    let cells = [c.m, c.lipschitz, c.alpha, c.beta, c.c1].map(|c| format!("{:.4}", c.value));
    let held = |verdict: Verdict| match verdict {
        Verdict::Holds => "holds",
        Verdict::NotRefuted => "may",
        Verdict::Fails => "fails",
    };
    let conditions = &record.conditions;
    let last = format!(
        "{:<6} {:<6} {:<7.4} {:<7.4} {:.4}",
        held(conditions.uniqueness),
        held(conditions.step),
        conditions.largest_step,
        conditions.factor,
        record.contraction,
    );
    row(text, name, &cells, &last);
    for warning in &record.warnings {
        let _ = writeln!(text, "    {warning}");
    }
    Ok(())
}
