//! Quadratic elements, graded and refined meshes: exactness, orders of convergence, contact weights, and runs on them.

mod common;

use common::{paper, relative, start, steps, strain_norm, value, values};
use nalgebra::{Matrix2, Rotation3, Vector2, Vector3};
use serde_json::{Value, json};
use stickslip::fem::{Body, Simplex};
use stickslip::linalg::SparseCholesky;
use stickslip::mesh::Mesh;
use stickslip::scene::{ElementKind, MeshSpec, Scene};

/// The paper's materials on a unit square in frictionless contact, clamped on the left.
fn square(cells: [u32; 2], element: &str) -> Value {
    json!({
        "schema_version": 1, "name": "square",
        "mesh": {"kind": "rectangle", "size": [1.0, 1.0], "cells": cells}, "element": element,
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "kazmi2014"}
        },
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": {"law": "frictionless"}},
        "time": {"step": 0.1}
    })
}

/// The scene, also without a clamped part, which a run would need.
fn parse(value: &Value) -> Scene {
    serde_json::from_value(value.clone()).expect("a well-formed scene")
}

/// Stress of the elasticity for a displacement gradient.
fn stress(gradient: Matrix2<f64>) -> Matrix2<f64> {
    let strain = (gradient + gradient.transpose()) / 2.0;
    Matrix2::identity() * (0.3 / 0.28 * strain.trace()) + strain * (1.0 / 1.3)
}

/// Free components of a field given by its vector at each point, which must satisfy the conditions.
fn project(body: &Body, field: impl Fn([f64; 3]) -> Vector2<f64>) -> Vec<f64> {
    let mut free = vec![0.0; body.len()];
    for (node, point) in body.mesh.nodes.iter().enumerate() {
        let vector = field(*point);
        for (dof, axis) in body
            .dofs
            .range(node as u32)
            .zip(body.dofs.frame(node as u32))
        {
            free[dof] = axis[0] * vector.x + axis[1] * vector.y;
        }
    }
    free
}

/// A quadratic displacement without a normal part on the bottom, on cells of no particular shape that are turned in the
/// plane: its stress is linear, so a uniform body force and linear tractions hold it, and quadratic elements find it exactly.
#[test]
fn quadratic_fields_pass_the_patch_test_on_a_distorted_turned_mesh() {
    let turn = Rotation3::from_euler_angles(0.0, 0.0, 0.4);
    let plane = |v: Vector3<f64>| Vector2::new(v.x, v.y);
    let flat = turn.matrix().fixed_view::<2, 2>(0, 0).into_owned();

    // the field in the axes of the square, and what holds it
    let displacement = |x: f64, y: f64| {
        Vector2::new(
            0.3 * x * x - 0.5 * x * y + 0.2 * y * y + 0.1 * x - 0.4 * y,
            0.6 * y * y + 0.7 * x * y - 0.2 * y,
        )
    };
    let gradient = |x: f64, y: f64| {
        Matrix2::new(
            0.6 * x - 0.5 * y + 0.1,
            -0.5 * x + 0.4 * y - 0.4,
            0.7 * y,
            1.2 * y + 0.7 * x - 0.2,
        )
    };
    // minus the divergence of the stress: differences are exact for a linear field
    let row = |dx: f64, dy: f64| stress(gradient(dx, dy)) - stress(gradient(0.0, 0.0));
    let force = -(row(1.0, 0.0).column(0) + row(0.0, 1.0).column(1));

    let mut value = square([4, 4], "p2");
    value["clamped"] = json!([]);
    let turned = flat * force;
    value["loads"] =
        json!([{"name": "hold", "kind": "body_force", "direction": [turned.x, turned.y]}]);
    let scene = parse(&value);
    let mut mesh = Mesh::generate(&scene.mesh).unwrap();
    let mut is_interior = vec![true; mesh.nodes.len()];
    for &node in mesh.parts.values().flatten() {
        is_interior[node as usize] = false;
    }
    for (i, node) in mesh.nodes.iter_mut().enumerate() {
        let mut point = Vector3::from(*node);
        if is_interior[i] {
            for c in 0..2 {
                point[c] += 0.025 * ((7 * i + 3 * c) as f64).sin();
            }
        }
        *node = (turn * point).into();
    }
    let body = Body::assemble_on(&scene, mesh).unwrap();
    assert_eq!(body.mesh.element.kind, ElementKind::P2);

    let back = |p: [f64; 3]| plane(turn.inverse() * Vector3::from(p));
    let exact = |p: [f64; 3]| {
        let at = back(p);
        flat * displacement(at.x, at.y)
    };
    let u = project(&body, exact);
    for (found, point) in body.displacement(&u).iter().zip(&body.mesh.nodes) {
        let error = Vector2::new(found[0], found[1]) - exact(*point);
        assert!(error.norm() < 1e-14, "{error}");
    }

    let operators = &body.operators;
    let mut inner = vec![0.0; body.len()];
    operators.apply(&operators.b, &u, &mut inner);
    let mut outer = vec![0.0; body.len()];
    for &(dof, share) in &body.loads[0].entries {
        outer[dof] += share * force.norm();
    }
    let mut length = 0.0;
    for faces in body.mesh.parts.values() {
        for face in faces.chunks_exact(3) {
            let [p, q, _] = [0, 1, 2].map(|i| body.mesh.nodes[face[i] as usize]);
            let along = plane(Vector3::from(q) - Vector3::from(p));
            length += along.norm();
            // outward, as long as the side; Simpson's rule is exact for a linear traction on quadratic shape functions
            let normal = Vector2::new(along.y, -along.x);
            for (&node, weight) in face.iter().zip([1.0 / 6.0, 1.0 / 6.0, 4.0 / 6.0]) {
                let at = back(body.mesh.nodes[node as usize]);
                let traction = flat * stress(gradient(at.x, at.y)) * flat.transpose() * normal;
                let axes = body.dofs.range(node).zip(body.dofs.frame(node));
                for (dof, axis) in axes {
                    outer[dof] += weight * (axis[0] * traction.x + axis[1] * traction.y);
                }
            }
        }
    }
    assert!((length - 4.0).abs() < 1e-14);
    let scale = common::largest(&outer);
    assert!(scale > 0.05);
    for (inner, outer) in inner.iter().zip(&outer) {
        assert!((inner - outer).abs() < 1e-13 * scale, "{inner} {outer}");
    }
}

/// Barycentric coordinates and weights (share of the area) of Radon's rule, exact to degree 5.
fn radon() -> Vec<([f64; 3], f64)> {
    let root = 15f64.sqrt();
    let mut points = vec![([1.0 / 3.0; 3], 9.0 / 40.0)];
    for sign in [-1.0, 1.0] {
        let a = (6.0 + sign * root) / 21.0;
        let weight = (155.0 + sign * root) / 1200.0;
        for i in 0..3 {
            let mut at = [a; 3];
            at[i] = 1.0 - 2.0 * a;
            points.push((at, weight));
        }
    }
    points
}

/// Gradients of the shape functions of a triangle with 3 or 6 nodes at barycentric coordinates.
fn shape_gradients(simplex: &Simplex, nodes: usize, l: [f64; 3]) -> Vec<Vector2<f64>> {
    let g = [0, 1, 2].map(|i| Vector2::new(simplex.gradients[i].x, simplex.gradients[i].y));
    if nodes == 3 {
        return g.to_vec();
    }
    let vertices = (0..3).map(|i| g[i] * (4.0 * l[i] - 1.0));
    let middles = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (g[i] * l[j] + g[j] * l[i]) * 4.0);
    vertices.chain(middles).collect()
}

/// Every point of the rule on every cell: weight, place, gradients of the shape functions and nodes.
fn integrate(body: &Body, mut add: impl FnMut(f64, [f64; 2], &[Vector2<f64>], &[u32])) {
    for cell in body.mesh.cells() {
        let simplex = Simplex::new(&body.mesh, cell);
        for (l, weight) in radon() {
            let at = [0, 1].map(|c| {
                (0..3)
                    .map(|i| l[i] * body.mesh.nodes[cell[i] as usize][c])
                    .sum()
            });
            let gradients = shape_gradients(&simplex, cell.len(), l);
            add(weight * simplex.volume, at, &gradients, cell);
        }
    }
}

/// Strain error of the Galerkin solution of a smooth problem on the square.
fn smooth_error(value: &Value) -> f64 {
    // zero on the clamped left, no normal part on the bottom
    let exact = |[x, y]: [f64; 2]| {
        Matrix2::new(
            2.0 * (2.0 * x).cos() * (1.0 + y).cos(),
            -(2.0 * x).sin() * (1.0 + y).sin(),
            x.exp() * (1.5 * y).sin() * (1.0 + x) * 0.2,
            0.3 * x * x.exp() * (1.5 * y).cos(),
        )
    };
    let body = Body::assemble(&parse(value)).unwrap();
    let mut load = vec![0.0; body.len()];
    integrate(&body, |weight, at, gradients, nodes| {
        let stress = stress(exact(at));
        for (gradient, &node) in gradients.iter().zip(nodes) {
            let force = stress * gradient * weight;
            for (dof, axis) in body.dofs.range(node).zip(body.dofs.frame(node)) {
                load[dof] += axis[0] * force.x + axis[1] * force.y;
            }
        }
    });
    let operators = &body.operators;
    let pattern = (&operators.col_ptr[..], &operators.row_idx[..]);
    let cholesky = SparseCholesky::new(pattern.0, pattern.1, &body.interior_places()).unwrap();
    let mut factor = vec![0.0; cholesky.len()];
    let mut memory = cholesky.scratch(1);
    cholesky
        .factor("B", &operators.b, &mut factor, &mut memory)
        .unwrap();
    let rhs = faer::ColMut::from_slice_mut(&mut load).as_mat_mut();
    cholesky.solve(&factor, rhs, &mut memory);

    let field = body.displacement(&load);
    let mut squares = 0.0;
    integrate(&body, |weight, at, gradients, nodes| {
        let mut error = -exact(at);
        for (gradient, &node) in gradients.iter().zip(nodes) {
            let u = field[node as usize];
            error += Vector2::new(u[0], u[1]) * gradient.transpose();
        }
        squares += weight * ((error + error.transpose()) / 2.0).norm_squared();
    });
    squares.sqrt()
}

/// The strain error of a smooth displacement falls with the first order for linear elements and with the second for
/// quadratic ones, on graded meshes too.
#[test]
fn smooth_solutions_converge_with_the_order_of_the_element() {
    for grading in [json!([1.0, 1.0]), json!([1.5, 2.0])] {
        let mut at_same_cells = Vec::new();
        for (element, order) in [("p1", 1.0), ("p2", 2.0)] {
            let errors = [8, 16, 32].map(|n| {
                let mut value = square([n, n], element);
                value["mesh"]["grading"] = grading.clone();
                smooth_error(&value)
            });
            for pair in errors.windows(2) {
                let found = (pair[0] / pair[1]).log2();
                assert!((found - order).abs() < 0.06, "{element}: {errors:?}");
            }
            at_same_cells.push(errors[1]);
        }
        assert!(
            at_same_cells[1] < 0.05 * at_same_cells[0],
            "{at_same_cells:?}"
        );
    }
}

/// Simpson's weights on every side: positive, and in sum the length, but for the share of a clamped end.
#[test]
fn contact_weights_of_quadratic_elements_are_simpsons() {
    let scene = paper(8, &[("element", "p2"), ("mesh.grading", "[2, 1.5]")]);
    let body = Body::assemble(&scene).unwrap();
    let contact = &body.contact;
    assert_eq!((contact.node_count(), contact.faces), (16, 8));
    let x: Vec<f64> = contact.points.iter().map(|p| p[0]).collect();
    assert!(x.is_sorted_by(|a, b| a < b));
    assert_eq!(x.last(), Some(&1.0));
    // L/2 (2 i/n)^2: 1/32, 1/8, 9/32, 1/2
    assert_eq!(&x[..4], [1.0 / 64.0, 1.0 / 32.0, 5.0 / 64.0, 0.125]);
    let lengths: Vec<f64> = [0.0]
        .iter()
        .chain(x.iter().skip(1).step_by(2))
        .zip(x.iter().skip(1).step_by(2))
        .map(|(low, high)| high - low)
        .collect();
    for (i, length) in lengths.iter().enumerate() {
        let next = lengths.get(i + 1).copied().unwrap_or(0.0);
        assert!((contact.weights[2 * i] - 4.0 / 6.0 * length).abs() < 1e-15);
        assert!((contact.weights[2 * i + 1] - (length + next) / 6.0).abs() < 1e-15);
    }
    let total: f64 = contact.weights.iter().sum();
    assert!((total + lengths[0] / 6.0 - 1.0).abs() < 1e-15);
    // the loaded top is consistent in the same way
    assert!((body.loads[0].measure - 1.0).abs() < 1e-14);
}

/// Ends of every axis of a graded body, and the sums that depend on its size.
#[test]
fn graded_bodies_end_exactly_and_keep_their_size() {
    let plate =
        json!({"kind": "rectangle", "size": [0.3, 0.7], "cells": [7, 3], "grading": [1.7, 2.3]});
    let block = json!({
        "kind": "box", "size": [0.3, 0.7, 0.1], "cells": [3, 4, 5], "grading": [1.7, 1.0, 2.3], "periodic": ["y"]
    });
    for mesh in [plate, block] {
        let mesh: MeshSpec = serde_json::from_value(mesh).unwrap();
        let body = Mesh::generate(&mesh).unwrap();
        for (axis, &length) in mesh.grid().unwrap().size.iter().enumerate() {
            let places = || body.nodes.iter().map(move |p| p[axis]);
            assert_eq!(places().fold(f64::INFINITY, f64::min), 0.0);
            assert_eq!(places().fold(0.0, f64::max), length);
        }
        let volume: f64 = body.cells().map(|c| Simplex::new(&body, c).volume).sum();
        let exact: f64 = mesh.grid().unwrap().size.iter().product();
        assert!((volume / exact - 1.0).abs() < 1e-14);
    }
}

/// What the three models of one scene give at the contact over a run.
fn runs(overrides: &[(&str, &str)]) -> [[Vec<f64>; 2]; 3] {
    ["full", "condensed", "reduced"].map(|model| {
        let mut all = overrides.to_vec();
        all.extend([
            ("fidelity.model", model),
            ("fidelity.friction_tolerance", "1e-12"),
        ]);
        let mut simulator = start(&paper(12, &all));
        let mut found = [Vec::new(), Vec::new()];
        for n in 0..24 {
            let load = -0.3 + 0.15 * (0.5 * f64::from(n)).sin();
            simulator.set_inputs(&[load]).unwrap();
            steps(&mut simulator, 0.04, 1);
            found[0].extend(values(&simulator, "contact.slip_rate"));
            found[1].extend(values(&simulator, "contact.tangential_stress"));
        }
        assert!(value(&simulator, "energy.balance_error").abs() < 1e-12);
        found
    })
}

#[test]
fn the_three_models_agree_on_quadratic_graded_and_refined_bodies() {
    let p2 = ("element", "p2");
    let graded = ("mesh.grading", "[2, 2.5]");
    let refined = (
        "mesh.refine",
        r#"[{"from": [0, 0.5], "size": 1e-3}, {"from": [0.1, 0], "to": [0.3, 0], "size": 0.03}]"#,
    );
    for overrides in [
        &[p2][..],
        &[graded],
        &[p2, graded],
        &[p2, refined],
        &[graded, refined],
    ] {
        let [full, condensed, reduced] = runs(overrides);
        for ((full, condensed), (reduced, tolerance)) in full
            .iter()
            .zip(&condensed)
            .zip(reduced.iter().zip([1e-7, 1e-5]))
        {
            assert!(relative(condensed, full) < 1e-9, "{overrides:?}");
            let error = relative(reduced, full);
            assert!(error < tolerance, "{overrides:?}: {error:e}");
        }
    }
}

/// A column held at its ends, dragged along by its own weight: `u = f/(2 G) y (H - y) (1 - exp(-r t))`, a parabola that
/// one quadratic cell across a periodic body finds exactly; f H/2 is the stress at each end, at all times.
#[test]
fn one_quadratic_cell_carries_a_column_under_its_weight() {
    for cells in [json!([1, 1]), json!([2, 1]), json!([3, 2])] {
        let mut column = common::column(
            json!({"law": "tresca", "bound": 10.0}),
            json!({"scheme": "tr_bdf2", "step": 0.25}),
        );
        column["element"] = json!("p2");
        column["mesh"]["cells"] = cells;
        column["loads"][0]["start"] = json!(0.6);
        column["probes"] =
            json!([{"name": "middle", "at": [0.3, 0.5]}, {"name": "low", "at": [0.9, 0.1]}]);
        let mut simulator = start(&common::scene(&column));
        for stress in values(&simulator, "contact.tangential_stress") {
            assert!((stress + 0.3).abs() < 1e-14, "{stress}");
        }
        simulator.set_inputs(&[0.6]).unwrap();
        steps(&mut simulator, 0.25, 200);
        for stress in values(&simulator, "contact.tangential_stress") {
            assert!((stress + 0.3).abs() < 1e-13, "{stress}");
        }
        // E/(1 + nu)/2 = 6/1.25/2 = 2.4
        for (probe, y) in [("middle", 0.5), ("low", 0.1)] {
            let found = values(&simulator, &format!("{probe}.displacement"));
            let exact = 0.6 / (2.0 * 2.4) * y * (1.0 - y);
            assert!((found[0] - exact).abs() < 1e-14, "{found:?}");
            assert!(found[1].abs() < 1e-15);
        }
        assert_eq!(value(&simulator, "contact.stick_fraction"), 1.0);
    }
}

/// A layer that is endless in its plane.
fn layer(contact: Value, start: &str) -> Value {
    json!({"schema_version": 1, "name": "layer", "element": "p2",
        "mesh": {"kind": "box", "size": [1.0, 0.5, 0.7], "cells": [2, 2, 1], "periodic": ["x", "z"]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.3, "mu2": 0.4},
                     "elasticity": {"law": "isotropic", "young": 2.0, "poisson": 0.3, "convention": "three_dimensional"}},
        "clamped": ["top"], "contact": contact,
        "time": {"step": 0.05, "scheme": "trapezoid", "start": start}, "fidelity": {"model": "condensed", "friction_tolerance": 1e-13}})
}

/// Quadratic tetrahedra bear friction at the midside nodes alone, with a third of each face. Then a constant traction is in balance node
/// by node: a layer over a foundation that slides away under it moves alike everywhere, as the scheme has it for one spring and dashpot.
#[test]
fn constant_friction_of_quadratic_tetrahedra_shears_a_layer_evenly() {
    let (bound, height) = (0.07, 0.5);
    let contact = json!({"part": "bottom", "friction": {"law": "tresca", "bound": bound},
        "foundation": [{"kind": "sliding", "name": "belt", "direction": [1, 0, 1], "start": 5.0}]});
    let scene = parse(&layer(contact, "consistent"));
    let mut simulator = start(&scene);
    let contact = simulator.model().contact().clone();
    assert!((contact.weights.iter().sum::<f64>() - 0.7).abs() < 1e-14);
    assert!(contact.weights.iter().all(|w| *w > 0.0));
    // two cells of the bottom, two triangles each, three sides each, of which the periodic ones are one
    assert_eq!(contact.node_count(), 6);
    let (resistance, stiffness) = (0.4 / 2.0, 2.0 / 2.6);
    let (mut velocity, mut displacement) = (bound * height / resistance, 0.0);
    for step in 0..10 {
        steps(&mut simulator, 0.05, 1);
        let theta = 0.025;
        let explicit = displacement + theta * velocity;
        velocity = (bound * height - stiffness * explicit) / (resistance + theta * stiffness);
        displacement = explicit + theta * velocity;
        let moved = velocity / 2f64.sqrt() - 5.0 / 2f64.sqrt();
        for rate in values(&simulator, "contact.slip_rate") {
            assert!((rate - moved).abs() < 1e-11, "{step}: {rate} {moved}");
        }
    }
}

/// The same under pressure: a layer that the foundation presses has one pressure at all nodes, whatever the contact may do.
#[test]
fn pressure_of_quadratic_tetrahedra_is_constant_under_an_even_approach() {
    for kind in ["bilateral", "unilateral", "compliance"] {
        let mut condition = json!({ "kind": kind });
        if kind == "compliance" {
            condition["stiffness"] = json!(50.0);
        }
        let contact = json!({"part": "bottom", "condition": condition, "friction": {"law": "coulomb", "coefficient": 0.3},
            "foundation": [{"kind": "approach", "name": "rise"}]});
        let mut value = layer(contact, "consistent");
        value["time"]["scheme"] = json!("tr_bdf2");
        let mut simulator = start(&parse(&value));
        for step in 1..=6 {
            let rise = simulator.model().ports().find("rise").unwrap().reference;
            simulator.set(rise, 0.01 * f64::from(step)).unwrap();
            steps(&mut simulator, 0.05, 1);
            let pressures = values(&simulator, "contact.pressure");
            let mean = common::value(&simulator, "contact.normal_force") / 0.7;
            assert!(mean > 0.01, "{kind}");
            for pressure in &pressures {
                assert!(
                    (pressure / mean - 1.0).abs() < 1e-9,
                    "{kind} {step}: {pressure} {mean}"
                );
            }
            // what the foundation gives is what the layer takes
            let force = common::value(&simulator, "rise.force");
            assert!((force / 0.7 / mean - 1.0).abs() < 1e-9);
        }
        if kind != "compliance" {
            // after the steps the strain is known, and with it the elastic share of the pressure
            steps(&mut simulator, 0.05, 200);
            let modulus = 2.0 * 0.7 / (1.3 * 0.4);
            let exact = modulus * 0.06 / 0.5;
            let pressure = values(&simulator, "contact.pressure")[0];
            assert!(
                (pressure / exact - 1.0).abs() < 1e-6,
                "{kind} {pressure} {exact}"
            );
        }
    }
}

/// The strain norm of a compiled scene is that of the field, for quadratic elements too.
#[test]
fn strain_norm_of_a_quadratic_field() {
    let mut value = square([3, 2], "p2");
    value["clamped"] = json!(["left"]);
    let compilation = stickslip::Compilation::new(&common::scene(&value)).unwrap();
    let field = project(&compilation.body, |p| Vector2::new(p[0] * p[0], 0.0));
    // int (2 x)^2 = 4/3
    assert!((strain_norm(&compilation, &field) - (4.0f64 / 3.0).sqrt()).abs() < 1e-13);
    let summary = compilation.model.summary();
    // 12 corners, 6 centres, 9 + 8 + 24 sides; the contact has 3 faces of two nodes each, the end not counted
    assert_eq!(summary.mesh_nodes, 12 + 6 + 41);
    assert_eq!(summary.dofs_with_multipliers, 2 * (59 + 6));
}
