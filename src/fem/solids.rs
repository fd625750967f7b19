//! Quadratic tetrahedra without contact, which scenes refuse them: patch test, and orders of convergence.

use super::cell::{Cell, Simplex};
use super::dofs::DofMap;
use super::forms::Forms;
use super::operators::OperatorPair;
use crate::element::{Barycentric, ElementKind};
use crate::linalg::SparseCholesky;
use crate::material::Form;
use crate::mesh::{BoxMesh, Mesh, MeshSpec};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::PI;

const FORM: Form = Form::Isotropic {
    lambda: 1.3,
    two_mu: 0.8,
};

/// The unit cube in n cells along every axis.
fn cube(n: u32) -> Mesh {
    let spec = MeshSpec::Box(BoxMesh {
        cells: [n; 3],
        ..BoxMesh::default()
    });
    Mesh::generate(&spec).expect("a mesh")
}

fn on_boundary(mesh: &Mesh) -> Vec<bool> {
    let mut is_outer = vec![false; mesh.nodes.len()];
    for &node in mesh.parts.values().flatten() {
        is_outer[node as usize] = true;
    }
    is_outer
}

fn assemble(mesh: &Mesh, is_held: &[bool]) -> (DofMap, OperatorPair) {
    let dofs = DofMap::number(
        mesh,
        is_held,
        Vec::new(),
        &[],
        mesh.dimension - 1,
        Vec::new(),
    );
    let pair = OperatorPair::from_elements(mesh, &dofs, &Forms::uniform(mesh, [FORM; 2]));
    (dofs, pair)
}

/// The stress of a quadratic displacement is linear, so that a uniform body force holds it inside; cells of no particular shape.
#[test]
fn quadratic_fields_pass_the_patch_test() {
    let turn = Rotation3::from_euler_angles(0.3, -0.2, 0.4);
    let mut mesh = cube(3);
    let is_outer = on_boundary(&mesh);
    for (i, node) in mesh.nodes.iter_mut().enumerate() {
        let mut point = Vector3::from(*node);
        if !is_outer[i] {
            for c in 0..3 {
                point[c] += 0.03 * ((7 * i + 3 * c) as f64).sin();
            }
        }
        *node = (turn * point).into();
    }
    let mesh = mesh.for_element(ElementKind::P2).expect("quadratic cells");
    let is_outer = on_boundary(&mesh);
    // u_i = x.Q_i x + ..., with the gradient of each component 2 Q_i x
    let q = [
        Matrix3::new(0.3, -0.1, 0.2, -0.1, 0.5, 0.4, 0.2, 0.4, -0.7),
        Matrix3::new(-0.2, 0.6, 0.1, 0.6, 0.1, -0.3, 0.1, -0.3, 0.4),
        Matrix3::new(0.8, 0.2, -0.5, 0.2, -0.4, 0.1, -0.5, 0.1, 0.3),
    ];
    let field = |x: Vector3<f64>| Vector3::from(q.map(|q| x.dot(&(q * x))));
    let stress = |x: Vector3<f64>| {
        let rows = q.map(|q| (q * x * 2.0).transpose());
        let gradient = Matrix3::from_rows(&rows);
        FORM.stress(&((gradient + gradient.transpose()) / 2.0))
    };
    // minus the divergence: differences are exact for a linear field
    let force: Vector3<f64> = (0..3)
        .map(|c| {
            let mut unit = Vector3::zeros();
            unit[c] = 1.0;
            -(stress(unit) - stress(Vector3::zeros()))
                .column(c)
                .into_owned()
        })
        .sum();
    let (dofs, pair) = assemble(&mesh, &vec![false; mesh.nodes.len()]);
    let mut u = vec![0.0; pair.n];
    let mut outer = vec![0.0; pair.n];
    for (node, place) in mesh.nodes.iter().enumerate() {
        let value = field(Vector3::from(*place));
        for (c, dof) in dofs.range(node as u32).enumerate() {
            u[dof] = value[c];
        }
    }
    let mut volume = 0.0;
    for cell in mesh.cells() {
        for (&node, share) in cell.iter().zip(Cell::new(&mesh, cell).integrals()) {
            volume += share;
            for (c, dof) in dofs.range(node).enumerate() {
                outer[dof] += share * force[c];
            }
        }
    }
    assert!((volume - 1.0).abs() < 1e-13);
    let mut inner = vec![0.0; pair.n];
    pair.apply(&pair.a, &u, &mut inner);
    let mut largest: f64 = 0.0;
    for node in (0..mesh.nodes.len()).filter(|node| !is_outer[*node]) {
        for dof in dofs.range(node as u32) {
            largest = largest.max(outer[dof].abs());
            assert!((inner[dof] - outer[dof]).abs() < 1e-14, "node {node}");
        }
    }
    assert!(largest > 1e-3, "the body force matters");
}

/// Bent sides everywhere, also where four cells meet: a linear field has a uniform stress, which holds itself inside.
#[test]
fn linear_fields_pass_the_patch_test_on_bent_cells() {
    let mut mesh = cube(2)
        .for_element(ElementKind::P2)
        .expect("quadratic cells");
    let corners = cube(2).nodes.len();
    for (i, node) in mesh.nodes.iter_mut().enumerate().skip(corners) {
        for (c, x) in node.iter_mut().enumerate() {
            *x += 0.015 * ((5 * i + 2 * c) as f64).sin();
        }
    }
    let is_outer = on_boundary(&mesh);
    let gradient = Matrix3::new(0.3, -0.2, 0.5, 0.7, 0.1, -0.4, 0.2, 0.6, -0.8);
    let (dofs, pair) = assemble(&mesh, &vec![false; mesh.nodes.len()]);
    let mut u = vec![0.0; pair.n];
    for (node, place) in mesh.nodes.iter().enumerate() {
        let value = gradient * Vector3::from(*place);
        for (c, dof) in dofs.range(node as u32).enumerate() {
            u[dof] = value[c];
        }
    }
    let mut force = vec![0.0; pair.n];
    pair.apply(&pair.a, &u, &mut force);
    // the energy is that of the bent volume
    let strain = (gradient + gradient.transpose()) / 2.0;
    let density = FORM.stress(&strain).component_mul(&strain).sum();
    let (mut volume, mut bent) = (0.0, 0);
    for cell in mesh.cells() {
        let cell = Cell::new(&mesh, cell);
        bent += usize::from(cell.is_bent());
        volume += cell.volume();
        assert!((cell.integrals().sum::<f64>() - cell.volume()).abs() < 1e-15);
    }
    let energy: f64 = u.iter().zip(&force).map(|(u, f)| u * f).sum();
    assert_eq!(bent, mesh.cell_count());
    assert!(
        (volume - 1.0).abs() > 1e-4,
        "bent faces change the volume: {volume}"
    );
    assert!((energy / (density * volume) - 1.0).abs() < 1e-13);
    let (mut inner, mut outer) = (0.0f64, 0.0f64);
    for (node, is_outer) in (0..).zip(&is_outer) {
        for dof in dofs.range(node) {
            let most = if *is_outer { &mut outer } else { &mut inner };
            *most = most.max(force[dof].abs());
        }
    }
    assert!(inner < 1e-14 && outer > 1e-2, "{inner:e} {outer}");
}

/// Points and weights of Gauss's rule with 4 points on (0, 1).
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// A product rule on the tetrahedron, exact to degree 5 and more: coordinates and shares of the volume.
fn rule() -> Vec<(Barycentric, f64)> {
    let mut points = Vec::new();
    for (a, wa) in GAUSS {
        for (b, wb) in GAUSS {
            for (c, wc) in GAUSS {
                let (y, z) = (b * (1.0 - a), c * (1.0 - a) * (1.0 - b));
                let weight = 6.0 * wa * wb * wc * (1.0 - a) * (1.0 - a) * (1.0 - b);
                points.push(([1.0 - a - y - z, a, y, z], weight));
            }
        }
    }
    points
}

/// Errors in L2 of displacement and strain of the elastic problem with the solution `(1, 2, -1) sin pi x sin pi y sin pi z`.
fn errors(n: u32, kind: ElementKind) -> [f64; 2] {
    let mesh = cube(n).for_element(kind).expect("an element");
    let (dofs, pair) = assemble(&mesh, &on_boundary(&mesh));
    let along = Vector3::new(1.0, 2.0, -1.0);
    let exact = |p: Vector3<f64>| along * p.map(|x| (PI * x).sin()).product();
    let strain = |p: Vector3<f64>| {
        let (s, c) = (p.map(|x| (PI * x).sin()), p.map(|x| PI * (PI * x).cos()));
        let slope = Vector3::new(c.x * s.y * s.z, s.x * c.y * s.z, s.x * s.y * c.z);
        let gradient = along * slope.transpose();
        (gradient + gradient.transpose()) / 2.0
    };
    let rule = rule();
    let place = |cell: &[u32], at: &Barycentric| -> Vector3<f64> {
        let corner = |i: usize| Vector3::from(mesh.nodes[cell[i] as usize]);
        (0..4).map(|i| corner(i) * at[i]).sum()
    };
    let mut load = vec![0.0; pair.n];
    for cell in mesh.cells() {
        let (shapes, volume) = (Cell::new(&mesh, cell), Simplex::new(&mesh, cell).volume);
        for (at, weight) in &rule {
            let stress = FORM.stress(&strain(place(cell, at))) * (weight * volume);
            for (i, &node) in cell.iter().enumerate() {
                let force = stress * shapes.gradient(i, at);
                for (c, dof) in dofs.range(node).enumerate() {
                    load[dof] += force[c];
                }
            }
        }
    }
    let mut places = vec![[0.0; 3]; pair.n];
    for (node, at) in mesh.nodes.iter().enumerate() {
        places[dofs.range(node as u32)].fill(*at);
    }
    let cholesky = SparseCholesky::new(&pair.col_ptr, &pair.row_idx, &places).expect("an order");
    let (mut factor, mut memory) = (vec![0.0; cholesky.len()], cholesky.scratch(1));
    let factored = cholesky.factor("K", &pair.a, &mut factor, &mut memory);
    factored.expect("a positive matrix");
    let rhs = faer::ColMut::from_slice_mut(&mut load).as_mat_mut();
    cholesky.solve(&factor, rhs, &mut memory);
    let mut squares = [0.0; 2];
    for cell in mesh.cells() {
        let (shapes, volume) = (Cell::new(&mesh, cell), Simplex::new(&mesh, cell).volume);
        for (at, weight) in &rule {
            let p = place(cell, at);
            let (mut u, mut gradient) = (-exact(p), Matrix3::zeros());
            for (i, &node) in cell.iter().enumerate() {
                let nodal = Vector3::from(dofs.vector(node, &load));
                u += nodal * (mesh.element.shape)(i, at);
                gradient += nodal * shapes.gradient(i, at).transpose();
            }
            let off = (gradient + gradient.transpose()) / 2.0 - strain(p);
            squares[0] += weight * volume * u.norm_squared();
            squares[1] += weight * volume * off.norm_squared();
        }
    }
    squares.map(f64::sqrt)
}

#[test]
fn smooth_solutions_converge_with_the_order_of_the_element() {
    for (kind, orders, cells) in [
        (ElementKind::P1, [2.0, 1.0], [8, 16]),
        (ElementKind::P2, [3.0, 2.0], [4, 8]),
    ] {
        let [coarse, fine] = cells.map(|n| errors(n, kind));
        for (order, (coarse, fine)) in orders.iter().zip(coarse.iter().zip(fine)) {
            let found = (coarse / fine).log2();
            assert!(
                (found - order).abs() < 0.15,
                "{kind:?}: {found} for {order}"
            );
        }
    }
}
