//! The pictures of a run: slip rate and stress along the contact, where and when it sticks, and where the energy goes.

use crate::course::{Energy, Frame};
use crate::failure::Failure;
use crate::pictures::{
    Axis, BLUE, Cell, Colour, Curves, GREEN, Map, Mark, ORANGE, Panel, RED, Series, Sheet,
    sequential,
};
use std::path::Path;
use stickslip::Scene;
use stickslip::fem::ContactPatch;

/// Instants drawn along the contact.
const INSTANTS: usize = 6;
/// Slip rates below this share of the largest share one colour.
const FAINTEST: f64 = 1e-4;
/// Cosine between tangents of a contact below which it counts as curved.
const STRAIGHT: f64 = 1.0 - 1e-6;

/// Draws everything into `folder`: the energies, and a set of pictures for every contact.
pub fn draw(
    folder: &Path,
    scene: &Scene,
    contact: &ContactPatch,
    frames: &[Frame],
) -> Result<(), Failure> {
    let failed = Failure::writing(folder);
    std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
    sheet(
        format!("{}: energies", scene.name),
        560,
        vec![Panel::Curves(energies(frames))],
    )
    .save(folder, "energies")?;
    if contact.parts.len() == 1 {
        return draw_contact(folder, (&scene.name, ""), contact, frames);
    }
    for (i, part) in contact.parts.iter().enumerate() {
        let of_part = |frame: &Frame| frame.of_nodes(part.nodes.clone(), part.can_open);
        let own: Vec<Frame> = frames.iter().map(of_part).collect();
        let title = format!("{}, {}", scene.name, part.name);
        let suffix = format!("_{}", part.name);
        draw_contact(folder, (&title, &suffix), &contact.of_part(i), &own)?;
    }
    Ok(())
}

fn sheet(title: String, height: u32, panels: Vec<Panel>) -> Sheet {
    Sheet {
        title,
        width: 1200,
        height,
        rows: vec![(1.0, panels)],
    }
}

/// Draws one contact, into files whose names end in `suffix`.
fn draw_contact(
    folder: &Path,
    (name, suffix): (&str, &str),
    contact: &ContactPatch,
    frames: &[Frame],
) -> Result<(), Failure> {
    let line = Line::of(contact);
    let file = |name: &str| format!("{name}{suffix}");
    let along = |heading: &str, quantity: &str, unit: &str, values: fn(&Frame) -> &[f64]| {
        Panel::Curves(line.curves(heading, Axis::new(quantity, unit), frames, values))
    };
    let where_ = line.description;
    let panels = vec![
        along("Slip rate", "slip rate", "m/s", |f| &f.slip_rate),
        along(
            "Tangential stress on the body",
            "tangential stress",
            "Pa",
            |f| &f.tangential_stress,
        ),
    ];
    sheet(format!("{name}: contact {where_}"), 520, panels).save(folder, &file("contact"))?;
    let has = |port: &str| frames.first().is_some_and(|f| !f.normal(port).is_empty());
    if has("contact.pressure") {
        let mut panels = vec![along("Pressure", "pressure", "Pa", |f| {
            f.normal("contact.pressure")
        })];
        if has("contact.gap") {
            panels.push(along("Gap", "gap", "m", |f| f.normal("contact.gap")));
        }
        sheet(format!("{name}: pressed {where_}"), 520, panels).save(folder, &file("pressure"))?;
        let panels = vec![Panel::Curves(friction_curve(contact, frames))];
        sheet(format!("{name}: friction against sliding"), 560, panels)
            .save(folder, &file("friction"))?;
    }
    sheet(
        format!("{name}: stick and slip in space and time"),
        640,
        vec![Panel::Map(line.map(frames))],
    )
    .save(folder, &file("stick_slip"))?;
    if contact.components == 2 {
        let panels = plan_views(contact, frames);
        sheet(format!("{name}: contact seen from above"), 460, panels)
            .save(folder, &file("plan"))?;
    }
    Ok(())
}

/// The contact nodes along a line: all of them in 2D, the middle row in 3D.
struct Line {
    nodes: Vec<usize>,
    /// Coordinate along the first tangent, m.
    position: Vec<f64>,
    axis: Axis,
    description: &'static str,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Name of the coordinate along a tangent.
fn coordinate(tangent: [f64; 3]) -> Axis {
    let named = ["x", "y", "z"]
        .into_iter()
        .zip(tangent)
        .find(|(_, t)| (t - 1.0).abs() < 1e-9);
    Axis::new(named.map_or("position along the contact", |(n, _)| n), "m")
}

/// Length along a plane contact from its first node to every node, m.
fn lengths(contact: &ContactPatch) -> Vec<f64> {
    let mut length = 0.0;
    let mut all = vec![0.0];
    for pair in contact.points.windows(2) {
        length += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        all.push(length);
    }
    all
}

/// Values in ascending order, each once.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    let size = all.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    all.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * size);
    all
}

impl Line {
    fn of(contact: &ContactPatch) -> Line {
        let [first, second] = contact.tangents.first().copied().unwrap_or_default();
        let across = |node: usize| dot(contact.points[node], second);
        let rows = distinct((0..contact.node_count()).map(across));
        let middle = rows.get(rows.len() / 2).copied().unwrap_or(0.0);
        let spacing = rows.windows(2).map(|w| w[1] - w[0]).fold(1.0, f64::min);
        let mut nodes: Vec<usize> = (0..contact.node_count())
            .filter(|&n| (across(n) - middle).abs() < 0.25 * spacing)
            .collect();
        let along = |node: usize| dot(contact.points[node], first);
        let is_curved = contact.tangents.iter().any(|t| dot(t[0], first) < STRAIGHT);
        if contact.components == 1 && is_curved {
            // the nodes of a part are in their order along it
            return Line {
                position: lengths(contact),
                nodes: (0..contact.node_count()).collect(),
                axis: Axis::new("length along the contact", "m"),
                description: "along its length",
            };
        }
        nodes.sort_by(|a, b| along(*a).total_cmp(&along(*b)));
        Line {
            position: nodes.iter().map(|&n| along(n)).collect(),
            nodes,
            axis: coordinate(first),
            description: match contact.components {
                1 if contact.node_count() == 1 => "at its only node",
                1 => "along its length",
                _ => "along its middle row, first tangential component",
            },
        }
    }

    /// A field over the contact nodes, its first component, at several instants.
    fn curves(
        &self,
        heading: &str,
        y: Axis,
        frames: &[Frame],
        values: fn(&Frame) -> &[f64],
    ) -> Curves {
        let first = |f: &Frame, node: usize| values(f)[node * (values(f).len() / f.stick.len())];
        if let [node] = self.nodes[..] {
            // a single node has a course, not a length
            let points = frames.iter().map(|f| (f.time, first(f, node)));
            return Curves {
                heading: heading.to_owned(),
                x: Axis::new("time", "s"),
                y,
                series: vec![Series {
                    name: String::new(),
                    colour: BLUE,
                    mark: Mark::Line,
                    points: points.collect(),
                }],
            };
        }
        let series = instants(frames)
            .into_iter()
            .map(|(frame, colour)| Series {
                name: format!("{} s", short(frame.time)),
                colour,
                mark: Mark::Line,
                points: self
                    .nodes
                    .iter()
                    .zip(&self.position)
                    .map(|(&node, &x)| (x, first(frame, node)))
                    .collect(),
            })
            .collect();
        Curves {
            heading: heading.to_owned(),
            x: self.axis.clone(),
            y,
            series,
        }
    }

    /// Slip rate over place and time.
    fn map(&self, frames: &[Frame]) -> Map {
        let times: Vec<f64> = frames.iter().map(|f| f.time).collect();
        let values: Vec<Vec<Cell>> = frames
            .iter()
            .map(|f| self.nodes.iter().map(|&n| rate(f, n)).collect())
            .collect();
        Map {
            heading: "Magnitude of the slip rate".to_owned(),
            x: self.axis.clone(),
            y: Axis::new("time", "s"),
            x_edges: edges(&self.position),
            y_edges: edges(&times),
            scale: rates_axis(frames),
            values,
        }
    }
}

/// Total friction force and normal force over the mean slip rate of the pressed nodes, first tangential components.
fn friction_curve(contact: &ContactPatch, frames: &[Frame]) -> Curves {
    let c = contact.components;
    let point = |frame: &Frame| {
        let pressure = frame.normal("contact.pressure");
        let pressed = (0..contact.node_count()).filter(|n| pressure[*n] > 0.0);
        let (mut area, mut slid, mut friction, mut normal) = (0.0, 0.0, 0.0, 0.0);
        for node in pressed {
            let weight = contact.weights[node];
            area += weight;
            slid += weight * frame.slip_rate[node * c];
            friction += weight * frame.tangential_stress[node * c];
            normal += weight * pressure[node];
        }
        (area > 0.0).then(|| (slid / area, friction, normal))
    };
    let points: Vec<_> = frames.iter().filter_map(point).collect();
    let series = |name: &str, colour, points| Series {
        name: name.to_owned(),
        colour,
        mark: Mark::Line,
        points,
    };
    Curves {
        heading: "Forces of the foundation on the body".to_owned(),
        x: Axis::new("mean slip rate of pressed nodes", "m/s"),
        y: Axis::new("force", "N"),
        series: vec![
            series(
                "friction",
                BLUE,
                points.iter().map(|p| (p.0, p.1)).collect(),
            ),
            series(
                "normal",
                ORANGE,
                points.iter().map(|p| (p.0, p.2)).collect(),
            ),
        ],
    }
}

/// Magnitude of the slip rate of a node, unless it sticks or is open.
fn rate(frame: &Frame, node: usize) -> Cell {
    if frame.normal("contact.status").get(node) == Some(&0.0) {
        return Cell::Open;
    }
    let c = frame.slip_rate.len() / frame.stick.len();
    let w = &frame.slip_rate[node * c..(node + 1) * c];
    let magnitude = w.iter().map(|v| v * v).sum::<f64>().sqrt();
    match frame.stick[node] {
        0.0 => Cell::Amount(magnitude),
        _ => Cell::Stick,
    }
}

/// The scale of slip rates that all frames share.
fn rates_axis(frames: &[Frame]) -> Axis {
    let all = frames
        .iter()
        .flat_map(|f| (0..f.stick.len()).filter_map(move |n| rate(f, n).amount()));
    let largest = all.fold(0.0, f64::max);
    if largest == 0.0 {
        return Axis::new("slip rate", "m/s").between(0.0, 1.0);
    }
    Axis::log("slip rate", "m/s").between(FAINTEST * largest, largest)
}

/// Borders of the cells around ordered values: halfway between neighbours, and the first and last values themselves.
fn edges(values: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
        return Vec::new();
    };
    if values.len() == 1 {
        return vec![first - 0.5, first + 0.5];
    }
    let between = values.windows(2).map(|w| 0.5 * (w[0] + w[1]));
    [first].into_iter().chain(between).chain([last]).collect()
}

/// Instants evenly over the run, each with its colour, dark to bright.
fn instants(frames: &[Frame]) -> Vec<(&Frame, Colour)> {
    let count = INSTANTS.min(frames.len().saturating_sub(1)).max(1);
    (1..=count)
        .map(|i| {
            let index = (i * (frames.len() - 1)) / count;
            let shade = 0.9 * (i - 1) as f64 / count.max(2) as f64;
            (&frames[index], sequential(shade))
        })
        .collect()
}

/// A time with at most three digits behind the point.
fn short(time: f64) -> String {
    format!("{}", (time * 1e3).round() / 1e3)
}

fn energies(frames: &[Frame]) -> Curves {
    let of = |name: &str, colour, mark, value: fn(&Energy) -> f64| Series {
        name: name.to_owned(),
        colour,
        mark,
        points: frames.iter().map(|f| (f.time, value(&f.energy))).collect(),
    };
    Curves {
        heading: "Since the start".to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new("energy", "J"),
        series: vec![
            of("external work", BLUE, Mark::Line, |e| e.external_work),
            of("elastic", GREEN, Mark::Line, |e| e.elastic),
            of("viscous dissipation", ORANGE, Mark::Line, |e| e.viscous),
            of("friction dissipation", RED, Mark::Line, |e| e.friction),
            of("sum of the three", (30, 30, 30), Mark::Dashed, |e| {
                e.elastic + e.viscous + e.friction
            }),
        ],
    }
}

/// The contact plane at three instants.
fn plan_views(contact: &ContactPatch, frames: &[Frame]) -> Vec<Panel> {
    let [first, second] = contact.tangents.first().copied().unwrap_or_default();
    let places = |t: [f64; 3]| distinct(contact.points.iter().map(|p| dot(*p, t)));
    let (xs, ys) = (places(first), places(second));
    let nearest = |all: &[f64], value: f64| {
        let closer = |a: &usize, b: &usize| {
            let gap = |i: usize| (all[i] - value).abs();
            gap(*a).total_cmp(&gap(*b))
        };
        (0..all.len()).min_by(closer).unwrap_or(0)
    };
    let view = |frame: &Frame| {
        let mut values = vec![vec![Cell::Nothing; xs.len()]; ys.len()];
        for (node, point) in contact.points.iter().enumerate() {
            let (i, j) = (
                nearest(&xs, dot(*point, first)),
                nearest(&ys, dot(*point, second)),
            );
            values[j][i] = rate(frame, node);
        }
        Panel::Map(Map {
            heading: format!("Slip rate at {} s", short(frame.time)),
            x: coordinate(first),
            y: coordinate(second),
            x_edges: edges(&xs),
            y_edges: edges(&ys),
            values,
            scale: rates_axis(frames),
        })
    };
    let last = frames.len() - 1;
    [last / 4, last / 2, 3 * last / 4]
        .into_iter()
        .map(|i| view(&frames[i]))
        .collect()
}
