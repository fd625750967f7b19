//! Laws whose matrix is given: any symmetric positive one, in the components of Voigt.

use super::form::Form;
use super::variation::Variation;
use super::voigt::{Voigt, components};
use super::{Law, Parameter, ParameterKind};
use crate::expression::PlaceFormula;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Difference of two entries, relative to the largest of the matrix, up to which they count as the same.
const SYMMETRIC: f64 = 1e-9;

/// Stress from strain (or strain rate) by a matrix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MatrixLaw {
    /// Rows of the matrix, Pa (of a viscosity Pa s); symmetric and positive: 3 x 3 on (xx, yy, xy) in 2D, 6 x 6 on
    /// (xx, yy, zz, yz, xz, xy) in 3D, with engineering shear `2 eps_ij`.
    pub matrix: Vec<Vec<f64>>,
    /// Slopes g of a factor `1 + g.x` of the law, 1/m, one per dimension; taken at the centroid of every cell. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<f64>,
    /// A factor of the law, taken at the centroid of every cell; positive. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "PlaceFormula")]
    pub factor: Option<PlaceFormula>,
}

impl Law for MatrixLaw {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let rows = self.matrix.iter().enumerate();
        let entries = rows.flat_map(|(i, row)| (0..row.len()).map(move |j| [i, j]));
        let mut all: Vec<Parameter> = entries
            .map(|[i, j]| Parameter {
                key: format!("matrix[{i}][{j}]"),
                kind: ParameterKind::Number(unit),
                text: "Entry of the symmetric matrix of the law.",
            })
            .collect();
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        let path_of_matrix = format!("{path}.matrix");
        let count = components(dimension).len();
        let is_square =
            self.matrix.len() == count && self.matrix.iter().all(|row| row.len() == count);
        ensure(is_square, || {
            let lengths: Vec<usize> = self.matrix.iter().map(Vec::len).collect();
            let found = format!("rows of {lengths:?} numbers");
            let allowed = format!("{count} rows of {count} numbers in {dimension} dimensions");
            Refusal::new(&path_of_matrix, found, allowed)
        })?;
        let largest = self
            .matrix
            .iter()
            .flatten()
            .fold(0.0, |m: f64, v| m.max(v.abs()));
        for (i, row) in self.matrix.iter().enumerate() {
            for (j, value) in row.iter().enumerate().take(i) {
                let other = self.matrix[j][i];
                ensure((value - other).abs() <= SYMMETRIC * largest, || {
                    let found = format!(
                        "{} and {} across the diagonal",
                        number(*value),
                        number(other)
                    );
                    Refusal::new(
                        format!("{path_of_matrix}[{i}][{j}]"),
                        found,
                        "a symmetric matrix",
                    )
                })?;
            }
        }
        let [least, most] = self.form().extremes(dimension);
        ensure(least > 0.0 && most.is_finite(), || {
            let found = format!("a smallest eigenvalue of {}", number(least));
            let allowed = "a positive matrix: otherwise the body gains energy";
            Refusal::new(&path_of_matrix, found, allowed)
        })?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        let dimension = if self.matrix.len() == 6 { 3 } else { 2 };
        let mut out = Voigt::zeros();
        for (row, i) in self.matrix.iter().zip(components(dimension)) {
            for (value, j) in row.iter().zip(components(dimension)) {
                out[(*i, *j)] += 0.5 * value;
                out[(*j, *i)] += 0.5 * value;
            }
        }
        Form::Matrix(out)
    }

    fn variation(&self) -> Variation<'_> {
        Variation {
            gradient: &self.gradient,
            factor: self.factor.as_ref(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(matrix: Vec<Vec<f64>>) -> MatrixLaw {
        MatrixLaw {
            matrix,
            gradient: Vec::new(),
            factor: None,
        }
    }

    fn refused(matrix: Vec<Vec<f64>>, dimension: usize) -> String {
        let refusal = law(matrix).check(dimension, "a").expect_err("a refusal");
        refusal.of("test").to_string()
    }

    #[test]
    fn what_is_wrong_with_a_matrix_is_named() {
        let good = vec![
            vec![3.0, 1.0, 0.1],
            vec![1.0, 2.0, 0.2],
            vec![0.1, 0.2, 0.8],
        ];
        assert!(law(good.clone()).check(2, "a").is_ok());
        assert!(refused(good.clone(), 3).contains("6 rows of 6 numbers"));
        let mut skew = good.clone();
        skew[2][0] = 0.2;
        assert!(refused(skew, 2).contains("a.matrix[2][0]"));
        let mut indefinite = good.clone();
        (indefinite[0][1], indefinite[1][0]) = (3.0, 3.0);
        assert!(refused(indefinite, 2).contains("smallest eigenvalue of -"));
        assert!(refused(vec![good[0].clone(), vec![1.0]], 2).contains("[3, 1]"));
    }
}
