//! Compilation over the C interface: a scene text, with files from a folder or from memory.

use super::STICKSLIP_OK;
use super::guard::{give, guarded, place, text, values};
use super::model::{new_handle, stickslip_model};
use crate::error::{Error, Result};
use crate::files::{Files, Folder, MemoryFiles, NoFiles};
use crate::progress::{Observer, Progress};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::ffi::{c_char, c_void};
use std::ops::ControlFlow;

/// Compiles `scene`, the NUL-terminated UTF-8 text of a scene.json, into `*model`. Takes from milliseconds to seconds; the
/// caller frees the model. Errors: `SCENE` (also for a scene that needs more memory than its `fidelity.memory_limit`, or than
/// there is), `BODY`, `REDUCTION_INACCURATE`, `NOT_POSITIVE_DEFINITE`, `UNSTABLE` (unless the scene says `time.force`), `NULL`.
/// Any thread.
///
/// # Safety
/// `scene` is NULL or NUL-terminated, `model` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_compile(
    scene: *const c_char,
    model: *mut *mut stickslip_model,
) -> i32 {
    let call = || {
        // SAFETY: as promised by the caller
        let text = unsafe { utf8(scene, "scene") }?;
        unsafe {
            compile(text, "scene", &NoFiles, model, &mut |_| {
                ControlFlow::Continue(())
            })
        }
    };
    guarded(call, || {})
}

/// Is told where a compilation stands: the phase (0: settings are measured for `fidelity.target_error`, 1: assembly, 2: the model
/// of the body is made, 3: certificate), the fraction of the work that is done (0 to 1, never falling; it stays 0 in phase 0),
/// and the `user_data` of the call. Any value but 0 stops the compilation. Must not throw, nor unwind by longjmp.
pub type stickslip_progress =
    Option<unsafe extern "C" fn(phase: i32, fraction: f64, user_data: *mut c_void) -> i32>;

/// `stickslip_model_compile` that calls `progress` some tens of times on the caller's thread, between factorizations, and stops
/// when it asks for that: `*model` is then left alone. `progress` NULL: as `stickslip_model_compile`. Errors: those of
/// `stickslip_model_compile`, `CANCELLED`. Any thread.
///
/// # Safety
/// `scene` is NULL or NUL-terminated, `model` NULL or writable, `progress` NULL or a function that may be called with `user_data`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_compile_with(
    scene: *const c_char,
    progress: stickslip_progress,
    user_data: *mut c_void,
    model: *mut *mut stickslip_model,
) -> i32 {
    let mut observer = observer(progress, user_data);
    let call = || {
        // SAFETY: as promised by the caller
        let text = unsafe { utf8(scene, "scene") }?;
        unsafe { compile(text, "scene", &NoFiles, model, &mut observer) }
    };
    guarded(call, || {})
}

/// `stickslip_model_compile_with` for the scene file at `path` (UTF-8), with the files of its folder: the mesh that a scene names is
/// looked for there. The model keeps the bytes of what it was made from, also in `stickslip_model_save`. `progress` may be NULL. Errors:
/// those of `stickslip_model_compile_with`; `SCENE` also for a scene file or a mesh file that cannot be read. Any thread.
///
/// # Safety
/// `path` is NULL or NUL-terminated, `model` NULL or writable, `progress` NULL or a function that may be called with `user_data`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_compile_file(
    path: *const c_char,
    progress: stickslip_progress,
    user_data: *mut c_void,
    model: *mut *mut stickslip_model,
) -> i32 {
    let mut observer = observer(progress, user_data);
    let call = || {
        // SAFETY: as promised by the caller
        let path = unsafe { utf8(path, "path") }?;
        let folder = Folder::of(path.as_ref());
        let unreadable = |why: String| Error::Scene {
            source_name: path.to_owned(),
            path: "$".into(),
            found: format!("no scene: {why}"),
            allowed: "a scene file, UTF-8".into(),
        };
        let bytes = Folder::default().read(path).map_err(unreadable)?;
        let text = std::str::from_utf8(&bytes).map_err(|e| unreadable(e.to_string()))?;
        // SAFETY: as promised by the caller
        unsafe { compile(text, path, &folder, model, &mut observer) }
    };
    guarded(call, || {})
}

/// A file in memory, for `stickslip_model_compile_files`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct stickslip_file {
    /// What the scene calls it, NUL-terminated UTF-8.
    pub name: *const c_char,
    /// Its contents.
    pub bytes: *const u8,
    /// Number of bytes.
    pub length: usize,
}

/// `stickslip_model_compile_with` for a scene whose files are in memory: `files` are `count` of them, by the names that the scene calls
/// them. Nothing of them is kept but copies of those that the scene names, in the model. `progress` may be NULL. Errors: those of
/// `stickslip_model_compile_with`; `SCENE` also for a file that is not among them or cannot be used. Any thread.
///
/// # Safety
/// `scene` is NULL or NUL-terminated, `files` NULL or `count` structures whose names are NUL-terminated and whose bytes are `length`
/// long, `model` NULL or writable, `progress` NULL or a function that may be called with `user_data`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_compile_files(
    scene: *const c_char,
    files: *const stickslip_file,
    count: usize,
    progress: stickslip_progress,
    user_data: *mut c_void,
    model: *mut *mut stickslip_model,
) -> i32 {
    let mut observer = observer(progress, user_data);
    let call = || {
        // SAFETY: as promised by the caller
        let text = unsafe { utf8(scene, "scene") }?;
        let mut all = BTreeMap::new();
        for file in unsafe { values(files, count, count, "files") }? {
            let name = unsafe { utf8(file.name, "name of a file") }?;
            let bytes = unsafe { values(file.bytes, file.length, file.length, "bytes of a file") }?;
            all.insert(name.to_owned(), bytes.into());
        }
        // SAFETY: as promised by the caller
        unsafe { compile(text, "scene", &MemoryFiles(all), model, &mut observer) }
    };
    guarded(call, || {})
}

/// What tells a C function where a compilation stands.
fn observer(
    progress: stickslip_progress,
    user_data: *mut c_void,
) -> impl FnMut(Progress) -> ControlFlow<()> {
    move |now: Progress| match progress {
        // SAFETY: as promised by the caller of the function that has it
        Some(call) if unsafe { call(now.phase as i32, now.fraction, user_data) } != 0 => {
            ControlFlow::Break(())
        }
        _ => ControlFlow::Continue(()),
    }
}

/// # Safety
/// `pointer` is NULL or points to a NUL-terminated text.
unsafe fn utf8<'a>(pointer: *const c_char, what: &'static str) -> Result<&'a str> {
    // SAFETY: as promised by the caller
    let bytes = unsafe { text(pointer, what) }?;
    std::str::from_utf8(bytes).map_err(|e| Error::Scene {
        source_name: what.into(),
        path: "$".into(),
        found: format!("bytes that are not UTF-8 ({e})"),
        allowed: "UTF-8 text".into(),
    })
}

/// # Safety
/// `model` is NULL or writable.
unsafe fn compile(
    text: &str,
    source_name: &str,
    files: &dyn Files,
    model: *mut *mut stickslip_model,
    observer: &mut Observer,
) -> Result<i32> {
    place(model, "model")?;
    let scene = Scene::from_json(text, source_name)?;
    let compiled = new_handle(crate::compile_with(&scene, files, observer)?)?;
    // SAFETY: checked by `place`
    unsafe { give(model, compiled) };
    Ok(STICKSLIP_OK)
}
