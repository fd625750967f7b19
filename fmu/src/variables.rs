//! The variables of the FMU: the ports of the model and the fixed parameters, declared once for both versions of FMI.
//!
//! All values of an instance stand in one flat list: time, the ports one after the other, the fixed parameters. The value
//! reference of a scalar (and of every element of an array in FMI 2) is its place in this list, so that a getter over
//! consecutive references is a copy. An array variable of FMI 3 has the reference [`ARRAY_BASE`] plus its number.

use crate::parameters::{Kind, Parameters, choices};
use std::ops::Range;
use stickslip::Model;
use stickslip::ports::{self, Causality, Port, Quantity};

/// First value reference of array variables.
pub const ARRAY_BASE: u32 = 1 << 24;

/// Fixed parameters that matter from the first step on.
const LATER: [&str; 4] = ["time.step", "time.tolerance", "time.scheme", "time.inputs"];

/// What a variable is to an importer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The independent variable.
    Time,
    Input,
    Output,
    /// A parameter that may change between steps.
    Tunable,
    /// A parameter that may change before the initialization ends.
    Fixed,
}

/// What the derivative of an output by time is, where the model knows it exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slope {
    Unknown,
    /// The values of this variable, element by element.
    Variable(usize),
    /// The Euclidean norms over the components of the nodes of this variable.
    NormOf(usize),
}

/// Whether a variable depends on the loads of the same instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follows {
    /// It does not: it is an integral over time, or no output.
    Nothing,
    /// It does, but for the start, where it is always the same.
    LoadsAfterStart,
    /// It does.
    Loads,
}

impl Follows {
    /// A body without inertia has velocities and contact forces that follow its loads at once. What is integrated over time
    /// (displacements, slips, energies) does not.
    fn of(quantity: Quantity) -> Follows {
        match quantity {
            Quantity::TangentialStress
            | Quantity::SlipRate
            | Quantity::Stick
            | Quantity::ContactForce
            | Quantity::MaxSlipRate
            | Quantity::StickFraction
            | Quantity::Pressure
            | Quantity::Gap
            | Quantity::Status
            | Quantity::NormalForce
            | Quantity::OpenFraction
            | Quantity::DriveVelocity(_)
            | Quantity::DriveForce(_)
            | Quantity::FoundationForce(_)
            | Quantity::LoadVelocity(_)
            | Quantity::ProbeVelocity(_)
            | Quantity::Iterations
            | Quantity::Residual
            | Quantity::Solutions
            | Quantity::SolutionGap
            | Quantity::Uniqueness
            | Quantity::UniquenessMargin
            | Quantity::LostDigits => Follows::Loads,
            Quantity::ErrorEstimate
            | Quantity::MeanTangentialStress
            | Quantity::MeanSlipRate
            | Quantity::MeanPressure => Follows::LoadsAfterStart,
            Quantity::Input(_)
            | Quantity::Coefficient(_)
            | Quantity::Material(_)
            | Quantity::Slip
            | Quantity::AccumulatedSlip
            | Quantity::SlipMemory
            | Quantity::FrictionState
            | Quantity::LoadDisplacement(_)
            | Quantity::DriveDisplacement(_)
            | Quantity::ProbeDisplacement(_)
            | Quantity::ExternalWork
            | Quantity::ElasticEnergy
            | Quantity::ViscousDissipation
            | Quantity::FrictionDissipation
            | Quantity::BalanceError => Follows::Nothing,
        }
    }
}

/// One variable.
#[derive(Debug, Clone)]
pub struct Variable {
    pub name: String,
    pub description: String,
    /// SI unit; `1` for a number.
    pub unit: &'static str,
    pub role: Role,
    /// Empty for a scalar.
    pub shape: Vec<usize>,
    /// Place of the first value in the flat list.
    pub first: usize,
    /// Number of values.
    pub len: usize,
    /// Enumeration type, for a choice.
    pub choice: Option<usize>,
    /// Reference of the port, for the variables that are ports.
    pub port: Option<u32>,
    pub slope: Slope,
    pub follows: Follows,
}

impl Variable {
    /// Places of the values in the flat list.
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.len
    }

    /// Names of the elements, `name[i]` or `name[i,j]` with indices from 1.
    pub fn element_names(&self) -> Vec<String> {
        match self.shape[..] {
            [] => vec![self.name.clone()],
            [n] => (1..=n).map(|i| format!("{}[{i}]", self.name)).collect(),
            _ => {
                let columns = self.shape[1];
                let name =
                    |i: usize| format!("{}[{},{}]", self.name, i / columns + 1, i % columns + 1);
                (0..self.len).map(name).collect()
            }
        }
    }

    /// Value reference of the whole variable in FMI 3.
    pub fn reference(&self, number: usize) -> u32 {
        if self.shape.is_empty() {
            self.first as u32
        } else {
            ARRAY_BASE + number as u32
        }
    }
}

/// All variables of a model.
#[derive(Debug)]
pub struct Variables {
    list: Vec<Variable>,
    /// Number of the variable of every place of the flat list.
    owner: Vec<u32>,
    /// First place of the choices: before it the list holds numbers, from it on enumerations.
    choices: usize,
    /// The fixed parameters, the last variables of the list.
    parameters: Parameters,
}

impl Variables {
    pub fn new(model: &Model) -> Variables {
        let mut all = Variables {
            list: Vec::new(),
            owner: Vec::new(),
            choices: 0,
            parameters: Parameters::of(model.scene()),
        };
        let time = "Time of the simulation.".to_owned();
        all.add("time".into(), time, "s", Role::Time, Vec::new());
        // numbers of a free material are fixed parameters, as those of any other
        let is_own = |port: &&Port| !matches!(port.quantity, Quantity::Material(_));
        for port in model.ports().all().iter().filter(is_own) {
            let role = match port.causality {
                Causality::Input => Role::Input,
                Causality::Output => Role::Output,
                Causality::Parameter => Role::Tunable,
            };
            all.add(
                port.name.clone(),
                port.description.clone(),
                port.unit,
                role,
                port.shape.clone(),
            );
            if let Some(last) = all.list.last_mut() {
                last.port = Some(port.reference);
                last.follows = Follows::of(port.quantity);
            }
        }
        for parameter in all.parameters.all().to_vec() {
            let unit = match parameter.kind {
                Kind::Real(unit) | Kind::Optional(unit) => unit,
                Kind::Choice(_) => "1",
            };
            if let (Kind::Choice(_), 0) = (parameter.kind, all.choices) {
                all.choices = all.len();
            }
            let text = parameter.description.to_owned();
            all.add(parameter.path, text, unit, Role::Fixed, Vec::new());
            if let (Kind::Choice(list), Some(last)) = (parameter.kind, all.list.last_mut()) {
                last.choice = Some(list);
            }
        }
        all.find_slopes(model);
        all
    }

    fn add(
        &mut self,
        name: String,
        description: String,
        unit: &'static str,
        role: Role,
        shape: Vec<usize>,
    ) {
        let (first, len) = (self.owner.len(), shape.iter().product());
        self.owner
            .extend(std::iter::repeat_n(self.list.len() as u32, len));
        self.list.push(Variable {
            name,
            description,
            unit,
            role,
            shape,
            first,
            len,
            choice: None,
            port: None,
            slope: Slope::Unknown,
            follows: Follows::Nothing,
        });
    }

    /// Finds the variables that are derivatives of others by time.
    fn find_slopes(&mut self, model: &Model) {
        let ports = model.ports().all();
        for port in ports {
            let variable_of = |quantity: Quantity| {
                let is_it = |p: &&Port| p.quantity == quantity && p.contact == port.contact;
                ports.iter().find(is_it).map(|p| p.reference as usize + 1)
            };
            let slope = match port.quantity.slope() {
                ports::Slope::Is(other) => variable_of(other).map(Slope::Variable),
                ports::Slope::NormOf(other) => variable_of(other).map(Slope::NormOf),
                ports::Slope::Unknown => None,
            };
            self.list[port.reference as usize + 1].slope = slope.unwrap_or(Slope::Unknown);
        }
    }

    pub fn all(&self) -> &[Variable] {
        &self.list
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.owner.len()
    }

    /// First place of the choices.
    pub fn first_choice(&self) -> usize {
        self.choices
    }

    /// First place of the fixed parameters.
    pub fn first_parameter(&self) -> usize {
        self.len() - self.parameters.all().len()
    }

    /// The fixed parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The variable of a place in the flat list.
    pub fn at(&self, place: usize) -> Option<&Variable> {
        self.owner
            .get(place)
            .map(|&number| &self.list[number as usize])
    }

    /// Places that a value reference stands for.
    pub fn resolve(&self, reference: u32) -> Option<Range<usize>> {
        if reference >= ARRAY_BASE {
            let variable = self.list.get((reference - ARRAY_BASE) as usize)?;
            (!variable.shape.is_empty()).then(|| variable.range())
        } else {
            let place = reference as usize;
            (place < self.len()).then(|| place..place + 1)
        }
    }

    /// Whether the values at the start depend on a variable: of the fixed parameters those of the time scheme do not matter yet.
    pub fn decides_start(variable: &Variable) -> bool {
        match variable.role {
            Role::Input | Role::Tunable => true,
            Role::Fixed => !LATER.contains(&variable.name.as_str()),
            Role::Time | Role::Output => false,
        }
    }

    /// What a message calls a value reference.
    pub fn name(&self, reference: u32) -> String {
        match self
            .resolve(reference)
            .and_then(|places| self.at(places.start))
        {
            Some(variable) => format!("{} (value reference {reference})", variable.name),
            None => format!("value reference {reference}"),
        }
    }

    /// Name of an enumeration type.
    pub fn choice_name(choice: usize) -> &'static str {
        choices()[choice].name
    }

    /// Words of an enumeration type.
    pub fn words(choice: usize) -> &'static [&'static str] {
        choices()[choice].words
    }
}
