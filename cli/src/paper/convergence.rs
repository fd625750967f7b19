//! Figure 4: the error against `h + k^2`, h = k, in the norm of V = |eps(.)|_L2, for both starting velocities.
//!
//! Coarse meshes are nested in the fine one, so a coarse displacement is a fine one exactly and the errors carry no
//! interpolation error.

use super::example::{self, nodal};
use crate::closing::{RULED, trimmed};
use crate::console;
use crate::contact_table::write_columns;
use crate::course;
use crate::failure::Failure;
use crate::field::{NodalField, strain_norm};
use crate::pictures::{Axis, BLUE, Curves, Mark, Panel, RED, Series, Sheet};
use comfy_table::Table;
use std::path::Path;
use std::sync::Arc;
use stickslip::mesh::Mesh;
use stickslip::{Compilation, Simulator};

/// The starting velocities compared: the paper's data, and the solution of the inequality at t = 0.
const STARTS: [&str; 2] = ["zero", "consistent"];
/// Errors from zero velocity against h = k = 1/256 by an independent solver (numpy and scipy), h = k = 1/2 ... 1/128.
const INDEPENDENT: [f64; 7] = [
    8.369e-2, 7.494e-2, 5.707e-2, 3.558e-2, 1.899e-2, 8.719e-3, 3.186e-3,
];

/// Errors of one pair h = k = 1/n.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub n: u32,
    /// Displacement at t = 1.
    pub at_end: f64,
    /// Displacement, largest over the common instants.
    pub largest: f64,
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
}

/// The errors for both starting velocities.
pub fn both_starts(reference: u32) -> Result<[Vec<Row>; 2], Failure> {
    Ok([errors(STARTS[0], reference)?, errors(STARTS[1], reference)?])
}

/// Figure 4 and its data.
pub fn draw(out: &Path, errors: &[Vec<Row>; 2], reference: u32) -> Result<(), Failure> {
    let [zero, consistent] = errors;
    let rows = zero.iter().zip(consistent).map(|(z, c)| {
        vec![
            1.0 / f64::from(z.n),
            z.abscissa(),
            z.largest,
            c.largest,
            z.at_end,
            c.at_end,
        ]
    });
    write_columns(
        &out.join("figure4.csv"),
        &[
            "h",
            "h_plus_k2",
            "largest_zero_start",
            "largest_consistent_start",
            "at_end_zero_start",
            "at_end_consistent_start",
        ],
        rows,
    )?;
    let series = |name: &str, colour, rows: &[Row], value: fn(&Row) -> f64| Series {
        name: name.to_owned(),
        colour,
        mark: Mark::Beads,
        points: rows.iter().map(|r| (r.abscissa(), value(r))).collect(),
    };
    // beside the finest meshes, below the curves
    let finest = &consistent[consistent.len().saturating_sub(4)..];
    let factor = finest
        .iter()
        .map(|r| 0.7 * r.largest / r.abscissa())
        .fold(f64::INFINITY, f64::min);
    let first_order = Series {
        name: "slope 1".to_owned(),
        colour: (110, 110, 110),
        mark: Mark::Dashed,
        points: finest
            .iter()
            .map(|r| (r.abscissa(), factor * r.abscissa()))
            .collect(),
    };
    let curves = Curves {
        heading: "Largest error over the instants".to_owned(),
        x: Axis::log("h + k²", "h in m, k in s"),
        y: Axis::log("|ε(u − u_ref)| in L²", "m"),
        series: vec![
            series("zero starting velocity", RED, zero, |r| r.largest),
            series("consistent start", BLUE, consistent, |r| r.largest),
            first_order,
        ],
    };
    Sheet {
        title: format!("Figure 4: error for h = k against h = k = 1/{reference}"),
        width: 900,
        height: 640,
        rows: vec![(1.0, vec![Panel::Curves(curves)])],
    }
    .save(out, "figure4")
}

/// The errors, digit by digit.
pub fn table(errors: &[Vec<Row>; 2], reference: u32) -> String {
    let mut table = Table::new();
    table.load_style(RULED);
    let mut header = vec!["h = k", "h + k²", "zero start", "consistent start", "order"];
    let is_comparable = reference == 256;
    if is_comparable {
        header.push("zero start, independent solver");
    }
    table.set_header(header);
    let mut before: Option<f64> = None;
    for (i, (zero, consistent)) in errors[0].iter().zip(&errors[1]).enumerate() {
        let order = before.map_or("-".to_owned(), |b| {
            format!("{:.2}", (b / consistent.largest).log2())
        });
        before = Some(consistent.largest);
        let mut row = vec![
            format!("1/{}", zero.n),
            format!("{:.4}", zero.abscissa()),
            format!("{:.3e}", zero.largest),
            format!("{:.3e}", consistent.largest),
            order,
        ];
        if is_comparable {
            row.push(format!("{:.3e}", INDEPENDENT[i]));
        }
        table.add_row(row);
    }
    format!(
        "{}\n\nError of the displacement against h = k = 1/{reference}: |eps(u - u_ref)| in L2, the largest over the instants \
         of the coarser run.",
        trimmed(&table)
    )
}

/// Errors for h = k = 1/2, 1/4, ... against h = k = 1/`reference`.
fn errors(start: &str, reference: u32) -> Result<Vec<Row>, Failure> {
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
        })
        .collect();
    let bar = console::bar(
        u64::from(reference),
        &format!("h = k = 1/{reference}, {start} start"),
    );
    follow(start, reference, |instant, compilation, simulator| {
        bar.set_position(u64::from(instant));
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
            if instant == reference {
                row.at_end = error;
            }
        }
        Ok(())
    })?;
    bar.finish_and_clear();
    Ok(rows)
}

fn run(start: &str, n: u32) -> Result<Coarse, Failure> {
    let mut displacements = Vec::new();
    follow(start, n, |_, compilation, simulator| {
        displacements.push(nodal(compilation, simulator.state().displacement())?);
        Ok(())
    })?;
    Ok(Coarse { n, displacements })
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
