//! The types of `scene.json`. All quantities are in SI units (2D scenes are per metre of depth).
//!
//! The JSON Schema is generated from these types, so every doc comment here is what a user reads there, and a range
//! written here (`#[schemars(...)]`) is the one that parsing enforces. Rules that tie several values together are in
//! `validate.rs`.

mod boundary;
mod condition;
mod fidelity;
mod friction;
mod initial;
mod motion;
mod run;

pub use boundary::*;
pub use condition::*;
pub use fidelity::*;
pub use friction::*;
pub use initial::*;
pub use motion::*;
pub use run::*;

pub use crate::element::ElementKind;
pub use crate::expression::{PlaceFormula, PlaceValue};
pub use crate::material::{
    Base, Branch, BulkMemory, CarreauViscosity, Convention, Deviator, DynamicMemory, Elasticity,
    FractionalKernel, FractionalMemory, Frequency, HenckyElasticity, IsotropicBranch,
    IsotropicElasticity, IsotropicViscosity, Material, MatrixLaw, Memory, Moduli, Orthotropic,
    RegionMaterial, RelativeMemory, RelativeTerm, RelaxationMemory, Viscosity, VonMisesElasticity,
};
pub use crate::mesh::{Axis, BoxMesh, GmshMesh, Grid, MeshSpec, Rectangle, Refinement, RegionBox};

use crate::element::{self, Element};
use crate::material::Operators;
use crate::mesh::Extent;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A viscoelastic body in frictional contact with a rigid foundation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Version of this format: 1.
    #[schemars(extend("const" = 1))]
    pub schema_version: u32,
    /// Name of the scene.
    pub name: String,
    /// Mesh of the body.
    pub mesh: MeshSpec,
    /// Finite element. Default: `p1`, or for a mesh from a file the one of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "ElementKind")]
    pub element: Option<ElementKind>,
    /// Material of the whole body; or else `materials`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Material")]
    pub material: Option<Material>,
    /// Materials by region, one for every region that has cells; or else `material`. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<RegionMaterial>,
    /// Names of the parts on which the body is clamped (velocity and displacement zero). At least one, or a driven one: without
    /// it the body could slide rigidly along the foundation, and without inertia nothing would determine its motion.
    #[serde(default)]
    pub clamped: Vec<String>,
    /// Names of the parts that roll: no motion along their normals, none hindered along them (a plane of symmetry, a guide). Default:
    /// none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rollers: Vec<String>,
    /// Parts whose motion is given; each direction is an input of the component. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub driven: Vec<Driven>,
    /// What the body starts with. Default: at rest and undeformed.
    #[serde(default, skip_serializing_if = "Initial::is_default")]
    pub initial: Initial,
    /// Contact with the foundation; or else `contacts`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Contact")]
    pub contact: Option<Contact>,
    /// Contacts, each with its own part, law and ports; or else `contact`. Arrays over all contact nodes go through them in this
    /// order. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 16))]
    pub contacts: Vec<Contact>,
    /// Loads; each is an input of the component. Default: none.
    #[serde(default)]
    pub loads: Vec<Load>,
    /// Points whose displacement and velocity are outputs. Default: none.
    #[serde(default)]
    pub probes: Vec<Probe>,
    /// Time integration.
    pub time: Time,
    /// Speed against accuracy.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// Recorded past of the contact.
    #[serde(default)]
    pub history: History,
    /// What `stickslip run` does with the scene.
    #[serde(default)]
    pub run: Run,
}

/// A material of a scene: what it is of, and where it stands.
pub(crate) struct Placed<'a> {
    /// Its place in the scene: `material` or `materials[i]`.
    pub path: String,
    /// Its region; `None` for the whole body.
    pub region: Option<&'a str>,
    pub operators: Operators<'a>,
}

/// A contact of a scene, and where it stands.
pub struct PlacedContact<'a> {
    /// Its place in the scene: `contact` or `contacts[i]`.
    pub path: String,
    contact: &'a Contact,
}

impl std::ops::Deref for PlacedContact<'_> {
    type Target = Contact;

    fn deref(&self) -> &Contact {
        self.contact
    }
}

impl Scene {
    /// The contacts, in their order.
    pub fn contacts(&self) -> Vec<PlacedContact<'_>> {
        let one = self.contact.iter().map(|contact| PlacedContact {
            path: CONTACT.to_owned(),
            contact,
        });
        let listed = self.contacts.iter().enumerate();
        let several = listed.map(|(i, contact)| PlacedContact {
            path: format!("contacts[{i}]"),
            contact,
        });
        one.chain(several).collect()
    }

    /// The contacts without their places.
    pub(crate) fn each_contact(&self) -> impl Iterator<Item = &Contact> {
        self.contact.iter().chain(&self.contacts)
    }

    /// The materials, in their order.
    pub(crate) fn materials(&self) -> Vec<Placed<'_>> {
        let whole = self.material.iter().map(|m| Placed {
            path: "material".to_owned(),
            region: None,
            operators: Operators {
                viscosity: &m.viscosity,
                elasticity: &m.elasticity,
                memory: &m.memory,
            },
        });
        let by_region = self.materials.iter().enumerate().map(|(i, m)| Placed {
            path: format!("materials[{i}]"),
            region: Some(&m.region),
            operators: Operators {
                viscosity: &m.viscosity,
                elasticity: &m.elasticity,
                memory: &m.memory,
            },
        });
        whole.chain(by_region).collect()
    }

    /// Whether a law of a material is not linear.
    pub fn is_nonlinear(&self) -> bool {
        let mut materials = self.materials().into_iter();
        materials.any(|material| material.operators.nonlinear_key().is_some())
    }

    /// Declared values of the materials, by their paths in the scene.
    pub fn material_parameters(&self) -> Vec<(String, crate::material::Parameter)> {
        let of = |placed: Placed| {
            let parameters = placed.operators.parameters().into_iter();
            parameters.map(move |(key, p)| (format!("{}.{key}", placed.path), p))
        };
        self.materials().into_iter().flat_map(of).collect()
    }

    /// The materials with memory: their places in the scene, how many branches each has, and the largest relative error of the fit
    /// that these come from, where there was one.
    pub fn memories(&self) -> Vec<(String, usize, Option<f64>)> {
        let with_memory = self.materials().into_iter();
        with_memory
            .filter(|placed| !placed.operators.memory.is_none())
            .map(|placed| {
                let (branches, error) = placed.operators.memory_fit();
                (format!("{}.memory", placed.path), branches, error)
            })
            .collect()
    }

    /// Whether all materials have a dashpot, so that velocities at a given displacement are determined.
    pub(crate) fn has_dashpots(&self) -> bool {
        let mut materials = self.materials().into_iter();
        materials.all(|placed| placed.operators.has_dashpot())
    }

    /// The time scheme, with what `auto` stands for.
    pub fn scheme(&self) -> Scheme {
        match self.time.scheme {
            Scheme::Auto if self.can_open() || self.has_approach() || !self.has_dashpots() => {
                Scheme::TrBdf2
            }
            Scheme::Auto => Scheme::Trapezoid,
            given => given,
        }
    }

    /// Whether the foundation moves along its normal.
    pub(crate) fn has_approach(&self) -> bool {
        let is_approach = |motion: &Foundation| matches!(motion, Foundation::Approach { .. });
        let mut motions = self.each_contact().flat_map(|contact| &contact.foundation);
        motions.any(is_approach)
    }

    /// Whether contact can open or give way somewhere.
    pub(crate) fn can_open(&self) -> bool {
        self.each_contact()
            .any(|contact| !contact.condition.is_default())
    }

    /// Whether a step needs the normal motion and force of the contact nodes: where contact opens or gives way, where friction
    /// depends on the pressure, where the foundation moves along its normal, and where the pressure is asked for. What one contact
    /// needs all of them get.
    pub fn is_pressed(&self) -> bool {
        let needs = |contact: &Contact| contact.pressure || contact.friction.needs_pressure();
        self.can_open() || self.has_approach() || self.each_contact().any(needs)
    }

    /// Names and starts of all inputs in their order: loads, driven directions, motions of the foundation.
    pub fn inputs(&self) -> impl Iterator<Item = (&str, f64)> {
        let loads = self
            .loads
            .iter()
            .map(|load| (load.name.as_str(), load.start));
        let directions = self.driven.iter().flat_map(|d| d.directions.keys());
        let driven = directions.map(|name| (name.as_str(), 0.0));
        let motions = self.each_contact().flat_map(|contact| &contact.foundation);
        let foundation = motions.map(|m| (m.name(), m.start()));
        loads.chain(driven).chain(foundation)
    }

    /// How large the mesh is, and all contacts on it; `None` where only the file of the mesh says that.
    pub fn extent(&self, element: &Element) -> Option<Extent> {
        let extents = self.each_contact();
        let extents = extents.map(|contact| self.mesh.extent(element, &contact.part));
        extents.reduce(|all, one| {
            let (all, one) = (all?, one?);
            let contact = all.contact + one.contact;
            Some(Extent { contact, ..all })
        })?
    }

    /// The table of the element in the dimension of the mesh; `None` where only the file of the mesh says the dimension.
    pub fn element_table(&self) -> Option<&'static Element> {
        self.mesh
            .dimension()
            .map(|dimension| self.element_in(dimension))
    }

    /// The table of the element in a dimension.
    pub(crate) fn element_in(&self, dimension: usize) -> &'static Element {
        let kind = self.element.unwrap_or_default();
        element::of(kind, dimension).unwrap_or_else(|| element::linear(dimension))
    }
}
