//! What a model starts with where the body has an initial displacement: slip, gap and outputs of it, and its energy.

use crate::bytes::{Reader, Writer};
use crate::error::Result;
use crate::fem::Body;

/// The initial displacement as the contact and the ports see it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct InitialState {
    /// Tangential displacements of the contact nodes, m.
    pub slip: Vec<f64>,
    /// Their normal displacements into the body, m; empty without normal components.
    pub normal: Vec<f64>,
    /// Work-conjugate integrals of the columns of forces, 0 for those of motions and for its own, then probes.
    pub outputs: Vec<f64>,
    /// Elastic energy, J.
    pub energy: f64,
}

impl InitialState {
    /// That of a body, where it has one; laws that are not linear store `beyond` more than B, J.
    pub fn of(body: &Body, beyond: f64) -> Option<InitialState> {
        let initial = body.initial.as_ref()?;
        let contact = &body.contact;
        let on_contact = &initial.field[body.dofs.contact_start()..];
        let nodes = || on_contact.chunks(contact.stride());
        let seen =
            |row: &Vec<(usize, f64)>| row.iter().map(|(dof, v)| v * initial.field[*dof]).sum();
        let loads = body.loads.iter().map(|load| seen(&load.entries));
        let others = body.force_columns().count() - body.loads.len();
        let probes = body.probes.iter().flat_map(|p| &p.rows);
        Some(InitialState {
            slip: nodes()
                .flat_map(|n| &n[..contact.components])
                .copied()
                .collect(),
            normal: match contact.has_normal {
                true => nodes().map(|n| n[contact.components]).collect(),
                false => Vec::new(),
            },
            outputs: loads
                .chain(std::iter::repeat_n(0.0, others))
                .chain(probes.map(seen))
                .collect(),
            energy: initial.energy + beyond,
        })
    }

    pub fn write(of: Option<&InitialState>, out: &mut Writer) {
        out.word(u64::from(of.is_some()));
        if let Some(initial) = of {
            for values in [&initial.slip, &initial.normal, &initial.outputs] {
                out.floats(values);
            }
            out.float(initial.energy);
        }
    }

    /// Reads what [`InitialState::write`] wrote, for a contact of so many nodes with so many tangential components.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub fn read(
        from: &mut Reader,
        (nodes, components): (usize, usize),
        has_normal: bool,
    ) -> Result<Option<InitialState>> {
        if from.word()? == 0 {
            return Ok(None);
        }
        let (slip, normal, outputs) = (from.finite()?, from.finite()?, from.finite()?);
        let energy = from.float()?;
        let normals = if has_normal { nodes } else { 0 };
        let is_possible = slip.len() == nodes * components
            && normal.len() == normals
            && energy.is_finite()
            && energy >= 0.0;
        if !is_possible {
            return Err(Reader::refusal("compiled model: initial displacement"));
        }
        Ok(Some(InitialState {
            slip,
            normal,
            outputs,
            energy,
        }))
    }

    /// Whether it has one output for each of a model.
    pub fn fits(&self, outputs: usize) -> bool {
        self.outputs.len() == outputs
    }
}
