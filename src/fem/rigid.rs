//! Motions of the body as a whole that no clamped or driven part holds, and what of them contact holds along its normals.
//!
//! On such a motion the viscosity A is singular. Where contact with normal components holds it, A gets a spring of velocity (a pin)
//! at as many normal components as there are such motions, and no more: so a field that A must not see there can vanish at the
//! pins, and nothing but the contact operator knows of them. The contact problem is solved with `S - pins`, which is that of the
//! body itself; wherever the body is given contact forces, they are those less what the pins take (`time::relative`).

use super::dofs::DofMap;
use crate::error::{Error, Result};
use crate::linalg::symmetric_eigen;
use crate::mesh::Mesh;
use crate::refusal::scene_error;
use crate::scene::Scene;
use faer::Mat;
use nalgebra::Vector3;

/// A motion is free when what is held of it is less than this share of itself, squared.
const FREE: f64 = 1e-10;
/// A contact holds a motion when the motion goes along a normal by this share of its largest.
const HELD: f64 = 1e-6;

/// A spring of velocity at a contact component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// Contact component.
    pub component: usize,
    /// Force by velocity, N s/m (2D: per metre of depth).
    pub resistance: f64,
}

/// A motion of a piece as a whole about its centre: translation, and rotation over the size of the piece.
#[derive(Clone, Copy, Default)]
struct Rigid {
    translation: Vector3<f64>,
    rotation: Vector3<f64>,
}

/// Centre and size of a piece.
struct Place {
    centre: Vector3<f64>,
    size: f64,
}

impl Rigid {
    fn at(&self, place: &Place, point: [f64; 3]) -> Vector3<f64> {
        let arm = (Vector3::from(point) - place.centre) / place.size;
        self.translation + self.rotation.cross(&arm)
    }

    fn add(&mut self, factor: f64, other: &Rigid) {
        self.translation += factor * other.translation;
        self.rotation += factor * other.rotation;
    }

    /// All motions of a body in this dimension.
    fn all(dimension: usize) -> Vec<Rigid> {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let moves = axes.iter().take(dimension).map(|axis| Rigid {
            translation: *axis,
            ..Rigid::default()
        });
        let turns = axes.iter().skip(if dimension == 2 { 2 } else { 0 });
        let turns = turns.map(|axis| Rigid {
            rotation: *axis,
            ..Rigid::default()
        });
        moves.chain(turns).collect()
    }

    /// The motion in words.
    fn name(&self, place: &Place, dimension: usize) -> String {
        let short = |v: Vector3<f64>| -> Vec<f64> {
            let round = |x: &f64| (x * 1e4).round() / 1e4 + 0.0;
            v.iter().take(dimension).map(round).collect()
        };
        let turn = self.rotation.norm();
        if turn < 1e-6 * self.translation.norm() {
            return format!("moves along {:?}", short(self.translation.normalize()));
        }
        let axis = self.rotation / turn;
        let about = place.centre + place.size * axis.cross(&self.translation) / turn;
        match dimension {
            2 => format!("turns about {:?}", short(about)),
            _ => format!(
                "turns about the axis {:?} through {:?}",
                short(axis),
                short(about)
            ),
        }
    }
}

/// The contact components at which pins hold the body where nothing but its contact does; none for a body that is held. Or why the
/// body cannot be compiled: [`Error::Scene`] for a motion that nothing holds, naming it.
///
/// # Errors
/// [`Error::Body`] where places are no numbers.
pub(super) fn pins(
    scene: &Scene,
    mesh: &Mesh,
    dofs: &DofMap,
) -> Result<std::result::Result<Vec<usize>, Error>> {
    let pieces = mesh.pieces();
    let mut own: Vec<u32> = mesh.cell_nodes.clone();
    own.sort_unstable_by_key(|node| (pieces[*node as usize], *node));
    own.dedup();
    let mut pins = Vec::new();
    for nodes in own.chunk_by(|a, b| pieces[*a as usize] == pieces[*b as usize]) {
        match pins_of_piece(scene, (mesh, dofs), nodes)? {
            Ok(own) => pins.extend(own),
            Err(free) => return Ok(Err(free)),
        }
    }
    pins.sort_unstable();
    Ok(Ok(pins))
}

fn pins_of_piece(
    scene: &Scene,
    (mesh, dofs): (&Mesh, &DofMap),
    nodes: &[u32],
) -> Result<std::result::Result<Vec<usize>, Error>> {
    let point = |node: u32| mesh.nodes[node as usize];
    let sum: Vector3<f64> = nodes.iter().map(|node| Vector3::from(point(*node))).sum();
    let centre = sum / nodes.len() as f64;
    let arms = nodes
        .iter()
        .map(|node| (Vector3::from(point(*node)) - centre).norm());
    let place = Place {
        size: arms.fold(f64::MIN_POSITIVE, f64::max),
        centre,
    };
    let free = free_motions(&place, (mesh, dofs), nodes)?;
    let mut left: Vec<Rigid> = free;
    let mut pins = Vec::new();
    // one motion after the other is held at the node that moves most along its normal
    while !left.is_empty() {
        let mut most = (0.0, 0, 0);
        if dofs.contact_components() == mesh.dimension {
            let contact = dofs.contact_nodes().iter().enumerate();
            for (index, node) in contact.filter(|(_, node)| nodes.binary_search(node).is_ok()) {
                let normal = Vector3::from(dofs.frame(*node)[mesh.dimension - 1]);
                for (which, motion) in left.iter().enumerate() {
                    let along = motion.at(&place, point(*node)).dot(&normal).abs();
                    if along > most.0 {
                        most = (along, index, which);
                    }
                }
            }
        }
        let (along, index, which) = most;
        if along < HELD {
            let found = format!(
                "parts that leave the body free as a whole: it {}",
                left[0].name(&place, mesh.dimension)
            );
            let allowed = match scene.is_pressed() {
                true => {
                    "clamped or driven parts (or rollers) that hold what contact does not hold along its normals"
                }
                false => "clamped or driven parts (or rollers) that hold the body",
            };
            return Ok(Err(scene_error("clamped", found, allowed.to_owned())));
        }
        let node = dofs.contact_nodes()[index];
        let normal = Vector3::from(dofs.frame(node)[mesh.dimension - 1]);
        let value = |motion: &Rigid| motion.at(&place, point(node)).dot(&normal);
        let held = left.swap_remove(which);
        for motion in &mut left {
            let share = value(motion) / value(&held);
            motion.add(-share, &held);
        }
        pins.push(index * mesh.dimension + mesh.dimension - 1);
    }
    Ok(Ok(pins))
}

/// The motions of a piece as a whole that no part holds, orthonormal in translation and rotation.
fn free_motions(
    place: &Place,
    (mesh, dofs): (&Mesh, &DofMap),
    nodes: &[u32],
) -> Result<Vec<Rigid>> {
    let all = Rigid::all(mesh.dimension);
    let count = all.len();
    let mut squares = Mat::<f64>::zeros(count, count);
    let mut held = vec![Vector3::zeros(); count];
    let mut add = |held: &[Vector3<f64>]| {
        for i in 0..count {
            for j in 0..count {
                squares[(i, j)] += held[i].dot(&held[j]);
            }
        }
    };
    for &node in nodes {
        let leader = mesh.leader[node as usize];
        let at = |node: u32| mesh.nodes[node as usize];
        if leader != node {
            // a follower moves as its leader does
            for (held, motion) in held.iter_mut().zip(&all) {
                *held = motion.at(place, at(node)) - motion.at(place, at(leader));
            }
            add(&held);
        }
        // an axis without length is held too
        let frame = &dofs.frame(node)[..dofs.range(node).len()];
        for (held, motion) in held.iter_mut().zip(&all) {
            let whole = motion.at(place, at(node));
            *held = frame.iter().fold(whole, |rest, axis| {
                let axis = Vector3::from(*axis);
                rest - axis * axis.dot(&whole)
            });
        }
        add(&held);
    }
    let (values, vectors) = symmetric_eigen("what holds the body", squares.as_ref())?;
    let free = values
        .iter()
        .enumerate()
        .filter(|(_, value)| **value < FREE);
    Ok(free
        .map(|(k, _)| {
            let mut sum = Rigid::default();
            for (i, motion) in all.iter().enumerate() {
                sum.add(vectors[(i, k)], motion);
            }
            sum
        })
        .collect())
}
