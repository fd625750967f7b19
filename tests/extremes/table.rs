//! What became of the scenes of a sweep, by what was driven to an extreme.

use crate::case::Case;
use crate::judge::Judge;
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

impl Table {
    pub fn add(&mut self, judge: &Judge) {
        let case: &Case = judge.case;
        let mut names: Vec<String> = vec![
            "all".into(),
            format!("model {}", case.model),
            format!("scheme {}", case.scheme),
        ];
        names.push(format!("{} {}D", case.element, case.dimension()));
        names.extend(case.extremes.iter().map(|name| format!("extreme {name}")));
        if case.extremes.is_empty() {
            names.push("nothing extreme".into());
        }
        for name in names {
            let row = self.rows.entry(name).or_default();
            row.scenes += 1;
            row.exact += u64::from(judge.exact.is_ok());
            if !judge.findings.is_empty() {
                if judge.is_told() {
                    row.told += 1;
                } else {
                    row.wrong += 1;
                }
            } else if judge.base.refusal.is_some() {
                row.refused += 1;
            } else {
                row.right += 1;
                row.cautious += u64::from(judge.is_told());
            }
        }
        if let Some(refusal) = &judge.base.refusal {
            *self
                .refusals
                .entry(format!("{:?} in {}", refusal.code, refusal.phase))
                .or_default() += 1;
        }
        let mut oracles: Vec<&'static str> = judge.findings.iter().map(|f| f.oracle).collect();
        oracles.sort_unstable();
        oracles.dedup();
        for oracle in oracles {
            *self.findings.entry(oracle).or_default() += 1;
        }
        self.sensitive += judge.sensitive;
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
