//! Mesh and material of the body.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mesh of the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum MeshSpec {
    /// `(0, size[0]) x (0, size[1])`, cut into cells, each cell into four triangles by both diagonals. Parts: left,
    /// right (x), bottom, top (y).
    Rectangle {
        /// Lengths along x and y, m; positive.
        #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0}))]
        size: [f64; 2],
        /// Number of cells along x and y; at least 1 each.
        #[schemars(inner(range(min = 1)))]
        cells: [u32; 2],
        /// Grading of the grid lines to both ends of the x and the y axis: an exponent p >= 1 each puts them at
        /// `L/2 (2 i/n)^p` up to the middle and mirrors them beyond. 1 is uniform, and the only choice along a periodic
        /// axis. Clamped and contact parts end in corners where the stress concentrates and a uniform mesh converges slowly:
        /// with as many unknowns, 2 (linear elements) or 2 to 2.5 (quadratic ones) makes the error two to eight times
        /// smaller. The cells in the middle become p times as long, and far from corners resolve less. Default: 1 each.
        #[serde(default = "uniform::<2>")]
        #[schemars(inner(range(min = 1)))]
        grading: [f64; 2],
        /// Places where the triangles are bisected until they are small. Default: none.
        #[serde(default)]
        refine: Vec<Refinement>,
        /// Axes along which the body is periodic (the two opposite sides move together, so
        /// that they are no longer parts). Default: none.
        #[serde(default)]
        periodic: Vec<Axis>,
    },
    /// `(0, size[0]) x (0, size[1]) x (0, size[2])`: the criss-cross of `rectangle` in the x-y plane, extruded along
    /// z; every prism is cut into three tetrahedra that conform with their neighbours. Parts: left, right (x), bottom,
    /// top (y), back, front (z).
    Box {
        /// Lengths along x, y and z, m; positive.
        #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0}))]
        size: [f64; 3],
        /// Number of cells along x, y and z; at least 1 each.
        #[schemars(inner(range(min = 1)))]
        cells: [u32; 3],
        /// Grading of the grid lines to both ends of the x, the y and the z axis: an exponent p >= 1 each puts them at
        /// `L/2 (2 i/n)^p` up to the middle and mirrors them beyond. 1 is uniform, and the only choice along a periodic
        /// axis. Clamped and contact parts end in corners where the stress concentrates and a uniform mesh converges slowly:
        /// with as many unknowns, 2 (linear elements) or 2 to 2.5 (quadratic ones) makes the error two to eight times
        /// smaller. The cells in the middle become p times as long, and far from corners resolve less. Default: 1 each.
        #[serde(default = "uniform::<3>")]
        #[schemars(inner(range(min = 1)))]
        grading: [f64; 3],
        /// Axes along which the body is periodic (the two opposite sides move together, so
        /// that they are no longer parts). Default: none.
        #[serde(default)]
        periodic: Vec<Axis>,
    },
}

/// Every triangle that touches a box is bisected until its longest side has at most a given length; its neighbours are
/// bisected as far as the mesh needs to conform, so that the triangles grow steadily with the distance from the box. This
/// puts unknowns where they matter: a corner at the end of a clamped or contact part, where the stress concentrates (a
/// corner costs some four triangles for every halving of `size`), or the piece of the contact where slip turns into stick.
/// Not together with `periodic`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Corner of the box with the smaller coordinates, m.
    pub from: [f64; 2],
    /// Corner of the box with the larger coordinates, m. Default: `from`, a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<[f64; 2]>,
    /// Longest side that the triangles there may have, m; at least 1e-7 of the longer side of the body.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub size: f64,
}

/// No grading.
fn uniform<const N: usize>() -> [f64; N] {
    [1.0; N]
}

/// A coordinate axis.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

/// Finite element.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElementKind {
    /// Linear simplex, in 2D and 3D.
    #[default]
    P1,
    /// Quadratic triangle with straight sides, in 2D: about four times the unknowns of `p1` on the same cells, and
    /// errors of the next order wherever the solution is smooth. Vertices and midside nodes are contact nodes.
    P2,
}

/// Kelvin-Voigt material: `sigma = A eps(u') + B eps(u)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Viscosity operator A.
    pub viscosity: Viscosity,
    /// Elasticity operator B.
    pub elasticity: Elasticity,
}

/// Viscosity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
pub enum Viscosity {
    /// `A tau = mu1 tr(tau) I + mu2 tau`.
    Isotropic {
        /// Coefficient of the trace, Pa s; `dimension * mu1 + mu2` is positive.
        mu1: f64,
        /// Coefficient of the strain rate, Pa s; positive.
        #[schemars(extend("exclusiveMinimum" = 0))]
        mu2: f64,
    },
}

/// Elasticity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
pub enum Elasticity {
    /// `B tau = lambda tr(tau) I + E/(1 + kappa) tau`, with lambda by the convention.
    Isotropic {
        /// Young's modulus E, Pa; positive.
        #[schemars(extend("exclusiveMinimum" = 0))]
        young: f64,
        /// Poisson's ratio kappa, in (-1, 0.5).
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
        poisson: f64,
        /// Coefficient of the trace.
        convention: Convention,
    },
}

/// How lambda follows from Young's modulus E and Poisson's ratio kappa.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Convention {
    /// `E kappa / ((1 - kappa)(1 - 2 kappa))`, as printed in Kazmi et al. 2014.
    Kazmi2014,
    /// `E kappa / ((1 + kappa)(1 - 2 kappa))`; 2D only.
    PlaneStrain,
    /// `E kappa / (1 - kappa^2)`; 2D only.
    PlaneStress,
    /// `E kappa / ((1 + kappa)(1 - 2 kappa))`; 3D only.
    ThreeDimensional,
}

impl Viscosity {
    /// Coefficients `(c, d)` of `A tau = c tr(tau) I + d tau`, Pa s.
    pub fn coefficients(&self) -> (f64, f64) {
        match *self {
            Viscosity::Isotropic { mu1, mu2 } => (mu1, mu2),
        }
    }
}

impl Elasticity {
    /// Coefficients `(c, d)` of `B tau = c tr(tau) I + d tau`, Pa: lambda of the convention, and `E / (1 + kappa)`.
    pub fn coefficients(&self) -> (f64, f64) {
        match *self {
            Elasticity::Isotropic {
                young,
                poisson,
                convention,
            } => {
                let lambda = match convention {
                    Convention::Kazmi2014 => {
                        young * poisson / ((1.0 - poisson) * (1.0 - 2.0 * poisson))
                    }
                    Convention::PlaneStrain | Convention::ThreeDimensional => {
                        young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
                    }
                    Convention::PlaneStress => young * poisson / (1.0 - poisson * poisson),
                };
                (lambda, young / (1.0 + poisson))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elasticity(convention: Convention) -> Elasticity {
        Elasticity::Isotropic {
            young: 1.0,
            poisson: 0.3,
            convention,
        }
    }

    /// The closed forms of lambda, evaluated by hand at E = 1, kappa = 0.3.
    #[test]
    fn lambda_follows_the_convention() {
        for (convention, lambda) in [
            (Convention::Kazmi2014, 0.3 / 0.28),
            (Convention::PlaneStrain, 0.3 / 0.52),
            (Convention::ThreeDimensional, 0.3 / 0.52),
            (Convention::PlaneStress, 0.3 / 0.91),
        ] {
            let (trace, identity) = elasticity(convention).coefficients();
            assert!((trace - lambda).abs() < 1e-15, "{convention:?}: {trace}");
            assert!((identity - 1.0 / 1.3).abs() < 1e-15);
        }
    }

    /// Plane stress is uniaxial in the plane: `sigma_yy = 0` at `eps_yy = -kappa eps_xx` gives `sigma_xx = E eps_xx`.
    #[test]
    fn plane_stress_gives_youngs_modulus() {
        let (trace, identity) = elasticity(Convention::PlaneStress).coefficients();
        let (xx, yy) = (1.0, -0.3);
        assert!((trace * (xx + yy) + identity * yy).abs() < 1e-15);
        assert!((trace * (xx + yy) + identity * xx - 1.0).abs() < 1e-15);
    }
}
