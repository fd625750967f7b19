//! The CSV: one row per setting measured. An error at the limit of the reference is empty, its bound is not.

use super::point::{Point, front};
use crate::contact_table::shortest;
use crate::failure::Failure;
use crate::standard;
use std::path::Path;
use stickslip::Scene;
use stickslip::tradeoff::Quantity;

/// Writes the points of a scene; `-` is standard output.
pub fn write(path: &Path, scene: &Scene, points: &[Point]) -> Result<(), Failure> {
    let failed = Failure::writing(path);
    let mut writer = csv::Writer::from_writer(standard::create(path)?);
    writer.write_record(header()).map_err(|e| failed(&e))?;
    let fronts = Quantity::ALL.map(|q| front(points, &[q]));
    for point in points {
        writer
            .write_record(row(scene, point, &fronts))
            .map_err(|e| failed(&e))?;
    }
    writer.flush().map_err(|e| failed(&e))
}

fn header() -> Vec<String> {
    let mut names: Vec<String> = ["group", "set", "nodes", "step_s"]
        .map(String::from)
        .to_vec();
    for kind in ["error", "bound", "front"] {
        let of = |q: Quantity| format!("{kind}_{}", q.name().replace(' ', "_"));
        names.extend(Quantity::ALL.map(of));
    }
    names.extend(
        [
            "setup_s",
            "step_us",
            "seconds_per_second",
            "steps",
            "states",
            "contact_nodes",
            "model_bytes",
            "state_bytes",
            "iterations_per_step",
            "multiplications_per_second",
        ]
        .map(String::from),
    );
    names
}

/// Nodes of a generated mesh; no other is studied.
fn nodes(scene: &Scene) -> String {
    let element = scene.element_table();
    let extent = element.and_then(|e| scene.extent(e));
    extent
        .map(|extent| extent.nodes.to_string())
        .unwrap_or_default()
}

fn row(scene: &Scene, point: &Point, fronts: &[Vec<&Point>; 4]) -> Vec<String> {
    let applied = point.setting.apply(scene).ok();
    let applied = applied.as_ref().unwrap_or(scene);
    let trajectory = &point.sample.trajectory;
    let of = |value: Option<f64>| value.map(shortest).unwrap_or_default();
    let mut row = vec![
        point.group.name().to_owned(),
        point.arguments(),
        nodes(applied),
        shortest(applied.time.step),
    ];
    row.extend(Quantity::ALL.map(|q| of(point.verdict.of(q).and_then(|m| m.figure()))));
    row.extend(Quantity::ALL.map(|q| of(point.verdict.of(q).map(|m| m.bound()))));
    row.extend(fronts.each_ref().map(|front| {
        let is_on = front.iter().any(|p| std::ptr::eq(*p, point));
        u8::from(is_on).to_string()
    }));
    row.extend([
        shortest(point.setup.as_secs_f64()),
        shortest(1e6 * point.per_step()),
        shortest(point.cost()),
        point.sample.trajectory.work.steps.to_string(),
        point.states.to_string(),
        point.contact_nodes.to_string(),
        point.model_bytes.to_string(),
        point.state_bytes.to_string(),
        shortest(point.iterations_per_step()),
        shortest(trajectory.work.multiplications / trajectory.until),
    ]);
    row
}
