//! Families of meshes: the same cells with other elements and gradings.

use super::setting::Setting;
use crate::element::with_contact;
use crate::scene::{Axis, Scene};

/// Exponents of `mesh.grading` that are tried; 1 is a uniform mesh.
pub const GRADINGS: [f64; 4] = [1.0, 1.5, 2.0, 2.5];
/// What a scene calls the elements that are tried on its mesh.
pub fn elements(scene: &Scene) -> impl Iterator<Item = &'static str> {
    with_contact(dimension(scene)).map(|element| element.kind.name())
}

/// Dimension of a generated mesh; no study takes another.
pub(super) fn dimension(scene: &Scene) -> usize {
    scene.mesh.dimension().unwrap_or(2)
}

/// A way to make meshes of any number of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Family {
    setting: Setting,
}

impl Family {
    /// What makes a mesh of this family, apart from its cells.
    pub fn setting(&self) -> Setting {
        self.setting.clone()
    }

    fn new(scene: &Scene, element: &str, exponent: f64) -> Family {
        let setting = Setting::unchanged()
            .with("element", element)
            .with("mesh.grading", grading(scene, exponent));
        Family {
            setting: setting.needed(scene),
        }
    }

    /// The families of a scene, its own first. What the scene refuses (quadratic elements in space) is left out.
    pub fn all(scene: &Scene) -> Vec<Family> {
        let mut families = vec![Family {
            setting: Setting::unchanged(),
        }];
        let mut known = vec![scene.clone()];
        for element in elements(scene) {
            for exponent in GRADINGS {
                let family = Family::new(scene, element, exponent);
                match family.setting.apply(scene) {
                    Ok(applied) if !known.contains(&applied) => {
                        known.push(applied);
                        families.push(family);
                    }
                    _ => {}
                }
            }
        }
        families
    }

    /// The one for references: measured on the example scenes, the most accurate at equal cells that have room for it.
    pub fn most_accurate(scene: &Scene) -> Family {
        let dimension = dimension(scene);
        let highest = with_contact(dimension).max_by_key(|element| element.order);
        let exponent = match dimension {
            2 => 2.5,
            _ => 1.5,
        };
        let element = highest.map_or(scene.element.unwrap_or_default(), |element| element.kind);
        Family::new(scene, element.name(), exponent)
    }
}

/// The same exponent along every axis that is not periodic.
pub fn grading(scene: &Scene, exponent: f64) -> String {
    let periodic = scene.mesh.grid().map_or(&[][..], |grid| grid.periodic);
    let is_periodic = |axis: &Axis| periodic.contains(axis);
    let axes = [Axis::X, Axis::Y, Axis::Z];
    list(axes[..dimension(scene)].iter().map(|axis| {
        let exponent = if is_periodic(axis) { 1.0 } else { exponent };
        exponent.to_string()
    }))
}

/// The cells of a scene, `factor` times as many along every axis, at least one.
pub fn cells(scene: &Scene, factor: f64) -> String {
    let scaled = |&n: &u32| (f64::from(n) * factor).round().max(1.0) as u32;
    let cells = scene.mesh.grid().map_or(&[][..], |grid| grid.cells);
    list(cells.iter().map(|n| scaled(n).to_string()))
}

/// A JSON array without blanks, so that it is one word of a command line.
fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::example;

    #[test]
    fn families_differ_and_begin_with_the_scene_itself() {
        for name in ["kazmi2014", "sheared_column", "brake_pad_3d"] {
            let scene = Scene::from_json(example(name).unwrap(), name).unwrap();
            let families = Family::all(&scene);
            let applied: Vec<Scene> = families
                .iter()
                .map(|f| f.setting().apply(&scene).unwrap())
                .collect();
            assert_eq!(applied[0], scene);
            for (i, one) in applied.iter().enumerate() {
                assert!(!applied[..i].contains(one), "{name}");
            }
        }
    }

    #[test]
    fn cells_scale_along_every_axis_and_never_vanish() {
        let name = "brake_pad_3d";
        let scene = Scene::from_json(example(name).unwrap(), name).unwrap();
        assert_eq!(cells(&scene, 2.0), "[32,6,16]");
        assert_eq!(cells(&scene, 0.125), "[2,1,1]");
        assert_eq!(grading(&scene, 1.5), "[1.5,1.5,1.5]");
    }
}
