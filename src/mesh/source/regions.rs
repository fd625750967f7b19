//! Regions of a generated mesh: boxes that pick cells by their centroids.

use crate::error::Result;
use crate::mesh::Mesh;
use crate::message::{cut, number};
use crate::refusal::{Refusal, Verdict, ensure, json};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name of the region of all cells that are in no box.
pub const BODY: &str = "body";

/// A box of cells with a name: the cells whose centroids it contains. Boxes with the same name are one region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionBox {
    /// Name of the region; not `body`, which is what is in no box.
    pub name: String,
    /// Corner of the box with the smaller coordinates, m, one per dimension.
    pub from: Vec<f64>,
    /// Corner of the box with the larger coordinates, m, one per dimension.
    pub to: Vec<f64>,
}

/// Refuses boxes that cannot be.
pub(super) fn check(boxes: &[RegionBox], dimension: usize) -> Verdict {
    for (i, RegionBox { name, from, to }) in boxes.iter().enumerate() {
        let path = format!("mesh.regions[{i}]");
        ensure(name != BODY && !name.is_empty(), || {
            let allowed = "a name other than \"body\", which is what is in no box";
            Refusal::new(format!("{path}.name"), json(name), allowed)
        })?;
        for (key, corner) in [("from", from), ("to", to)] {
            ensure(corner.len() == dimension, || {
                let allowed = format!("{dimension} numbers, one per dimension");
                Refusal::new(format!("{path}.{key}"), json(corner), allowed)
            })?;
        }
        for (axis, (low, high)) in from.iter().zip(to).enumerate() {
            // written so that a number that is none is refused
            ensure(low.is_finite() && high.is_finite() && low < high, || {
                let allowed = format!("a finite number > {} ({path}.from)", number(*low));
                Refusal::new(format!("{path}.to[{axis}]"), number(*high), allowed)
            })?;
        }
    }
    Ok(())
}

/// Names that regions may have: those of the boxes, then [`BODY`].
pub(super) fn names(boxes: &[RegionBox]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for region in boxes {
        if !names.contains(&region.name.as_str()) {
            names.push(&region.name);
        }
    }
    names.push(BODY);
    names
}

/// Gives every cell its region.
///
/// # Errors
/// [`crate::Error::Scene`] for a box without cells, and for a cell in boxes of two names.
pub(super) fn assign(boxes: &[RegionBox], mut mesh: Mesh) -> Result<Mesh> {
    if boxes.is_empty() {
        return Ok(mesh);
    }
    let refuse = |i: usize, found: String, allowed: &str| {
        let path = format!("mesh.regions[{i}]");
        Err(Refusal::new(path, found, allowed).of("scene"))
    };
    let names = names(boxes);
    let number = |name: &str| names.iter().position(|n| *n == name).unwrap_or(0) as u32;
    let body = number(BODY);
    let mut is_used = vec![false; boxes.len()];
    let mut regions = Vec::with_capacity(mesh.cell_count());
    for cell in mesh.cells() {
        let centre = mesh.centroid(cell);
        let contains = |b: &RegionBox| {
            let corners = b.from.iter().zip(&b.to);
            corners
                .zip(centre)
                .all(|((low, high), x)| (*low..=*high).contains(&x))
        };
        let mut found: Option<usize> = None;
        for (i, region) in boxes.iter().enumerate().filter(|(_, b)| contains(b)) {
            is_used[i] = true;
            if let Some(other) = found.filter(|o| boxes[*o].name != region.name) {
                let found = format!(
                    "{:?} with the cell at {:?}, which {:?} (mesh.regions[{other}]) has too",
                    cut(&region.name),
                    &centre[..mesh.dimension],
                    cut(&boxes[other].name),
                );
                return refuse(i, found, "boxes without common cells, or of the same name");
            }
            found = Some(i);
        }
        regions.push(found.map_or(body, |i| number(&boxes[i].name)));
    }
    if let Some(i) = is_used.iter().position(|used| !used) {
        let found = format!("{:?}, a box without cells", cut(&boxes[i].name));
        return refuse(i, found, "boxes that contain the centroid of a cell");
    }
    mesh.regions = names.into_iter().map(str::to_owned).collect();
    if !regions.contains(&body) {
        // the last one: the numbers of the others stay
        mesh.regions.pop();
    }
    mesh.cell_regions = regions;
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::super::{MeshSpec, Rectangle};
    use super::*;
    use crate::Error;

    fn region(name: &str, from: [f64; 2], to: [f64; 2]) -> RegionBox {
        RegionBox {
            name: name.to_owned(),
            from: from.to_vec(),
            to: to.to_vec(),
        }
    }

    fn mesh(regions: Vec<RegionBox>) -> Result<Mesh> {
        Mesh::generate(&MeshSpec::Rectangle(Rectangle {
            size: [2.0, 1.0],
            cells: [4, 2],
            regions,
            ..Rectangle::default()
        }))
    }

    fn counts(mesh: &Mesh) -> Vec<usize> {
        let of = |r: usize| {
            mesh.cell_regions
                .iter()
                .filter(|c| **c as usize == r)
                .count()
        };
        (0..mesh.regions.len()).map(of).collect()
    }

    #[test]
    fn cells_belong_to_the_box_of_their_centroid() {
        let plain = mesh(vec![]).unwrap();
        assert_eq!(
            (&*plain.regions, counts(&plain)),
            (&[BODY.to_owned()][..], vec![32])
        );
        let half = mesh(vec![region("low", [0.0, 0.0], [2.0, 0.5])]).unwrap();
        assert_eq!(half.regions, ["low", "body"]);
        assert_eq!(counts(&half), [16, 16]);
        assert_eq!(
            (&half.nodes, &half.cell_nodes),
            (&plain.nodes, &plain.cell_nodes)
        );
        // two boxes of one name are one region; nothing is left for the body
        let all = mesh(vec![
            region("a", [0.0, 0.0], [0.5, 1.0]),
            region("b", [0.5, 0.0], [1.5, 1.0]),
            region("a", [1.5, 0.0], [2.0, 1.0]),
        ]);
        let all = all.unwrap();
        assert_eq!(all.regions, ["a", "b"]);
        assert_eq!(counts(&all), [16, 16]);
    }

    #[test]
    fn boxes_without_cells_and_cells_in_two_boxes_are_refused() {
        let path = |regions| match mesh(regions) {
            Err(Error::Scene { path, found, .. }) => (path, found),
            other => panic!("{other:?}"),
        };
        let low = region("low", [0.0, 0.0], [2.0, 0.5]);
        let (at, found) = path(vec![low.clone(), region("thin", [0.0, 0.6], [2.0, 0.61])]);
        assert_eq!(at, "mesh.regions[1]");
        assert!(found.contains("without cells"), "{found}");
        let (at, found) = path(vec![low, region("left", [0.0, 0.0], [0.5, 1.0])]);
        assert_eq!(at, "mesh.regions[1]");
        assert!(found.contains("mesh.regions[0]"), "{found}");
    }
}
