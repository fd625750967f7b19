//! The strain norm `|eps(u)|` in L2, the norm of V in the paper.
//!
//! With one isotropic material the form `(eps(u), eps(v))` lies in the span of A and B and costs no third matrix. Where regions
//! differ it does not, and is assembled.

use super::dofs::DofMap;
use super::operators::OperatorPair;
use crate::material::Form;
use crate::mesh::Mesh;

/// How the form `(eps(u), eps(v))` is known.
#[derive(Debug, Clone, PartialEq)]
pub enum StrainNorm {
    /// `x A + y B`; where A and B are proportional, a multiple of A (1/two_mu) stands for it.
    Combination(f64, f64),
    /// Its own entries, on the pattern of the operators.
    Assembled(Vec<f64>),
}

impl StrainNorm {
    /// For the forms of A and B in every region.
    pub(super) fn new(mesh: &Mesh, dofs: &DofMap, forms: &[[Form; 2]]) -> StrainNorm {
        match forms {
            [first, others @ ..] if others.iter().all(|f| f == first) => combination(*first),
            _ => {
                let strain = vec![[Form::STRAIN; 2]; forms.len()];
                StrainNorm::Assembled(OperatorPair::from_elements(mesh, dofs, &strain).a)
            }
        }
    }

    /// Its entries on the pattern of the operators.
    pub fn values(&self, operators: &OperatorPair) -> Vec<f64> {
        match self {
            StrainNorm::Combination(x, y) => {
                let mut values = vec![0.0; operators.row_idx.len()];
                operators.combine(*x, *y, &mut values);
                values
            }
            StrainNorm::Assembled(values) => values.clone(),
        }
    }
}

fn combination([a, b]: [Form; 2]) -> StrainNorm {
    let det = a.two_mu * b.lambda - b.two_mu * a.lambda;
    let size = (a.two_mu.abs() + a.lambda.abs()) * (b.two_mu.abs() + b.lambda.abs());
    if det.abs() <= 1e-9 * size {
        StrainNorm::Combination(1.0 / a.two_mu, 0.0)
    } else {
        StrainNorm::Combination(b.lambda / det, -a.lambda / det)
    }
}
