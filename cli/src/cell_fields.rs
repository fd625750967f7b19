//! Stress and strain rate of the cells, straight from the nodal fields: means over the points of integration.

use stickslip::fem::{Body, Cell};
use stickslip::material::COMPONENTS;

/// Symmetric tensors as nine components, row by row.
type Tensor = [f64; 9];

/// What the cells have at an instant.
pub struct CellFields {
    /// `A eps(w) + B eps(u)`, Pa; in the plane without the stress across it.
    pub stress: Vec<Tensor>,
    /// `eps(w)`, 1/s.
    pub strain_rate: Vec<Tensor>,
}

impl CellFields {
    /// From displacements and velocities of all nodes.
    pub fn new(body: &Body, displacement: &[[f64; 3]], velocity: &[[f64; 3]]) -> CellFields {
        let mesh = &body.mesh;
        let mut fields = CellFields {
            stress: Vec::with_capacity(mesh.cell_count()),
            strain_rate: Vec::with_capacity(mesh.cell_count()),
        };
        for (index, nodes) in mesh.cells().enumerate() {
            let [viscosity, elasticity] = &*body.forms.of(index);
            let (mut volume, mut strain, mut rate) = (0.0, [0.0; 6], [0.0; 6]);
            for (weight, gradients) in Cell::new(mesh, nodes).points() {
                volume += weight;
                for (gradient, &node) in gradients.iter().zip(nodes) {
                    let (u, w) = (&displacement[node as usize], &velocity[node as usize]);
                    for (i, [p, q]) in COMPONENTS.into_iter().enumerate() {
                        let of = |v: &[f64; 3]| match p == q {
                            true => gradient[p] * v[p],
                            false => gradient[p] * v[q] + gradient[q] * v[p],
                        };
                        strain[i] += weight * of(u);
                        rate[i] += weight * of(w);
                    }
                }
            }
            let [strain, rate] = [strain, rate].map(|sum| sum.map(|value| value / volume));
            let mut stress = elasticity.stresses(strain);
            let viscous = viscosity.stresses(rate);
            stress.iter_mut().zip(viscous).for_each(|(s, v)| *s += v);
            if mesh.dimension == 2 {
                // what acts across the plane depends on what the law leaves out
                stress[2] = 0.0;
            }
            let shear = |i: usize| if i < 3 { 1.0 } else { 0.5 };
            fields.stress.push(tensor(|i| stress[i]));
            fields.strain_rate.push(tensor(|i| shear(i) * rate[i]));
        }
        fields
    }

    /// Normal stress at the contact nodes, Pa: of the mean of the cells around each, weighed by their volumes; negative where the body is
    /// pressed.
    pub fn normal_stress(&self, body: &Body) -> Vec<f64> {
        let mesh = &body.mesh;
        let mut sums = vec![([0.0; 9], 0.0); mesh.nodes.len()];
        for (stress, nodes) in self.stress.iter().zip(mesh.cells()) {
            let volume = Cell::new(mesh, nodes).volume();
            for &node in nodes {
                let (sum, weight) = &mut sums[mesh.leader[node as usize] as usize];
                sum.iter_mut()
                    .zip(stress)
                    .for_each(|(sum, s)| *sum += volume * s);
                *weight += volume;
            }
        }
        let contact = &body.contact;
        let along = |(&node, normal): (&u32, &[f64; 3])| {
            let (sum, weight) = &sums[node as usize];
            let products = (0..9).map(|i| sum[i] * normal[i / 3] * normal[i % 3]);
            products.sum::<f64>() / weight
        };
        contact
            .nodes
            .iter()
            .zip(&contact.normals)
            .map(along)
            .collect()
    }
}

fn tensor(component: impl Fn(usize) -> f64) -> Tensor {
    let mut out = [0.0; 9];
    for (i, [p, q]) in COMPONENTS.into_iter().enumerate() {
        out[3 * p + q] = component(i);
        out[3 * q + p] = component(i);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::example;

    /// Stresses of the cells balance the contact forces: their resultant on the body is that of the strains at the points.
    #[test]
    fn the_stress_along_the_contact_is_that_of_friction() {
        let mut overrides = example::sizes(32, 32);
        overrides.push(("fidelity.model", "full".to_owned()));
        let scene = example::scene(&overrides).unwrap();
        let run = example::finish(&scene).unwrap();
        let (body, state) = (&run.compilation.body, run.simulator.state());
        let u = run.compilation.nodal_displacement(state).unwrap();
        let w = run.compilation.nodal_velocity(state).unwrap();
        let fields = CellFields::new(body, &u, &w);
        // the press: on cells at the top the stress along y is the traction
        let on_top = body.mesh.cells().zip(&fields.stress).filter(|(cell, _)| {
            let [x, y, _] = body.mesh.centroid(cell);
            y > 0.49 && x > 0.2 && x < 0.9
        });
        let of_top: Vec<f64> = on_top.map(|(_, stress)| stress[4]).collect();
        let mean = of_top.iter().sum::<f64>() / of_top.len() as f64;
        assert!((mean / -0.3 - 1.0).abs() < 0.05, "{mean}");
        // bilateral contact without a pressure port: the stress across it carries the press and pulls nowhere far
        let normal = fields.normal_stress(body);
        let total: f64 = normal
            .iter()
            .zip(&body.contact.weights)
            .map(|(s, w)| s * w)
            .sum();
        let forces = crate::field::contact_forces(body, &u, &w);
        let expected: f64 = forces.iter().map(|f| f[1]).sum();
        assert!((total / -expected - 1.0).abs() < 0.05, "{total} {expected}");
        // traces of strain rate and gradients agree
        let widest = fields
            .strain_rate
            .iter()
            .map(|e| e[0].abs())
            .fold(0.0, f64::max);
        assert!(widest > 0.0);
    }
}
