//! The friction of a scene: one of the laws, with the coefficients that it declares.
//!
//! Schema, reading and writing follow from the lists of laws and kinds (`contact::law`); nothing here knows a law by name.

mod schema;

use crate::contact::law::{Coefficient, Extent, Given, KernelTerm, Law, Omitted, Role};
use serde::de::Error as _;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};

/// Key of a coefficient that is given node by node.
const NODES: &str = "nodes";

/// Key of a coefficient that is a formula of the place.
const EXPRESSION: &str = "expression";

/// Key of the choice that tension bounds the friction too.
const TENSION: &str = "tension";

/// Key of the memory of slip, and of its kernel.
const MEMORY: &str = "memory";
const KERNEL: &str = "kernel";
const WEIGHT: &str = "weight";
const TAU: &str = "tau";

/// Friction law of the contact and its coefficients, in the order in which the law declares them.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    pub law: Law,
    pub coefficients: Vec<Given>,
    /// Kernel by which the law remembers slip, in place of the accumulated slip; empty for none.
    pub memory: Vec<KernelTerm>,
}

impl Friction {
    /// Whether it is Coulomb's law.
    pub fn is_coulomb(&self) -> bool {
        matches!(self.law.role(), Role::Coulomb { .. })
    }

    /// Whether it takes the solver with pressure: Coulomb's law, and laws whose bound has no potential.
    pub fn needs_pressure(&self) -> bool {
        self.is_coulomb() || !self.law.kind().has_potential()
    }

    /// Whether there is no friction where nothing presses.
    pub fn vanishes_without_pressure(&self) -> bool {
        if !self.is_coulomb() {
            return self.coefficients.is_empty();
        }
        let of_cohesion = |i: &usize| self.law.is_cohesion(*i);
        let mut all = (0..self.coefficients.len()).filter(of_cohesion);
        all.all(|i| match &self.coefficients[i] {
            Given::Number(value) => *value == 0.0,
            Given::Nodes(values) => values.iter().all(|v| *v == 0.0),
            given => *given == Given::Absent,
        })
    }
}

impl<'de> Deserialize<'de> for Friction {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Friction, D::Error> {
        let value = Value::deserialize(from)?;
        read(&value).ok_or_else(|| D::Error::custom("no friction law with its coefficients"))
    }
}

/// The friction that a value writes, if it does.
fn read(value: &Value) -> Option<Friction> {
    let members = value.as_object()?;
    let name = members.get("law")?.as_str()?;
    let tension = members.get(TENSION).map_or(Some(false), Value::as_bool)?;
    let is_named = |role: &Role| role.words().is_some_and(|[law, _]| law == name);
    let Some(role) = Role::OF_KINDS.into_iter().find(is_named) else {
        let law = Law::find(Role::Own, name)?;
        let coefficients = read_list(law.kind().coefficients(), members, 1)?;
        return Some(Friction {
            law,
            coefficients,
            memory: Vec::new(),
        });
    };
    let [_, key] = role.words()?;
    let memory = match members.get(MEMORY) {
        Some(value) => read_memory(value)?,
        None => Vec::new(),
    };
    let has_memory = usize::from(members.contains_key(MEMORY));
    // beside the name of the law and the kind
    let (role, others) = match role {
        Role::Coulomb { .. } => {
            let has_choice = usize::from(members.contains_key(TENSION));
            (Role::Coulomb { tension }, 2 + has_choice)
        }
        Role::Own | Role::Bound => (role, 2),
    };
    let others = others + has_memory;
    match members.get(key)? {
        Value::Object(kind) if kind.contains_key("kind") => {
            let law = Law::find(role, kind.get("kind")?.as_str()?)?;
            let mut coefficients = read_list(law.kind().coefficients(), kind, 1)?;
            coefficients.extend(read_list(role.coefficients(), members, others)?);
            Some(Friction {
                law,
                coefficients,
                memory,
            })
        }
        value => {
            let law = Law::constant(role);
            let declared = law.coefficient(0);
            let mut coefficients = vec![read_given(declared.extent, value)?];
            coefficients.extend(read_list(role.coefficients(), members, others)?);
            Some(Friction {
                law,
                coefficients,
                memory,
            })
        }
    }
}

/// The terms of a memory.
fn read_memory(value: &Value) -> Option<Vec<KernelTerm>> {
    let members = value.as_object().filter(|members| members.len() == 1)?;
    let terms = members.get(KERNEL)?.as_array()?;
    let terms = terms.iter().map(|term| {
        let members = term.as_object()?;
        let tau = match members.get(TAU) {
            Some(tau) => tau.as_f64()?,
            None => f64::INFINITY,
        };
        let known = 1 + usize::from(members.contains_key(TAU));
        let weight = members.get(WEIGHT)?.as_f64()?;
        (members.len() == known).then_some(KernelTerm { weight, tau })
    });
    terms.collect()
}

/// A memory as a scene writes it.
fn written_memory(terms: &[KernelTerm]) -> Value {
    let terms = terms.iter().map(|term| match term.tau.is_finite() {
        true => json!({ WEIGHT: term.weight, TAU: term.tau }),
        false => json!({ WEIGHT: term.weight }),
    });
    json!({ KERNEL: terms.collect::<Vec<_>>() })
}

/// Declared coefficients among members of which so many others are allowed.
fn read_list(
    declared: &[Coefficient],
    members: &Map<String, Value>,
    others: usize,
) -> Option<Vec<Given>> {
    let is_known = |key: &String| declared.iter().any(|c| c.name == *key);
    let given = |declared: &Coefficient| match (members.get(declared.name), declared.omitted) {
        (Some(value), _) => read_given(declared.extent, value),
        (None, Omitted::Means(default)) => Some(Given::Number(default)),
        (None, Omitted::Without) => Some(Given::Absent),
        (None, Omitted::Refused) => None,
    };
    let unknown = members.keys().filter(|key| !is_known(key)).count();
    let all = || declared.iter().map(given).collect();
    if unknown == others { all() } else { None }
}

fn read_given(extent: Extent, value: &Value) -> Option<Given> {
    let list = |value: &Value| -> Option<Vec<f64>> {
        let items = value.as_array().filter(|items| !items.is_empty())?;
        items.iter().map(Value::as_f64).collect()
    };
    match (extent, value) {
        (Extent::Grid, Value::Array(rows)) if rows.first().is_some_and(Value::is_array) => {
            let rows: Vec<Vec<f64>> = rows.iter().map(list).collect::<Option<_>>()?;
            let lengths = rows.iter().map(Vec::len).collect();
            Some(Given::Rows(rows.concat(), lengths))
        }
        (Extent::Choice(words), _) => {
            let word = value.as_str()?;
            let choice = words.iter().position(|known| *known == word);
            choice.map(Given::Choice)
        }
        (Extent::Points | Extent::Grid, _) => list(value).map(Given::Points),
        (Extent::Formula, _) => Some(Given::Formula(value.as_str()?.to_owned())),
        (Extent::Nodes, Value::Object(members)) if members.len() == 1 => {
            match members.get(EXPRESSION) {
                Some(text) => Some(Given::Expression(text.as_str()?.to_owned())),
                None => list(members.get(NODES)?).map(Given::Nodes),
            }
        }
        (Extent::Nodes, _) => value.as_f64().map(Given::Number),
    }
}

impl Serialize for Friction {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let own = self.law.kind().coefficients();
        let (given, of_role) = self.coefficients.split_at(own.len());
        let tag = |tag: &'static str| Listed {
            tag: (tag, self.law.name()),
            declared: own,
            given,
        };
        let role = self.law.role();
        let Some([name, key]) = role.words() else {
            return tag("law").serialize(to);
        };
        let mut map = to.serialize_map(None)?;
        map.serialize_entry("law", name)?;
        match given {
            [number] if self.law.is_number() => {
                map.serialize_entry(key, &Written(&own[0], number))?
            }
            _ => map.serialize_entry(key, &tag("kind"))?,
        }
        for (declared, given) in present(role.coefficients(), of_role) {
            map.serialize_entry(declared.name, &Written(declared, given))?;
        }
        if let Role::Coulomb { tension: true } = role {
            map.serialize_entry(TENSION, &true)?;
        }
        if !self.memory.is_empty() {
            map.serialize_entry(MEMORY, &written_memory(&self.memory))?;
        }
        map.end()
    }
}

/// The coefficients that are not left out.
fn present<'a>(
    declared: &'a [Coefficient],
    given: &'a [Given],
) -> impl Iterator<Item = (&'a Coefficient, &'a Given)> {
    let all = declared.iter().zip(given);
    all.filter(|(_, given)| **given != Given::Absent)
}

/// Coefficients beside the name of their law.
struct Listed<'a> {
    tag: (&'static str, &'static str),
    declared: &'a [Coefficient],
    given: &'a [Given],
}

impl Serialize for Listed<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(None)?;
        map.serialize_entry(self.tag.0, self.tag.1)?;
        for (declared, given) in present(self.declared, self.given) {
            map.serialize_entry(declared.name, &Written(declared, given))?;
        }
        map.end()
    }
}

/// A coefficient as a scene writes it.
struct Written<'a>(&'a Coefficient, &'a Given);

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.1 {
            Given::Number(value) => value.serialize(to),
            Given::Points(values) => values.serialize(to),
            Given::Nodes(values) => json!({ NODES: values }).serialize(to),
            Given::Expression(text) => json!({ EXPRESSION: text }).serialize(to),
            Given::Formula(text) => text.serialize(to),
            Given::Rows(values, lengths) => {
                let mut rest = values.as_slice();
                let rows = lengths.iter().map(|length| {
                    let (row, after) = rest.split_at(*length);
                    rest = after;
                    row
                });
                to.collect_seq(rows)
            }
            Given::Choice(choice) => match self.0.extent {
                Extent::Choice(words) => words.get(*choice).serialize(to),
                _ => to.serialize_none(),
            },
            Given::Absent => to.serialize_none(),
        }
    }
}
