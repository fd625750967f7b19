//! Memory as other programs tabulate it: shares of the moduli that relax.

use super::resolved::{Pair, Resolved, branch};
use crate::message::number;
use crate::refusal::{Refusal, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A relaxation table of shares, as Abaqus, Ansys and others have it: `G(t) = G0 (1 - sum g_j (1 - exp(-t / tau_j)))`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeMemory {
    /// Its terms; shares of the shear modulus sum to less than 1, and those of the bulk modulus.
    pub relative: Vec<RelativeTerm>,
    /// What the moduli of the elasticity are: `instantaneous` (G0, K0) or `long_term` (what is left in the end).
    pub moduli: Moduli,
}

/// Shares of the instantaneous moduli that relax with a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeTerm {
    /// Relaxation time, s; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub tau: f64,
    /// Share g of the shear modulus; not negative.
    #[schemars(extend("minimum" = 0))]
    pub shear: f64,
    /// Share k of the bulk modulus; not negative. Default: 0, the bulk does not relax.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub bulk: f64,
}

/// What moduli are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Moduli {
    Instantaneous,
    LongTerm,
}

impl RelativeMemory {
    pub(super) fn resolve(&self, of: Pair, path: &str) -> Result<Resolved, Refusal> {
        let sum = |share: fn(&RelativeTerm) -> f64| self.relative.iter().map(share).sum::<f64>();
        let shares = Pair {
            shear: sum(|term| term.shear),
            bulk: sum(|term| term.bulk),
        };
        for (key, share) in [("shear", shares.shear), ("bulk", shares.bulk)] {
            ensure(share < 1.0, || {
                let found = format!("shares {key} that sum to {}", number(share));
                let allowed = "a sum below 1: otherwise nothing resists in the end";
                Refusal::new(format!("{path}.relative"), found, allowed)
            })?;
        }
        let left = Pair {
            shear: 1.0 - shares.shear,
            bulk: 1.0 - shares.bulk,
        };
        let (left, at_once) = match self.moduli {
            Moduli::Instantaneous => (left, of),
            Moduli::LongTerm => (
                Pair::WHOLE,
                Pair {
                    shear: of.shear / left.shear,
                    bulk: of.bulk / left.bulk,
                },
            ),
        };
        let terms = self
            .relative
            .iter()
            .filter(|t| t.shear > 0.0 || t.bulk > 0.0);
        let of_term =
            |t: &RelativeTerm| branch(t.tau, t.shear * at_once.shear, t.bulk * at_once.bulk);
        Ok(Resolved {
            branches: terms.map(of_term).collect(),
            left,
            error: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::memory::Branch;
    use super::*;

    const OF: Pair = Pair {
        shear: 2.0,
        bulk: 5.0,
    };

    fn resolved(text: &str) -> Result<Resolved, Refusal> {
        let table: RelativeMemory = serde_json::from_str(text).unwrap();
        table.resolve(OF, "memory")
    }

    #[test]
    fn shares_are_of_the_instantaneous_moduli() {
        let text = r#"{"relative": [{"tau": 0.1, "shear": 0.3, "bulk": 0.1}, {"tau": 2, "shear": 0.2}], "moduli": "MODULI"}"#;
        let at_once = resolved(&text.replace("MODULI", "instantaneous")).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(close(at_once.left.shear, 0.5) && close(at_once.left.bulk, 0.9));
        let Branch::Isotropic(first) = &at_once.branches[0];
        assert!(close(first.shear, 0.6) && close(first.bulk, 0.5));
        let late = resolved(&text.replace("MODULI", "long_term")).unwrap();
        assert_eq!(late.left, Pair::WHOLE);
        let Branch::Isotropic(second) = &late.branches[1];
        assert!(close(second.shear, 0.2 * 2.0 / 0.5) && second.bulk == 0.0);
        let all = r#"{"relative": [{"tau": 0.1, "shear": 1.0}], "moduli": "long_term"}"#;
        assert!(resolved(all).is_err());
    }
}
