//! The strain norm `|eps(u)|` in L2, the norm of V in the paper.
//!
//! With one isotropic material the form `(eps(u), eps(v))` lies in the span of A and B and costs no third matrix. Elsewhere it does
//! not, nor where products of a body have the share of its memory, and is assembled.

use super::dofs::DofMap;
use super::forms::Forms;
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
    /// For the forms of A and B in every cell.
    pub(super) fn new(mesh: &Mesh, dofs: &DofMap, forms: &Forms) -> StrainNorm {
        let is_spanned = !forms.have_memory() && forms.have_dashpots();
        let common = forms.common().filter(|_| is_spanned);
        common.and_then(combination).unwrap_or_else(|| {
            let strain = Forms::uniform(mesh, [Form::STRAIN; 2]);
            StrainNorm::Assembled(OperatorPair::from_elements(mesh, dofs, &strain).a)
        })
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

/// The norm of two isotropic forms; `None` for others.
fn combination(forms: [Form; 2]) -> Option<StrainNorm> {
    let [
        Form::Isotropic {
            lambda: of_a,
            two_mu: a_two_mu,
        },
        Form::Isotropic {
            lambda: of_b,
            two_mu: b_two_mu,
        },
    ] = forms
    else {
        return None;
    };
    let det = a_two_mu * of_b - b_two_mu * of_a;
    let size = (a_two_mu.abs() + of_a.abs()) * (b_two_mu.abs() + of_b.abs());
    Some(if det.abs() <= 1e-9 * size {
        StrainNorm::Combination(1.0 / a_two_mu, 0.0)
    } else {
        StrainNorm::Combination(of_b / det, -of_a / det)
    })
}
