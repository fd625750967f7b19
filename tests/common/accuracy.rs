//! The end of a run on the paper's example, and its errors against the end of a finer one.

use super::{value, values};
use stickslip::fem::{Body, Simplex};
use stickslip::scene::ElementKind;
use stickslip::{Compilation, Simulator};

/// What the errors are measured against: a run with four times the cells (256 x 128) gives 0.118 963 34 at the tip.
pub const FINE: [(&str, &str); 3] = [
    ("element", "p2"),
    ("mesh.cells", "[128, 64]"),
    ("mesh.grading", "[2.2, 3]"),
];

/// A fiftieth of the unknowns of the paper's finest mesh: refined at the corners of the clamped and contact parts, the
/// slipping end, and where the stress changes its sign.
pub const REFINED: [(&str, &str); 3] = [
    ("element", "p2"),
    ("mesh.cells", "[14, 7]"),
    (
        "mesh.refine",
        r#"[{"from": [0, 0.5], "size": 1e-3}, {"from": [0, 0], "size": 0.01}, {"from": [1, 0], "size": 2e-3},
        {"from": [0.8, 0], "to": [1, 0], "size": 0.03}, {"from": [0.04, 0], "to": [0.1, 0], "size": 0.012},
        {"from": [0.055, 0], "to": [0.075, 0], "size": 0.006}]"#,
    ),
];

/// The end of a run.
pub struct End {
    pub compilation: Compilation,
    displacement: Vec<[f64; 3]>,
    /// Displacement of (1, 0) along x, m.
    pub tip: f64,
    slip_rate: Vec<f64>,
    stress: Vec<f64>,
}

/// Errors against a reference.
#[derive(Debug)]
pub struct Errors {
    /// Of the tip, m.
    pub tip: f64,
    /// Of the slip rate and the tangential stress, L2 over the contact, relative.
    pub slip_rate: f64,
    pub stress: f64,
    /// Of the displacement in the strain norm, relative.
    pub strain: f64,
}

impl End {
    /// Where the simulator of the compiled scene is now.
    pub fn new(compilation: Compilation, simulator: &Simulator) -> End {
        let field = compilation
            .field(simulator.state().displacement())
            .expect("the field of a compiled body");
        End {
            displacement: compilation.body.displacement(&field),
            tip: value(simulator, "tip.displacement"),
            slip_rate: values(simulator, "contact.slip_rate"),
            stress: values(simulator, "contact.tangential_stress"),
            compilation,
        }
    }

    /// Degrees of freedom as the paper counts them.
    pub fn dofs(&self) -> usize {
        self.compilation.model.summary().dofs_with_multipliers
    }

    pub fn errors(&self, reference: &End) -> Errors {
        let contact = |values: fn(&End) -> &[f64]| {
            let [mut error, mut size] = [0.0; 2];
            let ends = std::iter::once(0.0).chain(reference.contact_places());
            for (low, high) in ends.zip(reference.contact_places()) {
                for i in 0..4 {
                    let x = low + (high - low) * (f64::from(i) + 0.5) / 4.0;
                    let exact = reference.on_contact(values(reference), x);
                    let found = self.on_contact(values(self), x);
                    error += (high - low) * (found - exact).powi(2);
                    size += (high - low) * exact * exact;
                }
            }
            f64::sqrt(error / size)
        };
        Errors {
            tip: (self.tip - reference.tip).abs(),
            slip_rate: contact(|end| &end.slip_rate),
            stress: contact(|end| &end.stress),
            strain: self.strain_error(reference),
        }
    }

    fn contact_places(&self) -> impl Iterator<Item = f64> {
        self.compilation.body.contact.points.iter().map(|p| p[0])
    }

    /// A field on the contact by its shape functions; up to the first node as there.
    fn on_contact(&self, values: &[f64], x: f64) -> f64 {
        let places = &self.compilation.body.contact.points;
        let order = match self.compilation.body.mesh.element.kind {
            ElementKind::P1 => 1,
            ElementKind::P2 => 2,
        };
        // the clamped end is no contact node: the first face ends at node order - 1
        let after = places.partition_point(|p| p[0] < x);
        let face = (after / order).min(places.len() / order - 1);
        let node = |i: usize| match (face * order + i).checked_sub(1) {
            Some(node) => (places[node][0], values[node]),
            None => (0.0, values[0]),
        };
        let ((low, first), (high, last)) = (node(0), node(order));
        let t = (x - low) / (high - low);
        match order {
            1 => first * (1.0 - t) + last * t,
            _ => {
                let (_, middle) = node(1);
                let ends = first * (1.0 - t) * (1.0 - 2.0 * t) + last * t * (2.0 * t - 1.0);
                ends + 4.0 * t * (1.0 - t) * middle
            }
        }
    }

    /// On the points of integration of the reference, which resolve where the strain of this run jumps.
    fn strain_error(&self, reference: &End) -> f64 {
        let finder = Finder::new(&self.compilation.body);
        let [mut error, mut size] = [0.0; 2];
        let mesh = &reference.compilation.body.mesh;
        for (number, cell) in mesh.cells().enumerate() {
            let volume = Simplex::new(mesh, cell).volume;
            for i in 0..3 {
                let mut l = [1.0 / 6.0; 3];
                l[i] = 2.0 / 3.0;
                let at = [0, 1].map(|c| {
                    let corners = cell.iter().zip(l);
                    corners.map(|(&n, l)| l * mesh.nodes[n as usize][c]).sum()
                });
                let exact = reference.strain(number, l);
                let (here, l) = finder.find(at);
                let found = self.strain(here, l);
                let square = |e: [f64; 3]| e[0] * e[0] + e[1] * e[1] + 2.0 * e[2] * e[2];
                error += volume * square(std::array::from_fn(|i| found[i] - exact[i]));
                size += volume * square(exact);
            }
        }
        f64::sqrt(error / size)
    }

    /// Strain `[xx, yy, xy]` at barycentric coordinates of a cell.
    fn strain(&self, cell: usize, l: [f64; 3]) -> [f64; 3] {
        let mesh = &self.compilation.body.mesh;
        let nodes = mesh.cell(cell);
        let g = Simplex::new(mesh, nodes).gradients;
        let mut strain = [0.0; 3];
        let mut add = |[gx, gy]: [f64; 2], node: u32| {
            let u = self.displacement[node as usize];
            strain[0] += gx * u[0];
            strain[1] += gy * u[1];
            strain[2] += 0.5 * (gy * u[0] + gx * u[1]);
        };
        for i in 0..3 {
            match mesh.element.kind {
                ElementKind::P1 => add([g[i].x, g[i].y], nodes[i]),
                ElementKind::P2 => {
                    let factor = 4.0 * l[i] - 1.0;
                    add([factor * g[i].x, factor * g[i].y], nodes[i]);
                    let j = (i + 1) % 3;
                    let side = (g[i] * l[j] + g[j] * l[i]) * 4.0;
                    add([side.x, side.y], nodes[3 + i]);
                }
            }
        }
        strain
    }
}

/// Finds the cell at a point: the cells by the squares of a grid that they meet.
struct Finder<'a> {
    body: &'a Body,
    squares: Vec<Vec<usize>>,
}

/// Squares along x; half as many along y.
const SQUARES: usize = 256;

impl Finder<'_> {
    fn new(body: &Body) -> Finder<'_> {
        let mut squares = vec![Vec::new(); SQUARES * SQUARES / 2];
        for (number, cell) in body.mesh.cells().enumerate() {
            let range = |axis: usize| {
                let places = cell[..3].iter().map(|&n| body.mesh.nodes[n as usize][axis]);
                let [low, high] = [
                    places.clone().fold(f64::INFINITY, f64::min),
                    places.fold(0.0, f64::max),
                ];
                square(low, axis)..=square(high, axis)
            };
            for j in range(1) {
                for i in range(0) {
                    squares[j * SQUARES + i].push(number);
                }
            }
        }
        Finder { body, squares }
    }

    /// The cell and the barycentric coordinates there.
    fn find(&self, at: [f64; 2]) -> (usize, [f64; 3]) {
        let mesh = &self.body.mesh;
        let candidates = &self.squares[square(at[1], 1) * SQUARES + square(at[0], 0)];
        let coordinates = candidates.iter().map(|&number| {
            let cell = mesh.cell(number);
            let l = Simplex::new(mesh, cell).barycentric(mesh, cell, [at[0], at[1], 0.0]);
            (number, [l[0], l[1], l[2]])
        });
        let depth = |l: &[f64; 3]| l.iter().copied().fold(f64::INFINITY, f64::min);
        let (number, l) = coordinates
            .max_by(|(_, a), (_, b)| depth(a).total_cmp(&depth(b)))
            .expect("a cell at every point of the body");
        assert!(depth(&l) > -1e-9);
        (number, l)
    }
}

/// Number of the square at a coordinate.
fn square(x: f64, axis: usize) -> usize {
    let most = [SQUARES, SQUARES / 2][axis] - 1;
    ((x * SQUARES as f64) as usize).min(most)
}
