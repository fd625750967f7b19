//! The assembled body: exactness for linear fields, frames, periodicity, contact weights, loads and probes.

use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use serde_json::{Value, json};
use stickslip::fem::{Body, OperatorPair};
use stickslip::mesh::Mesh;
use stickslip::scene::Scene;
use stickslip::{Error, Result};

mod boundary;
mod energies;
mod periodic;

/// The example of the paper (Section 7) on `m x m/2` cells.
fn paper(m: u32) -> Value {
    json!({
        "schema_version": 1,
        "name": "paper",
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [m, m / 2]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "kazmi2014"}
        },
        "clamped": ["left"],
        "contact": {
            "part": "bottom",
            "friction": {"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0}
        },
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0.0, -2.0], "start": 0.3}],
        "time": {"step": 0.03125}
    })
}

fn assemble(scene: &Value) -> Result<Body> {
    Body::assemble(&parse(scene))
}

fn parse(scene: &Value) -> Scene {
    serde_json::from_value(scene.clone()).expect("the scene of a test is well formed")
}

/// Free components of a field given by its vector at each point, which must satisfy the conditions.
fn project(body: &Body, field: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
    let mut free = vec![0.0; body.len()];
    for (node, point) in body.mesh.nodes.iter().enumerate() {
        let value = field(Vector3::from(*point));
        let node = node as u32;
        if body.mesh.leader[node as usize] == node {
            for (dof, axis) in body.dofs.range(node).zip(body.dofs.frame(node)) {
                free[dof] = Vector3::from(*axis).dot(&value);
            }
        }
    }
    free
}

/// Exact densities of x.Ax and x.Bx for the gradient of a linear field, material of the paper.
fn densities(gradient: Matrix3<f64>) -> [f64; 2] {
    let strain = (gradient + gradient.transpose()) / 2.0;
    [[0.05, 0.1], [0.3 / 0.28, 1.0 / 1.3]].map(|[lambda, two_mu]| {
        lambda * strain.trace() * strain.trace() + two_mu * strain.norm_squared()
    })
}

fn dense(pair: &OperatorPair, values: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(pair.n, pair.n);
    for j in 0..pair.n {
        for at in pair.col_ptr[j]..pair.col_ptr[j + 1] {
            matrix[(pair.row_idx[at], j)] = values[at];
            matrix[(j, pair.row_idx[at])] = values[at];
        }
    }
    matrix
}

/// Ascending eigenvalues of `A^-1 B`.
fn rates(body: &Body) -> Vec<f64> {
    let pair = &body.operators;
    let factor = dense(pair, &pair.a).cholesky().expect("the body is held");
    let half = factor
        .l()
        .solve_lower_triangular(&dense(pair, &pair.b))
        .expect("a regular factor");
    let full = factor
        .l()
        .solve_lower_triangular(&half.transpose())
        .expect("a regular factor");
    let mut values: Vec<f64> = full.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Reproducible numbers in (-1, 1).
fn noise(n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| ((i as f64 * 12.9898 + 4.1).sin() * 43_758.545_3).fract())
        .collect()
}

#[track_caller]
fn assert_close(found: f64, expected: f64, relative: f64) {
    let scale = expected.abs().max(1e-300);
    assert!(
        (found - expected).abs() <= relative * scale,
        "found {found}, expected {expected}"
    );
}
