//! Models of the same body with other numbers of a material that stays free: made from the modes without any matrix of
//! the size of the body.
//!
//! All of them have the same ports, the same layout of states, and the same fingerprint: it is taken without the numbers of the
//! material and what follows from them. A state carries the numbers that it was made with.

use super::Model;
use super::certificate::{LawConstants, MaterialConstants, certify, constants_of_compliance};
use super::free::{FreeMaterial, blend_of};
use super::parts::Parts;
use crate::error::{Error, Result};
use crate::fem::Forms;
use crate::material::FreeNumber;
use crate::scene::Scene;
use crate::time::scheme::Tableau;
use std::sync::Arc;

impl Model {
    /// The numbers of the material that stay free: paths in the scene, units, meanings; none without `fidelity.free_material`.
    pub fn free_numbers(&self) -> &[FreeNumber] {
        self.free.as_ref().map_or(&[], |free| &free.numbers)
    }

    /// Their values.
    pub fn free_values(&self) -> &[f64] {
        self.free.as_ref().map_or(&[], |free| &free.values)
    }

    /// The model of the same body with other values of [`Model::free_numbers`]: nothing is compiled, and states of both are
    /// interchangeable.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of values, [`Error::Value`] for one that is out of its own range, [`Error::Scene`] for
    /// values that do not fit each other or ratios that the body is not compiled for, [`Error::Unstable`].
    pub fn with_material(&self, values: &[f64]) -> Result<Arc<Model>> {
        let scene = self.with_numbers(values)?;
        let Some(free) = &self.free else {
            return Err(unknown());
        };
        let blend = blend_of(&scene, Some(free.body.branch_count())).ok_or_else(|| {
            let found = "more branches than the compiled model has room for".to_owned();
            let allowed = format!("{} branches", free.body.branch_count());
            crate::refusal::scene_error("material.memory", found, allowed)
        })?;
        let body = Arc::new(free.body.with(&blend));
        let Some(material) = &scene.material else {
            return Err(unknown());
        };
        let dimension = self.summary.dimension;
        let forms = Forms::of_material(&material.operators());
        let rates = forms.rates(dimension);
        let tableau = Tableau::of(scene.scheme());
        match tableau.stability_limit(rates[1]) {
            Some(limit) if self.largest_step > limit && !scene.time.force => {
                let step = self.largest_step;
                return Err(Error::Unstable { step, limit });
            }
            _ => {}
        }
        let theta_k = tableau.theta() * scene.time.step;
        let certificate = certify(
            MaterialConstants::of(&forms, dimension),
            constants_of_compliance(&self.contact, &body.strain_compliance())?,
            LawConstants::of(&self.friction, theta_k),
            theta_k,
            |x, y| constants_of_compliance(&self.contact, &body.compliance(x, y)),
        )?;
        let summary = &self.summary;
        let parts = Parts {
            kind: summary.kind,
            reduction: summary.reduction.clone(),
            contact: self.contact.clone(),
            measures: self.measures.clone(),
            motions: self.motions.clone(),
            initial: None,
            certificate,
            strain_weights: None,
            dimension,
            mesh_nodes: summary.mesh_nodes,
            mesh_cells: summary.mesh_cells,
            free_dofs: summary.free_dofs,
            rates,
            selection: summary.selection.clone(),
            fallback: summary.fallback.clone(),
            lost_digits: summary.lost_digits,
            files: self.files.clone(),
            free: FreeMaterial::new(&scene, Arc::clone(&body)),
            body,
        };
        Model::new(&scene, parts).map(Arc::new)
    }

    /// Refuses values of the numbers that [`Model::with_material`] would refuse before it makes anything.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn check_material(&self, values: &[f64]) -> Result<()> {
        self.with_numbers(values).map(|_| ())
    }

    /// Refuses a value that a number cannot have by itself.
    ///
    /// # Errors
    /// [`Error::Value`].
    pub(crate) fn check_number(&self, number: usize, value: f64) -> Result<()> {
        let number = &self.free_numbers()[number];
        match number.fault(value) {
            None => Ok(()),
            Some(allowed) => Err(Error::Value {
                what: number.path.clone(),
                found: value,
                allowed,
            }),
        }
    }

    /// The scene with other values of its numbers, checked.
    fn with_numbers(&self, values: &[f64]) -> Result<Scene> {
        let numbers = self.free_numbers();
        if values.len() != numbers.len() {
            return Err(Error::Length {
                what: "numbers of the free material",
                expected: numbers.len(),
                found: values.len(),
            });
        }
        let mut scene = self.scene.clone();
        let Some(material) = &mut scene.material else {
            return Err(unknown());
        };
        for (i, (number, value)) in numbers.iter().zip(values).enumerate() {
            self.check_number(i, *value)?;
            if let Some(slot) = number.slot(material) {
                *slot = *value;
            }
        }
        let operators = material.operators();
        let check = operators.check(self.summary.dimension, "material");
        let check = check.and_then(|()| operators.check_free("material"));
        check.map_err(|refusal| refusal.of(&scene.name))?;
        Ok(scene)
    }

    /// The text of the scene in the fingerprint: without the numbers that stay free.
    pub(super) fn scene_of_fingerprint(&self) -> String {
        let mut scene = self.scene.clone();
        if let Some(material) = &mut scene.material {
            for number in self.free_numbers() {
                if let Some(slot) = number.slot(material) {
                    *slot = 0.0;
                }
            }
        }
        scene.to_json()
    }
}

fn unknown() -> Error {
    Error::Unknown {
        what: "free material (fidelity.free_material is false)",
        found: "numbers of one".to_owned(),
    }
}
