//! Rules of the friction of a scene, and its law on a contact.

use super::types::{Friction, PlacedContact, Scene};
use crate::Result;
use crate::contact::law::{ChosenLaw, ContactLaw, Given, Misfit, SlipKernel, Wrong};
use crate::message::number;
use crate::refusal::Refusal;
use std::ops::Range;

impl Scene {
    /// The friction laws on contact nodes with these coordinates, m, of which every contact has a range.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a coefficient that has not one number per contact node, or whose expression gives one that is out
    /// of its range.
    pub(crate) fn friction_on(
        &self,
        points: &[[f64; 3]],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<ContactLaw> {
        let mut laws = Vec::new();
        for (contact, nodes) in self.contacts().iter().zip(ranges) {
            let law = choose(contact, Some(&points[nodes.clone()]));
            laws.push((law.map_err(|refusal| refusal.of("scene"))?, nodes));
        }
        Ok(ContactLaw::new(laws))
    }

    /// The coefficients that are given node by node, and so belong to one mesh.
    pub(crate) fn nodal_coefficient(&self) -> Option<String> {
        let nodal = |given: &Given| matches!(given, Given::Nodes(_));
        self.contacts().iter().find_map(|contact| {
            let friction = &contact.friction;
            let first = friction.coefficients.iter().position(nodal)?;
            Some(friction.law.path_in(&law_path(contact), first))
        })
    }
}

/// Refuses coefficients that do not fit each other.
pub(super) fn check(contact: &PlacedContact) -> std::result::Result<(), Refusal> {
    choose(contact, None).map(|_| ())
}

/// Where the coefficients of a contact stand.
fn law_path(contact: &PlacedContact) -> String {
    format!("{}.friction", contact.path)
}

fn choose(
    contact: &PlacedContact,
    points: Option<&[[f64; 3]]>,
) -> std::result::Result<ChosenLaw, Refusal> {
    let friction = &contact.friction;
    let (law, base) = (friction.law, law_path(contact));
    let chosen = ChosenLaw::new(law, &friction.coefficients, points);
    let chosen = chosen.map_err(|misfit: Misfit| {
        let given = &friction.coefficients[misfit.coefficient];
        let path = law.path_in(&base, misfit.coefficient);
        let path = match (misfit.wrong, given) {
            (Wrong::Row(row), _) => format!("{path}[{row}]"),
            (Wrong::Count, Given::Nodes(_)) => format!("{path}.nodes"),
            (Wrong::Entry(node), Given::Nodes(_)) => format!("{path}.nodes[{node}]"),
            (Wrong::Entry(point), Given::Points(_) | Given::Rows(..)) => {
                format!("{path}[{point}]")
            }
            (_, Given::Expression(_)) => format!("{path}.expression"),
            // beside a field, a number is wrong at one of its nodes
            _ => path,
        };
        let found = match misfit.wrong {
            _ if misfit.words.is_some() => misfit.words.unwrap_or_default(),
            Wrong::Count | Wrong::Row(_) => format!("{} numbers", misfit.found),
            Wrong::Rows => format!("{} rows", misfit.found),
            _ => number(misfit.found).to_string(),
        };
        Refusal::new(path, found, misfit.allowed)
    })?;
    remember(chosen.placed(base.clone()), &base, friction)
}

/// The law with the memory of slip that the scene gives it.
fn remember(
    chosen: ChosenLaw,
    base: &str,
    friction: &Friction,
) -> std::result::Result<ChosenLaw, Refusal> {
    let path = format!("{base}.memory");
    if friction.memory.is_empty() {
        return Ok(chosen);
    }
    for (i, term) in friction.memory.iter().enumerate() {
        for (name, value) in [("weight", term.weight), ("tau", term.tau)] {
            let is_absent = name == "tau" && value == f64::INFINITY;
            if !(value > 0.0 && value.is_finite() || is_absent) {
                let path = format!("{path}.kernel[{i}].{name}");
                let allowed = "a positive number".to_owned();
                return Err(Refusal::new(path, number(value).to_string(), allowed));
            }
        }
    }
    if !chosen.depends_on_slip() {
        let found = format!("a memory of slip for {}", friction.law.name());
        let allowed = "a memory where the value depends on the slip: slip_weakening, a table with slip, an expression of s";
        return Err(Refusal::new(path, found, allowed));
    }
    Ok(chosen.with_kernel(SlipKernel::new(friction.memory.clone())))
}
