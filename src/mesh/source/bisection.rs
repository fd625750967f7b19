//! Local refinement of the criss-cross: newest vertex bisection.
//!
//! A triangle (p, q, r) is bisected through the middle m of its first side into (r, p, m) and (q, r, m), whose first sides
//! face the newest vertex. The neighbour across the side is bisected with it; where that is not the first side of the
//! neighbour, the neighbour is bisected first. Started from the criss-cross, whose first sides are those of the grid and
//! shared by both neighbours, this ends and gives a conforming mesh with finitely many shapes (Mitchell, ACM Trans. Math.
//! Softw. 15 (1989) 326-347; Binev, Dahmen and DeVore, Numer. Math. 97 (2004) 219-268).

use super::criss_cross::CrissCross;
use super::refinement::Refinement;
use crate::error::Result;
use crate::mesh::MAX_NODES;
use crate::refusal::scene_error;
use std::collections::BTreeMap;

/// Bisects every triangle that touches the box of a refinement until its longest side has at most its size.
///
/// # Errors
/// [`crate::Error::Scene`] at the refinement that makes more nodes than can be numbered.
pub(super) fn refine(plane: &mut CrissCross, refinements: &[Refinement]) -> Result<()> {
    if refinements.is_empty() {
        return Ok(());
    }
    let mut bisection = Bisection::of(plane);
    for (i, refinement) in refinements.iter().enumerate() {
        // a pass bisects every triangle that is too large once, or more often as its neighbours ask
        loop {
            let before = bisection.triangles.len();
            for number in 0..before {
                if bisection.is_there[number] && bisection.is_large(number, refinement) {
                    bisection.bisect(number);
                }
            }
            if bisection.triangles.len() == before {
                break;
            }
            // a pass can double the nodes: their numbers still fit 32 bits
            let nodes = bisection.plane.nodes.len();
            if nodes as u64 > u64::from(MAX_NODES) {
                return Err(scene_error(
                    &format!("mesh.refine[{i}].size"),
                    format!(
                        "{}, which makes {nodes} nodes",
                        crate::message::number(refinement.size)
                    ),
                    format!("at most {MAX_NODES} nodes"),
                ));
            }
        }
    }
    let Bisection {
        triangles,
        is_there,
        ..
    } = bisection;
    let kept = triangles.into_iter().zip(is_there);
    plane.triangles = kept
        .filter_map(|(t, is_there)| is_there.then_some(t))
        .collect();
    Ok(())
}

/// A side without a sense.
fn side(p: u32, q: u32) -> [u32; 2] {
    [p.min(q), p.max(q)]
}

struct Bisection<'a> {
    plane: &'a mut CrissCross,
    /// All triangles so far, the side to be bisected first.
    triangles: Vec<[u32; 3]>,
    /// Whether each triangle has not been bisected.
    is_there: Vec<bool>,
    /// The triangles at each side: two, or one on the boundary.
    around: BTreeMap<[u32; 2], Vec<usize>>,
}

impl Bisection<'_> {
    fn of(plane: &mut CrissCross) -> Bisection<'_> {
        let triangles = std::mem::take(&mut plane.triangles);
        let mut bisection = Bisection {
            plane,
            triangles: Vec::with_capacity(2 * triangles.len()),
            is_there: Vec::with_capacity(2 * triangles.len()),
            around: BTreeMap::new(),
        };
        for triangle in triangles {
            bisection.add(triangle);
        }
        bisection
    }

    fn add(&mut self, triangle: [u32; 3]) {
        let number = self.triangles.len();
        self.triangles.push(triangle);
        self.is_there.push(true);
        for [p, q] in sides(triangle) {
            self.around.entry(side(p, q)).or_default().push(number);
        }
    }

    fn remove(&mut self, number: usize) {
        self.is_there[number] = false;
        for [p, q] in sides(self.triangles[number]) {
            if let Some(around) = self.around.get_mut(&side(p, q)) {
                around.retain(|other| *other != number);
            }
        }
    }

    /// The other triangle at the first side of a triangle.
    fn neighbour(&self, number: usize) -> Option<usize> {
        let [p, q, _] = self.triangles[number];
        let around = self.around.get(&side(p, q))?;
        around.iter().copied().find(|other| *other != number)
    }

    /// Bisects a triangle and its neighbour. The recursion is as deep as there are levels of bisection.
    fn bisect(&mut self, number: usize) {
        let [p, q, _] = self.triangles[number];
        let has_same_side = |bisection: &Self, other: usize| {
            let [r, s, _] = bisection.triangles[other];
            side(r, s) == side(p, q)
        };
        while let Some(other) = self.neighbour(number) {
            if has_same_side(self, other) {
                break;
            }
            self.bisect(other);
        }
        let middle = self.add_middle(p, q);
        let both = [Some(number), self.neighbour(number)];
        for number in both.into_iter().flatten() {
            let [p, q, r] = self.triangles[number];
            self.remove(number);
            self.add([r, p, middle]);
            self.add([q, r, middle]);
        }
    }

    fn add_middle(&mut self, p: u32, q: u32) -> u32 {
        let plane = &mut *self.plane;
        let number = plane.nodes.len() as u32;
        let (a, b) = (p as usize, q as usize);
        let ends = [plane.nodes[a], plane.nodes[b]];
        let middle = std::array::from_fn(|i| 0.5 * (ends[0][i] + ends[1][i]));
        plane.nodes.push(middle);
        // the sides are straight: what joins two of their points lies on them
        plane.sides.push(plane.sides[a] & plane.sides[b]);
        plane.leader.push(number);
        number
    }

    fn is_large(&self, number: usize, refinement: &Refinement) -> bool {
        let corners = self.triangles[number].map(|node| {
            let [x, y, _] = self.plane.nodes[node as usize];
            [x, y]
        });
        let longest = [(0, 1), (1, 2), (2, 0)]
            .map(|(i, j)| (corners[j][0] - corners[i][0]).hypot(corners[j][1] - corners[i][1]))
            .into_iter()
            .fold(0.0, f64::max);
        longest > refinement.size && touches(corners, refinement.from, refinement.upper())
    }
}

fn sides([p, q, r]: [u32; 3]) -> [[u32; 2]; 3] {
    [[p, q], [q, r], [r, p]]
}

/// Whether a counter-clockwise triangle and an axis-parallel box have a point in common: no axis and no side separates them.
fn touches(corners: [[f64; 2]; 3], low: [f64; 2], high: [f64; 2]) -> bool {
    // points on a side may lie beside it by rounding
    const ROUNDING: f64 = 1e-12;
    let is_apart_along = |axis: usize| {
        let values = corners.map(|p| p[axis]);
        let least = values.into_iter().fold(f64::INFINITY, f64::min);
        let most = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let room = ROUNDING * (most - least);
        most < low[axis] - room || least > high[axis] + room
    };
    let is_beside = |i: usize| {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        let along = [q[0] - p[0], q[1] - p[1]];
        // largest distance of the box to the inner side, times the length of the side
        let x = if along[1] > 0.0 { low[0] } else { high[0] };
        let y = if along[0] > 0.0 { high[1] } else { low[1] };
        let inside = along[0] * (y - p[1]) - along[1] * (x - p[0]);
        inside < -ROUNDING * (along[0] * along[0] + along[1] * along[1])
    };
    !(is_apart_along(0) || is_apart_along(1) || (0..3).any(is_beside))
}

#[cfg(test)]
mod tests {
    use super::super::{MeshSource, Rectangle};
    use super::*;
    use crate::mesh::Mesh;

    fn mesh(cells: [u32; 2], refinements: &[Refinement]) -> Mesh {
        let source = Rectangle {
            size: [1.0, 0.5],
            cells,
            refine: refinements.to_vec(),
            ..Rectangle::default()
        };
        source.mesh(&crate::files::NoFiles).unwrap()
    }

    fn point(from: [f64; 2], size: f64) -> Refinement {
        Refinement {
            from,
            to: None,
            size,
        }
    }

    fn area(mesh: &Mesh, cell: &[u32]) -> f64 {
        let [p, q, r] = [0, 1, 2].map(|i| mesh.nodes[cell[i] as usize]);
        0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]))
    }

    #[test]
    fn refined_meshes_conform_and_keep_their_parts() {
        let places = [
            point([0.0, 0.5], 1e-4),
            point([0.31, 0.2], 0.01),
            Refinement {
                from: [0.55, 0.0],
                to: Some([0.62, 0.03]),
                size: 4e-3,
            },
        ];
        for cells in [[4, 2], [5, 1], [1, 3]] {
            let mesh = mesh(cells, &places);
            let total: f64 = mesh.cells().map(|c| area(&mesh, c)).sum();
            assert!((total - 0.5).abs() < 1e-12, "{cells:?}: {total}");
            assert!(mesh.cells().all(|c| area(&mesh, c) > 0.0));
            let mut uses: BTreeMap<[u32; 2], u32> = BTreeMap::new();
            for cell in mesh.cells() {
                for [p, q] in sides([cell[0], cell[1], cell[2]]) {
                    *uses.entry(side(p, q)).or_default() += 1;
                }
            }
            assert!(uses.values().all(|&n| n <= 2));
            // a hanging node would leave a side with one triangle inside the body
            let mut outer = 0;
            for (part, length) in [("left", 0.5), ("right", 0.5), ("bottom", 1.0), ("top", 1.0)] {
                let mut sum = 0.0;
                for face in mesh.parts[part].chunks_exact(2) {
                    let [p, q] = [0, 1].map(|i| mesh.nodes[face[i] as usize]);
                    sum += (q[0] - p[0]).hypot(q[1] - p[1]);
                    assert_eq!(uses[&side(face[0], face[1])], 1);
                    outer += 1;
                }
                assert!((sum - length).abs() < 1e-12, "{part}");
            }
            assert_eq!(uses.values().filter(|n| **n == 1).count(), outer);
        }
    }

    #[test]
    fn triangles_at_the_place_are_as_small_as_asked_and_few() {
        let coarse = mesh([4, 2], &[]).cell_count();
        let mut counts = Vec::new();
        for size in [0.1, 0.01, 0.001, 1e-4] {
            let place = point([0.0, 0.5], size);
            let mesh = mesh([4, 2], std::slice::from_ref(&place));
            for cell in mesh.cells() {
                let corners = [0, 1, 2].map(|i| mesh.nodes[cell[i] as usize]);
                let longest = [(0, 1), (1, 2), (2, 0)]
                    .map(|(i, j)| {
                        (corners[i][0] - corners[j][0]).hypot(corners[i][1] - corners[j][1])
                    })
                    .into_iter()
                    .fold(0.0, f64::max);
                let touches = touches(corners.map(|p| [p[0], p[1]]), [0.0, 0.5], [0.0, 0.5]);
                assert!(!touches || longest <= size);
                // right isosceles triangles stay that
                assert!((area(&mesh, cell) / (longest * longest) - 0.25).abs() < 1e-9);
            }
            counts.push(mesh.cell_count() - coarse);
        }
        // some four triangles for every halving of the size, however small it is
        let growth: Vec<_> = counts.windows(2).map(|c| c[1] - c[0]).collect();
        assert!(growth.iter().all(|g| (10..20).contains(g)), "{counts:?}");
    }

    #[test]
    fn boxes_touch_triangles_they_meet() {
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for (low, high, expected) in [
            ([0.2, 0.2], [0.2, 0.2], true),
            ([0.5, 0.5], [0.5, 0.5], true),
            ([0.6, 0.6], [0.6, 0.6], false),
            ([0.6, 0.6], [2.0, 2.0], false),
            ([0.4, 0.4], [2.0, 2.0], true),
            ([-1.0, -1.0], [2.0, 2.0], true),
            ([-1.0, -1.0], [0.0, 0.0], true),
            ([-1.0, -1.0], [-0.1, 2.0], false),
            ([1.0, 0.0], [1.0, 3.0], true),
            ([0.3, -0.5], [0.4, -0.1], false),
        ] {
            assert_eq!(touches(triangle, low, high), expected, "{low:?} {high:?}");
        }
    }
}
