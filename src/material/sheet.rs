//! Memory as a scene has it: branches, or what data sheets and other programs state, brought to branches.

use super::fractional::FractionalMemory;
use super::measured::{DynamicMemory, RelaxationMemory};
use super::memory::Branch;
use super::relative::RelativeMemory;
use super::resolved::{Pair, Resolved};
use crate::refusal::Refusal;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Long memory of a material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Memory {
    /// Branches of a generalised Maxwell body, in moduli.
    Branches(Vec<Branch>),
    /// Shares of the moduli of an isotropic elasticity.
    Relative(RelativeMemory),
    /// Storage and loss modulus in shear over the frequency.
    Dynamic(DynamicMemory),
    /// Relaxation modulus in shear over the time.
    Relaxation(RelaxationMemory),
    /// A power of the time.
    Fractional(FractionalMemory),
}

impl Default for Memory {
    fn default() -> Memory {
        Memory::Branches(Vec::new())
    }
}

impl Memory {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        matches!(self, Memory::Branches(branches) if branches.is_empty())
    }

    /// The branches, beside an elasticity and a viscosity of these moduli (`None` for laws that are not isotropic); `path` is the
    /// place of the memory in the scene.
    ///
    /// # Errors
    /// Tables that do not ascend, shares that leave nothing, laws that are not isotropic, fits that miss too much.
    pub(super) fn resolve(
        &self,
        elasticity: Option<Pair>,
        viscosity: Option<Pair>,
        path: &str,
    ) -> Result<Resolved, Refusal> {
        let isotropic = |pair: Option<Pair>, what: &str| {
            pair.ok_or_else(|| {
                let found = format!("a data sheet beside {what} that is not isotropic");
                Refusal::new(path, found, "branches in moduli (tau, shear, bulk)")
            })
        };
        match self {
            Memory::Branches(branches) => Ok(Resolved {
                branches: branches.clone(),
                left: Pair::WHOLE,
                error: None,
            }),
            Memory::Relative(table) => table.resolve(isotropic(elasticity, "an elasticity")?, path),
            Memory::Dynamic(table) => {
                let own = isotropic(elasticity, "an elasticity")?;
                table.resolve(own, isotropic(viscosity, "a viscosity")?, path)
            }
            Memory::Relaxation(table) => {
                table.resolve(isotropic(elasticity, "an elasticity")?, path)
            }
            Memory::Fractional(memory) => memory.fractional.resolve(path),
        }
    }
}
