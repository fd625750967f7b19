//! Compilation: the setting of a scene is resolved, then its model is made.

use crate::error::Result;
use crate::files::{Files, NoFiles};
use crate::model::{Compilation, Model, Observer};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::tradeoff::resolve;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Compiles a scene that names no files.
///
/// # Errors
/// [`crate::Error::Scene`] and [`crate::Error::Body`] for a scene without a usable body or beyond `fidelity.memory_limit`;
/// [`crate::Error::ReductionInaccurate`] when the reduction asked for is out of reach; [`crate::Error::LostDigits`] when 64-bit numbers lose
/// more of the body than `fidelity.tolerance`; [`crate::Error::Unstable`] for an explicit scheme beyond its stability limit without
/// `time.force`; [`crate::Error::Scene`] at `fidelity.target_error` for a target out of reach.
pub fn compile(scene: &Scene) -> Result<Arc<Model>> {
    Compilation::new(scene).map(|c| c.model)
}

/// Compiles a scene with the files that it names, as that of its mesh: [`crate::Folder`], [`crate::MemoryFiles`]. The model keeps what
/// it read ([`Model::files`]).
///
/// # Errors
/// Those of [`compile`]; [`crate::Error::Scene`] at the name of a file that cannot be read or used.
pub fn compile_from(scene: &Scene, files: &dyn Files) -> Result<Arc<Model>> {
    compile_with(scene, files, &mut |_| ControlFlow::Continue(()))
}

/// The same, and tells `observer` where that stands; it may stop it.
///
/// # Errors
/// Those of [`compile_from`]; [`crate::Error::Cancelled`].
pub fn compile_with(
    scene: &Scene,
    files: &dyn Files,
    observer: &mut Observer,
) -> Result<Arc<Model>> {
    Compilation::with(scene, files, observer).map(|c| c.model)
}

impl Compilation {
    /// Compiles a scene on the mesh it describes, or on the one that is picked for its `fidelity.target_error`.
    ///
    /// # Errors
    /// Those of [`compile`].
    pub fn new(scene: &Scene) -> Result<Compilation> {
        Compilation::with(scene, &NoFiles, &mut |_| ControlFlow::Continue(()))
    }

    /// The same with the files that the scene names, and tells `observer` where it stands.
    ///
    /// # Errors
    /// Those of [`compile_with`].
    pub fn with(scene: &Scene, files: &dyn Files, observer: &mut Observer) -> Result<Compilation> {
        let mut watch = Watch::new(observer);
        let (scene, selection) = resolve(scene, &mut watch)?;
        Compilation::resolved(scene, files, selection, &mut watch)
    }
}
