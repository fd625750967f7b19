//! The picture of the body: mesh, clamped, driven, loaded and contact parts, what moves, probes, axes; as SVG. In 3D an oblique projection in
//! which the faces turned to the reader let the others shine through.

use super::drawing::{Frame, OBLIQUE, Point, arrow, axes, path, project, text};
use std::collections::BTreeMap;
use std::fmt::Write;
use stickslip::Model;
use stickslip::fem::{ContactPart, ContactPatch};
use stickslip::mesh::Mesh;
use stickslip::scene::{DrivenDirection, Foundation, LoadKind};

const ARROW: f64 = 56.0;
/// A mesh with more faces to draw is shown by its outline alone.
const MOST_FACES: usize = 20_000;
pub const CONTACT: &str = "#c0392b";
pub const CLAMPED: &str = "#444444";
pub const DRIVEN: &str = "#7d3c98";
pub const FOUNDATION: &str = "#b9770e";
pub const LOAD: &str = "#1e8449";
pub const PROBE: &str = "#1f4e9c";
const LINES: &str = "#7f9cc4";

/// Whether a face shows its outer side: its normal has a share against the line of sight, the direction that the projection
/// maps to a point.
fn is_turned_to_reader(mesh: &Mesh, face: &[u32]) -> bool {
    let p = |i: usize| mesh.nodes[face[i] as usize];
    let side = |i: usize| [0, 1, 2].map(|k| p(i)[k] - p(0)[k]);
    let (a, b) = (side(1), side(2));
    let normal = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    normal[2] < OBLIQUE[0] * normal[0] + OBLIQUE[1] * normal[1]
}

/// Outer faces of a mesh of tetrahedra: those that belong to one cell.
fn outer_faces(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut faces: BTreeMap<[u32; 3], Option<[u32; 3]>> = BTreeMap::new();
    for cell in mesh.cells() {
        for face in mesh.element.faces {
            let face = [face[0], face[1], face[2]].map(|i| cell[i]);
            let mut key = face;
            key.sort_unstable();
            faces
                .entry(key)
                .and_modify(|f| *f = None)
                .or_insert(Some(face));
        }
    }
    faces.into_values().flatten().collect()
}

/// Edges that belong to one of the faces only.
fn outline(faces: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for face in faces {
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let once = edges.into_iter().filter(|(_, count)| *count == 1);
    once.map(|(edge, _)| edge.to_vec()).collect()
}

/// Corners of the faces of a part.
fn part(mesh: &Mesh, name: &str) -> Vec<Vec<u32>> {
    let corners = |face: &[u32]| face[..mesh.dimension].to_vec();
    mesh.faces(name, "")
        .map_or(Vec::new(), |faces| faces.map(corners).collect())
}

/// Middle of the nodes of faces.
fn middle(mesh: &Mesh, faces: &[Vec<u32>]) -> Option<[f64; 3]> {
    let nodes: Vec<u32> = faces.concat();
    let count = nodes.len() as f64;
    let sum = |i: usize| {
        nodes
            .iter()
            .map(|n| mesh.nodes[*n as usize][i])
            .sum::<f64>()
    };
    (!nodes.is_empty()).then(|| [sum(0) / count, sum(1) / count, sum(2) / count])
}

/// The body, back to front.
fn body(frame: &Frame, mesh: &Mesh, model: &Model) -> String {
    let scene = model.scene();
    let loaded = scene.loads.iter().filter_map(|l| l.part.as_ref());
    let clamped = scene.clamped.iter().map(|name| (name, CLAMPED));
    let driven = scene.driven.iter().map(|driven| (&driven.part, DRIVEN));
    let held = clamped.chain(driven);
    let parts: Vec<_> = held.chain(loaded.map(|name| (name, LOAD))).collect();
    let mut svg = String::new();
    if mesh.dimension == 2 {
        let cells: Vec<Vec<u32>> = mesh.cells().map(|cell| cell[..3].to_vec()).collect();
        let lines = format!("fill=\"none\" stroke=\"{LINES}\" stroke-width=\"0.6\"");
        if cells.len() <= MOST_FACES {
            svg += &path(frame, mesh, &cells, &lines);
        }
        let outer = "stroke=\"#555\" stroke-width=\"1.2\" fill=\"none\"";
        svg += &path(frame, mesh, &outline(&cells), outer);
        for (name, colour) in parts {
            let style = format!("stroke=\"{colour}\" stroke-width=\"5\" stroke-linecap=\"round\"");
            svg += &path(frame, mesh, &part(mesh, name), &style);
        }
        return svg + &contact(frame, mesh, model, &[], false);
    }
    let turned = |face: &Vec<u32>| is_turned_to_reader(mesh, face);
    let faces = outer_faces(mesh).into_iter().map(|f| f.to_vec());
    let front: Vec<Vec<u32>> = faces.filter(turned).collect();
    let fill = |is_front: bool, svg: &mut String| {
        for (name, colour) in &parts {
            let faces = part(mesh, name)
                .into_iter()
                .filter(|f| turned(f) == is_front);
            let style = format!("fill=\"{colour}\" fill-opacity=\"0.3\"");
            *svg += &path(frame, mesh, &faces.collect::<Vec<_>>(), &style);
        }
    };
    fill(false, &mut svg);
    svg += &contact(frame, mesh, model, &front, true);
    let stroke = match front.len() <= MOST_FACES {
        true => format!("stroke=\"{LINES}\" stroke-width=\"0.6\""),
        false => String::new(),
    };
    let veil = format!("fill=\"#fff\" fill-opacity=\"0.72\" {stroke}");
    svg += &path(frame, mesh, &front, &veil);
    fill(true, &mut svg);
    let outer = "stroke=\"#555\" stroke-width=\"1.2\" fill=\"none\"";
    svg += &path(frame, mesh, &outline(&front), outer);
    svg + &contact(frame, mesh, model, &front, false)
}

/// Contact nodes behind the front faces, or the others.
fn contact(
    frame: &Frame,
    mesh: &Mesh,
    model: &Model,
    front: &[Vec<u32>],
    is_behind: bool,
) -> String {
    let seen: std::collections::BTreeSet<[u64; 3]> = front
        .iter()
        .flatten()
        .map(|n| mesh.nodes[*n as usize].map(f64::to_bits))
        .collect();
    let hidden = |p: &[f64; 3]| mesh.dimension == 3 && !seen.contains(&p.map(f64::to_bits));
    let points = model.contact().points.iter();
    let mut svg = String::new();
    for point in points.filter(|p| hidden(p) == is_behind) {
        let [x, y] = frame.at(point);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{CONTACT}\"/>"
        );
    }
    svg
}

/// Arrows and names of the loads.
fn loads(frame: &Frame, mesh: &Mesh, model: &Model) -> String {
    let corners: Vec<Vec<u32>> = mesh.cells().map(<[u32]>::to_vec).collect();
    let mut svg = String::new();
    for load in &model.scene().loads {
        let faces = load.part.as_ref().map(|name| part(mesh, name));
        let Some(place) = middle(mesh, faces.as_deref().unwrap_or(&corners)) else {
            continue;
        };
        let is_inwards = load.kind == LoadKind::Traction && {
            // an arrow into the body ends on its side, one out of it or along it begins there
            let [at, inner] =
                [place, middle(mesh, &corners).unwrap_or(place)].map(|p| frame.at(&p));
            let [d, inner] = [along(&load.direction), [inner[0] - at[0], inner[1] - at[1]]];
            inner[0] * d[0] + inner[1] * d[1] > 0.2 * ARROW * inner[0].hypot(inner[1])
        };
        let at = frame.at(&place);
        svg += &pointer(at, &load.direction, is_inwards, LOAD, &load.name);
    }
    svg
}

/// A direction of the scene as drawn, as long as an arrow.
fn along(direction: &[f64]) -> Point {
    let mut vector = [0.0; 3];
    vector[..direction.len()].copy_from_slice(direction);
    let d = project(&vector);
    let length = d[0].hypot(d[1]).max(f64::MIN_POSITIVE);
    d.map(|x| ARROW * x / length)
}

/// An arrow that ends or begins at a place, with a name at its far end.
fn pointer(at: Point, direction: &[f64], ends: bool, colour: &str, name: &str) -> String {
    let d = along(direction);
    let (from, to) = match ends {
        true => ([at[0] - d[0], at[1] - d[1]], at),
        false => (at, [at[0] + d[0], at[1] + d[1]]),
    };
    let far = if ends { from } else { to };
    arrow(from, to, colour) + &text([far[0] + 8.0, far[1] - 6.0], "start", colour, name)
}

/// Arrows and names of what is driven, and of the motions of the foundation; what turns has its name alone.
fn motions(frame: &Frame, mesh: &Mesh, model: &Model) -> String {
    let mut svg = String::new();
    for driven in &model.scene().driven {
        let Some(place) = middle(mesh, &part(mesh, &driven.part)) else {
            continue;
        };
        let at = frame.at(&place);
        for (name, direction) in &driven.directions {
            svg += &match direction {
                DrivenDirection::Translation(along) => pointer(at, along, false, DRIVEN, name),
                DrivenDirection::Rotation(_) => turning(at, -14.0, DRIVEN, name),
            };
        }
    }
    for (placed, part) in model.scene().contacts().iter().zip(&model.contact().parts) {
        svg += &motions_of(frame, model.contact(), part, &placed.foundation);
    }
    svg
}

/// The same of the foundation of one contact.
fn motions_of(
    frame: &Frame,
    contact: &ContactPatch,
    part: &ContactPart,
    motions: &[Foundation],
) -> String {
    let mut svg = String::new();
    let middle = part.nodes.start + part.nodes.len() / 2;
    for (i, motion) in motions.iter().enumerate() {
        // on the side of the foundation, one below the other
        let beside = 22.0 * (i + 1) as f64;
        let out = along(&contact.normals[middle].map(|n| -n)).map(|x| beside * x / ARROW);
        let on = frame.at(&contact.points[middle]);
        let at = [on[0] + out[0], on[1] + out[1]];
        svg += &match motion {
            Foundation::Sliding {
                name, direction, ..
            } => pointer(at, direction, false, FOUNDATION, name),
            Foundation::Rotation { name, .. } => turning(at, 0.0, FOUNDATION, name),
            Foundation::Approach { name, .. } => {
                pointer(on, &contact.normals[middle], true, FOUNDATION, name)
            }
        };
    }
    svg
}

/// The name of something that turns.
fn turning(at: Point, lift: f64, colour: &str, name: &str) -> String {
    let words = format!("{name} (turns)");
    text([at[0], at[1] + lift], "middle", colour, &words)
}

fn probes(frame: &Frame, model: &Model) -> String {
    let mut svg = String::new();
    for probe in &model.scene().probes {
        let mut point = [0.0; 3];
        point[..probe.at.len()].copy_from_slice(&probe.at);
        let [x, y] = frame.at(&point);
        let _ = writeln!(
            svg,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"8\" height=\"8\" fill=\"{PROBE}\"/>",
            x - 4.0,
            y - 4.0
        );
        svg += &text([x + 8.0, y - 8.0], "start", PROBE, &probe.name);
    }
    svg
}

/// Numbers of the first and the last node of every contact, on that side of the contact that is away from the body.
fn numbers(frame: &Frame, model: &Model) -> String {
    let contact = model.contact();
    let parts = contact.parts.iter();
    parts.map(|part| numbers_of(frame, contact, part)).collect()
}

fn numbers_of(frame: &Frame, contact: &ContactPatch, part: &ContactPart) -> String {
    let points = contact.points[part.nodes.clone()].iter();
    let points: Vec<Point> = points.map(|p| frame.at(p)).collect();
    let count = points.len() as f64;
    let away =
        [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / count - frame.size[i] / 2.0);
    let share = 18.0 / away[0].hypot(away[1]).max(f64::MIN_POSITIVE);
    let (first, last) = (part.nodes.start + 1, part.nodes.end);
    let mut svg = String::new();
    for (number, point) in [(first, points.first()), (last, points.last())] {
        if let Some([x, y]) = point {
            let place = [x + share * away[0], y + share * away[1] + 5.0];
            svg += &text(place, "middle", CONTACT, &number.to_string());
        }
    }
    svg
}

/// The picture.
pub fn svg(mesh: &Mesh, model: &Model) -> String {
    let frame = Frame::of(mesh);
    let [width, height] = frame.size;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" role=\"img\" font-size=\"15\" \
         font-family=\"sans-serif\"><title>The body</title>\n"
    );
    svg += &body(&frame, mesh, model);
    svg += &loads(&frame, mesh, model);
    svg += &motions(&frame, mesh, model);
    svg += &probes(&frame, model);
    svg += &numbers(&frame, model);
    svg += &axes(&frame, mesh.dimension);
    svg + "</svg>\n"
}
