//! Figure 4: the error against `h + k^2`, h = k, in the norm of V = |eps(.)|_L2, for both starting velocities.
//!
//! Coarse meshes are nested in the fine one, so a coarse displacement is a fine one exactly and the errors carry no
//! interpolation error.

use super::example::{self, nodal};
use crate::console;
use crate::course;
use crate::failure::Failure;
use crate::field::{NodalField, strain_norm};
use std::sync::Arc;
use stickslip::mesh::Mesh;
use stickslip::{Compilation, Simulator};

/// Errors of one pair h = k = 1/n.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub n: u32,
    /// Displacement at t = 1.
    pub at_end: f64,
    /// Displacement, largest over the common instants.
    pub largest: f64,
    /// Velocity at t = 1.
    pub velocity_at_end: f64,
    /// Norm of the reference displacement at t = 1.
    pub size: f64,
}

impl Row {
    /// `h + k^2`.
    pub fn abscissa(&self) -> f64 {
        let h = 1.0 / f64::from(self.n);
        h + h * h
    }
}

/// A coarse run, in nodal fields.
struct Coarse {
    n: u32,
    displacements: Vec<NodalField>,
    last_velocity: NodalField,
}

/// Errors for h = k = 1/2, 1/4, ... against h = k = 1/`reference`.
pub fn errors(start: &str, reference: u32) -> Result<Vec<Row>, Failure> {
    let mut coarse = Vec::new();
    let mut n = 2;
    while n < reference {
        coarse.push(run(start, n)?);
        n *= 2;
    }
    let mut rows: Vec<Row> = coarse
        .iter()
        .map(|c| Row {
            n: c.n,
            at_end: 0.0,
            largest: 0.0,
            velocity_at_end: 0.0,
            size: 0.0,
        })
        .collect();
    let bar = console::bar(
        u64::from(reference),
        &format!("h = k = 1/{reference}, {start} start"),
    );
    follow(start, reference, |instant, compilation, simulator| {
        bar.set_position(u64::from(instant));
        let is_end = instant == reference;
        let mut fine = None;
        for (coarse, row) in coarse.iter().zip(&mut rows) {
            let stride = reference / coarse.n;
            if instant % stride != 0 {
                continue;
            }
            if fine.is_none() {
                fine = Some(nodal(compilation, simulator.state().displacement())?);
            }
            let mesh = &compilation.body.mesh;
            let field = fine.as_ref().map_or(&[][..], |f| f);
            let at = &coarse.displacements[(instant / stride) as usize];
            let error = distance(mesh, field, coarse, at);
            row.largest = row.largest.max(error);
            if is_end {
                row.at_end = error;
                row.size = strain_norm(mesh, field);
                let velocity = nodal(compilation, simulator.state().velocity())?;
                row.velocity_at_end = distance(mesh, &velocity, coarse, &coarse.last_velocity);
            }
        }
        Ok(())
    })?;
    bar.finish_and_clear();
    Ok(rows)
}

fn run(start: &str, n: u32) -> Result<Coarse, Failure> {
    let mut displacements = Vec::new();
    let mut last = None;
    follow(start, n, |instant, compilation, simulator| {
        displacements.push(nodal(compilation, simulator.state().displacement())?);
        if instant == n {
            last = Some(nodal(compilation, simulator.state().velocity())?);
        }
        Ok(())
    })?;
    let last_velocity = last.unwrap_or_default();
    Ok(Coarse {
        n,
        displacements,
        last_velocity,
    })
}

/// Runs h = k = 1/n on the whole mesh and shows every instant.
fn follow(
    start: &str,
    n: u32,
    mut observe: impl FnMut(u32, &Compilation, &Simulator) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut overrides = example::sizes(n, n);
    overrides.push(("time.start", start.to_owned()));
    overrides.push(("fidelity.model", "condensed".to_owned()));
    let scene = example::scene(&overrides)?;
    let compilation = Compilation::new(&scene).map_err(Failure::of(example::NAME))?;
    let mut simulator = Simulator::new(Arc::clone(&compilation.model));
    let mut instant = 0;
    course::follow(&scene, example::NAME, &mut simulator, |simulator, _| {
        observe(instant, &compilation, simulator)?;
        instant += 1;
        Ok(())
    })?;
    Ok(())
}

/// Strain norm of the difference of a fine field and a coarse one.
fn distance(mesh: &Mesh, fine: &[[f64; 3]], coarse: &Coarse, values: &[[f64; 3]]) -> f64 {
    let difference: NodalField = mesh
        .nodes
        .iter()
        .zip(fine)
        .map(|(point, fine)| {
            let coarse = value_at(coarse, values, *point);
            std::array::from_fn(|i| fine[i] - coarse[i])
        })
        .collect();
    strain_norm(mesh, &difference)
}

/// Value of a coarse field at a point: linear on the four triangles of its cell.
fn value_at(coarse: &Coarse, values: &[[f64; 3]], point: [f64; 3]) -> [f64; 3] {
    let (nx, ny) = (coarse.n as usize, coarse.n as usize / 2);
    let place = |x: f64, cells: usize| {
        let scaled = x * coarse.n as f64;
        let cell = (scaled as usize).min(cells - 1);
        (cell, scaled - cell as f64)
    };
    let ((i, s), (j, t)) = (place(point[0], nx), place(point[1], ny));
    let corner = |di: usize, dj: usize| values[(j + dj) * (nx + 1) + i + di];
    let centre = values[(nx + 1) * (ny + 1) + j * nx + i];
    // the side of the triangle, its two ends and the distance from it
    let (depth, along, ends) = if t <= s && t <= 1.0 - s {
        (t, s, [corner(0, 0), corner(1, 0)])
    } else if t >= s && t >= 1.0 - s {
        (1.0 - t, s, [corner(0, 1), corner(1, 1)])
    } else if s < t {
        (s, t, [corner(0, 0), corner(0, 1)])
    } else {
        (1.0 - s, t, [corner(1, 0), corner(1, 1)])
    };
    std::array::from_fn(|c| {
        2.0 * depth * centre[c] + (1.0 - along - depth) * ends[0][c] + (along - depth) * ends[1][c]
    })
}
