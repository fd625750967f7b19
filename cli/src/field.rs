//! Nodal fields on triangles: the strain norm and the contact forces, straight from the strains at the points of
//! integration of each triangle.

use std::ops::Index;
use stickslip::fem::{Body, Cell};
use stickslip::material::Form;
use stickslip::mesh::Mesh;

/// Vectors at all nodes of a mesh; the third component is zero in 2D.
pub type NodalField = Vec<[f64; 3]>;

/// Strain `[xx, yy, xy]` of a plane field where the shape functions of a cell have these gradients.
fn strain(
    gradients: &[impl Index<usize, Output = f64>],
    cell: &[u32],
    field: &[[f64; 3]],
) -> [f64; 3] {
    let mut strain = [0.0; 3];
    for (g, &node) in gradients.iter().zip(cell) {
        let u = field[node as usize];
        strain[0] += g[0] * u[0];
        strain[1] += g[1] * u[1];
        strain[2] += 0.5 * (g[1] * u[0] + g[0] * u[1]);
    }
    strain
}

/// `|eps(u)|` in L2, the norm of V in the paper, of a plane field.
pub fn strain_norm(mesh: &Mesh, field: &[[f64; 3]]) -> f64 {
    let mut sum = 0.0;
    for cell in mesh.cells() {
        for (weight, gradients) in Cell::new(mesh, cell).points() {
            let [xx, yy, xy] = strain(&gradients, cell, field);
            sum += weight * (xx * xx + yy * yy + 2.0 * xy * xy);
        }
    }
    sum.sqrt()
}

/// Forces of the foundation on the body at the contact nodes, N: what balances the stress
/// `A eps(u') + B eps(u)` there. Plane bodies whose contact part carries no load.
pub fn contact_forces(body: &Body, displacement: &[[f64; 3]], velocity: &[[f64; 3]]) -> NodalField {
    let mesh = &body.mesh;
    let mut forces = vec![[0.0; 3]; mesh.nodes.len()];
    let add = |stress: &mut [f64; 3], form: &Form, [xx, yy, xy]: [f64; 3]| {
        let [x, y, .., shear] = form.stresses([xx, yy, 0.0, 0.0, 0.0, 2.0 * xy]);
        stress[0] += x;
        stress[1] += y;
        stress[2] += shear;
    };
    for (index, cell) in mesh.cells().enumerate() {
        let forms = body.forms.of(index);
        let [viscosity, elasticity] = &*forms;
        for (weight, gradients) in Cell::new(mesh, cell).points() {
            let mut stress = [0.0; 3];
            let elastic = strain(&gradients, cell, displacement);
            add(&mut stress, elasticity, elastic);
            add(&mut stress, viscosity, strain(&gradients, cell, velocity));
            for (g, &node) in gradients.iter().zip(cell) {
                let force = &mut forces[node as usize];
                force[0] += weight * (stress[0] * g[0] + stress[2] * g[1]);
                force[1] += weight * (stress[2] * g[0] + stress[1] * g[1]);
            }
        }
    }
    body.contact
        .nodes
        .iter()
        .map(|&node| forces[node as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::example;

    /// The stress of the elements balances what the friction solver found, and the strain norm is `x A + y B`.
    #[test]
    fn forces_and_norm_agree_with_the_assembled_body() {
        for element in ["p1", "p2"] {
            agree(element);
        }
    }

    fn agree(element: &str) {
        let mut overrides = example::sizes(8, 8);
        overrides.push(("fidelity.model", "full".to_owned()));
        overrides.push(("element", element.to_owned()));
        let scene = example::scene(&overrides).unwrap();
        let run = example::finish(&scene).unwrap();
        let (body, state) = (&run.compilation.body, run.simulator.state());
        let u = example::nodal(&run.compilation, state.displacement()).unwrap();
        let w = example::nodal(&run.compilation, state.velocity()).unwrap();
        let forces = contact_forces(body, &u, &w);
        let stress = run
            .simulator
            .get_by_name("contact.tangential_stress")
            .unwrap();
        for ((force, stress), weight) in forces.iter().zip(&stress).zip(&body.contact.weights) {
            let error = force[0] - stress * weight;
            assert!(error.abs() < 1e-12, "{error}");
            assert!(force[1] > 0.0);
        }
        let free = run.compilation.field(state.displacement()).unwrap();
        let expected = body.strain_norm(&free);
        assert!((strain_norm(&body.mesh, &u) / expected - 1.0).abs() < 1e-12);
    }
}
