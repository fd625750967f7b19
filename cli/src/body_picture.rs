//! The picture of the deformed body at the end of a run, for plane bodies.

use crate::failure::Failure;
use crate::pictures::{Axis, BodyView, Panel, Place, Shape, Sheet};
use std::collections::BTreeMap;
use std::path::Path;
use stickslip::mesh::Mesh;
use stickslip::{Compilation, Scene, Simulator};

/// Share of the size of a body below which a displacement is rounding.
const ROUNDING: f64 = 1e-14;
/// Share of the size of the body that a displacement must have to be seen at true scale.
const VISIBLE: f64 = 0.02;
/// Share of the size of the body up to which a smaller displacement is enlarged.
const LARGEST: f64 = 0.1;

/// Draws `body.png` and `body.svg` into `folder`; nothing for a body in space.
pub fn draw(
    folder: &Path,
    scene: &Scene,
    compilation: &Compilation,
    simulator: &Simulator,
) -> Result<(), Failure> {
    let body = &compilation.body;
    if body.mesh.dimension != 2 {
        return Ok(());
    }
    let [low, high] = body.mesh.bounds();
    let size = (high[0] - low[0]).max(high[1] - low[1]);
    let displacement = compilation.nodal_displacement(simulator.state());
    let displacement = displacement.map_err(Failure::of(&scene.name))?;
    let amount: Vec<f64> = displacement.iter().map(|u| u[0].hypot(u[1])).collect();
    let largest = amount.iter().copied().fold(0.0, f64::max);
    let factor = enlargement(largest / size);
    let shape = Shape::new(&body.mesh, &displacement, factor);
    let mut contact = Vec::new();
    for of in scene.contacts() {
        let path = format!("{}.part", of.path);
        let faces = body.mesh.faces(&of.part, &path);
        let faces = faces.map_err(Failure::of(&scene.name))?;
        let ends = faces.map(|face| [face[0], face[1]].map(|node| shape.nodes[node as usize]));
        contact.extend(ends.map(Vec::from));
    }
    let scale = match factor {
        1.0 => "true scale".to_owned(),
        _ => format!("displacement times {factor}"),
    };
    let view = BodyView {
        heading: format!("At t = {} s, {scale}; contact in black", simulator.time()),
        shape,
        outline: border(&body.mesh),
        amount,
        scale: Axis::new("displacement", "m"),
        contact,
        forces: Vec::new(),
        arrows: None,
    };
    Sheet {
        title: format!("{}: deformed mesh", scene.name),
        width: 1100,
        height: 640,
        rows: vec![(1.0, vec![Panel::Body(view)])],
    }
    .save(folder, "body")
}

/// The closed lines around a plane mesh, from side to side of its cells.
fn border(mesh: &Mesh) -> Vec<Vec<Place>> {
    // a side between two cells is met once in each direction
    let mut next: BTreeMap<u32, BTreeMap<u32, Vec<u32>>> = BTreeMap::new();
    let element = mesh.element;
    for cell in mesh.cells() {
        for side in element.faces {
            let (p, q) = (cell[side[0]], cell[side[1]]);
            let opposite = next.get_mut(&q).and_then(|from| from.remove(&p));
            if opposite.is_none() {
                let is_its = |ends: &[usize; 2]| side.contains(&ends[0]) && side.contains(&ends[1]);
                let middle = element.midsides.iter().position(is_its);
                let middle = middle.map(|place| cell[element.corners() + place]);
                let line = middle.into_iter().chain([q]).collect();
                next.entry(p).or_default().insert(q, line);
            }
        }
    }
    let place = |node: u32| (mesh.nodes[node as usize][0], mesh.nodes[node as usize][1]);
    let mut lines = Vec::new();
    while let Some((&start, _)) = next.iter().find(|(_, ends)| !ends.is_empty()) {
        let mut line = vec![place(start)];
        let mut at = start;
        while let Some((end, along)) = next.get_mut(&at).and_then(BTreeMap::pop_first) {
            line.extend(along.into_iter().map(place));
            at = end;
        }
        next.retain(|_, ends| !ends.is_empty());
        lines.push(line);
    }
    lines
}

/// 1 for a displacement of this share that can be seen, else the largest of 1, 2, 5, 10, ... that keeps it small.
fn enlargement(share: f64) -> f64 {
    if !(share > ROUNDING && share < VISIBLE) {
        return 1.0;
    }
    let most = LARGEST / share;
    let decade = 10f64.powi(most.log10().floor() as i32);
    let round = [5.0, 2.0, 1.0].into_iter().find(|r| r * decade <= most);
    round.unwrap_or(1.0) * decade
}

#[cfg(test)]
mod tests {
    use super::enlargement;

    #[test]
    fn small_displacements_are_enlarged_by_round_factors() {
        for (share, factor) in [
            (0.0, 1.0),
            (1e-20, 1.0),
            (0.3, 1.0),
            (0.02, 1.0),
            (0.019, 5.0),
            (1.1e-5, 5000.0),
        ] {
            assert_eq!(enlargement(share), factor, "{share}");
        }
        assert_eq!(enlargement(f64::NAN), 1.0);
    }
}
