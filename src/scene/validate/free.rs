//! What a scene cannot have whose material stays free, with the reason.

use super::super::types::*;
use crate::refusal::{Refusal, Verdict, ensure, json};

/// Refuses what is compiled from the numbers of the material beside `fidelity.free_material`.
pub(super) fn check(scene: &Scene) -> Verdict {
    if !scene.fidelity.free_material {
        return Ok(());
    }
    let Some(material) = &scene.material else {
        let found = "materials by region beside fidelity.free_material";
        let allowed = "one material for the whole body: with several the operators are not in the span of two";
        return Err(Refusal::new("materials", found, allowed));
    };
    let model = scene.fidelity.model;
    let is_reduced = matches!(model, ModelKind::Reduced | ModelKind::Auto);
    ensure(is_reduced, || {
        let found = format!("{} beside fidelity.free_material", json(&model));
        let allowed = "reduced or auto: the modes are what all materials share";
        Refusal::new("fidelity.model", found, allowed)
    })?;
    ensure(scene.fidelity.target_error.is_none(), || {
        let found = "a value beside fidelity.free_material";
        let allowed = "no target: the error would be that of one material only";
        Refusal::new("fidelity.target_error", found, allowed)
    })?;
    ensure(scene.initial.is_default(), || {
        let found = "a displacement beside fidelity.free_material";
        let allowed = "an undeformed body: the force that holds it is compiled";
        Refusal::new("initial.displacement", found, allowed)
    })?;
    material.operators().check_free("material")
}
