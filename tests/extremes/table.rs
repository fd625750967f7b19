//! What became of the scenes of a sweep, by what was driven to an extreme.

use crate::judge::Finding;
use std::collections::BTreeMap;
use std::fmt::{self, Display};

/// Scenes of one kind.
#[derive(Debug, Default, Clone)]
struct Row {
    scenes: u64,
    /// Ran to their end and every oracle holds.
    right: u64,
    /// Refused with an error before or in a step, nothing wrong before.
    refused: u64,
    wrong: u64,
    /// Some oracle does not hold, and a step said that it lost digits.
    told: u64,
    /// A step said so, and yet all holds.
    cautious: u64,
    /// Compared with the solution in 96 digits.
    exact: u64,
}

#[derive(Default)]
pub struct Table {
    rows: BTreeMap<String, Row>,
    refusals: BTreeMap<String, u64>,
    findings: BTreeMap<&'static str, u64>,
    sensitive: usize,
}

/// What became of one scene.
pub struct Outcome<'a> {
    /// Rows in which it counts.
    pub names: Vec<String>,
    pub is_ordinary: bool,
    pub findings: &'a [Finding],
    /// Whether a step said that it lost digits.
    pub is_told: bool,
    pub refusal: Option<String>,
    /// Whether it was compared with the solution in 96 digits.
    pub is_exact: bool,
    /// Comparisons left out.
    pub sensitive: usize,
}

impl Table {
    pub fn add(&mut self, outcome: &Outcome) {
        let mut names = vec!["all"];
        names.extend(outcome.names.iter().map(String::as_str));
        if outcome.is_ordinary {
            names.push("nothing extreme");
        }
        for name in names {
            let row = self.rows.entry(name.to_owned()).or_default();
            row.scenes += 1;
            row.exact += u64::from(outcome.is_exact);
            if !outcome.findings.is_empty() {
                if outcome.is_told {
                    row.told += 1;
                } else {
                    row.wrong += 1;
                }
            } else if outcome.refusal.is_some() {
                row.refused += 1;
            } else {
                row.right += 1;
                row.cautious += u64::from(outcome.is_told);
            }
        }
        if let Some(refusal) = &outcome.refusal {
            *self.refusals.entry(refusal.clone()).or_default() += 1;
        }
        let mut oracles: Vec<&'static str> = outcome.findings.iter().map(|f| f.oracle).collect();
        oracles.sort_unstable();
        oracles.dedup();
        for oracle in oracles {
            *self.findings.entry(oracle).or_default() += 1;
        }
        self.sensitive += outcome.sensitive;
    }

    /// Scenes that are wrong and do not say so.
    pub fn wrong(&self) -> u64 {
        self.rows.get("all").map_or(0, |row| row.wrong)
    }

    pub fn refused(&self) -> u64 {
        self.rows.get("all").map_or(0, |row| row.refused)
    }

    /// Scenes with nothing extreme that were refused.
    pub fn refused_ordinary(&self) -> u64 {
        self.rows
            .get("nothing extreme")
            .map_or(0, |row| row.refused)
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| scenes with | number | right | of these with the note | refused | wrong with the note | wrong, silent | of these solved in 96 digits |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|---|---|")?;
        for (name, row) in &self.rows {
            let Row {
                scenes,
                right,
                refused,
                wrong,
                told,
                cautious,
                exact,
            } = row;
            writeln!(
                f,
                "| {name} | {scenes} | {right} | {cautious} | {refused} | {told} | {wrong} | {exact} |"
            )?;
        }
        writeln!(
            f,
            "\nrefused: {:?}\nwrong: {:?}\ncomparisons left out as too sensitive: {}",
            self.refusals, self.findings, self.sensitive
        )
    }
}
