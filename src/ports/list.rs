//! The list of the ports: inputs, contact, work-conjugates and probes, energies and solver, coefficients.

use super::{Causality, Port, Ports, Quantity, Shapes};
use crate::scene::CONTACT;

impl Ports {
    pub(crate) fn new(shapes: &Shapes) -> Ports {
        let mut ports = Ports { list: Vec::new() };
        ports.add_inputs(shapes);
        for scope in Scope::all(shapes) {
            ports.add_contact(shapes, &scope);
            ports.add_normal(shapes, &scope);
        }
        ports.add_conjugates_and_probes(shapes);
        ports.add_motions(shapes);
        ports.add_accounts(shapes);
        ports.add_coefficients(shapes);
        ports.add_material(shapes);
        ports
    }

    fn add(
        &mut self,
        name: impl Into<String>,
        unit: &'static str,
        causality: Causality,
        shape: &[usize],
        quantity: Quantity,
        description: impl Into<String>,
    ) {
        self.list.push(Port {
            reference: self.list.len() as u32,
            name: name.into(),
            unit,
            causality,
            shape: shape.to_vec(),
            quantity,
            contact: None,
            description: description.into(),
        });
    }

    /// Adds an output over a contact.
    fn add_of(
        &mut self,
        scope: &Scope,
        name: &str,
        unit: &'static str,
        shape: &[usize],
        quantity: Quantity,
        description: &'static str,
    ) {
        let name = format!("{}.{name}", scope.name);
        let causality = Causality::Output;
        self.add(name, unit, causality, shape, quantity, description);
        if let Some(port) = self.list.last_mut() {
            port.contact = scope.contact;
        }
    }

    fn add_inputs(&mut self, shapes: &Shapes) {
        let loads = shapes.loads.iter().map(|(name, unit)| {
            let text = "Intensity of the load at the end of the next step.";
            (name, *unit, text)
        });
        let driven = shapes.driven.iter().map(|driven| {
            let (unit, text) = match (driven.is_displacement, driven.is_rotation) {
                (false, false) => ("m/s", "Velocity of the driven part at the end of the next step."),
                (false, true) => (
                    "rad/s",
                    "Angular velocity of the driven part at the end of the next step.",
                ),
                (true, false) => (
                    "m",
                    "Displacement of the driven part at the end of the next step, reached with a constant velocity.",
                ),
                (true, true) => (
                    "rad",
                    "Angle of the driven part at the end of the next step, reached with a constant velocity.",
                ),
            };
            (&driven.name, unit, text)
        });
        let foundation = shapes.foundation.iter().map(|motion| {
            let (unit, text) = match (motion.is_approach, motion.is_rotation) {
                (true, _) => (
                    "m",
                    "Displacement of the foundation towards the body at the end of the next step.",
                ),
                (_, true) => (
                    "rad/s",
                    "Angular velocity of the foundation at the end of the next step.",
                ),
                _ => (
                    "m/s",
                    "Velocity of the foundation at the end of the next step.",
                ),
            };
            (&motion.name, unit, text)
        });
        for (i, (name, unit, text)) in loads.chain(driven).chain(foundation).enumerate() {
            self.add(name, unit, Causality::Input, &[], Quantity::Input(i), text);
        }
    }

    /// Pressure and gap, where the contact has them.
    fn add_normal(&mut self, shapes: &Shapes, scope: &Scope) {
        if !shapes.has_normal {
            return;
        }
        let nodal: &[usize] = &[scope.nodes];
        let text =
            "Pressure of the foundation on the body; negative where bilateral contact pulls.";
        self.add_of(scope, "pressure", "Pa", nodal, Quantity::Pressure, text);
        let text = "Total force of the foundation on the body along the inward normals.";
        self.add_of(scope, "normal_force", "N", &[], Quantity::NormalForce, text);
        if scope.can_open {
            let text = "Distance to the foundation along its normal; negative where it gives way.";
            self.add_of(scope, "gap", "m", nodal, Quantity::Gap, text);
            let text = "0 where the node is open, 1 where it sticks, 2 where it slips.";
            self.add_of(scope, "status", "1", nodal, Quantity::Status, text);
            let text = "Share of the contact area that is open.";
            let quantity = Quantity::OpenFraction;
            self.add_of(scope, "open_fraction", "1", &[], quantity, text);
        }
        if scope.has_memory {
            let text = "State of the friction law.";
            let quantity = Quantity::FrictionState;
            self.add_of(scope, "friction_state", "s", nodal, quantity, text);
        }
        if shapes.has_means {
            let text = "Mean pressure over the last internal step.";
            let quantity = Quantity::MeanPressure;
            self.add_of(scope, "mean_pressure", "Pa", nodal, quantity, text);
        }
    }

    /// What the motions of driven parts and of the foundation take.
    fn add_motions(&mut self, shapes: &Shapes) {
        use Causality::Output;
        for (i, driven) in shapes.driven.iter().enumerate() {
            let name = &driven.name;
            let (length, rate, force, unit) = match driven.is_rotation {
                true => ("rad", "rad/s", "torque", "N.m"),
                false => ("m", "m/s", "force", "N"),
            };
            let text = "Displacement of the driven part since the start.";
            let quantity = Quantity::DriveDisplacement(i);
            self.add(
                format!("{name}.displacement"),
                length,
                Output,
                &[],
                quantity,
                text,
            );
            let text = "Velocity of the driven part.";
            let quantity = Quantity::DriveVelocity(i);
            self.add(
                format!("{name}.velocity"),
                rate,
                Output,
                &[],
                quantity,
                text,
            );
            let text = "What is needed to drive the part; times the velocity it is the power.";
            let quantity = Quantity::DriveForce(i);
            self.add(format!("{name}.{force}"), unit, Output, &[], quantity, text);
        }
        for (i, motion) in shapes.foundation.iter().enumerate() {
            let name = &motion.name;
            let (force, unit) = match motion.is_rotation {
                true => ("torque", "N.m"),
                false => ("force", "N"),
            };
            let text = "What is needed to move the foundation against the body; times the velocity it is the power.";
            let quantity = Quantity::FoundationForce(i);
            self.add(format!("{name}.{force}"), unit, Output, &[], quantity, text);
        }
    }

    fn add_contact(&mut self, shapes: &Shapes, scope: &Scope) {
        let field: &[usize] = if shapes.components == 1 {
            &[scope.nodes]
        } else {
            &[scope.nodes, shapes.components]
        };
        let nodal = &[scope.nodes];
        let total: &[usize] = if shapes.components == 1 {
            &[]
        } else {
            &[shapes.components]
        };
        use Quantity::*;
        for (name, unit, shape, quantity, text) in [
            (
                "tangential_stress",
                "Pa",
                field,
                TangentialStress,
                "Tangential stress on the body; opposes the slip rate.",
            ),
            (
                "slip_rate",
                "m/s",
                field,
                SlipRate,
                "Tangential velocity of the body relative to the foundation.",
            ),
            (
                "slip",
                "m",
                field,
                Slip,
                "Tangential displacement of the body relative to the foundation.",
            ),
            (
                "accumulated_slip",
                "m",
                nodal,
                AccumulatedSlip,
                "Integral of the magnitude of the slip rate over time.",
            ),
            (
                "stick",
                "1",
                nodal,
                Stick,
                "1 where the node sticks, 0 where it slips.",
            ),
            (
                "force",
                "N",
                total,
                ContactForce,
                "Total tangential force of the foundation on the body.",
            ),
            (
                "max_slip_rate",
                "m/s",
                &[],
                MaxSlipRate,
                "Largest magnitude of the slip rate.",
            ),
            (
                "stick_fraction",
                "1",
                &[],
                StickFraction,
                "Share of the contact area that sticks.",
            ),
        ] {
            self.add_of(scope, name, unit, shape, quantity, text);
        }
        if scope.has_kernel {
            let text = "Slip as the kernel of the friction law remembers it.";
            self.add_of(scope, "slip_memory", "m", nodal, SlipMemory, text);
        }
        if shapes.has_means {
            for (name, unit, quantity, text) in [
                (
                    "mean_slip_rate",
                    "m/s",
                    MeanSlipRate,
                    "Mean slip rate over the last internal step.",
                ),
                (
                    "mean_tangential_stress",
                    "Pa",
                    MeanTangentialStress,
                    "Mean tangential stress on the body over the last internal step.",
                ),
            ] {
                self.add_of(scope, name, unit, field, quantity, text);
            }
        }
    }

    fn add_conjugates_and_probes(&mut self, shapes: &Shapes) {
        use Causality::Output;
        for (i, (name, _)) in shapes.loads.iter().enumerate() {
            let text = "of the loaded part along the load direction; times the intensity and the measure of the part it is the";
            self.add(
                format!("{name}.displacement"),
                "m",
                Output,
                &[],
                Quantity::LoadDisplacement(i),
                format!("Mean displacement {text} work."),
            );
            self.add(
                format!("{name}.velocity"),
                "m/s",
                Output,
                &[],
                Quantity::LoadVelocity(i),
                format!("Mean velocity {text} power."),
            );
        }
        let vector = &[shapes.dimension];
        for (i, name) in shapes.probes.iter().enumerate() {
            self.add(
                format!("{name}.displacement"),
                "m",
                Output,
                vector,
                Quantity::ProbeDisplacement(i),
                "Displacement of the point along x, y (and z).",
            );
            self.add(
                format!("{name}.velocity"),
                "m/s",
                Output,
                vector,
                Quantity::ProbeVelocity(i),
                "Velocity of the point along x, y (and z).",
            );
        }
    }

    fn add_accounts(&mut self, shapes: &Shapes) {
        use Quantity::*;
        for (name, unit, quantity, text) in [
            (
                "energy.external_work",
                "J",
                ExternalWork,
                "Work of the loads since the start.",
            ),
            (
                "energy.elastic",
                "J",
                ElasticEnergy,
                "Elastic energy stored.",
            ),
            (
                "energy.viscous_dissipation",
                "J",
                ViscousDissipation,
                "Energy dissipated by the viscosity since the start.",
            ),
            (
                "energy.friction_dissipation",
                "J",
                FrictionDissipation,
                "Energy dissipated by friction since the start.",
            ),
            (
                "energy.balance_error",
                "J",
                BalanceError,
                "External work less the growth of the three others: rounding for the trapezoid with a consistent start, the numerical \
                 dissipation of the scheme otherwise.",
            ),
            (
                "solver.iterations",
                "1",
                Iterations,
                "Friction iterations of the last communication step, those of refused steps and of the error estimate included.",
            ),
            (
                "solver.residual",
                "1",
                Residual,
                "Largest force by which the friction law was violated at a node in the last communication step, over the bound there.",
            ),
            (
                "solver.solutions",
                "1",
                Solutions,
                "Most solutions of one internal step found by the multiplicity test; 0 when it is off.",
            ),
            (
                "solver.solution_gap",
                "m/s",
                SolutionGap,
                "Largest difference in slip rate between them.",
            ),
        ] {
            self.add(name, unit, Causality::Output, &[], quantity, text);
        }
        if shapes.asks_uniqueness {
            self.add(
                "solver.uniqueness",
                "1",
                Causality::Output,
                &[],
                Uniqueness,
                "Whether the last communication step has one solution: 1 proved, 0 not decided, -1 there are more.",
            );
            self.add(
                "solver.uniqueness_margin",
                "1",
                Causality::Output,
                &[],
                UniquenessMargin,
                "1 - max(P L_mu) / m - mu_max c at the pressures found, at the worst: above 0 one solution is proved; -1 \
                 where no constants are known.",
            );
        }
        if shapes.has_error_estimate {
            self.add(
                "solver.error_estimate",
                "1",
                Causality::Output,
                &[],
                ErrorEstimate,
                "Estimated error in time of the slip rate, accumulated since the start: discrete L2 norm over the contact, \
                 relative to the largest such norm of the slip rate so far. No bound.",
            );
        }
        if shapes.can_lose_digits {
            self.add(
                "solver.lost_digits",
                "1",
                Causality::Output,
                &[],
                LostDigits,
                "Estimated share of displacement and slip that the last communication step lost to rounding: steps far beyond \
                 the relaxation times after a jump of the loads. Beyond twice fidelity.tolerance answers may be off by more \
                 than the tolerances.",
            );
        }
    }

    fn add_coefficients(&mut self, shapes: &Shapes) {
        let places = shapes.friction.places().iter().enumerate();
        for (i, place) in places.filter(|(_, place)| place.len > 0) {
            let (part, own) = shapes.friction.coefficient(i);
            self.add(
                part.law.path(own),
                part.law.law().unit(own),
                Causality::Parameter,
                &place.shape(),
                Quantity::Coefficient(i),
                "Coefficient of the friction law; may change between steps.",
            );
        }
    }
}

impl Ports {
    fn add_material(&mut self, shapes: &Shapes) {
        for (i, number) in shapes.free_numbers.iter().enumerate() {
            self.add(
                number.path.as_str(),
                number.unit,
                Causality::Parameter,
                &[],
                Quantity::Material(i),
                format!("{} Set before the initialization.", number.text),
            );
        }
    }
}

/// What outputs over the contact are of: all contacts together, or one of them.
struct Scope<'a> {
    /// First part of the names of its ports.
    name: &'a str,
    contact: Option<usize>,
    nodes: usize,
    can_open: bool,
    has_memory: bool,
    /// Whether the one law of all its nodes has a kernel of slip.
    has_kernel: bool,
}

impl Scope<'_> {
    /// All contacts together, then every one that has a name of its own.
    fn all<'a>(shapes: &Shapes<'a>) -> Vec<Scope<'a>> {
        let contacts = shapes.contacts;
        let mut all = vec![Scope {
            name: CONTACT,
            contact: None,
            nodes: contacts.iter().map(|part| part.nodes.len()).sum(),
            can_open: contacts.iter().any(|part| part.can_open),
            has_memory: shapes.friction.has_memory(),
            has_kernel: matches!(shapes.friction.parts(), [one] if !one.law.kernel().is_empty()),
        }];
        for (i, (part, law)) in contacts.iter().zip(shapes.friction.parts()).enumerate() {
            if part.name != CONTACT {
                all.push(Scope {
                    name: &part.name,
                    contact: Some(i),
                    nodes: part.nodes.len(),
                    can_open: part.can_open,
                    has_memory: law.law.has_memory(),
                    has_kernel: !law.law.kernel().is_empty(),
                });
            }
        }
        all
    }
}
