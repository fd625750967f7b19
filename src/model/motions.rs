//! Motions of driven parts and of the foundation, as a step and the ports see them: which inputs they are, what they do at the
//! contact, to loads and to probes, and what they take.

use crate::bytes::{Reader, Writer};
use crate::error::Result;
use crate::fem::Body;
use crate::scene::{DrivenInput, Foundation, MAX_CONTACTS, Scene};

/// One motion of a driven part.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    /// Its place among the columns of forces of the body; `None` where it moves the body as a whole.
    pub column: Option<usize>,
    /// Whether its input is a displacement.
    pub is_displacement: bool,
    /// Contact velocities by a unit velocity.
    on_contact: Vec<f64>,
    on_loads: Vec<f64>,
    on_probes: Vec<f64>,
}

/// One motion of the foundation: its velocities at the contact components by a unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FoundationMotion {
    /// The contact that it moves under.
    pub contact: usize,
    pub is_approach: bool,
    on_contact: Vec<f64>,
}

/// What the foundation of every contact does towards the body: a displacement, m, or a velocity, m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approach([f64; MAX_CONTACTS]);

impl Approach {
    pub const NONE: Approach = Approach([0.0; MAX_CONTACTS]);

    /// That of a contact.
    pub fn of(&self, contact: usize) -> f64 {
        self.0[contact]
    }

    /// Mean velocity between two displacements.
    pub fn rate(from: Approach, to: Approach, time: f64) -> Approach {
        Approach(std::array::from_fn(|i| (to.0[i] - from.0[i]) / time))
    }

    /// Those of the first contacts.
    pub fn copy_to(&self, out: &mut [f64]) {
        let count = out.len();
        out.copy_from_slice(&self.0[..count]);
    }
}

/// All motions of a scene. Inputs are loads, then drives, then motions of the foundation.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Motions {
    loads: usize,
    pub drives: Vec<Drive>,
    /// Of the drives by the drives, row by row; see `fem::Drives`.
    viscosity: Vec<f64>,
    elasticity: Vec<f64>,
    pub foundation: Vec<FoundationMotion>,
    /// Whether the last column of forces is that of the initial displacement, with a constant intensity.
    has_initial: bool,
}

impl Motions {
    pub fn of(scene: &Scene, body: &Body) -> Motions {
        let drives = &body.drives;
        let count = drives.len();
        let mut columns = Vec::with_capacity(3 * count);
        for i in 0..count {
            columns.extend([
                &drives.on_contact[i],
                &drives.on_loads[i],
                &drives.on_probes[i],
            ]);
        }
        let is_zero: Vec<bool> = drives.columns.iter().map(Vec::is_empty).collect();
        let owned = columns.into_iter().cloned().collect();
        let foundation = body.foundation.clone();
        let mut motions = Motions::build(scene, &is_zero, owned, foundation);
        motions.has_initial = body.initial.is_some();
        motions.viscosity.clone_from(&drives.viscosity);
        motions.elasticity.clone_from(&drives.elasticity);
        motions
    }

    /// `seen` holds contact, loads and probes of every drive.
    fn build(
        scene: &Scene,
        is_zero: &[bool],
        seen: Vec<Vec<f64>>,
        foundation: Vec<Vec<f64>>,
    ) -> Motions {
        let loads = scene.loads.len();
        let inputs = scene.driven.iter();
        let kinds = inputs.flat_map(|d| d.directions.iter().map(|_| d.input));
        let mut next = loads;
        let mut seen = seen.into_iter();
        let mut drives = Vec::new();
        for (kind, is_zero) in kinds.zip(is_zero) {
            let column = (!is_zero).then_some(next);
            next += usize::from(!is_zero);
            let mut take = || seen.next().unwrap_or_default();
            drives.push(Drive {
                column,
                is_displacement: kind == DrivenInput::Displacement,
                on_contact: take(),
                on_loads: take(),
                on_probes: take(),
            });
        }
        let of =
            |((contact, motion), on_contact): ((usize, &Foundation), Vec<f64>)| FoundationMotion {
                contact,
                is_approach: matches!(motion, Foundation::Approach { .. }),
                on_contact,
            };
        let contacts = scene.each_contact().enumerate();
        let listed = contacts.flat_map(|(i, c)| c.foundation.iter().map(move |motion| (i, motion)));
        Motions {
            loads,
            drives,
            viscosity: Vec::new(),
            elasticity: Vec::new(),
            has_initial: false,
            foundation: listed.zip(foundation).map(of).collect(),
        }
    }

    /// Whether nothing moves but the body.
    pub fn is_empty(&self) -> bool {
        self.drives.is_empty() && self.foundation.is_empty()
    }

    /// Number of loads.
    pub fn loads(&self) -> usize {
        self.loads
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.loads + self.drives.len() + self.foundation.len()
    }

    /// Columns of forces of the body: the loads, the drives that do not move it as a whole, the initial displacement.
    pub fn force_count(&self) -> usize {
        let columns = self.drives.iter().filter(|drive| drive.column.is_some());
        self.loads + columns.count() + usize::from(self.has_initial)
    }

    /// The column of the initial displacement, whose intensity is 1.
    pub fn initial_column(&self) -> Option<usize> {
        self.has_initial.then(|| self.force_count() - 1)
    }

    /// The input of a drive.
    pub fn drive_input(&self, drive: usize) -> usize {
        self.loads + drive
    }

    /// The velocities of the drives, which are among the inputs.
    pub fn drive_velocities(&self, inputs: &[f64], out: &mut [f64]) {
        let first = self.drive_input(0);
        out.copy_from_slice(&inputs[first..first + out.len()]);
    }

    /// Adds `factor` times the velocities of the drives, which are among the inputs, to their displacements.
    pub fn integrate(&self, displacement: &mut [f64], factor: f64, inputs: &[f64]) {
        for (drive, displacement) in displacement.iter_mut().enumerate() {
            *displacement += factor * inputs[self.drive_input(drive)];
        }
    }

    /// The input of a motion of the foundation.
    pub fn foundation_input(&self, motion: usize) -> usize {
        self.loads + self.drives.len() + motion
    }

    /// Intensities of the columns of forces from the inputs; that of the initial displacement is no input.
    pub fn forces(&self, inputs: &[f64], out: &mut [f64]) {
        out[..self.loads].copy_from_slice(&inputs[..self.loads]);
        for (i, drive) in self.drives.iter().enumerate() {
            if let Some(column) = drive.column {
                out[column] = inputs[self.drive_input(i)];
            }
        }
    }

    /// What is added to the velocities that the contact is solved for, to get those of the body without its drives.
    pub fn shift(&self, inputs: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let mut add = |column: &[f64], factor: f64| {
            for (out, value) in out.iter_mut().zip(column) {
                *out += factor * value;
            }
        };
        for (i, drive) in self.drives.iter().enumerate() {
            add(&drive.on_contact, -inputs[self.drive_input(i)]);
        }
        for (i, motion) in self.foundation.iter().enumerate() {
            if !motion.is_approach {
                add(&motion.on_contact, inputs[self.foundation_input(i)]);
            }
        }
    }

    /// Displacements of the foundations towards the body, m; with rates of the inputs their velocities.
    pub fn approach(&self, inputs: &[f64]) -> Approach {
        self.approach_by(|motion| inputs[self.foundation_input(motion)])
    }

    /// The same from what every motion of the foundation does.
    pub fn approach_by(&self, moves: impl Fn(usize) -> f64) -> Approach {
        // what a sum of nothing is
        let mut sum = Approach([-0.0; MAX_CONTACTS]);
        for (i, motion) in self.foundation.iter().enumerate() {
            sum.0[motion.contact] += if motion.is_approach { moves(i) } else { 0.0 };
        }
        sum
    }

    /// Adds the drives' share to what loads and probes see of a velocity (or, with displacements of drives, of a displacement).
    pub fn add_outputs(&self, drive: impl Fn(usize) -> f64, outputs: &mut [f64]) {
        let probes = self.force_count();
        for (i, of) in self.drives.iter().enumerate() {
            let by = drive(i);
            for (out, value) in outputs[..self.loads].iter_mut().zip(&of.on_loads) {
                *out += by * value;
            }
            for (out, value) in outputs[probes..].iter_mut().zip(&of.on_probes) {
                *out += by * value;
            }
        }
    }

    /// What the drives take: from the inputs, their displacements, the conjugates of the columns of forces without the drives'
    /// own share, and the contact forces (the force on the body is minus these).
    pub fn drive_forces(
        &self,
        inputs: &[f64],
        displacement: &[f64],
        conjugates: &[f64],
        contact: &[f64],
        out: &mut [f64],
    ) {
        let count = self.drives.len();
        for (i, (out, drive)) in out.iter_mut().zip(&self.drives).enumerate() {
            let mut force = -drive.column.map_or(0.0, |column| conjugates[column]);
            for j in 0..count {
                force += self.viscosity[i * count + j] * inputs[self.drive_input(j)]
                    + self.elasticity[i * count + j] * displacement[j];
            }
            let of_loads = drive.on_loads.iter().zip(&inputs[..self.loads]);
            force -= of_loads.map(|(by, load)| by * load).sum::<f64>();
            let of_contact = drive.on_contact.iter().zip(contact);
            *out = force + of_contact.map(|(by, force)| by * force).sum::<f64>();
        }
    }

    /// What the motions of the foundation take: the power of the contact forces on the body (minus `contact`) at its velocities.
    pub fn foundation_forces(&self, contact: &[f64], out: &mut [f64]) {
        for (out, motion) in out.iter_mut().zip(&self.foundation) {
            let of = motion.on_contact.iter().zip(contact);
            *out = 0.0 - of.map(|(by, force)| by * force).sum::<f64>();
        }
    }

    /// What the drives add to `x.A y` of two velocities of the body, each with its inputs and its conjugates of the columns:
    /// `v_x.A v_y - v_x.G^T y - v_y.G^T x`.
    pub fn viscous_product(&self, x: [&[f64]; 2], y: [&[f64]; 2]) -> f64 {
        let [[x, of_x], [y, of_y]] = [x, y];
        let velocity = |inputs: &[f64], i: usize| inputs[self.drive_input(i)];
        let own = self.product(&self.viscosity, |i| velocity(x, i), |i| velocity(y, i));
        let coupled = self.drives.iter().enumerate().map(|(i, drive)| {
            let of = |conjugates: &[f64]| drive.column.map_or(0.0, |column| conjugates[column]);
            velocity(x, i) * of(of_y) + velocity(y, i) * of(of_x)
        });
        own - coupled.sum::<f64>()
    }

    /// `d_x.B d_y` of two displacements of the drives.
    pub fn elastic_product(&self, x: &[f64], y: &[f64]) -> f64 {
        self.product(&self.elasticity, |i| x[i], |i| y[i])
    }

    fn product(&self, matrix: &[f64], x: impl Fn(usize) -> f64, y: impl Fn(usize) -> f64) -> f64 {
        let count = self.drives.len();
        let rows = (0..count).map(|i| {
            let row = (0..count).map(|j| matrix[i * count + j] * y(j));
            x(i) * row.sum::<f64>()
        });
        rows.sum()
    }

    pub fn write(&self, out: &mut Writer) {
        let is_zero: Vec<usize> = self
            .drives
            .iter()
            .map(|d| usize::from(d.column.is_none()))
            .collect();
        out.indices(&is_zero);
        for drive in &self.drives {
            for values in [&drive.on_contact, &drive.on_loads, &drive.on_probes] {
                out.floats(values);
            }
        }
        out.floats(&self.viscosity);
        out.floats(&self.elasticity);
        self.foundation
            .iter()
            .for_each(|motion| out.floats(&motion.on_contact));
    }

    /// Reads what [`Motions::write`] wrote, for a contact of so many components, with an initial displacement or without.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub fn read(
        from: &mut Reader,
        scene: &Scene,
        (contact, dimension): (usize, usize),
        has_initial: bool,
    ) -> Result<Motions> {
        let refusal =
            || Reader::refusal("compiled model: motions of driven parts or of the foundation");
        let drives: usize = scene.driven.iter().map(|d| d.directions.len()).sum();
        let is_zero: Vec<bool> = from.indices(2)?.into_iter().map(|zero| zero == 1).collect();
        if is_zero.len() != drives {
            return Err(refusal());
        }
        let lengths = [contact, scene.loads.len(), scene.probes.len() * dimension];
        let mut seen = Vec::new();
        for i in 0..3 * drives {
            let values = from.finite()?;
            if values.len() != lengths[i % 3] {
                return Err(refusal());
            }
            seen.push(values);
        }
        let (viscosity, elasticity) = (from.finite()?, from.finite()?);
        if viscosity.len() != drives * drives || elasticity.len() != drives * drives {
            return Err(refusal());
        }
        let mut foundation = Vec::new();
        for _ in scene.each_contact().flat_map(|c| &c.foundation) {
            let values = from.finite()?;
            if values.len() != contact {
                return Err(refusal());
            }
            foundation.push(values);
        }
        let mut motions = Motions::build(scene, &is_zero, seen, foundation);
        (motions.viscosity, motions.elasticity) = (viscosity, elasticity);
        motions.has_initial = has_initial;
        Ok(motions)
    }
}
