//! Materials: the operators A (viscosity) and B (elasticity) of a region, one file per law, one line each in the lists below.
//!
//! A law declares its parameters, refuses values under which its operator is not positive, and gives its linear form. Everything
//! else follows from these: the schema of scenes from its type, the parameters of an FMU from the declarations, matrices,
//! relaxation rates and the certificate from the form. What is not here: cells and matrices (`crate::fem`).

mod form;
mod isotropic;
mod matrix;
mod orthotropic;
mod variation;
mod voigt;

pub use form::{Form, GradientPair};
pub use isotropic::{Convention, IsotropicElasticity, IsotropicViscosity};
pub use matrix::MatrixLaw;
pub use orthotropic::Orthotropic;
pub use voigt::{COMPONENTS, Voigt};

use variation::Variation;

use crate::refusal::{Refusal, Verdict};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Viscosity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Viscosity {
    Isotropic(IsotropicViscosity),
    Orthotropic(Orthotropic),
    Matrix(MatrixLaw),
}

/// Elasticity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Elasticity {
    Isotropic(IsotropicElasticity),
    Orthotropic(Orthotropic),
    Matrix(MatrixLaw),
}

impl Viscosity {
    fn law(&self) -> &dyn Law {
        match self {
            Viscosity::Isotropic(law) => law,
            Viscosity::Orthotropic(law) => law,
            Viscosity::Matrix(law) => law,
        }
    }
}

impl Elasticity {
    fn law(&self) -> &dyn Law {
        match self {
            Elasticity::Isotropic(law) => law,
            Elasticity::Orthotropic(law) => law,
            Elasticity::Matrix(law) => law,
        }
    }
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

/// The material of a region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionMaterial {
    /// Name of the region: one of the mesh, or `body`, which is all that is in no other.
    pub region: String,
    /// Viscosity operator A.
    pub viscosity: Viscosity,
    /// Elasticity operator B.
    pub elasticity: Elasticity,
}

/// A law of an operator, with its values.
trait Law {
    /// Its values, by their keys in the scene; moduli have this unit.
    fn parameters(&self, unit: &'static str) -> Vec<Parameter>;
    /// Refuses values under which the operator is not positive in this dimension; `path` is its place in the scene.
    fn check(&self, dimension: usize, path: &str) -> Verdict;
    /// Its form, that of a place whose factor is 1.
    fn form(&self) -> Form;
    /// How it varies over the body.
    fn variation(&self) -> Variation<'_>;
}

/// A value of a law.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// Key in the scene, of an element of a list with its place: `young[0]`.
    pub key: String,
    /// What values it takes.
    pub kind: ParameterKind,
    /// Meaning.
    pub text: &'static str,
}

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// A number with its SI unit; `1` for a number.
    Number(&'static str),
    /// One of the words of [`CHOICES`].
    Choice(&'static Choice),
}

/// The elements of a list.
fn indexed(key: &str, count: usize, kind: ParameterKind, text: &'static str) -> Vec<Parameter> {
    let element = |i| Parameter {
        key: format!("{key}[{i}]"),
        kind,
        text,
    };
    (0..count).map(element).collect()
}

/// Words that a parameter may be.
#[derive(Debug, PartialEq, Eq)]
pub struct Choice {
    /// Name of the choice.
    pub name: &'static str,
    /// The words, as a scene writes them.
    pub words: &'static [&'static str],
}

/// The choices of all laws.
pub const CHOICES: [&Choice; 1] = [&isotropic::CONVENTIONS];

/// The operators of one material of a scene.
#[derive(Debug, Clone, Copy)]
pub struct Operators<'a> {
    /// Viscosity A.
    pub viscosity: &'a Viscosity,
    /// Elasticity B.
    pub elasticity: &'a Elasticity,
}

impl Operators<'_> {
    /// Both laws with their keys in the scene and the unit of their moduli.
    fn laws(&self) -> [(&'static str, &'static str, &dyn Law); 2] {
        [
            ("viscosity", "Pa.s", self.viscosity.law()),
            ("elasticity", "Pa", self.elasticity.law()),
        ]
    }

    /// The forms of A (Pa s) and B (Pa), where their factors are 1.
    pub fn forms(&self) -> [Form; 2] {
        self.laws().map(|(.., law)| law.form())
    }

    /// Whether a law varies over the body.
    pub(crate) fn varies(&self) -> bool {
        let varies = |(.., law): &(_, _, &dyn Law)| !law.variation().is_none();
        self.laws().iter().any(varies)
    }

    /// The factors of A and of B at each of these places, m; `path` is the place of the material in the scene.
    ///
    /// # Errors
    /// A factor that is not positive, with its place.
    pub(crate) fn factors(
        &self,
        places: &[[f64; 3]],
        path: &str,
    ) -> Result<[Vec<f64>; 2], Refusal> {
        let [a, b] = self.laws().map(|(key, _, law)| {
            let places = places.iter().copied();
            law.variation().factors(places, &format!("{path}.{key}"))
        });
        Ok([a?, b?])
    }

    /// Values of both laws, by their paths below the material.
    pub fn parameters(&self) -> Vec<(String, Parameter)> {
        let of = |(key, unit, law): (&str, &'static str, &dyn Law)| -> Vec<(String, Parameter)> {
            let path = |p: Parameter| (format!("{key}.{}", p.key), p);
            law.parameters(unit).into_iter().map(path).collect()
        };
        self.laws().into_iter().flat_map(of).collect()
    }

    /// Refuses operators that are not positive in this dimension; `path` is the place of the material in the scene.
    pub(crate) fn check(&self, dimension: usize, path: &str) -> Verdict {
        self.laws()
            .into_iter()
            .try_for_each(|(key, _, law)| law.check(dimension, &format!("{path}.{key}")))
    }
}
