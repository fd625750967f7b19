//! The matrices of a small body, assembled anew: linear simplices on the nodes and cells of the library's mesh, nothing else
//! of it. Contact components last.

use super::number::{Matrix, Real, zeros};
use crate::case::Case;
use stickslip::Scene;
use stickslip::mesh::Mesh;

pub struct Body {
    /// Viscosity and elasticity.
    pub a: Matrix,
    pub b: Matrix,
    /// Force of a unit of each load.
    pub loads: Vec<Vec<Real>>,
    /// Contact weights, contact nodes in the order of their components.
    pub weights: Vec<Real>,
    /// Coordinates of the contact nodes.
    pub points: Vec<[f64; 3]>,
    /// Tangential components of a contact node.
    pub components: usize,
}

impl Body {
    pub fn free(&self) -> usize {
        self.a.len()
    }

    pub fn contact_start(&self) -> usize {
        self.a.len() - self.components * self.weights.len()
    }
}

/// Assembles the body of a case with linear elements.
pub fn assemble(case: &Case) -> Body {
    let scene = Scene::from_json(&case.json().to_string(), "exact").expect("a valid scene");
    let mesh = Mesh::generate(&scene.mesh).expect("a mesh");
    let d = case.dimension();
    let on = |part: &str| -> Vec<bool> {
        let mut is_on = vec![false; mesh.nodes.len()];
        for &node in &mesh.parts[part] {
            is_on[node as usize] = true;
        }
        is_on
    };
    let (clamped, contact) = (on(case.clamped), on("bottom"));
    let is_contact = |node: usize| contact[node] && !clamped[node];
    // numbers: the interior first, then the tangential components of the contact (y is normal to it)
    let mut numbers = vec![[usize::MAX; 3]; mesh.nodes.len()];
    let mut free = 0;
    for node in 0..mesh.nodes.len() {
        if !clamped[node] && !contact[node] {
            for number in numbers[node].iter_mut().take(d) {
                *number = free;
                free += 1;
            }
        }
    }
    for (node, numbers) in numbers.iter_mut().enumerate() {
        if is_contact(node) {
            for axis in [0, 2].into_iter().take(d - 1) {
                numbers[axis] = free;
                free += 1;
            }
        }
    }
    let half = Real::new(0.5);
    let (mut a, mut b) = (zeros(free, free), zeros(free, free));
    let [viscosity, elasticity] = forms(case);
    let mut volumes = vec![Real::zero(); mesh.nodes.len()];
    for cell in mesh.cells() {
        let corners: Vec<[f64; 3]> = cell.iter().map(|&n| mesh.nodes[n as usize]).collect();
        let (volume, gradients) = simplex(&corners, d);
        let share = &volume / &Real::new((d + 1) as f64);
        for (i, gi) in gradients.iter().enumerate() {
            let node = cell[i] as usize;
            volumes[node] = &volumes[node] + &share;
            for (j, gj) in gradients.iter().enumerate() {
                let inner = (0..d).fold(Real::zero(), |sum, c| sum + &gi[c] * &gj[c]);
                for p in 0..d {
                    for q in 0..d {
                        let (row, column) = (numbers[node][p], numbers[cell[j] as usize][q]);
                        if row == usize::MAX || column == usize::MAX {
                            continue;
                        }
                        // lambda g_p g_q + mu (g_q g_p + delta g.g), mu = two_mu / 2
                        let trace = &gi[p] * &gj[q];
                        let mut shear = &gi[q] * &gj[p];
                        if p == q {
                            shear = shear + &inner;
                        }
                        for (matrix, (lambda, two_mu)) in
                            [(&mut a, &viscosity), (&mut b, &elasticity)]
                        {
                            let value = lambda * &trace + two_mu * &half * &shear;
                            matrix[row][column] = &matrix[row][column] + &volume * &value;
                        }
                    }
                }
            }
        }
    }
    let areas = |part: &str| {
        let mut shares = vec![Real::zero(); mesh.nodes.len()];
        for face in mesh.parts[part].chunks_exact(d) {
            let corners: Vec<[f64; 3]> = face.iter().map(|&n| mesh.nodes[n as usize]).collect();
            let share = area(&corners) / Real::new(d as f64);
            for &node in face {
                shares[node as usize] = &shares[node as usize] + &share;
            }
        }
        shares
    };
    let loads = case
        .loads
        .iter()
        .map(|load| {
            let shares = load.part.map_or_else(|| volumes.clone(), areas);
            let direction: Vec<Real> = load.direction.iter().map(|&x| Real::new(x)).collect();
            let square = direction.iter().fold(Real::zero(), |sum, x| sum + x * x);
            let size = square.sqrt();
            let mut column = vec![Real::zero(); free];
            for (share, numbers) in shares.iter().zip(&numbers) {
                for (x, &number) in direction.iter().zip(numbers) {
                    if number != usize::MAX {
                        column[number] = share * &(x / &size);
                    }
                }
            }
            column
        })
        .collect();
    let all = areas("bottom");
    let nodes: Vec<usize> = (0..mesh.nodes.len())
        .filter(|&node| is_contact(node))
        .collect();
    Body {
        a,
        b,
        loads,
        weights: nodes.iter().map(|&node| all[node].clone()).collect(),
        points: nodes.iter().map(|&node| mesh.nodes[node]).collect(),
        components: d - 1,
    }
}

/// `(lambda, two mu)` of viscosity and elasticity.
fn forms(case: &Case) -> [(Real, Real); 2] {
    let (one, two) = (Real::new(1.0), Real::new(2.0));
    let (young, poisson) = (Real::new(case.young), Real::new(case.poisson));
    let near = &one - &(&two * &poisson);
    let lambda = match case.convention {
        "kazmi2014" => &young * &poisson / ((&one - &poisson) * near),
        "plane_stress" => &young * &poisson / (&one - &(&poisson * &poisson)),
        _ => &young * &poisson / ((&one + &poisson) * near),
    };
    [
        (Real::new(case.mu1), Real::new(case.mu2)),
        (lambda, &young / &(&one + &poisson)),
    ]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [Real; 3] {
    std::array::from_fn(|i| &Real::new(a[i]) - &Real::new(b[i]))
}

fn cross(a: &[Real; 3], b: &[Real; 3]) -> [Real; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}

/// Area or volume of a simplex and the gradients of its barycentric coordinates.
fn simplex(corners: &[[f64; 3]], d: usize) -> (Real, Vec<[Real; 3]>) {
    let e1 = minus(corners[1], corners[0]);
    let e2 = minus(corners[2], corners[0]);
    let e3 = if d == 3 {
        minus(corners[3], corners[0])
    } else {
        [Real::zero(), Real::zero(), Real::new(1.0)]
    };
    let normal = cross(&e2, &e3);
    let determinant = (0..3).fold(Real::zero(), |sum, i| sum + &e1[i] * &normal[i]);
    let over = |v: [Real; 3]| v.map(|x| x / &determinant);
    let mut gradients = vec![over(normal), over(cross(&e3, &e1))];
    if d == 3 {
        gradients.push(over(cross(&e1, &e2)));
    }
    let first = std::array::from_fn(|c| gradients.iter().fold(Real::zero(), |sum, g| sum - &g[c]));
    gradients.insert(0, first);
    let parts = Real::new(if d == 3 { 6.0 } else { 2.0 });
    (determinant / parts, gradients)
}

/// Length of an edge or area of a triangle.
fn area(corners: &[[f64; 3]]) -> Real {
    let e1 = minus(corners[1], corners[0]);
    let length = |v: &[Real; 3]| v.iter().fold(Real::zero(), |sum, x| sum + x * x).sqrt();
    match corners.get(2) {
        None => length(&e1),
        Some(&third) => length(&cross(&e1, &minus(third, corners[0]))) / Real::new(2.0),
    }
}
