//! Drawing in SVG: the projection from coordinates to pixels, lines, arrows, words, axes.

use std::fmt::Write;
use stickslip::mesh::Mesh;

/// Longer side of the body in the picture, pixels.
const WIDTH: f64 = 720.0;
/// Room around the body for arrows and names.
const MARGIN: f64 = 90.0;
/// Share of z in the two directions of the picture.
pub const OBLIQUE: [f64; 2] = [0.45, 0.35];

pub type Point = [f64; 2];

/// From coordinates to pixels.
pub struct Frame {
    low: Point,
    scale: f64,
    pub size: Point,
}

pub fn project(p: &[f64; 3]) -> Point {
    [p[0] + OBLIQUE[0] * p[2], -(p[1] + OBLIQUE[1] * p[2])]
}

impl Frame {
    pub fn of(mesh: &Mesh) -> Frame {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in mesh.nodes.iter().map(project) {
            for i in 0..2 {
                low[i] = low[i].min(point[i]);
                high[i] = high[i].max(point[i]);
            }
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let scale = WIDTH / extent[0].max(1.6 * extent[1]).max(f64::MIN_POSITIVE);
        Frame {
            low,
            scale,
            size: extent.map(|e| e * scale + 2.0 * MARGIN),
        }
    }

    pub fn at(&self, p: &[f64; 3]) -> Point {
        let q = project(p);
        [0, 1].map(|i| MARGIN + (q[i] - self.low[i]) * self.scale)
    }
}

/// A path through the nodes of every face, closed for triangles.
pub fn path(frame: &Frame, mesh: &Mesh, faces: &[Vec<u32>], style: &str) -> String {
    let mut d = String::new();
    for face in faces {
        for (i, node) in face.iter().enumerate() {
            let [x, y] = frame.at(&mesh.nodes[*node as usize]);
            let _ = write!(d, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
        }
        if face.len() > 2 {
            d.push('Z');
        }
    }
    match d.is_empty() {
        true => String::new(),
        false => format!("<path {style} d=\"{d}\"/>\n"),
    }
}

pub fn text(at: Point, anchor: &str, colour: &str, words: &str) -> String {
    let words = super::escaped(words);
    let [x, y] = at;
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\" stroke=\"#fff\" stroke-width=\"4\" \
         paint-order=\"stroke\">{words}</text>\n"
    )
}

pub fn arrow(from: Point, to: Point, colour: &str) -> String {
    let d = [to[0] - from[0], to[1] - from[1]];
    let length = d[0].hypot(d[1]).max(f64::MIN_POSITIVE);
    let (u, v) = (d[0] / length, d[1] / length);
    let wing = |side: f64| {
        format!(
            "L{:.1} {:.1}",
            to[0] - 9.0 * u - side * 4.0 * v,
            to[1] - 9.0 * v + side * 4.0 * u
        )
    };
    format!(
        "<path stroke=\"{colour}\" stroke-width=\"2\" fill=\"{colour}\" d=\"M{:.1} {:.1}L{:.1} {:.1}{}{}L{2:.1} {3:.1}\"/>\n",
        from[0],
        from[1],
        to[0],
        to[1],
        wing(1.0),
        wing(-1.0)
    )
}

pub fn axes(frame: &Frame, dimension: usize) -> String {
    let origin = [18.0, frame.size[1] - 18.0];
    let mut svg = String::new();
    for (axis, name) in ["x", "y", "z"].iter().enumerate().take(dimension) {
        let mut unit = [0.0; 3];
        unit[axis] = 34.0;
        let d = project(&unit);
        let tip = [origin[0] + d[0], origin[1] + d[1]];
        svg += &arrow(origin, tip, "#222");
        svg += &text([tip[0] + 6.0, tip[1] + 4.0], "start", "#222", name);
    }
    svg
}
