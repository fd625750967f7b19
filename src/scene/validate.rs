//! Rules that tie several values of a scene together. What concerns one value alone (types, names, ranges) is stated
//! with the types and has been checked before; what only a mesh can say (points inside the body, normals, free contact
//! nodes, cells of regions) is said when the body is assembled (`crate::fem`).

mod body;
mod free;
mod initial;
mod motion;
mod nonlinear;

use super::types::*;
use crate::message::{cut, number};
use crate::refusal::{Refusal, Verdict, ensure, json};
use body::{check_clamped, check_contact, check_materials, check_mesh, check_part, refuse_contact};
use initial::check_initial;
use motion::{check_condition, check_driven, check_foundation};
use std::collections::{BTreeMap, BTreeSet};

/// First components of the ports that every scene has; a load or probe of that name would collide with them.
const RESERVED: [&str; 4] = ["contact", "energy", "solver", "time"];

/// Refuses the first violated rule.
pub(super) fn check(scene: &Scene) -> Verdict {
    check_in(scene, scene.mesh.dimension())
}

/// The same for a mesh of this dimension; `None`: it is not known yet, and the rules that need it wait.
pub(super) fn check_in(scene: &Scene, dimension: Option<usize>) -> Verdict {
    check_mesh(scene, dimension)?;
    check_materials(scene, dimension)?;
    check_clamped(scene)?;
    check_driven(scene, dimension)?;
    check_contact(scene, dimension)?;
    check_foundation(scene, dimension)?;
    check_condition(scene)?;
    check_initial(scene, dimension)?;
    check_names(scene)?;
    for (i, load) in scene.loads.iter().enumerate() {
        check_load(scene, dimension, load, &format!("loads[{i}]"))?;
    }
    for (i, probe) in scene.probes.iter().enumerate() {
        check_dimension(dimension, &probe.at, &format!("probes[{i}].at"))?;
    }
    check_time(&scene.time)?;
    check_dashpots(scene)?;
    check_precision(&scene.fidelity)?;
    nonlinear::check(scene)?;
    free::check(scene)?;
    check_work_limit(scene)?;
    check_target(scene)?;
    check_signals(scene)
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
    let driven = scene.driven.iter().enumerate().flat_map(|(i, d)| {
        let of = move |name| (format!("driven[{i}].directions"), name);
        d.directions.keys().map(of)
    });
    let contacts = scene.contacts();
    let names = contacts.iter().filter(|c| c.name != CONTACT);
    let named = names.map(|c| (format!("{}.name", c.path), c.name.as_str()));
    let foundation = contacts.iter().flat_map(|contact| {
        let motions = contact.foundation.iter().enumerate();
        motions.map(|(i, m)| (format!("{}.foundation[{i}].name", contact.path), m.name()))
    });
    if let Some(contact) = contacts
        .iter()
        .find(|c| contacts.len() > 1 && c.name == CONTACT)
    {
        let allowed = "a name of its own for each of several contacts: the ports of all together begin with contact";
        return Err(Refusal::new(
            format!("{}.name", contact.path),
            json(&contact.name),
            allowed,
        ));
    }
    let all = loads
        .chain(probes)
        .chain(driven)
        .map(|(path, name)| (path, name.as_str()));
    let mut taken: BTreeMap<&str, String> = BTreeMap::new();
    for (path, name) in all.chain(named).chain(foundation) {
        ensure(is_identifier(name), || {
            let allowed = "a letter or underscore, then letters, digits and underscores";
            Refusal::new(&path, json(name), allowed)
        })?;
        ensure(!RESERVED.contains(&name), || {
            let allowed = format!("a name other than {}", RESERVED.join(", "));
            Refusal::new(&path, json(name), allowed)
        })?;
        if let Some(other) = taken.get(name) {
            let found = format!("{:?}, the same as {other}", cut(name));
            return Err(Refusal::new(
                &path,
                found,
                "a name that no other load, probe, contact or motion has",
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

fn check_load(scene: &Scene, dimension: Option<usize>, load: &Load, path: &str) -> Verdict {
    let part_path = format!("{path}.part");
    match (load.kind, &load.part) {
        (LoadKind::Traction, None) => {
            let allowed = match scene.mesh.source().parts() {
                Some(parts) => format!("for a traction, one of the parts {}", parts.join(", ")),
                None => "for a traction, a part of the mesh".to_owned(),
            };
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
            refuse_contact(scene, part, &part_path, "parts that are not in contact")?;
            ensure(!scene.clamped.contains(part), || {
                let found = format!("{:?}, which is clamped", cut(part));
                Refusal::new(&part_path, found, "parts that are not clamped")
            })?;
        }
    }
    check_vector(dimension, &load.direction, &format!("{path}.direction"))
}

/// A direction: one component per dimension, and a length that can be divided by.
fn check_vector(dimension: Option<usize>, vector: &[f64], path: &str) -> Verdict {
    check_dimension(dimension, vector, path)?;
    ensure(length(vector) > 0.0 && length(vector).is_finite(), || {
        Refusal::new(path, json(&vector), "a vector of nonzero finite length")
    })
}

fn check_dimension(dimension: Option<usize>, vector: &[f64], path: &str) -> Verdict {
    let is_possible = match dimension {
        Some(dimension) => vector.len() == dimension,
        None => matches!(vector.len(), 2 | 3),
    };
    ensure(is_possible, || {
        let dimension = dimension.map_or("2 or 3".to_owned(), |d| d.to_string());
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

/// Only a reduced model has a port matrix.
fn check_work_limit(scene: &Scene) -> Verdict {
    let Some(limit) = scene.fidelity.work_limit else {
        return Ok(());
    };
    ensure(limit >= 1, || {
        Refusal::new("fidelity.work_limit", json(&limit), "at least 1")
    })?;
    let is_fixed_point = matches!(scene.fidelity.solver, FrictionSolver::FixedPoint { .. });
    for (is_refused, what) in [
        (
            scene.time.tolerance.is_some(),
            "time.tolerance, which has no bound on the number of internal steps",
        ),
        (
            scene.fidelity.target_error.is_some(),
            "fidelity.target_error, which measures steps that are solved",
        ),
        (
            scene.fidelity.multiplicity_test,
            "fidelity.multiplicity_test, whose solves have no limit",
        ),
        (
            scene.fidelity.uniqueness,
            "fidelity.uniqueness, whose solves have no limit",
        ),
        (is_fixed_point, "fidelity.solver.kind \"fixed_point\""),
    ] {
        ensure(!is_refused, || {
            let found = format!("{limit} beside {what}");
            Refusal::new("fidelity.work_limit", found, "one of the two")
        })?;
    }
    Ok(())
}

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

/// Two ways to choose the steps; other meshes than the one that a coefficient was given for.
fn check_target(scene: &Scene) -> Verdict {
    let has_file = scene.mesh.file().is_some();
    ensure(scene.fidelity.target_error.is_none() || !has_file, || {
        let found = "a value with a mesh from a file, whose cells cannot be chosen";
        let allowed = "a target with mesh.kind rectangle or box";
        Refusal::new("fidelity.target_error", found, allowed)
    })?;
    let nodal = scene.nodal_coefficient();
    if let (Some(path), Some(_)) = (nodal, scene.fidelity.target_error) {
        let found = "a value beside a coefficient per contact node, which belongs to one mesh";
        let allowed = format!("a target with numbers in {path}");
        return Err(Refusal::new("fidelity.target_error", found, allowed));
    }
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

/// Where a material has no dashpot, nothing gives its velocity at a fixed displacement: what needs one cannot be.
fn check_dashpots(scene: &Scene) -> Verdict {
    let materials = scene.materials();
    let Some(without) = materials.iter().find(|m| !m.operators.has_dashpot()) else {
        return Ok(());
    };
    let of = format!("{} has no dashpot (viscosity 0)", without.path);
    let scheme = scene.scheme();
    let is_stiff = matches!(scheme, Scheme::BackwardEuler | Scheme::TrBdf2);
    let is_taken = is_stiff || (scheme == Scheme::Trapezoid && scene.time.force);
    ensure(is_taken, || {
        let why = match scheme {
            Scheme::Trapezoid => "the trapezoid would ring for ever",
            _ => "it needs the velocity at a fixed displacement",
        };
        let found = format!("{} where {of}: {why}", json(&scheme));
        let allowed = match scheme {
            Scheme::Trapezoid => "auto, tr_bdf2 or backward_euler; or time.force",
            _ => "auto, tr_bdf2 or backward_euler",
        };
        Refusal::new("time.scheme", found, allowed)
    })?;
    ensure(scene.time.start == Start::Zero, || {
        let found = format!(
            "{} where {of}: a load would move it at once",
            json(&scene.time.start)
        );
        let allowed =
            "zero, with loads that begin at rest: the first step follows those that do not";
        Refusal::new("time.start", found, allowed)
    })?;
    ensure(scene.time.tolerance.is_none(), || {
        let found = format!("a value where {of}: errors are measured in the norm of the viscosity");
        Refusal::new("time.tolerance", found, "equal steps")
    })
}

fn check_signals(scene: &Scene) -> Verdict {
    let inputs: BTreeSet<&str> = scene.inputs().map(|(name, _)| name).collect();
    for (name, signal) in &scene.run.signals {
        let path = super::path::Path::default()
            .key("run")
            .key("signals")
            .key(name);
        ensure(inputs.contains(name.as_str()), || {
            let names: Vec<&str> = scene.inputs().map(|(name, _)| name).collect();
            let found = format!("the unknown input {:?}", cut(name));
            let allowed = format!("the inputs {}", cut(&names.join(", ")));
            Refusal::new(&path, found, allowed)
        })?;
        let Signal::Table(points) = signal else {
            continue;
        };
        for (i, pair) in points.windows(2).enumerate() {
            let [[before, _], [time, _]] = pair else {
                continue;
            };
            let is_third = i > 0 && points[i - 1][0] == *time;
            ensure(time >= before && !is_third, || {
                let before = number(*before);
                let allowed =
                    format!("times that increase: > {before}, or for a jump {before} twice");
                Refusal::new(path.index(i + 1).index(0), number(*time), allowed)
            })?;
        }
    }
    Ok(())
}
