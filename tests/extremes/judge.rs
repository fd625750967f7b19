//! Collects what is wrong with the answer to one case.

use crate::case::Case;
use crate::compare::{Distance, sensitivity};
use crate::exact::NotSolved;
use crate::run::Run;

/// A statement that does not hold.
#[derive(Debug, Clone)]
pub struct Finding {
    pub oracle: &'static str,
    pub error: f64,
    pub allowed: f64,
    pub detail: String,
}

/// Factor between a tolerance and what counts as wrong.
pub const TOLERANCES: f64 = 10.0;

/// Relative difference that counts as the same bits.
pub const SAME: f64 = 1e-12;

/// Beyond this a case is too close to a change of its pattern of stick for runs that differ by rounding to be compared.
pub const MOST_SENSITIVE: f64 = 1e3;

/// A case, its run, and what is found about it.
pub struct Judge<'a> {
    pub case: &'a Case,
    pub base: &'a Run,
    pub findings: Vec<Finding>,
    /// Comparisons that were left out because the case is too sensitive.
    pub sensitive: usize,
    /// What became of the comparison with the exact solution.
    pub exact: Result<(), NotSolved>,
    sensitivity: Option<f64>,
}

impl<'a> Judge<'a> {
    /// All oracles on a case and its run.
    pub fn of(case: &'a Case, base: &'a Run) -> Judge<'a> {
        let mut judge = Judge {
            case,
            base,
            findings: Vec::new(),
            sensitive: 0,
            exact: Err(NotSolved::NotMeant),
            sensitivity: None,
        };
        judge.look_within();
        judge.transform();
        judge.compare_models();
        judge.solve_exactly();
        judge
    }

    /// Whether the answer came with the note that its steps lost digits: wrong, but not silently.
    pub fn is_told(&self) -> bool {
        self.base.has_lost_digits
    }

    /// The tolerance that the answer promises, seen through the body and its friction.
    pub fn tolerance(&self) -> f64 {
        self.case.tolerance.max(self.case.friction_tolerance)
    }

    pub fn find(&mut self, oracle: &'static str, error: f64, allowed: f64, detail: String) {
        // written so that NaN is a finding
        let holds = error <= allowed;
        if !holds {
            self.findings.push(Finding {
                oracle,
                error,
                allowed,
                detail,
            });
        }
    }

    /// What is wrong with a run without any oracle.
    pub fn find_faults(&mut self, of: &str, run: &Run) {
        for fault in &run.faults {
            self.find("fault", f64::INFINITY, 0.0, format!("{of}: {fault}"));
        }
    }

    /// A difference that rounding and the tolerances of solver and body may make, magnified as the case magnifies a change of
    /// its loads.
    pub fn find_apart(&mut self, oracle: &'static str, d: Distance, other: &Run) {
        let allowed = TOLERANCES * self.tolerance();
        if d.largest() <= allowed {
            return;
        }
        let (case, base) = (self.case, self.base);
        let factor = *self
            .sensitivity
            .get_or_insert_with(|| sensitivity(case, base));
        if factor > MOST_SENSITIVE {
            self.sensitive += 1;
            return;
        }
        let detail = format!(
            "{d}, sensitivity {factor:.1e}, {} against {}",
            base.kind, other.kind
        );
        self.find(oracle, d.largest(), allowed * factor, detail);
    }

    /// Exact symmetries are refused alike.
    pub fn find_other_end(&mut self, oracle: &'static str, other: &Run) {
        self.find_faults(oracle, other);
        let code = |run: &Run| run.refusal.as_ref().map(|r| (r.code, r.phase));
        let base = self.base;
        if code(base) != code(other) || base.points.len() != other.points.len() {
            let text = |run: &Run| {
                run.refusal
                    .as_ref()
                    .map_or("runs".to_owned(), |r| r.text.clone())
            };
            let detail = format!("refused on one side only: {} / {}", text(base), text(other));
            self.find(oracle, f64::INFINITY, 0.0, detail);
        }
    }
}
