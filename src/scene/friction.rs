//! Rules of the friction of a scene, and its law on a contact.

use super::types::Scene;
use crate::Result;
use crate::contact::law::{ChosenLaw, Extent, Given, Misfit, Wrong};
use crate::message::number;
use crate::refusal::Refusal;

impl Scene {
    /// The friction law on a contact of so many nodes.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a coefficient that has not one number per contact node.
    pub(crate) fn friction_on(&self, nodes: usize) -> Result<ChosenLaw> {
        choose(self, Some(nodes)).map_err(|refusal| refusal.of("scene"))
    }

    /// The coefficients that are given node by node, and so belong to one mesh.
    pub(crate) fn nodal_coefficient(&self) -> Option<String> {
        let friction = &self.contact.friction;
        let nodal = |given: &Given| matches!(given, Given::Nodes(_));
        let first = friction.coefficients.iter().position(nodal);
        first.map(|coefficient| friction.law.path(coefficient))
    }
}

/// Refuses coefficients that do not fit each other.
pub(super) fn check(scene: &Scene) -> std::result::Result<(), Refusal> {
    choose(scene, None).map(|_| ())
}

fn choose(scene: &Scene, nodes: Option<usize>) -> std::result::Result<ChosenLaw, Refusal> {
    let friction = &scene.contact.friction;
    let law = friction.law;
    ChosenLaw::new(law, &friction.coefficients, nodes).map_err(|misfit: Misfit| {
        let path = law.path(misfit.coefficient);
        let path = match (misfit.wrong, law.coefficient(misfit.coefficient).extent) {
            (Wrong::Number | Wrong::Rows, _)
            | (_, Extent::Choice(_))
            | (Wrong::Count, Extent::Points | Extent::Grid) => path,
            (Wrong::Row(row), _) => format!("{path}[{row}]"),
            (Wrong::Count, Extent::Nodes) => format!("{path}.nodes"),
            (Wrong::Entry(point), Extent::Points | Extent::Grid) => format!("{path}[{point}]"),
            // beside a field, a number is wrong at one of its nodes
            (Wrong::Entry(node), Extent::Nodes) => {
                match friction.coefficients[misfit.coefficient] {
                    Given::Nodes(_) => format!("{path}.nodes[{node}]"),
                    _ => path,
                }
            }
        };
        let found = match misfit.wrong {
            Wrong::Count | Wrong::Row(_) => format!("{} numbers", misfit.found),
            Wrong::Rows => format!("{} rows", misfit.found),
            _ => number(misfit.found).to_string(),
        };
        Refusal::new(path, found, misfit.allowed)
    })
}
