//! Midside nodes: the mesh of quadratic cells on the cells of a linear one.
//!
//! Corners keep their numbers; the midside nodes follow, in the order in which the cells meet their sides (the edges of the
//! cells, in the plane and in space). Where a side follows another one (periodicity), its midside node follows that of the
//! other: the two join the same leaders by the same vector. Leaders alone do not tell sides apart where an axis has one or two cells.

use super::{MAX_NODES, Mesh};
use crate::element::{self, Element, ElementKind};
use crate::error::{Error, Result};
use crate::refusal::scene_error;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Share of a side within which two vectors are the same.
const CLOSE: f64 = 1e-6;

/// Two corners, the smaller number first.
type Side = [u32; 2];

fn side(p: u32, q: u32) -> Side {
    [p.min(q), p.max(q)]
}

impl Mesh {
    /// The mesh with the element of this kind: a linear mesh gets midside nodes where the element has them.
    ///
    /// # Errors
    /// [`Error::Scene`] at `element` for an element that there is not in this dimension, or too many nodes to number;
    /// or for a quadratic mesh where a linear one is asked for.
    pub fn for_element(self, kind: ElementKind) -> Result<Mesh> {
        let Some(wanted) = element::of(kind, self.dimension) else {
            let found = format!("{:?} in {} dimensions", kind.name(), self.dimension);
            return Err(scene_error(
                "element",
                found,
                "an element of the mesh".to_owned(),
            ));
        };
        if self.element == wanted {
            return Ok(self);
        }
        if self.element.midsides.is_empty() {
            return self.with_midside_nodes(wanted);
        }
        let found = format!("{:?}, while the mesh has second-order cells", kind.name());
        let allowed = format!("{:?}", self.element.kind.name());
        Err(scene_error("element", found, allowed))
    }

    fn with_midside_nodes(self, element: &'static Element) -> Result<Mesh> {
        let most = self.nodes.len() + element.midsides.len() * self.cell_count();
        if most > MAX_NODES as usize {
            let allowed = "a mesh whose unknowns can be numbered with 32 bits".to_owned();
            return Err(scene_error(
                "element",
                format!("up to {most} nodes"),
                allowed,
            ));
        }
        let mut cell_nodes = Vec::with_capacity(element.nodes * self.cell_count());
        let corners = self.nodes.len() as u32;
        let mut sides = Sides::default();
        for cell in self.cells() {
            cell_nodes.extend(cell);
            for [i, j] in element.midsides {
                cell_nodes.push(corners + sides.number(side(cell[*i], cell[*j])));
            }
        }
        let mut nodes = self.nodes.clone();
        nodes.extend(sides.ends.iter().map(|ends| {
            let [p, q] = ends.map(|node| self.nodes[node as usize]);
            std::array::from_fn::<f64, 3, _>(|i| 0.5 * (p[i] + q[i]))
        }));
        let mut leader = self.leader.clone();
        leader.extend(sides.leaders(&self).iter().map(|number| corners + number));
        let mut parts = BTreeMap::new();
        for (name, faces) in &self.parts {
            let per_face = self.element.face_nodes();
            let mut with_middles =
                Vec::with_capacity(faces.len() / per_face * element.face_nodes());
            for face in faces.chunks_exact(per_face) {
                with_middles.extend(face);
                for [i, j] in element.face_midsides {
                    let Some(number) = sides.number.get(&side(face[*i], face[*j])) else {
                        return Err(Error::Body {
                            what: format!("a face of the part \"{name}\" is the side of no cell"),
                        });
                    };
                    with_middles.push(corners + number);
                }
            }
            parts.insert(name.clone(), with_middles);
        }
        Ok(Mesh {
            element,
            nodes,
            cell_nodes,
            parts,
            leader,
            ..self
        })
    }
}

fn squared(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

/// The sides of the cells of a mesh, numbered as they are met.
#[derive(Default)]
struct Sides {
    ends: Vec<Side>,
    number: BTreeMap<Side, u32>,
}

impl Sides {
    fn number(&mut self, ends: Side) -> u32 {
        let next = self.ends.len() as u32;
        let number = *self.number.entry(ends).or_insert(next);
        if number == next {
            self.ends.push(ends);
        }
        number
    }

    /// The side that each side follows: of those that are the same up to a period the one with most ends that lead.
    fn leaders(&self, mesh: &Mesh) -> Vec<u32> {
        let mut same: BTreeMap<Side, Vec<Alike>> = BTreeMap::new();
        let mut place = Vec::with_capacity(self.ends.len());
        for (number, &ends) in (0..).zip(&self.ends) {
            let vector = vector_between_leaders(mesh, ends);
            let lead = |node: &u32| mesh.leader[*node as usize] == *node;
            let leading_ends = ends.iter().filter(|node| lead(node)).count();
            let key = ends.map(|node| mesh.leader[node as usize]);
            let key = side(key[0], key[1]);
            let group = same.entry(key).or_default();
            let index = match group.iter().position(|other| is_same(other.vector, vector)) {
                Some(index) => {
                    let kept = &mut group[index];
                    if leading_ends > kept.leading_ends {
                        (kept.number, kept.leading_ends) = (number, leading_ends);
                    }
                    index
                }
                None => {
                    group.push(Alike {
                        vector,
                        number,
                        leading_ends,
                    });
                    group.len() - 1
                }
            };
            place.push((key, index));
        }
        place
            .iter()
            .map(|(key, index)| same[key][*index].number)
            .collect()
    }
}

/// Sides that are the same up to a period: their vector, and which of them leads.
struct Alike {
    vector: [f64; 3],
    number: u32,
    leading_ends: usize,
}

fn is_same(a: [f64; 3], b: [f64; 3]) -> bool {
    let difference = std::array::from_fn(|i| a[i] - b[i]);
    squared(difference) <= CLOSE * CLOSE * squared(a)
}

/// The vector along a side from the end with the smaller leader to the other one.
fn vector_between_leaders(mesh: &Mesh, [p, q]: Side) -> [f64; 3] {
    let (from, to) = (mesh.nodes[p as usize], mesh.nodes[q as usize]);
    let vector = std::array::from_fn(|i| to[i] - from[i]);
    let is_turned = match mesh.leader[p as usize].cmp(&mesh.leader[q as usize]) {
        Ordering::Less => false,
        Ordering::Greater => true,
        // both ends follow one node, and the vector has no sense of its own
        Ordering::Equal => vector.iter().find(|v| **v != 0.0).is_some_and(|v| *v < 0.0),
    };
    if is_turned {
        vector.map(|v| -v)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::ungraded;
    use super::super::{Axis, BoxMesh, MeshSpec};
    use super::*;

    #[test]
    fn every_side_gets_one_node_in_its_middle() {
        let mesh = ungraded([2.0, 1.0], [3, 2], &[]);
        let corners = mesh.nodes.len();
        let quadratic = mesh.clone().for_element(ElementKind::P2).unwrap();
        // sides of the grid and of the diagonals
        assert_eq!(quadratic.nodes.len(), corners + 3 * 3 + 4 * 2 + 4 * 6);
        assert_eq!(quadratic.nodes[..corners], mesh.nodes);
        assert_eq!(quadratic.cell_count(), mesh.cell_count());
        for (cell, linear) in quadratic.cells().zip(mesh.cells()) {
            assert_eq!(&cell[..3], linear);
        }
        assert_eq!(
            quadratic.clone().for_element(ElementKind::P2),
            Ok(quadratic.clone())
        );
        for (part, length) in [("left", 1.0), ("right", 1.0), ("bottom", 2.0), ("top", 2.0)] {
            let faces = quadratic.parts[part].chunks_exact(3);
            let lengths = faces.map(|face| {
                let [p, q, m] = [face[0], face[1], face[2]].map(|n| quadratic.nodes[n as usize]);
                assert!((0..3).all(|i| m[i] == 0.5 * (p[i] + q[i])));
                (q[0] - p[0]).hypot(q[1] - p[1])
            });
            assert!((lengths.sum::<f64>() - length).abs() < 1e-15);
        }
    }

    #[test]
    fn midside_nodes_follow_those_of_the_opposite_side() {
        for cells in [[1, 1], [2, 1], [1, 2], [2, 2], [3, 2]] {
            for periodic in [vec![Axis::X], vec![Axis::Y], vec![Axis::X, Axis::Y]] {
                let size = [2.0, 1.0];
                let mesh = ungraded(size, cells, &periodic);
                let mesh = mesh.for_element(ElementKind::P2).unwrap();
                for (p, &leader) in mesh.nodes.iter().zip(&mesh.leader) {
                    assert_eq!(mesh.leader[leader as usize], leader);
                    let q = mesh.nodes[leader as usize];
                    for (i, axis) in [Axis::X, Axis::Y].into_iter().enumerate() {
                        let wraps = periodic.contains(&axis) && p[i] == size[i];
                        assert_eq!(
                            q[i],
                            if wraps { 0.0 } else { p[i] },
                            "{cells:?} {periodic:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_quadratic_is_refused() {
        let mesh = ungraded([1.0, 1.0], [1, 1], &[]);
        let mut quadratic = mesh.clone().for_element(ElementKind::P2).unwrap();
        let back = quadratic.clone().for_element(ElementKind::P1);
        assert!(matches!(back, Err(Error::Scene { .. })));
        // midside nodes may stand where they like: they bend the sides
        quadratic.nodes[7][1] += 1e-3;
        let bent = quadratic.clone().for_element(ElementKind::P2);
        assert_eq!(bent, Ok(quadratic));
    }

    /// Every edge of a box of tetrahedra has one node in its middle, also those of the faces of its parts; across periodic sides
    /// they follow.
    #[test]
    fn quadratic_tetrahedra_conform() {
        let size = [2.0, 1.0, 1.5];
        for periodic in [vec![], vec![Axis::X], vec![Axis::X, Axis::Z]] {
            let spec = MeshSpec::Box(BoxMesh {
                size,
                cells: [2, 1, 1],
                periodic: periodic.clone(),
                ..BoxMesh::default()
            });
            let linear = Mesh::generate(&spec).unwrap();
            let mesh = linear.clone().for_element(ElementKind::P2).unwrap();
            assert_eq!(mesh.element.name, "tet10");
            assert_eq!(mesh.nodes[..linear.nodes.len()], linear.nodes);
            assert_eq!(mesh.clone().for_element(ElementKind::P2), Ok(mesh.clone()));
            for (part, faces) in &mesh.parts {
                assert_eq!(faces.len() / 6, linear.parts[part].len() / 3);
                for face in faces.chunks_exact(6) {
                    let p = |i: usize| mesh.nodes[face[i] as usize];
                    for (m, [i, j]) in mesh.element.face_midsides.iter().enumerate() {
                        assert!((0..3).all(|c| p(3 + m)[c] == 0.5 * (p(*i)[c] + p(*j)[c])));
                    }
                }
            }
            for (p, &leader) in mesh.nodes.iter().zip(&mesh.leader) {
                assert_eq!(mesh.leader[leader as usize], leader);
                let q = mesh.nodes[leader as usize];
                for (i, axis) in [Axis::X, Axis::Y, Axis::Z].into_iter().enumerate() {
                    let wraps = periodic.contains(&axis) && p[i] == size[i];
                    assert_eq!(q[i], if wraps { 0.0 } else { p[i] }, "{periodic:?}");
                }
            }
        }
    }
}
