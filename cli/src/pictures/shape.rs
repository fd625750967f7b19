//! The shape of a deformed plane body: triangles to fill and sides to draw.

use stickslip::mesh::Mesh;

/// Straight pieces of a drawn side of a quadratic triangle, a parabola once it is deformed.
const PIECES: usize = 6;

/// A point of the picture plane, m.
pub type Place = (f64, f64);

/// A deformed plane body.
pub struct Shape {
    /// Nodes where they are now.
    pub nodes: Vec<Place>,
    /// Triangles of node numbers; a quadratic one is four.
    pub triangles: Vec<[usize; 3]>,
    /// The closed outline of every cell.
    pub outlines: Vec<Vec<Place>>,
}

impl Shape {
    /// A plane mesh under `factor` times a displacement.
    pub fn new(mesh: &Mesh, displacement: &[[f64; 3]], factor: f64) -> Shape {
        let now = |(p, u): (&[f64; 3], &[f64; 3])| (p[0] + factor * u[0], p[1] + factor * u[1]);
        let nodes: Vec<Place> = mesh.nodes.iter().zip(displacement).map(now).collect();
        let mut triangles = Vec::new();
        let mut outlines = Vec::new();
        for cell in mesh.cells() {
            let at = |i: usize| nodes[cell[i] as usize];
            let triangle = |corners: [usize; 3]| corners.map(|i| cell[i] as usize);
            triangles.extend(mesh.element.pieces.iter().map(|p| triangle(*p)));
            let mut outline = vec![at(0)];
            for side in mesh.element.faces {
                let (p, q) = (at(side[0]), at(side[1]));
                let is_its = |ends: &[usize; 2]| side.contains(&ends[0]) && side.contains(&ends[1]);
                match mesh.element.midsides.iter().position(is_its) {
                    None => outline.push(q),
                    Some(middle) => {
                        let m = at(mesh.element.corners() + middle);
                        outline.extend((1..=PIECES).map(|i| {
                            let t = i as f64 / PIECES as f64;
                            parabola([p, m, q], t)
                        }));
                    }
                }
            }
            outlines.push(outline);
        }
        Shape {
            nodes,
            triangles,
            outlines,
        }
    }
}

/// Point `t` (0 to 1) of the parabola through the start, the middle and the end of a side.
fn parabola([p, m, q]: [Place; 3], t: f64) -> Place {
    let weights = [
        (1.0 - t) * (1.0 - 2.0 * t),
        4.0 * t * (1.0 - t),
        t * (2.0 * t - 1.0),
    ];
    let sum = |component: fn(Place) -> f64| {
        let values = [p, m, q].map(component);
        weights.iter().zip(values).map(|(w, v)| w * v).sum()
    };
    (sum(|p| p.0), sum(|p| p.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::scene::{ElementKind, Scene, example};

    /// The drawn sides of a quadratic body lie on the displacement field itself, when that is quadratic.
    #[test]
    fn sides_are_drawn_as_parabolas() {
        let cells = [("mesh.cells".to_owned(), "[2, 1]".to_owned())];
        let text = example("kazmi2014").unwrap();
        let scene = Scene::with_overrides(text, "kazmi2014", &cells).unwrap();
        let mesh = Mesh::generate(&scene.mesh).unwrap();
        let mesh = mesh.for_element(ElementKind::P2).unwrap();
        let bend = |p: [f64; 3]| [0.0, 0.2 * p[0] * p[0], 0.0];
        let displacement: Vec<_> = mesh.nodes.iter().map(|p| bend(*p)).collect();
        let shape = Shape::new(&mesh, &displacement, 2.0);
        assert_eq!(shape.triangles.len(), 4 * mesh.cell_count());
        let lowest = |outline: &Vec<Place>| outline.iter().all(|p| p.1 <= 0.4 * p.0 * p.0 + 0.3);
        let below = shape.outlines.iter().filter(|o| lowest(o));
        let mut on_the_bottom = 0;
        for outline in below {
            for (x, y) in outline {
                if (y - 0.4 * x * x).abs() < 1e-12 {
                    on_the_bottom += 1;
                }
            }
        }
        // the two lower triangles have all points of their bottom side on the bent bottom
        assert!(on_the_bottom >= 2 * (PIECES + 1), "{on_the_bottom}");
    }
}
