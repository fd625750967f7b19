//! The numbers of a material that stays free: set before the initialization, and taken up by it. A simulator then has a model of its
//! own, with the modes of the one it was made of.

use super::Simulator;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::ports::Quantity;
use crate::time::workspace::Workspace;
use std::sync::Arc;

impl Simulator {
    /// Takes up the numbers that were set.
    ///
    /// # Errors
    /// Those of [`Model::with_material`]; nothing has changed then.
    pub(super) fn take_material(&mut self) -> Result<()> {
        if let Some(model) = self.model_of(&self.state.material)? {
            self.put_model(model);
        }
        Ok(())
    }

    /// The model with these numbers; `None` where it is the present one.
    pub(super) fn model_of(&self, numbers: &[f64]) -> Result<Option<Arc<Model>>> {
        if numbers == self.model.free_values() {
            return Ok(None);
        }
        if numbers == self.compiled.free_values() {
            return Ok(Some(Arc::clone(&self.compiled)));
        }
        self.model.with_material(numbers).map(Some)
    }

    /// Goes on with a model of the same modes.
    pub(super) fn put_model(&mut self, model: Arc<Model>) {
        if !Arc::ptr_eq(&self.model, &model) {
            self.workspace = Workspace::new(&model);
            self.model = model;
            self.last_step = None;
        }
    }

    /// Refuses to set what is set before the initialization only.
    pub(super) fn check_phase(&self, quantity: Quantity) -> Result<()> {
        match quantity {
            Quantity::Material(_) if self.is_initialized() => Err(Error::CallOrder {
                call: "set of a number of the material",
                expected: "before init (reset starts over)",
            }),
            _ => Ok(()),
        }
    }

    /// Refuses numbers of the material that do not fit each other, among values of ports that are set together.
    pub(super) fn check_material_ports(&self, references: &[u32], values: &[f64]) -> Result<()> {
        if self.state.material.is_empty() {
            return Ok(());
        }
        let mut numbers = self.state.material.clone();
        let mut rest = values.iter();
        for reference in references {
            let port = self.model.ports().get(*reference)?;
            for value in rest.by_ref().take(port.len()) {
                if let Quantity::Material(i) = port.quantity {
                    self.check_phase(port.quantity)?;
                    numbers[i] = *value;
                }
            }
        }
        match numbers == self.state.material {
            true => Ok(()),
            false => self.model.check_material(&numbers),
        }
    }
}
