//! The numbers of a material that stays free, and what its operators are made of.

use crate::body::free::Free;
use crate::material::{Blend, FreeNumber};
use crate::scene::Scene;
use std::sync::Arc;

/// The numbers of a material that stays free, with the body that has them.
#[derive(Clone)]
pub(crate) struct FreeMaterial {
    pub numbers: Arc<[FreeNumber]>,
    /// Values of the numbers.
    pub values: Vec<f64>,
    pub body: Arc<Free>,
}

impl FreeMaterial {
    /// Those of a scene of which the body was made; `None` without a material of its own.
    pub fn new(scene: &Scene, body: Arc<Free>) -> Option<FreeMaterial> {
        let material = scene.material.as_ref()?;
        let numbers = FreeNumber::all(material);
        Some(FreeMaterial {
            values: numbers.iter().map(|n| n.value(material)).collect(),
            numbers: numbers.into(),
            body,
        })
    }
}

/// What the operators of the material of a scene are, with room for so many branches (`None`: for those of its own numbers, however
/// they are chosen).
pub(super) fn blend_of(scene: &Scene, branches: Option<usize>) -> Option<Blend> {
    let operators = scene.material.as_ref()?.operators();
    Blend::of(
        &operators,
        branches.unwrap_or_else(|| operators.branch_count()),
    )
}
