//! A law as a scene names it: one of the lists, in one of its roles, with all coefficients that it then has.

use super::{
    CONSTANT, Coefficient, Extent, FrictionLaw, KINDS, LAWS, Misfit, PATH, Unit, Wrong, coulomb,
};
use crate::error::{Error, Result};
use std::fmt;

/// What a law is in a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// One of [`LAWS`]: a bound in Pa with keys of its own.
    Own,
    /// A kind of a bound in Pa.
    Bound,
    /// A kind of the coefficient of Coulomb's law.
    Coulomb {
        /// Whether tension bounds the friction as pressure does.
        tension: bool,
    },
}

impl Role {
    /// The roles in which a kind can be, without tension.
    pub const OF_KINDS: [Role; 2] = [Role::Bound, Role::Coulomb { tension: false }];

    /// The name of the law in a scene, and the key of its kind; `None` for a law with a name of its own.
    pub fn words(self) -> Option<[&'static str; 2]> {
        match self {
            Role::Own => None,
            Role::Bound => Some(["bound", "bound"]),
            Role::Coulomb { .. } => Some(["coulomb", "coefficient"]),
        }
    }

    /// A unit in this role.
    pub fn unit(self, unit: Unit) -> &'static str {
        match self {
            Role::Own | Role::Bound => unit.in_bound(),
            Role::Coulomb { .. } => unit.in_coefficient(),
        }
    }

    /// Coefficients of the role, which follow those of the kind.
    pub fn coefficients(self) -> &'static [Coefficient] {
        match self {
            Role::Own | Role::Bound => &[],
            Role::Coulomb { .. } => &coulomb::DECLARED,
        }
    }
}

/// A law in a role.
#[derive(Clone, Copy)]
pub struct Law {
    kind: &'static dyn FrictionLaw,
    role: Role,
}

impl PartialEq for Law {
    fn eq(&self, other: &Law) -> bool {
        (self.kind.name(), self.role) == (other.kind.name(), other.role)
    }
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.role.words() {
            Some([law, _]) => write!(f, "{law} {}", self.kind.name()),
            None => f.write_str(self.kind.name()),
        }
    }
}

impl Law {
    /// What a number in the place of a kind is: Tresca's law as a bound, a constant coefficient in Coulomb's law.
    pub fn constant(role: Role) -> Law {
        let role = match role {
            Role::Own | Role::Bound => Role::Own,
            Role::Coulomb { .. } => role,
        };
        Law {
            kind: CONSTANT,
            role,
        }
    }

    /// The law that scenes write with this name in this role.
    pub fn find(role: Role, name: &str) -> Option<Law> {
        let list = match role {
            Role::Own => LAWS,
            Role::Bound | Role::Coulomb { .. } => KINDS,
        };
        let kind = *list.iter().find(|kind| kind.name() == name)?;
        Some(Law { kind, role })
    }

    /// Every law in every role, Coulomb's law without tension.
    pub fn all() -> Vec<Law> {
        let own = LAWS.iter().map(|kind| (*kind, Role::Own));
        let kinds = Role::OF_KINDS
            .into_iter()
            .flat_map(|role| KINDS.iter().map(move |kind| (*kind, role)));
        let named = own.chain(kinds).map(|(kind, role)| Law { kind, role });
        let [_, coulomb] = Role::OF_KINDS;
        named.chain([Law::constant(coulomb)]).collect()
    }

    /// Its formulas.
    pub fn kind(&self) -> &'static dyn FrictionLaw {
        self.kind
    }

    pub fn role(&self) -> Role {
        self.role
    }

    /// Name in scenes.
    pub fn name(&self) -> &'static str {
        self.kind.name()
    }

    /// Whether a scene writes it as a number in the place of a kind.
    pub fn is_number(&self) -> bool {
        self.role != Role::Own && self.kind.name() == CONSTANT.name()
    }

    /// All coefficients: those of the kind, then those of the role.
    pub fn coefficients(&self) -> impl Iterator<Item = &'static Coefficient> + Clone + use<> {
        let own = self.kind.coefficients().iter();
        own.chain(self.role.coefficients())
    }

    /// A coefficient by its place among all.
    ///
    /// # Panics
    /// Where there are not so many.
    pub fn coefficient(&self, coefficient: usize) -> &'static Coefficient {
        let own = self.kind.coefficients();
        own.get(coefficient)
            .unwrap_or_else(|| &self.role.coefficients()[coefficient - own.len()])
    }

    /// Whether a coefficient bounds the friction of a node that nothing presses.
    pub fn is_cohesion(&self, coefficient: usize) -> bool {
        let is_of_role = coefficient >= self.kind.coefficients().len();
        is_of_role && self.coefficient(coefficient).name == coulomb::DECLARED[0].name
    }

    /// Unit of a coefficient.
    pub fn unit(&self, coefficient: usize) -> &'static str {
        self.role.unit(self.coefficient(coefficient).unit)
    }

    /// Where a scene with one contact has a coefficient, which is also the name of its port.
    pub fn path(&self, coefficient: usize) -> String {
        self.path_in(PATH, coefficient)
    }

    /// Where a coefficient stands beside the others at this path.
    pub fn path_in(&self, base: &str, coefficient: usize) -> String {
        let name = self.coefficient(coefficient).name;
        match self.role.words() {
            Some([_, key]) if coefficient < self.kind.coefficients().len() => {
                if self.is_number() {
                    format!("{base}.{key}")
                } else {
                    format!("{base}.{key}.{name}")
                }
            }
            _ => format!("{base}.{name}"),
        }
    }

    /// Refuses a value that the coefficient, which stands at this path with the others, cannot have, whatever these are.
    ///
    /// # Errors
    /// [`Error::Value`] when it is not finite or out of its range.
    pub fn check_value(&self, base: &str, coefficient: usize, value: f64) -> Result<()> {
        let range = self.coefficient(coefficient).range;
        if range.contains(value) {
            return Ok(());
        }
        Err(Error::Value {
            what: self.path_in(base, coefficient),
            found: value,
            allowed: range.allowed,
        })
    }

    /// What a simulator says of coefficients at this path that do not fit each other.
    pub fn refusal(&self, base: &str, misfit: Misfit) -> Error {
        let extent = self.coefficient(misfit.coefficient).extent;
        let place = match (misfit.wrong, extent) {
            (Wrong::Number, _) | (Wrong::Entry(_), Extent::Choice(_) | Extent::Formula) => {
                String::new()
            }
            (Wrong::Count, _) => ", its numbers".to_owned(),
            (Wrong::Rows, _) => ", its rows".to_owned(),
            (Wrong::Row(row), _) => format!(", the numbers of row {row}"),
            (Wrong::Entry(node), Extent::Nodes) => format!(" at contact node {node}"),
            (Wrong::Entry(point), Extent::Points | Extent::Grid) => format!(" at point {point}"),
        };
        let path = |coefficient: usize| self.path_in(base, coefficient);
        let beside = |(other, value): (usize, f64)| format!(", where {} is {value:?}", path(other));
        Error::Value {
            what: format!(
                "{}{place}{}",
                path(misfit.coefficient),
                misfit.beside.map(beside).unwrap_or_default()
            ),
            found: misfit.found,
            allowed: misfit.rule,
        }
    }
}
