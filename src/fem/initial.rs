//! The displacement u0 that the body starts with.
//!
//! The displacement is split, `u = u0 + u~` with `u~` zero at the start. Then u0 enters as one more column of forces with a constant
//! intensity of 1,
//!
//! ```text
//! A u~' + B u~ + E Lambda = F f - B u0
//! ```
//!
//! as an offset of what is seen of displacements, and in the elastic energy `1/2 u0.B u0 + u0.B u~ + 1/2 u~.B u~`. Memory that starts
//! relaxed at u0 sees `u~` alone. So every model of the body is the one without u0.

use super::contact::ContactPatch;
use super::dofs::DofMap;
use super::operators::OperatorPair;
use crate::error::Result;
use crate::expression::{PlaceProgram, PlaceValue};
use crate::mesh::Mesh;
use crate::refusal::scene_error;
use crate::scene::{Condition, Scene};
use nalgebra::Vector3;

const PATH: &str = "initial.displacement";

/// Share of the largest displacement up to which a component that must vanish counts as zero.
const ROUNDING: f64 = 1e-9;

/// What a body starts with.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialDisplacement {
    /// u0 on the free components, m.
    pub field: Vec<f64>,
    /// `-B u0` on the free components, ascending, N; without zeros.
    pub column: Vec<(usize, f64)>,
    /// `1/2 u0.B u0`, J.
    pub energy: f64,
}

/// The initial displacement of a scene; `None` where it has none, or zero.
///
/// # Errors
/// [`crate::Error::Scene`] for one that is not finite, moves a clamped or driven part, or leaves the contact where that cannot be.
pub(super) fn initial_displacement(
    scene: &Scene,
    (mesh, dofs): (&Mesh, &DofMap),
    operators: &OperatorPair,
    contact: &ContactPatch,
) -> Result<Option<InitialDisplacement>> {
    if scene.initial.displacement.is_empty() {
        return Ok(None);
    }
    let nodal = nodal(scene, mesh)?;
    let largest = nodal.iter().fold(0.0_f64, |most, v| most.max(v.amax()));
    if largest == 0.0 {
        return Ok(None);
    }
    let allowed = ROUNDING * largest;
    let mut field = vec![0.0; dofs.len()];
    let mut has_cell = vec![false; nodal.len()];
    for &node in &mesh.cell_nodes {
        has_cell[node as usize] = true;
    }
    for (node, u) in (0..).zip(&nodal) {
        let leader = mesh.leader[node as usize];
        let mut held = *u;
        for (dof, axis) in dofs.range(node).zip(dofs.frame(node)) {
            let axis = Vector3::from(*axis);
            let along = axis.dot(u);
            held -= axis * along;
            if leader == node {
                field[dof] = if along.abs() > allowed { along } else { 0.0 };
            }
        }
        let refuse = |what: &str, allowed: &str| {
            let at = &mesh.nodes[node as usize][..mesh.dimension];
            let found = format!("{:?} at {what} {at:?}", &u.as_slice()[..mesh.dimension]);
            Err(scene_error(PATH, found, allowed.to_owned()))
        };
        if leader != node && (nodal[leader as usize] - u).amax() > allowed {
            return refuse(
                "the periodic node",
                "the same displacement on both periodic sides",
            );
        }
        if has_cell[node as usize] && held.amax() > allowed {
            return match dofs.contact_index(node) {
                Some(_) => refuse("the contact node", "a displacement along the foundation"),
                None => refuse(
                    "the clamped, driven or held node",
                    "0 where the body is held",
                ),
            };
        }
    }
    check_contact(scene, contact, &field[dofs.contact_start()..], allowed)?;
    let mut force = vec![0.0; field.len()];
    operators.apply(&operators.b, &field, &mut force);
    let energy = 0.5 * field.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>();
    let column = force.iter().enumerate().filter(|(_, f)| **f != 0.0);
    Ok(Some(InitialDisplacement {
        column: column.map(|(dof, f)| (dof, -f)).collect(),
        field,
        energy,
    }))
}

/// The given values at all nodes; z = 0 in 2D.
fn nodal(scene: &Scene, mesh: &Mesh) -> Result<Vec<Vector3<f64>>> {
    let mut nodal = vec![Vector3::zeros(); mesh.nodes.len()];
    for (c, value) in scene.initial.displacement.iter().enumerate() {
        let program: Option<PlaceProgram> = match value {
            PlaceValue::Number(_) => None,
            PlaceValue::Formula(formula) => Some(formula.parse().map_err(|fault| {
                let path = format!("{PATH}[{c}].expression");
                scene_error(&path, fault.to_string(), "a formula of x, y, z".to_owned())
            })?),
        };
        for (u, at) in nodal.iter_mut().zip(&mesh.nodes) {
            let found = match (&program, value) {
                (Some(program), _) => program.value(at),
                (None, PlaceValue::Number(value)) => *value,
                (None, PlaceValue::Formula(_)) => 0.0,
            };
            if !found.is_finite() {
                let found = format!("{found} at {:?}", &at[..mesh.dimension]);
                let path = format!("{PATH}[{c}]");
                return Err(scene_error(&path, found, "finite numbers".to_owned()));
            }
            u[c] = found;
        }
    }
    Ok(nodal)
}

/// Where the body has a component along the normal although it may not leave the foundation, or may not enter it.
fn check_contact(
    scene: &Scene,
    contact: &ContactPatch,
    on_contact: &[f64],
    allowed: f64,
) -> Result<()> {
    if !contact.has_normal {
        return Ok(());
    }
    let contacts = scene.contacts();
    for (node, own) in on_contact.chunks(contact.stride()).enumerate() {
        let normal = own[contact.components];
        let (is_wrong, what) = match contacts[contact.part_of(node)].condition {
            Condition::Bilateral => (
                normal.abs() > allowed,
                "a displacement along the foundation",
            ),
            Condition::Unilateral { .. } => (
                contact.gaps[node] + normal < -allowed,
                "a displacement that leaves no node inside the foundation",
            ),
            Condition::Compliance { .. } => (false, ""),
        };
        if is_wrong {
            let at = contact.points[node];
            let found = format!("{normal} along the normal at the contact node {at:?}");
            return Err(scene_error(PATH, found, what.to_owned()));
        }
    }
    Ok(())
}
