//! Rules of what presses and moves: the normal condition, the foundation, driven parts, and the schemes that can follow them.

use super::super::types::*;
use super::body::{check_part, refuse_contact};
use super::{check_dimension, check_vector};
use crate::message::cut;
use crate::refusal::{Refusal, Verdict, ensure, json};

/// Cosine of the angle between two directions of a part up to which they are at right angles.
const ORTHOGONAL: f64 = 1e-9;

pub(super) fn check_condition(scene: &Scene) -> Verdict {
    for contact in scene.contacts() {
        let gap = contact.condition.gap();
        if let (Some(Gap::Nodal(_)), Some(_)) = (gap, scene.fidelity.target_error) {
            let found = "a value beside a gap per contact node, which belongs to one mesh";
            let allowed = format!(
                "a target with a number or \"geometry\" in {}.condition.gap",
                contact.path
            );
            return Err(Refusal::new("fidelity.target_error", found, allowed));
        }
        ensure(
            contact.condition.is_default() || contact.friction.vanishes_without_pressure(),
            || {
                let found = "a bound that is not zero without pressure, where contact can open";
                let allowed = "frictionless, or coulomb without cohesion: a bound that jumps where contact opens leaves steps without solution";
                Refusal::new(format!("{}.friction", contact.path), found, allowed)
            },
        )?;
    }
    let can_open = scene.can_open();
    let gives_way = |c: &Contact| matches!(c.condition, Condition::Compliance { .. });
    let is_mixed = scene.each_contact().any(gives_way) && !scene.each_contact().all(gives_way);
    ensure(!is_mixed || scene.scheme() != Scheme::Midpoint, || {
        let found = "\"midpoint\", where one contact gives way and another is rigid: the rule puts their gaps at different instants";
        Refusal::new("time.scheme", found, "auto, backward_euler or tr_bdf2")
    })?;
    if !scene.is_pressed() {
        return Ok(());
    }
    ensure(
        matches!(scene.fidelity.solver, FrictionSolver::Newton { .. }),
        || {
            let found = "\"fixed_point\", where the contact has a pressure";
            Refusal::new("fidelity.solver.kind", found, "newton")
        },
    )?;
    ensure(scene.scheme() != Scheme::Rectangle, || {
        let found =
            "\"rectangle\", which is explicit: no pressure of a step could keep the gap at its end";
        Refusal::new(
            "time.scheme",
            found,
            "auto, midpoint, backward_euler or tr_bdf2",
        )
    })?;
    let rings = can_open || scene.has_approach();
    let is_refused = rings && scene.scheme() == Scheme::Trapezoid && !scene.time.force;
    ensure(!is_refused, || {
        let found = "\"trapezoid\" where contact opens or closes, or the foundation moves along its normal: the pressure would ring from then on";
        let allowed = "auto, midpoint, backward_euler or tr_bdf2; or time.force";
        Refusal::new("time.scheme", found, allowed)
    })
}

pub(super) fn check_foundation(scene: &Scene, dimension: Option<usize>) -> Verdict {
    for contact in scene.contacts() {
        for (i, motion) in contact.foundation.iter().enumerate() {
            let path = format!("{}.foundation[{i}]", contact.path);
            match motion {
                Foundation::Sliding { direction, .. } => {
                    check_vector(dimension, direction, &format!("{path}.direction"))?;
                }
                Foundation::Rotation { centre, axis, .. } => {
                    check_axis(dimension, centre, axis.as_deref(), &path)?;
                }
                Foundation::Approach { .. } => {}
            }
        }
    }
    Ok(())
}

pub(super) fn check_driven(scene: &Scene, dimension: Option<usize>) -> Verdict {
    ensure(
        !(scene.clamped.is_empty() && scene.driven.is_empty() && scene.rollers.is_empty()),
        || {
            let allowed = "an array of at least 1 part; or driven parts, or rollers";
            Refusal::new("clamped", json(&scene.clamped), allowed)
        },
    )?;
    for (i, driven) in scene.driven.iter().enumerate() {
        let path = format!("driven[{i}].part");
        let part = &driven.part;
        check_part(&scene.mesh, part, &path)?;
        let is_other = |other: &Driven| other.part == *part;
        let allowed = "parts that are neither clamped, nor in contact, nor driven twice";
        refuse_contact(scene, part, &path, allowed)?;
        for (is_taken, what) in [
            (scene.clamped.contains(part), "which is clamped"),
            (scene.driven[..i].iter().any(is_other), "a second time"),
        ] {
            ensure(!is_taken, || {
                let found = format!("{:?}, {what}", cut(part));
                Refusal::new(&path, found, allowed)
            })?;
        }
        check_directions(dimension, driven, &format!("driven[{i}].directions"))?;
    }
    Ok(())
}

fn check_directions(dimension: Option<usize>, driven: &Driven, path: &str) -> Verdict {
    ensure(!driven.directions.is_empty(), || {
        Refusal::new(path, "{}", "at least one direction with its name")
    })?;
    let mut vectors: Vec<&[f64]> = Vec::new();
    for (name, direction) in &driven.directions {
        let path = format!("{path}.{}", cut(name));
        match direction {
            DrivenDirection::Translation(vector) => {
                check_vector(dimension, vector, &path)?;
                let is_orthogonal = |other: &&[f64]| {
                    let product: f64 = other.iter().zip(vector).map(|(a, b)| a * b).sum();
                    let lengths = super::length(other) * super::length(vector);
                    product.abs() <= ORTHOGONAL * lengths
                };
                ensure(vectors.iter().all(is_orthogonal), || {
                    let allowed = "directions of a part at right angles to each other";
                    Refusal::new(&path, json(vector), allowed)
                })?;
                vectors.push(vector);
            }
            DrivenDirection::Rotation(RotationAxis { centre, axis }) => {
                check_axis(dimension, centre, axis.as_deref(), &path)?;
            }
        }
    }
    Ok(())
}

/// A point and, in three dimensions, a direction; where the dimension is not known yet, that waits.
fn check_axis(
    dimension: Option<usize>,
    centre: &[f64],
    axis: Option<&[f64]>,
    path: &str,
) -> Verdict {
    check_dimension(dimension, centre, &format!("{path}.centre"))?;
    let path = format!("{path}.axis");
    match (axis, dimension) {
        (_, None) | (None, Some(2)) => Ok(()),
        (Some(axis), Some(2)) => Err(Refusal::new(
            path,
            json(&axis),
            "nothing in 2D: the axis is z",
        )),
        (None, _) => Err(Refusal::new(path, "nothing", "a direction of 3 numbers")),
        (Some(axis), _) => check_vector(dimension, axis, &path),
    }
}
