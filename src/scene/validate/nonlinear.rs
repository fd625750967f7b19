//! What a body of laws that are not linear cannot have yet, with the reason.

use super::super::types::*;
use crate::refusal::{Refusal, Verdict, ensure};

/// Refuses what needs a linear body beside a law that is not linear.
pub(super) fn check(scene: &Scene) -> Verdict {
    let materials = scene.materials();
    let found = materials.iter().find_map(|material| {
        let key = material.operators.nonlinear_key()?;
        Some(format!("{}.{key}", material.path))
    });
    let Some(law) = found else {
        return Ok(());
    };
    let sheet = materials.iter().find(|material| {
        let is_sheet = !matches!(material.operators.memory, Memory::Branches(_));
        is_sheet && material.operators.excesses()[1].is_some()
    });
    if let Some(material) = sheet {
        let allowed = "branches in moduli: shares and fits are of a linear elasticity";
        let found = "a data sheet beside an elasticity that is not linear";
        return Err(Refusal::new(
            format!("{}.memory", material.path),
            found,
            allowed,
        ));
    }
    let beside = |what: &str| format!("{what} beside the nonlinear law of {law}");
    ensure(scene.fidelity.model != ModelKind::Reduced, || {
        let allowed =
            "full, condensed or auto: a reduced model is made of the modes of a linear body";
        Refusal::new("fidelity.model", beside("reduced"), allowed)
    })?;
    ensure(!scene.fidelity.solver.measures_strains(), || {
        let allowed = "newton: the friction problem is solved exactly at every iterate of the body";
        Refusal::new("fidelity.solver", beside("fixed_point"), allowed)
    })?;
    ensure(!scene.fidelity.multiplicity_test, || {
        let allowed = "false: the test looks for other solutions of one linear stage";
        Refusal::new("fidelity.multiplicity_test", beside("true"), allowed)
    })?;
    ensure(!scene.fidelity.uniqueness, || {
        let allowed = "false: what is proved is proved of one linear stage";
        Refusal::new("fidelity.uniqueness", beside("true"), allowed)
    })?;
    ensure(scene.fidelity.work_limit.is_none(), || {
        let allowed = "no limit: the iterations of the body would not be counted in it";
        Refusal::new("fidelity.work_limit", beside("a limit"), allowed)
    })?;
    ensure(scene.driven.is_empty(), || {
        let allowed = "no driven parts: the motion of the body that follows from theirs is that of linear laws";
        Refusal::new("driven", beside("driven parts"), allowed)
    })
}
