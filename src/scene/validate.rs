//! Rules that tie several values of a scene together. What concerns one value alone (types, names, ranges) is stated
//! with the types and has been checked before.

use super::refusal::{Refusal, shown};
use super::types::*;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of mesh nodes: with three unknowns per node, every index still fits 32 bits.
pub const MAX_NODES: u32 = 1 << 30;

type Verdict = Result<(), Refusal>;

/// First components of the ports that every scene has; a load or probe of that name would collide with them.
const RESERVED: [&str; 4] = ["contact", "energy", "solver", "time"];

/// Refuses the first violated rule.
pub(super) fn check(scene: &Scene) -> Verdict {
    check_mesh(scene)?;
    check_material(scene)?;
    check_clamped(scene)?;
    check_contact(scene)?;
    check_names(scene)?;
    for (i, load) in scene.loads.iter().enumerate() {
        check_load(scene, load, &format!("loads[{i}]"))?;
    }
    for (i, probe) in scene.probes.iter().enumerate() {
        check_probe(&scene.mesh, probe, &format!("probes[{i}].at"))?;
    }
    check_time(&scene.time)?;
    check_precision(&scene.fidelity)?;
    check_target(scene)?;
    check_signals(scene)
}

fn ensure(holds: bool, refusal: impl FnOnce() -> Refusal) -> Verdict {
    if holds { Ok(()) } else { Err(refusal()) }
}

fn check_mesh(scene: &Scene) -> Verdict {
    let mesh = &scene.mesh;
    if let Some((found, allowed)) = scene.element.fault(mesh.dimension()) {
        return Err(Refusal::new("element", found, allowed));
    }
    let axes = ["x", "y", "z"];
    let axes = &axes[..mesh.dimension()];
    for (i, axis) in mesh.periodic().iter().enumerate() {
        let path = format!("mesh.periodic[{i}]");
        let found = json(axis);
        ensure(axis.index() < mesh.dimension(), || {
            Refusal::new(
                &path,
                &found,
                format!("the axes of the mesh: {}", axes.join(", ")),
            )
        })?;
        ensure(!mesh.periodic()[..i].contains(axis), || {
            Refusal::new(&path, format!("{found} a second time"), "each axis once")
        })?;
    }
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        if let Some((found, allowed)) = mesh.grading_fault(axis) {
            let path = format!("mesh.grading[{}]", axis.index());
            return Err(Refusal::new(path, found, allowed));
        }
    }
    if let Some((path, found, allowed)) = mesh.refinement_fault() {
        return Err(Refusal::new(path, found, allowed));
    }
    let nodes = mesh.node_bound(scene.element);
    ensure(nodes <= u128::from(MAX_NODES), || {
        let found = format!("{}, which makes {nodes} nodes", json(&mesh.cells()));
        Refusal::new("mesh.cells", found, format!("at most {MAX_NODES} nodes"))
    })
}

fn check_material(scene: &Scene) -> Verdict {
    let dimension = scene.mesh.dimension();
    // Both operators are `c tr(tau) I + d tau`: on symmetric tensors they are positive iff d > 0 and dim c + d > 0.
    let trace = |(c, d): (f64, f64)| dimension as f64 * c + d;
    let positive = |value: f64| value.is_finite() && value > 0.0;

    let viscosity = scene.material.viscosity.coefficients();
    ensure(positive(trace(viscosity)), || {
        let found = format!(
            "{} ({dimension} mu1 + mu2 = {})",
            viscosity.0,
            trace(viscosity)
        );
        let allowed =
            format!("{dimension} mu1 + mu2 finite and > 0: otherwise the body gains energy");
        Refusal::new("material.viscosity.mu1", found, allowed)
    })?;

    let Elasticity::Isotropic { convention, .. } = scene.material.elasticity;
    let allowed = match dimension {
        2 => [
            Convention::Kazmi2014,
            Convention::PlaneStrain,
            Convention::PlaneStress,
        ]
        .as_slice(),
        _ => [Convention::Kazmi2014, Convention::ThreeDimensional].as_slice(),
    };
    ensure(allowed.contains(&convention), || {
        let found = format!("{} in {dimension} dimensions", json(&convention));
        let names: Vec<String> = allowed.iter().map(json).collect();
        Refusal::new("material.elasticity.convention", found, names.join(", "))
    })?;
    let elasticity = scene.material.elasticity.coefficients();
    ensure(
        positive(elasticity.1) && positive(trace(elasticity)),
        || {
            let (lambda, two_mu) = elasticity;
            let found = format!("lambda = {lambda}, 2 mu = {two_mu}");
            let allowed = format!("2 mu and {dimension} lambda + 2 mu finite and > 0");
            Refusal::new("material.elasticity", found, allowed)
        },
    )
}

/// A part that the mesh has.
fn check_part(mesh: &MeshSpec, part: &str, path: &str) -> Verdict {
    ensure(mesh.normal_axis(part).is_some(), || {
        let allowed = match (mesh.parts(), mesh.periodic()) {
            (parts, []) => format!("the parts {}", parts.join(", ")),
            (parts, _) if parts.is_empty() => {
                "no part, because mesh.periodic closes every axis".to_owned()
            }
            (parts, periodic) => {
                let periodic = json(&periodic);
                format!(
                    "the parts {} (mesh.periodic is {periodic})",
                    parts.join(", ")
                )
            }
        };
        Refusal::new(path, json(&part), allowed)
    })
}

fn check_clamped(scene: &Scene) -> Verdict {
    for (i, part) in scene.clamped.iter().enumerate() {
        let path = format!("clamped[{i}]");
        check_part(&scene.mesh, part, &path)?;
        ensure(!scene.clamped[..i].contains(part), || {
            Refusal::new(&path, format!("{part:?} a second time"), "each part once")
        })?;
        ensure(*part != scene.contact.part, || {
            let found = format!("{part:?}, which is contact.part");
            Refusal::new(&path, found, "parts that are not in contact")
        })?;
    }
    Ok(())
}

fn check_contact(scene: &Scene) -> Verdict {
    let (mesh, contact) = (&scene.mesh, &scene.contact);
    check_part(mesh, &contact.part, "contact.part")?;
    let Some(normal) = mesh.normal_axis(&contact.part) else {
        return Ok(());
    };
    ensure(has_free_contact_node(scene, normal), || {
        let allowed = "parts that leave nodes of contact.part free (or more cells between them)";
        Refusal::new("clamped", json(&scene.clamped), allowed)
    })?;
    if let Friction::Exponential { a, b, .. } = contact.friction {
        ensure(a >= b, || {
            Refusal::new("contact.friction.a", a, format!("at least b = {b}"))
        })?;
    }
    if let Some(tangent) = &contact.tangent {
        let path = "contact.tangent";
        check_vector(mesh, tangent, path)?;
        let mut along = tangent.clone();
        along[normal.index()] = 0.0;
        // Below this the direction left in the contact plane would be rounding error.
        ensure(length(&along) > 1e-8 * length(tangent), || {
            let allowed = format!(
                "a direction that is not normal to the contact ({})",
                json(&normal)
            );
            Refusal::new(path, json(tangent), allowed)
        })?;
    }
    Ok(())
}

/// Whether a node of the contact part is on no clamped part. The nodes of a part normal to z include centres of cells,
/// which no other part touches; those of the other parts are a grid.
fn has_free_contact_node(scene: &Scene, normal: Axis) -> bool {
    let in_plane = [Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .zip(scene.mesh.cells());
    normal == Axis::Z
        || in_plane
            .filter(|(axis, _)| *axis != normal)
            .all(|(axis, &cells)| {
                let is_across = |part: &&String| scene.mesh.normal_axis(part) == Some(axis);
                let clamped = scene.clamped.iter().filter(is_across).count();
                scene.element.nodes_along(cells) > clamped as u64
            })
}

fn check_names(scene: &Scene) -> Verdict {
    let loads = scene
        .loads
        .iter()
        .enumerate()
        .map(|(i, l)| (format!("loads[{i}].name"), &l.name));
    let probes = scene
        .probes
        .iter()
        .enumerate()
        .map(|(i, p)| (format!("probes[{i}].name"), &p.name));
    let mut taken: BTreeMap<&str, String> = BTreeMap::new();
    for (path, name) in loads.chain(probes) {
        ensure(is_identifier(name), || {
            let allowed = "a letter or underscore, then letters, digits and underscores";
            Refusal::new(&path, json(name), allowed)
        })?;
        ensure(!RESERVED.contains(&name.as_str()), || {
            let allowed = format!("a name other than {}", RESERVED.join(", "));
            Refusal::new(&path, json(name), allowed)
        })?;
        if let Some(other) = taken.get(name.as_str()) {
            let found = format!("{name:?}, the same as {other}");
            return Err(Refusal::new(
                &path,
                found,
                "a name that no other load or probe has",
            ));
        }
        taken.insert(name, path);
    }
    Ok(())
}

fn is_identifier(name: &str) -> bool {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.chars().all(is_word) && name.chars().next().is_some_and(|c| !c.is_ascii_digit())
}

fn check_load(scene: &Scene, load: &Load, path: &str) -> Verdict {
    let part_path = format!("{path}.part");
    match (load.kind, &load.part) {
        (LoadKind::Traction, None) => {
            let allowed = format!(
                "for a traction, one of the parts {}",
                scene.mesh.parts().join(", ")
            );
            return Err(Refusal::new(part_path, "nothing", allowed));
        }
        (LoadKind::BodyForce, Some(part)) => {
            let allowed = "no part: a body force acts on the whole body";
            return Err(Refusal::new(part_path, json(part), allowed));
        }
        (LoadKind::BodyForce, None) => {}
        (LoadKind::Traction, Some(part)) => {
            check_part(&scene.mesh, part, &part_path)?;
            // On either, some or all of the traction would vanish without a word.
            ensure(*part != scene.contact.part, || {
                let found = format!("{part:?}, which is contact.part");
                Refusal::new(&part_path, found, "parts that are not in contact")
            })?;
            ensure(!scene.clamped.contains(part), || {
                let found = format!("{part:?}, which is clamped");
                Refusal::new(&part_path, found, "parts that are not clamped")
            })?;
        }
    }
    check_vector(&scene.mesh, &load.direction, &format!("{path}.direction"))
}

/// A direction: one component per dimension, and a length that can be divided by.
fn check_vector(mesh: &MeshSpec, vector: &[f64], path: &str) -> Verdict {
    check_dimension(mesh, vector, path)?;
    ensure(length(vector) > 0.0 && length(vector).is_finite(), || {
        Refusal::new(path, json(&vector), "a vector of nonzero finite length")
    })
}

fn check_dimension(mesh: &MeshSpec, vector: &[f64], path: &str) -> Verdict {
    let dimension = mesh.dimension();
    ensure(vector.len() == dimension, || {
        Refusal::new(
            path,
            json(&vector),
            format!("{dimension} numbers, one per dimension"),
        )
    })
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn check_probe(mesh: &MeshSpec, probe: &Probe, path: &str) -> Verdict {
    check_dimension(mesh, &probe.at, path)?;
    for (i, (x, size)) in probe.at.iter().zip(mesh.size()).enumerate() {
        ensure((0.0..=*size).contains(x), || {
            Refusal::new(
                format!("{path}[{i}]"),
                x,
                format!("0 to {size}, inside the body"),
            )
        })?;
    }
    Ok(())
}

/// Only a reduced model has a port matrix.
fn check_precision(fidelity: &Fidelity) -> Verdict {
    let is_reduced = fidelity.model == ModelKind::Reduced;
    ensure(
        is_reduced || fidelity.precision == Precision::Double,
        || {
            Refusal::new(
                "fidelity.precision",
                "\"single\" without fidelity.model \"reduced\"",
                "double, or reduced as fidelity.model",
            )
        },
    )
}

/// Two ways to choose the steps.
fn check_target(scene: &Scene) -> Verdict {
    let has_both = scene.fidelity.target_error.is_some() && scene.time.tolerance.is_some();
    ensure(!has_both, || {
        let found = "a value beside time.tolerance, which chooses the steps";
        Refusal::new(
            "fidelity.target_error",
            found,
            "a target without time.tolerance",
        )
    })
}

/// The step of an explicit scheme is bounded by its stability: errors that grow with twice the step say nothing.
fn check_time(time: &Time) -> Verdict {
    let asked = [
        ("time.tolerance", time.tolerance.is_some()),
        ("time.error_estimate", time.estimates_error()),
    ];
    for (path, is_asked) in asked {
        ensure(!is_asked || time.scheme != Scheme::Rectangle, || {
            let found = "a value with time.scheme \"rectangle\", which is explicit";
            Refusal::new(
                path,
                found,
                "trapezoid, backward_euler or tr_bdf2 as time.scheme",
            )
        })?;
    }
    Ok(())
}

fn check_signals(scene: &Scene) -> Verdict {
    let loads: BTreeSet<&str> = scene.loads.iter().map(|load| load.name.as_str()).collect();
    for (name, signal) in &scene.run.signals {
        let path = super::path::Path::default()
            .key("run")
            .key("signals")
            .key(name);
        ensure(loads.contains(name.as_str()), || {
            let names: Vec<&str> = scene.loads.iter().map(|load| load.name.as_str()).collect();
            let found = format!("the unknown load {name:?}");
            Refusal::new(&path, found, format!("the loads {}", names.join(", ")))
        })?;
        let Signal::Table(points) = signal else {
            continue;
        };
        for (i, pair) in points.windows(2).enumerate() {
            let [[before, _], [time, _]] = pair else {
                continue;
            };
            ensure(time > before, || {
                let allowed = format!("times that increase strictly: > {before}");
                Refusal::new(path.index(i + 1).index(0), time, allowed)
            })?;
        }
    }
    Ok(())
}

/// A value as the scene writes it.
fn json(value: &(impl serde::Serialize + ?Sized)) -> String {
    serde_json::to_value(value).map_or_else(|error| error.to_string(), |value: Value| shown(&value))
}
