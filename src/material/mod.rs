//! Materials: the operators A (viscosity) and B (elasticity) of a region, one file per law, one line each in the lists below.
//!
//! A law declares its parameters, refuses values under which its operator is not positive, and gives its linear form; one whose
//! stress is no linear function of the strain also what it adds to that form. Everything else follows from these: the schema of
//! scenes from its type, the parameters of an FMU from the declarations, matrices, relaxation rates and the certificate from the
//! forms, Newton's method from the excess. What is not here: cells and matrices (`crate::fem`).

mod carreau;
mod excess;
mod fit;
mod form;
mod fractional;
mod free;
mod hencky;
mod isotropic;
mod matrix;
mod measured;
mod memory;
mod nnls;
mod orthotropic;
mod plane_stress;
mod relative;
mod resolved;
mod sheet;
mod thinning;
mod variation;
mod voigt;
mod von_mises;

pub use carreau::CarreauViscosity;
pub use excess::{Curve, CurvePoint, Deviator, Excess, ExcessPoint};
pub use form::{Form, GradientPair};
pub use fractional::{FractionalKernel, FractionalMemory};
pub use free::{Blend, FreeNumber, RATIOS, Share};
pub use hencky::HenckyElasticity;
pub use isotropic::{Convention, IsotropicElasticity, IsotropicViscosity};
pub use matrix::MatrixLaw;
pub use measured::{BulkMemory, DynamicMemory, Frequency, RelaxationMemory};
pub use memory::{Branch, IsotropicBranch, MOST_BRANCHES, rates_with_memory};
pub use orthotropic::Orthotropic;
pub use relative::{Moduli, RelativeMemory, RelativeTerm};
pub use sheet::Memory;
pub use voigt::{COMPONENTS, Voigt};
pub use von_mises::{Base, VonMisesElasticity};

use resolved::{Pair, Resolved};

use isotropic::plate_of;
use plane_stress::Plate;
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
    Carreau(CarreauViscosity),
}

/// Elasticity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Elasticity {
    Isotropic(IsotropicElasticity),
    Orthotropic(Orthotropic),
    Matrix(MatrixLaw),
    VonMises(VonMisesElasticity),
    Hencky(HenckyElasticity),
}

impl Default for Viscosity {
    fn default() -> Viscosity {
        Viscosity::Isotropic(IsotropicViscosity::default())
    }
}

impl Viscosity {
    fn law(&self) -> &dyn Law {
        match self {
            Viscosity::Isotropic(law) => law,
            Viscosity::Orthotropic(law) => law,
            Viscosity::Matrix(law) => law,
            Viscosity::Carreau(law) => law,
        }
    }
}

impl Elasticity {
    fn law(&self) -> &dyn Law {
        match self {
            Elasticity::Isotropic(law) => law,
            Elasticity::Orthotropic(law) => law,
            Elasticity::Matrix(law) => law,
            Elasticity::VonMises(law) => law,
            Elasticity::Hencky(law) => law,
        }
    }
}

/// Viscoelastic material: `sigma = A eps(u') + B eps(u)`, and its memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Viscosity operator A. Default: none, the material has no dashpot.
    #[serde(default)]
    pub viscosity: Viscosity,
    /// Elasticity operator B.
    pub elasticity: Elasticity,
    /// Long memory: branches of a generalised Maxwell body, each `int C exp(-(t - s) / tau) eps(u'(s)) ds`, or what they follow
    /// from. Default: none.
    #[serde(default, skip_serializing_if = "Memory::is_none")]
    pub memory: Memory,
}

/// The material of a region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionMaterial {
    /// Name of the region: one of the mesh, or `body`, which is all that is in no other.
    pub region: String,
    /// Viscosity operator A. Default: none, the material has no dashpot.
    #[serde(default)]
    pub viscosity: Viscosity,
    /// Elasticity operator B.
    pub elasticity: Elasticity,
    /// Long memory: branches of a generalised Maxwell body, each `int C exp(-(t - s) / tau) eps(u'(s)) ds`, or what they follow
    /// from. Default: none.
    #[serde(default, skip_serializing_if = "Memory::is_none")]
    pub memory: Memory,
}

/// A law of an operator, with its values.
trait Law: std::fmt::Debug {
    /// Its values, by their keys in the scene; moduli have this unit.
    fn parameters(&self, unit: &'static str) -> Vec<Parameter>;
    /// Refuses values under which the operator is not positive in this dimension; `path` is its place in the scene.
    fn check(&self, dimension: usize, path: &str) -> Verdict;
    /// Its form, that of a place whose factor is 1: all of a linear law, the lower tangent of another one.
    fn form(&self) -> Form;
    /// What it adds to its form, at such a place; `None` for a linear law.
    fn excess(&self) -> Option<Excess> {
        None
    }
    /// How it varies over the body.
    fn variation(&self) -> Variation<'_>;
}

fn parameter(key: &str, kind: ParameterKind, text: &'static str) -> Parameter {
    let key = key.to_owned();
    Parameter { key, kind, text }
}

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
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
pub const CHOICES: [&Choice; 2] = [&isotropic::CONVENTIONS, &excess::DEVIATORS];

/// The operators of one material of a scene.
#[derive(Debug, Clone, Copy)]
pub struct Operators<'a> {
    /// Viscosity A.
    pub viscosity: &'a Viscosity,
    /// Elasticity B.
    pub elasticity: &'a Elasticity,
    /// Its memory.
    pub memory: &'a Memory,
}

impl Operators<'_> {
    /// Both laws with their keys in the scene and the unit of their moduli.
    fn laws(&self) -> [(&'static str, &'static str, &dyn Law); 2] {
        [
            ("viscosity", "Pa.s", self.viscosity.law()),
            ("elasticity", "Pa", self.elasticity.law()),
        ]
    }

    /// Whether it has a dashpot: a viscosity that is not 0.
    pub fn has_dashpot(&self) -> bool {
        self.viscosity.law().form() != Form::ZERO
    }

    /// The forms of A (Pa s) and B (Pa), where their factors are 1: of B what a memory in shares of it leaves in the end.
    pub fn forms(&self) -> [Form; 2] {
        if let Some(plate) = self.plate() {
            return [plate.viscosity, plate.elasticity];
        }
        let [viscosity, elasticity] = self.laws().map(|(.., law)| law.form());
        let left = match self.memory {
            Memory::Relative(_) => self.resolved("memory").map(|resolved| resolved.left).ok(),
            _ => None,
        };
        let long_term = left
            .zip(moduli(&elasticity))
            .map(|(left, of)| memory::form(of.bulk * left.bulk, of.shear * left.shear));
        [viscosity, long_term.unwrap_or(elasticity)]
    }

    /// The plate with free faces that it is, where its convention says so.
    fn plate(&self) -> Option<Plate> {
        match (self.viscosity, self.elasticity) {
            (Viscosity::Isotropic(viscosity), Elasticity::Isotropic(elasticity)) => {
                plate_of(viscosity, elasticity)
            }
            _ => None,
        }
    }

    /// Whether its convention makes it a plate with free faces.
    fn is_plate(&self) -> bool {
        self.plate().is_some()
    }

    /// Refuses what a plate with free faces cannot have beside its elasticity.
    fn check_plate(&self, path: &str) -> Verdict {
        let Elasticity::Isotropic(elasticity) = self.elasticity else {
            return Ok(());
        };
        if elasticity.convention != Convention::PlaneStressRelaxing {
            return Ok(());
        }
        let refuse = |found: &str| {
            let path = format!("{path}.elasticity.convention");
            let found = format!("\"plane_stress_relaxing\" beside {found}");
            let allowed = "isotropic laws without memory that do not vary over the body";
            Err(Refusal::new(path, found, allowed))
        };
        match self.viscosity {
            _ if !self.memory.is_none() => refuse("memory"),
            _ if self.varies() => refuse("a law that varies"),
            Viscosity::Isotropic(viscosity) => {
                isotropic::check_plate(viscosity, &format!("{path}.viscosity"))
            }
            _ => refuse("a viscosity that is not isotropic"),
        }
    }

    /// The memory as branches; `path` is its place in the scene.
    fn resolved(&self, path: &str) -> Result<Resolved, Refusal> {
        let is_sheet = !matches!(self.memory, Memory::Branches(_));
        if is_sheet && self.varies() {
            let found = "a data sheet beside a law that varies over the body";
            return Err(Refusal::new(
                path,
                found,
                "branches in moduli (tau, shear, bulk)",
            ));
        }
        let [viscosity, elasticity] = self.laws().map(|(.., law)| moduli(&law.form()));
        self.memory.resolve(elasticity, viscosity, path)
    }

    /// Number of branches of the memory, and the largest relative error of the fit that they come from, where there was one.
    pub fn memory_fit(&self) -> (usize, Option<f64>) {
        let resolved = self.resolved("memory").ok();
        resolved.map_or((0, None), |found| (found.branches.len(), found.error))
    }

    /// Relaxation times (s) and forms (Pa) of the branches of the memory, ascending; equal times are one branch. A memory that
    /// the check refuses has none.
    pub fn branches(&self) -> Vec<(f64, Form)> {
        if let Some(plate) = self.plate() {
            return plate.branch.into_iter().collect();
        }
        if self.memory.is_none() {
            return Vec::new();
        }
        let resolved = self.resolved("memory").map(|found| found.branches);
        let mut branches: Vec<(f64, Form)> = Vec::new();
        for branch in resolved.unwrap_or_default() {
            let (tau, form) = (branch.tau(), branch.law().form());
            match branches.iter_mut().find(|(of, _)| *of == tau) {
                Some((_, sum)) => *sum = *sum + form,
                None => branches.push((tau, form)),
            }
        }
        branches.sort_by(|a, b| a.0.total_cmp(&b.0));
        branches
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

    /// What the laws of A and B add to their forms; `None` for a linear one.
    pub fn excesses(&self) -> [Option<Excess>; 2] {
        self.laws().map(|(.., law)| law.excess())
    }

    /// The forms of A and B with the largest excess: their largest tangents.
    pub fn upper_forms(&self) -> [Form; 2] {
        let (forms, excesses) = (self.forms(), self.excesses());
        std::array::from_fn(|i| match &excesses[i] {
            None => forms[i],
            Some(excess) => forms[i].plus(&excess.largest()),
        })
    }

    /// The key of the first law that is not linear.
    pub(crate) fn nonlinear_key(&self) -> Option<&'static str> {
        let mut laws = self.laws().into_iter();
        laws.find_map(|(key, _, law)| law.excess().map(|_| key))
    }

    /// Values of all laws, by their paths below the material; what follows from a data sheet has no keys of its own.
    pub fn parameters(&self) -> Vec<(String, Parameter)> {
        let of = |key: &str, unit: &'static str, law: &dyn Law| -> Vec<(String, Parameter)> {
            let path = |p: Parameter| (format!("{key}.{}", p.key), p);
            law.parameters(unit).into_iter().map(path).collect()
        };
        let laws = self.laws().into_iter();
        let mut all: Vec<_> = laws
            .flat_map(|(key, unit, law)| of(key, unit, law))
            .collect();
        if let Memory::Branches(branches) = self.memory {
            for (i, branch) in branches.iter().enumerate() {
                all.extend(of(&format!("memory[{i}]"), "Pa", branch.law()));
            }
        }
        all
    }

    /// Refuses operators that are not positive in this dimension; `path` is the place of the material in the scene.
    pub(crate) fn check(&self, dimension: usize, path: &str) -> Verdict {
        self.laws()
            .into_iter()
            .try_for_each(|(key, _, law)| law.check(dimension, &format!("{path}.{key}")))?;
        self.check_plate(path)?;
        let path = format!("{path}.memory");
        let branches = self.resolved(&path)?.branches;
        memory::check(&branches, &path)?;
        branches.iter().enumerate().try_for_each(|(i, branch)| {
            let path = match self.memory {
                Memory::Branches(_) => format!("{path}[{i}]"),
                _ => path.clone(),
            };
            branch.law().check(dimension, &path)
        })
    }
}

/// Shear and bulk modulus of an isotropic form, `lambda = K - 2 G / 3`.
fn moduli(form: &Form) -> Option<Pair> {
    match form {
        Form::Isotropic { lambda, two_mu } => Some(Pair {
            shear: two_mu / 2.0,
            bulk: lambda + two_mu / 3.0,
        }),
        Form::Matrix(_) => None,
    }
}

#[cfg(test)]
mod tests;
