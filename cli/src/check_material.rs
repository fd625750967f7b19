//! What a nearly incompressible material asks of the mesh and of the viscosity.

use crate::closing::figure;
use stickslip::material::{Form, RATIOS};
use stickslip::message::number;
use stickslip::{Compilation, Model};

/// lambda / mu of a Poisson's ratio of 0.45: beyond, linear cells of a mesh without pattern lock.
const LOCKS: f64 = 9.0;
/// `k r` from which a stiff volume is worth a word.
const STIFF: f64 = 4.0;
/// How much faster than the slowest rate the one of the volume is then.
const APART: f64 = 4.0;

/// Resistance to a change of volume, `I : D I / dimension`.
fn volume(form: &Form, dimension: usize) -> f64 {
    let along = |i: usize| f64::from(u8::from(i < dimension));
    let stress = form.stresses([along(0), along(1), along(2), 0.0, 0.0, 0.0]);
    stress[..dimension].iter().sum::<f64>() / dimension as f64
}

/// Largest `lambda / mu` of the elasticity over the cells, and the region where it is.
fn incompressibility(compilation: &Compilation) -> (f64, &str) {
    let body = &compilation.body;
    let dimension = body.mesh.dimension;
    let mut worst = (0.0, "");
    for (cell, region) in body.mesh.cell_regions.iter().enumerate() {
        let [_, elasticity] = &*body.forms.of(cell);
        let ratio = volume(elasticity, dimension) / elasticity.extremes(dimension)[0];
        let ratio = 2.0 * (ratio - 1.0) / dimension as f64;
        if ratio > worst.0 {
            worst = (ratio, &body.mesh.regions[*region as usize]);
        }
    }
    worst
}

/// Which numbers of the material stay free.
pub fn free(model: &Model) -> Option<(&'static str, String)> {
    let numbers = model.free_numbers();
    let paths: Vec<&str> = numbers.iter().map(|n| n.path.as_str()).collect();
    let [low, high] = RATIOS;
    (!paths.is_empty()).then(|| {
        let text = format!(
            "{} numbers are parameters until the initialization ends, for lambda / 2 mu of {} to {}: {}",
            paths.len(),
            number(low),
            number(high),
            paths.join(", ")
        );
        ("free material", text)
    })
}

/// Advice, where there is any.
pub fn advice(compilation: &Compilation) -> Vec<(&'static str, String)> {
    let body = &compilation.body;
    let mesh = &body.mesh;
    let mut rows = Vec::new();
    let has_pattern = mesh.dimension == 2 && compilation.scene.mesh.file().is_none();
    let (ratio, region) = incompressibility(compilation);
    if mesh.element.order == 1 && !has_pattern && ratio > LOCKS {
        rows.push((
            "locking",
            format!(
                "linear cells in the region {region:?}, whose elasticity has lambda/mu = {} (more than 9, a Poisson's ratio beyond \
                 0.45): displacements at rest come out too small, by tens of per cent near 0.5; \"element\": \"p2\" does not lock",
                figure(ratio, 3)
            ),
        ));
    }
    let [slowest, fastest] = compilation.model.summary().rates;
    let of_volume = (0..mesh.cell_count()).map(|cell| {
        let [a, b] = &*body.forms.of(cell);
        volume(b, mesh.dimension) / volume(a, mesh.dimension)
    });
    let of_volume = of_volume.fold(0.0, f64::max);
    let is_fastest = of_volume > 0.9 * fastest && of_volume > APART * slowest;
    if compilation.scene.time.step * fastest > STIFF && is_fastest {
        rows.push((
            "stiff volume",
            format!(
                "the fastest relaxation is that of the volume ({} 1/s; the slowest rate is {}): the elasticity is much less \
                 compressible than the viscosity. With mu1 / mu2 of the viscosity as lambda / 2 mu of the elasticity both relax alike",
                figure(of_volume, 4),
                figure(slowest, 4)
            ),
        ));
    }
    rows
}
