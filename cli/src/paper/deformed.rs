//! Figure 3: the deformed mesh at t = 1 with the forces of the foundation on the body.

use super::example::{Finished, nodal};
use crate::contact_table::write_columns;
use crate::failure::Failure;
use crate::field::{NodalField, contact_forces};
use crate::pictures::{Axis, BodyView, Panel, Shape, Sheet};
use std::path::Path;
use stickslip::mesh::Mesh;

pub struct Deformed {
    mesh: Mesh,
    displacement: NodalField,
    /// Contact nodes and the forces on the body there, N per metre of depth.
    nodes: Vec<u32>,
    forces: NodalField,
}

impl Deformed {
    /// The end of a run.
    pub fn of(finished: &Finished) -> Result<Deformed, Failure> {
        let compilation = &finished.compilation;
        let state = finished.simulator.state();
        let displacement = nodal(compilation, state.displacement())?;
        let velocity = nodal(compilation, state.velocity())?;
        let body = &compilation.body;
        Ok(Deformed {
            forces: contact_forces(body, &displacement, &velocity),
            mesh: body.mesh.clone(),
            displacement,
            nodes: body.contact.nodes.clone(),
        })
    }

    pub fn view(&self) -> BodyView {
        let shape = Shape::new(&self.mesh, &self.displacement, 1.0);
        let foot: Vec<_> = self
            .nodes
            .iter()
            .map(|&n| shape.nodes[n as usize])
            .collect();
        let forces = self.forces.iter().map(|f| (f[0], f[1]));
        BodyView {
            heading: "Deformed mesh at t = 1 s (true scale)".to_owned(),
            forces: foot.iter().copied().zip(forces).collect(),
            contact: vec![foot],
            shape,
            outline: vec![vec![
                (0.0, 0.0),
                (1.0, 0.0),
                (1.0, 0.5),
                (0.0, 0.5),
                (0.0, 0.0),
            ]],
            amount: self.displacement.iter().map(|u| u[0].hypot(u[1])).collect(),
            scale: Axis::new("displacement", "m"),
            arrows: Some("contact force on the body".to_owned()),
        }
    }

    /// Writes the figure and its data.
    pub fn draw(&self, out: &Path) -> Result<(), Failure> {
        let rows = self.nodes.iter().zip(&self.forces).map(|(&node, force)| {
            let (p, u) = (
                self.mesh.nodes[node as usize],
                self.displacement[node as usize],
            );
            vec![p[0], p[1], u[0], u[1], force[0], force[1]]
        });
        write_columns(
            &out.join("figure3.csv"),
            &["x", "y", "u_x", "u_y", "force_x", "force_y"],
            rows,
        )?;
        Sheet {
            title: "Figure 3: deformed body and contact forces, h = k = 1/32".to_owned(),
            width: 1100,
            height: 640,
            rows: vec![(1.0, vec![Panel::Body(self.view())])],
        }
        .save(out, "figure3")
    }
}
