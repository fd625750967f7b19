//! Orthotropic laws: nine constants along three axes of the material.
//!
//! `nu_ij = -eps_j / eps_i` under stress along i, and `nu_ji = nu_ij E_j / E_i`. The matrix of compliances along the axes is positive
//! exactly if the moduli are, `|nu_ij| < sqrt(E_i / E_j)`, and `1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 > 0`.

use super::form::Form;
use super::isotropic::{CONVENTIONS, Convention};
use super::variation::Variation;
use super::voigt::{self, Voigt};
use super::{Law, Parameter, ParameterKind, indexed};
use crate::expression::PlaceFormula;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure, json};
use nalgebra::{Matrix3, Rotation3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far rows of `axes` may be from orthonormal.
const ORTHONORMAL: f64 = 1e-6;

/// Stress from strain (or strain rate) by nine constants along the axes of the material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Orthotropic {
    /// Moduli E1, E2, E3 along the axes of the material, Pa (of a viscosity Pa s); positive.
    pub young: [f64; 3],
    /// Ratios nu12, nu13, nu23: nu_ij is the contraction along j by a stretch along i. `|nu_ij| < sqrt(E_i / E_j)`.
    pub poisson: [f64; 3],
    /// Shear moduli G23, G13, G12, Pa (of a viscosity Pa s); positive.
    pub shear: [f64; 3],
    /// Angle from the x axis to the first axis of the material, degrees; 2D only, where the third axis is z. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub angle_deg: Option<f64>,
    /// The axes of the material as rows, orthonormal; 3D only. Default: x, y, z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[[f64; 3]; 3]")]
    pub axes: Option<[[f64; 3]; 3]>,
    /// `plane_strain` or `plane_stress` in 2D, where it is required; `three_dimensional` in 3D, where it may be left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Convention")]
    pub convention: Option<Convention>,
    /// Slopes g of a factor `1 + g.x` of the law, 1/m, one per dimension; taken at the centroid of every cell. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<f64>,
    /// A factor of the law, taken at the centroid of every cell; positive. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "PlaceFormula")]
    pub factor: Option<PlaceFormula>,
}

/// Pairs of axes that a Poisson's ratio is of.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

impl Orthotropic {
    /// Compliances of the stretches along the axes.
    fn stretches(&self) -> Matrix3<f64> {
        let e = self.young;
        let mut out = Matrix3::from_diagonal(&Vector3::from(e.map(|e| 1.0 / e)));
        for ([i, j], nu) in PAIRS.into_iter().zip(self.poisson) {
            out[(i, j)] = -nu / e[i];
            out[(j, i)] = -nu / e[i];
        }
        out
    }

    /// `1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13`.
    fn determinant(&self) -> f64 {
        let ([e1, e2, e3], [nu12, nu13, nu23]) = (self.young, self.poisson);
        let (nu21, nu31, nu32) = (nu12 * e2 / e1, nu13 * e3 / e1, nu23 * e3 / e2);
        1.0 - nu12 * nu21 - nu23 * nu32 - nu13 * nu31 - 2.0 * nu21 * nu32 * nu13
    }

    /// The matrix along the axes; of a plane its components of the plane.
    fn matrix(&self) -> Voigt {
        let mut stiff = self
            .stretches()
            .try_inverse()
            .unwrap_or_else(|| Matrix3::repeat(f64::NAN));
        stiff = (stiff + stiff.transpose()) / 2.0;
        let is_plane = match self.convention {
            Some(Convention::PlaneStress) => {
                // the stretch along z is what leaves no stress there
                let along = stiff.column(2).into_owned();
                stiff -= along * along.transpose() / stiff[(2, 2)];
                true
            }
            Some(Convention::PlaneStrain) => true,
            // a plane needs one of the two: `check` refuses the others there
            Some(
                Convention::Kazmi2014
                | Convention::PlaneStressRelaxing
                | Convention::ThreeDimensional,
            )
            | None => false,
        };
        let shear = self.shear;
        Voigt::from_fn(|i, j| {
            let is_known = |i: usize| !is_plane || matches!(i, 0 | 1 | 5);
            match (i < 3, j < 3) {
                _ if !is_known(i) || !is_known(j) => 0.0,
                (true, true) => stiff[(i, j)],
                (false, false) if i == j => shear[i - 3],
                _ => 0.0,
            }
        })
    }

    /// The axes as rows.
    fn frame(&self) -> Matrix3<f64> {
        if let Some(rows) = self.axes {
            return Matrix3::from_fn(|i, j| rows[i][j]);
        }
        let angle = self.angle_deg.unwrap_or(0.0).to_radians();
        Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
            .matrix()
            .transpose()
    }

    fn check_axes(&self, dimension: usize, path: &str) -> Verdict {
        let only = |is_given: bool, key: &str, allowed: &str| {
            ensure(!is_given, || {
                let found = format!("{key} in {dimension} dimensions");
                Refusal::new(format!("{path}.{key}"), found, allowed)
            })
        };
        if dimension == 2 {
            only(self.axes.is_some(), "axes", "angle_deg")?;
        } else {
            only(self.angle_deg.is_some(), "angle_deg", "axes")?;
        }
        let frame = self.frame();
        let off = (frame * frame.transpose() - Matrix3::identity()).amax();
        ensure(off <= ORTHONORMAL, || {
            let found = format!("rows whose products are off by {off:.1e}");
            Refusal::new(format!("{path}.axes"), found, "orthonormal rows")
        })?;
        let allowed: &[Option<Convention>] = match dimension {
            2 => &[Some(Convention::PlaneStrain), Some(Convention::PlaneStress)],
            _ => &[None, Some(Convention::ThreeDimensional)],
        };
        ensure(allowed.contains(&self.convention), || {
            let found = match &self.convention {
                Some(given) => format!("{} in {dimension} dimensions", json(given)),
                None => "nothing".to_owned(),
            };
            let names: Vec<String> = allowed.iter().flatten().map(json).collect();
            Refusal::new(format!("{path}.convention"), found, names.join(", "))
        })
    }
}

impl Law for Orthotropic {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let of = |key, kind, text| indexed(key, 3, kind, text);
        let modulus = ParameterKind::Number(unit);
        let one = |key: &str, kind, text| Parameter {
            key: key.to_owned(),
            kind,
            text,
        };
        let mut all = of("young", modulus, "Modulus along an axis of the material.");
        let text = "Ratio nu12, nu13 or nu23.";
        all.extend(of("poisson", ParameterKind::Number("1"), text));
        all.extend(of("shear", modulus, "Shear modulus G23, G13 or G12."));
        if self.angle_deg.is_some() {
            let text = "Angle from the x axis to the first axis of the material, degrees.";
            all.push(one("angle_deg", ParameterKind::Number("1"), text));
        }
        if self.convention.is_some() {
            let text = "Which strains or stresses the plane has.";
            all.push(one("convention", ParameterKind::Choice(&CONVENTIONS), text));
        }
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        for (key, values) in [("young", self.young), ("shear", self.shear)] {
            for (i, value) in values.into_iter().enumerate() {
                ensure(value.is_finite() && value > 0.0, || {
                    Refusal::new(format!("{path}.{key}[{i}]"), number(value), "a number > 0")
                })?;
            }
        }
        let names = ["nu12", "nu13", "nu23"];
        for (place, ([i, j], nu)) in PAIRS.into_iter().zip(self.poisson).enumerate() {
            let most = (self.young[i] / self.young[j]).sqrt();
            ensure(nu.abs() < most, || {
                let (name, i, j) = (names[place], i + 1, j + 1);
                let allowed = format!("|{name}| < sqrt(E{i}/E{j}) = {}", number(most));
                Refusal::new(format!("{path}.poisson[{place}]"), number(nu), allowed)
            })?;
        }
        let determinant = self.determinant();
        ensure(determinant > 0.0, || {
            let condition = "1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13";
            let found = format!("{condition} = {}", number(determinant));
            let allowed = format!("{condition} > 0: otherwise the body gains energy");
            Refusal::new(format!("{path}.poisson"), found, allowed)
        })?;
        self.check_axes(dimension, path)?;
        let [least, most] = self.form().extremes(dimension);
        ensure(least > 0.0 && most.is_finite(), || {
            let found = format!("eigenvalues from {} to {}", number(least), number(most));
            Refusal::new(path, found, "moduli whose matrix is finite and positive")
        })?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        Form::Matrix(voigt::turned(&self.matrix(), &self.frame()))
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

    fn law(convention: Option<Convention>) -> Orthotropic {
        Orthotropic {
            young: [4.0, 1.0, 2.0],
            poisson: [0.3, 0.2, 0.4],
            shear: [0.4, 0.7, 0.5],
            angle_deg: None,
            axes: None,
            convention,
            gradient: Vec::new(),
            factor: None,
        }
    }

    fn matrix(law: &Orthotropic) -> Voigt {
        law.form().voigt()
    }

    /// A stress along one axis alone stretches that axis by E and contracts the others by nu.
    #[test]
    fn stretches_along_the_axes_follow_the_constants() {
        let law = law(None);
        let compliance = matrix(&law).try_inverse().unwrap();
        for ([i, j], nu) in PAIRS.into_iter().zip(law.poisson) {
            assert!((compliance[(i, i)] * law.young[i] - 1.0).abs() < 1e-13);
            assert!((compliance[(j, i)] / compliance[(i, i)] + nu).abs() < 1e-13);
        }
        for (i, g) in law.shear.iter().enumerate() {
            assert!((compliance[(3 + i, 3 + i)] * g - 1.0).abs() < 1e-13);
        }
        // the determinant of the compliances has the sign of the condition
        let expected = law.stretches().determinant() * law.young.iter().product::<f64>();
        assert!((law.determinant() - expected).abs() < 1e-14);
    }

    /// Plane stress stretches under a stress along x as the bare material does.
    #[test]
    fn plane_stress_leaves_the_third_axis_free() {
        let law = law(Some(Convention::PlaneStress));
        let d = matrix(&law);
        let plane = Matrix3::from_fn(|i, j| d[([0, 1, 5][i], [0, 1, 5][j])]);
        let strain = plane.try_inverse().unwrap() * Vector3::x();
        assert!((strain[0] - 1.0 / law.young[0]).abs() < 1e-14);
        assert!((strain[1] + law.poisson[0] / law.young[0]).abs() < 1e-14);
    }

    /// A quarter turn exchanges the axes.
    #[test]
    fn a_quarter_turn_exchanges_the_axes() {
        let straight = law(Some(Convention::PlaneStrain));
        let turned = Orthotropic {
            angle_deg: Some(90.0),
            ..straight.clone()
        };
        let (a, b) = (matrix(&straight), matrix(&turned));
        assert!((a[(0, 0)] - b[(1, 1)]).abs() < 1e-13 && (a[(0, 1)] - b[(0, 1)]).abs() < 1e-13);
        assert!((a[(0, 0)] - b[(0, 0)]).abs() > 1.0);
        // the first axis at 30 degrees has the modulus of the first axis
        let leaning = Orthotropic {
            angle_deg: Some(30.0),
            ..straight.clone()
        };
        let along = Vector3::new(0.75_f64.sqrt(), 0.5, 0.0);
        let strain = along * along.transpose();
        let stress = leaning.form().stress(&strain);
        assert!((along.dot(&(stress * along)) - a[(0, 0)]).abs() < 1e-13);
    }

    fn refused(law: &Orthotropic, dimension: usize) -> String {
        let refusal = law.check(dimension, "b").expect_err("a refusal");
        refusal.of("test").to_string()
    }

    #[test]
    fn the_condition_that_is_violated_is_named() {
        let plane = || law(Some(Convention::PlaneStrain));
        let mut one = plane();
        one.poisson[1] = 1.5;
        assert!(
            refused(&one, 2).contains("b.poisson[1]") && refused(&one, 2).contains("sqrt(E1/E3)")
        );
        let mut one = plane();
        (one.young, one.poisson) = ([1.0; 3], [0.6, 0.6, 0.6]);
        assert!(
            refused(&one, 2).contains("2 nu21 nu32 nu13 = -0.5"),
            "{}",
            refused(&one, 2)
        );
        let mut one = plane();
        one.shear[2] = 0.0;
        assert!(refused(&one, 2).contains("b.shear[2]"));
        assert!(refused(&law(None), 2).contains("b.convention"));
        assert!(refused(&plane(), 3).contains("b.convention"));
        let mut one = law(None);
        one.axes = Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.1], [0.0, 0.0, 1.0]]);
        assert!(refused(&one, 3).contains("orthonormal"));
        assert!(plane().check(2, "b").is_ok() && law(None).check(3, "b").is_ok());
    }
}
