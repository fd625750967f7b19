//! A setting: values of a scene that decide speed and accuracy, as pairs of a JSON path and a value.

use crate::error::Result;
use crate::scene::Scene;

/// Values that replace those of a scene; what a user passes as `--set PATH=VALUE`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setting {
    changes: Vec<(String, String)>,
}

impl Setting {
    /// The setting that changes nothing.
    pub fn unchanged() -> Setting {
        Setting::default()
    }

    /// The same with the value at `path` replaced (JSON if it parses, a string otherwise).
    pub fn with(mut self, path: &str, value: impl Into<String>) -> Setting {
        let value = value.into();
        match self.changes.iter_mut().find(|(known, _)| known == path) {
            Some((_, old)) => *old = value,
            None => self.changes.push((path.to_owned(), value)),
        }
        self
    }

    /// The same with all changes of another one.
    pub fn and(self, other: &Setting) -> Setting {
        let add = |all: Setting, (path, value): &(String, String)| all.with(path, value.as_str());
        other.changes.iter().fold(self, add)
    }

    /// Paths and values, in the order in which they were set.
    pub fn changes(&self) -> &[(String, String)] {
        &self.changes
    }

    /// The same without what a scene already says.
    pub fn needed(self, scene: &Scene) -> Setting {
        let changes_it = |change: &(String, String)| {
            let alone = Setting {
                changes: vec![change.clone()],
            };
            alone.apply(scene).as_ref() != Ok(scene)
        };
        Setting {
            changes: self.changes.into_iter().filter(changes_it).collect(),
        }
    }

    /// The scene with this setting.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a value that the scene refuses.
    pub fn apply(&self, scene: &Scene) -> Result<Scene> {
        Scene::with_overrides(&scene.to_json(), &scene.name, &self.changes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::example;

    #[test]
    fn a_setting_changes_what_it_names_and_nothing_else() {
        let text = example("kazmi2014").unwrap();
        let scene = Scene::from_json(text, "kazmi2014").unwrap();
        assert_eq!(Setting::unchanged().apply(&scene).unwrap(), scene);
        let setting = Setting::unchanged()
            .with("time.step", "0.5")
            .with("mesh.cells", "[4, 2]")
            .with("time.step", "0.25");
        assert_eq!(setting.changes().len(), 2);
        let changed = setting.apply(&scene).unwrap();
        assert_eq!(changed.time.step, 0.25);
        assert_eq!(changed.mesh.grid().unwrap().cells, [4, 2]);
        assert_eq!(changed.contact, scene.contact);
        let both = Setting::unchanged().with("time.step", "1").and(&setting);
        assert_eq!(both.changes()[0], ("time.step".into(), "0.25".into()));
        let needed = setting.clone().needed(&changed.clone());
        assert_eq!(needed, Setting::unchanged());
        assert!(setting.with("mesh.cell", "1").apply(&scene).is_err());
    }
}
