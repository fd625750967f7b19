//! The assembled body: `A u' + B u + E Lambda = sum of p_j(t) * column_j` on the free components.
//!
//! Contact holds the normal components, friction the tangential ones only up to its bound: a body that can still slide or turn
//! rigidly is refused. One that contact alone holds along the normal, where that is an unknown, has pins in A (see `rigid`).

use super::cell::Cell;
use super::contact::{ContactPart, ContactPatch};
use super::dofs::DofMap;
use super::driven::Drives;
use super::forms::Forms;
use super::foundation;
use super::initial::{InitialDisplacement, initial_displacement};
use super::loads::{LoadColumn, ProbeRows, load_columns, probe_rows};
use super::memory::{branch_operators, refuse_strained_memory};
use super::operators::OperatorPair;
use super::pieces::refuse_loose_pieces;
use super::rigid::{Pin, pins};
use super::strain::StrainNorm;
use crate::error::{Error, Result};
use crate::material::Form;
use crate::mesh::Mesh;
use crate::refusal::scene_error;
use crate::scene::Scene;

/// The discrete body of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The mesh.
    pub mesh: Mesh,
    /// Numbers of the free components.
    pub dofs: DofMap,
    /// Viscosity matrix A, with the pins of the contact, and elasticity matrix B.
    pub operators: OperatorPair,
    /// Contact nodes.
    pub contact: ContactPatch,
    /// One column per load of the scene, in its order.
    pub loads: Vec<LoadColumn>,
    /// Rows of each probe of the scene, in its order.
    pub probes: Vec<ProbeRows>,
    /// Motions of driven parts.
    pub drives: Drives,
    /// Velocities of the foundation at the contact components by a unit of each of its motions.
    pub foundation: Vec<Vec<f64>>,
    /// The displacement that it starts with, where it has one.
    pub initial: Option<InitialDisplacement>,
    /// Viscosity A and elasticity B in every cell, and the branches of the memory.
    pub forms: Forms,
    /// Why no model can be made of the body: a motion as a whole that nothing holds.
    pub free_motion: Option<Error>,
    /// Whether a law is not linear: the operators are then those of the lower tangents.
    pub is_nonlinear: bool,
    /// The strain norm.
    pub strain: StrainNorm,
    /// Smallest and largest relaxation rate of the materials, 1/s: bounds of all eigenvalues of `A^-1 B`, or of
    /// the pencil of the body with its memory.
    pub element_rates: [f64; 2],
}

impl Body {
    /// Generates the mesh of a scene and assembles the body on it.
    ///
    /// # Errors
    /// As [`Mesh::generate`] and [`Body::assemble_on`].
    pub fn assemble(scene: &Scene) -> Result<Body> {
        Body::assemble_on(scene, Mesh::generate(&scene.mesh)?)
    }

    /// Assembles the body on a given mesh, which gets the element of the scene; the mesh of the scene is not looked at.
    ///
    /// # Errors
    /// Those of [`Mesh::for_element`]; [`Error::Scene`] for a part the mesh does not have, a contact part that is clamped, a region
    /// without a material, a direction without length, a tangent normal to the contact, a probe outside the body or an initial
    /// displacement that does not fit what holds it; [`Error::Body`] for a cell without positive volume.
    pub fn assemble_on(scene: &Scene, mesh: Mesh) -> Result<Body> {
        let kind = scene.element.unwrap_or(mesh.element.kind);
        let mesh = mesh.for_element(kind)?;
        for (index, cell) in mesh.cells().enumerate() {
            let shape = Cell::new(&mesh, cell);
            let volume = shape.volume();
            if !(volume.is_finite() && volume > 0.0) {
                let what = match shape.is_bent() {
                    false => format!("cell {index} of the mesh has the volume {volume:e}"),
                    true => format!(
                        "the bent sides of the cell at {:?} turn it inside out (smallest Jacobian {volume:e})",
                        &mesh.centroid(cell)[..mesh.dimension]
                    ),
                };
                return Err(Error::Body { what });
            }
        }
        let forms = Forms::new(scene, &mesh)?;
        let dofs = DofMap::new(scene, &mesh)?;
        refuse_loose_pieces(&mesh, &dofs)?;
        let (pinned, free_motion) = match pins(scene, &mesh, &dofs)? {
            Ok(pinned) => (pinned, None),
            // fields of driven parts are solved for here
            Err(free) if !scene.driven.is_empty() => return Err(free),
            Err(free) => (Vec::new(), Some(free)),
        };
        if !pinned.is_empty() && scene.is_nonlinear() {
            let found = "parts that leave it to contact to hold the body along the normal";
            let allowed = "parts that hold the body: its laws are not linear";
            return Err(scene_error("clamped", found.to_owned(), allowed.to_owned()));
        }
        let mut operators = OperatorPair::from_elements(&mesh, &dofs, &forms);
        let (loads, load_rows) = load_columns(scene, &mesh, &dofs)?;
        let (probes, nodal_rows) = probe_rows(scene, &mesh, &dofs)?;
        let drives = Drives::new(
            scene,
            &mesh,
            &dofs,
            &forms,
            (&operators, &pinned),
            &interior_places(&mesh, &dofs),
            (&load_rows, &nodal_rows),
        )?;
        let pins = pin(&mut operators, dofs.contact_start(), &pinned);
        refuse_strained_memory(scene, &drives, &forms)?;
        operators.memory = branch_operators(&mesh, &dofs, &forms);
        let contact = ContactPatch {
            pins,
            ..contact_patch(scene, &mesh, &dofs)?
        };
        Ok(Body {
            initial: initial_displacement(scene, (&mesh, &dofs), &operators, &contact)?,
            foundation: foundation::motions(scene, &contact)?,
            contact,
            loads,
            probes,
            drives,
            free_motion,
            is_nonlinear: scene.is_nonlinear(),
            strain: StrainNorm::new(&mesh, &dofs, &forms),
            element_rates: forms.rates(mesh.dimension),
            operators,
            forms,
            mesh,
            dofs,
        })
    }

    /// The same body with other forms in the places of A and B, everywhere the same and without memory.
    pub(crate) fn of_forms(&self, forms: [Form; 2]) -> Body {
        let forms = Forms::uniform(&self.mesh, forms);
        Body {
            operators: OperatorPair::from_elements(&self.mesh, &self.dofs, &forms),
            element_rates: forms.rates(self.mesh.dimension),
            is_nonlinear: false,
            forms,
            ..self.clone()
        }
    }

    /// Number of free components.
    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// Whether no component is free; never so for an assembled body.
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// Number of contact components: they are the last ones.
    pub fn contact_len(&self) -> usize {
        self.contact.force_len()
    }

    /// Coordinates of the node of every component that is not a contact one, m; z = 0 in 2D.
    pub fn interior_places(&self) -> Vec<[f64; 3]> {
        interior_places(&self.mesh, &self.dofs)
    }

    /// The columns of forces: those of the loads, those of driven parts that are not zero, then that of the initial displacement.
    pub fn force_columns(&self) -> impl Iterator<Item = &Vec<(usize, f64)>> {
        let loads = self.loads.iter().map(|load| &load.entries);
        let initial = self.initial.iter().map(|initial| &initial.column);
        loads.chain(self.drives.force_columns()).chain(initial)
    }

    /// `|eps(u)|` in L2 of a field of free components.
    pub fn strain_norm(&self, field: &[f64]) -> f64 {
        let squared = match &self.strain {
            StrainNorm::Combination(x, y) => {
                let (a, b) = self.operators.product(field, field);
                x * a + y * b
            }
            StrainNorm::Assembled(values) => self.operators.square(values, field),
        };
        // the difference of two positive terms may round below zero
        squared.max(0.0).sqrt()
    }

    /// Vectors at all nodes (global axes; z = 0 in 2D) of a field of free components: displacements or velocities.
    pub fn displacement(&self, field: &[f64]) -> Vec<[f64; 3]> {
        (0..self.mesh.nodes.len() as u32)
            .map(|node| self.dofs.vector(node, field))
            .collect()
    }
}

/// Puts pins at these contact components, each as stiff as the viscosity of the body there (its elasticity, where it has none).
fn pin(operators: &mut OperatorPair, contact_start: usize, components: &[usize]) -> Vec<Pin> {
    let pin = |&component: &usize| {
        let at = operators.col_ptr[contact_start + component];
        let (a, b) = (operators.a[at], operators.b[at]);
        let resistance = if a > 0.0 { a } else { b };
        operators.a[at] += resistance;
        Pin {
            component,
            resistance,
        }
    };
    components.iter().map(pin).collect()
}

/// Coordinates of the node of every component that is not a contact one.
fn interior_places(mesh: &Mesh, dofs: &DofMap) -> Vec<[f64; 3]> {
    let mut places = vec![[0.0; 3]; dofs.contact_start()];
    for (node, leader) in mesh.leader.iter().enumerate() {
        if *leader as usize == node
            && let Some(places) = places.get_mut(dofs.range(*leader))
        {
            places.fill(mesh.nodes[node]);
        }
    }
    places
}

fn contact_patch(scene: &Scene, mesh: &Mesh, dofs: &DofMap) -> Result<ContactPatch> {
    let nodes = dofs.contact_nodes().to_vec();
    let components = mesh.dimension - 1;
    let mut faces = 0;
    let mut parts = Vec::new();
    for (contact, nodes) in scene.contacts().iter().zip(dofs.contact_ranges()) {
        let path = format!("{}.part", contact.path);
        faces += mesh.faces(&contact.part, &path)?.count();
        parts.push(ContactPart {
            name: contact.name.clone(),
            nodes: nodes.clone(),
            can_open: !contact.condition.is_default(),
        });
    }
    let tangents = |&node: &u32| {
        let frame = dofs.frame(node);
        // In 2D the second direction of the frame is the normal.
        let second = if components == 2 { frame[1] } else { [0.0; 3] };
        [frame[0], second]
    };
    let has_normal = scene.is_pressed();
    let sign = if has_normal { 1.0 } else { -1.0 };
    let normals = nodes.iter().map(|&node| {
        let normal = dofs.frame(node)[components];
        normal.map(|n| 0.0 + sign * n)
    });
    let mut patch = ContactPatch {
        has_normal,
        normals: normals.collect(),
        gaps: Vec::new(),
        points: nodes.iter().map(|&n| mesh.nodes[n as usize]).collect(),
        weights: dofs.contact_weights().to_vec(),
        tangents: nodes.iter().map(tangents).collect(),
        components,
        faces,
        parts,
        nodes,
        pins: Vec::new(),
    };
    patch.gaps = foundation::initial_gaps(scene, mesh, &patch)?;
    Ok(patch)
}
