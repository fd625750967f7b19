//! Compilation over the C interface: progress, cancellation, and what is refused there.
#![cfg(feature = "capi")]
#![allow(unsafe_code)]

mod common;

use common::paper;
use std::ffi::{CString, c_void};
use std::ptr::null_mut;
use stickslip::ErrorCode;
use stickslip::capi::*;

/// What the callback saw; it stops at the call `last`.
struct Watch {
    seen: Vec<(i32, f64)>,
    last: usize,
}

unsafe extern "C" fn progress(phase: i32, fraction: f64, user_data: *mut c_void) -> i32 {
    // SAFETY: the test hands over its own Watch, which outlives the call
    let watch = unsafe { &mut *user_data.cast::<Watch>() };
    watch.seen.push((phase, fraction));
    i32::from(watch.seen.len() == watch.last)
}

fn text(overrides: &[(&str, &str)]) -> CString {
    CString::new(paper(8, overrides).to_json()).unwrap()
}

#[test]
fn a_callback_sees_the_compilation_and_may_stop_it() {
    let scene = text(&[]);
    let compile = |watch: &mut Watch| {
        let mut model = null_mut();
        let data = std::ptr::from_mut(watch).cast();
        // SAFETY: text and places outlive the call
        let code = unsafe {
            stickslip_model_compile_with(scene.as_ptr(), Some(progress), data, &mut model)
        };
        (code, model)
    };
    let mut whole = Watch {
        seen: vec![],
        last: usize::MAX,
    };
    let (code, model) = compile(&mut whole);
    assert_eq!((code, model.is_null()), (STICKSLIP_OK, false));
    assert_eq!(whole.seen.first(), Some(&(1, 0.0)));
    assert_eq!(whole.seen.last(), Some(&(3, 1.0)));
    assert!(whole.seen.is_sorted_by(|a, b| a.0 <= b.0 && a.1 <= b.1));

    let mut stopped = Watch {
        seen: vec![],
        last: 4,
    };
    let (code, left) = compile(&mut stopped);
    assert_eq!(code, ErrorCode::Cancelled as i32);
    assert_eq!((stopped.seen.len(), left.is_null()), (4, true));
    // SAFETY: the name is a static text
    let name = unsafe { std::ffi::CStr::from_ptr(stickslip_code_name(code)) };
    assert_eq!(name.to_str(), Ok("CANCELLED"));

    // without a callback as the plain call
    let mut plain = null_mut();
    // SAFETY: text and places outlive the calls, the handles are live
    unsafe {
        let code = stickslip_model_compile_with(scene.as_ptr(), None, null_mut(), &mut plain);
        assert_eq!(code, STICKSLIP_OK);
        let mut infos = [std::mem::zeroed::<stickslip_model_info>(); 2];
        for (handle, info) in [model, plain].into_iter().zip(&mut infos) {
            assert_eq!(stickslip_model_get_info(handle, info), STICKSLIP_OK);
            stickslip_model_free(handle);
        }
        assert_eq!(infos[0].fingerprint, infos[1].fingerprint);
    }
}

#[test]
fn what_rust_refuses_c_refuses_by_code() {
    let refused = |overrides: &[(&str, &str)]| {
        let (scene, mut model) = (text(overrides), null_mut());
        // SAFETY: text and place outlive the call
        let code = unsafe { stickslip_model_compile(scene.as_ptr(), &mut model) };
        assert!(model.is_null());
        code
    };
    let explicit = [("time.scheme", "rectangle"), ("time.step", "1")];
    assert_eq!(refused(&explicit), ErrorCode::Unstable as i32);
    assert_eq!(
        refused(&[("history.capacity", "1000000"), ("mesh.cells", "[256, 4]")]),
        ErrorCode::Scene as i32
    );
    for model in ["full", "condensed", "reduced", "auto"] {
        let flat = [
            ("mesh.size", "[1, 1e-6]"),
            ("fidelity.model", model),
            ("probes[0].at", "[1, 0]"),
        ];
        assert_eq!(
            refused(&flat),
            ErrorCode::ReductionInaccurate as i32,
            "{model}"
        );
    }
}

const SHOE: &[u8] = include_bytes!("meshes/shoe.v2.bin.msh");

fn shoe() -> String {
    let material = r#""viscosity": {"law": "isotropic", "mu1": 5e4, "mu2": 1e5},
        "elasticity": {"law": "isotropic", "young": 2e7, "poisson": 0.3, "convention": "plane_strain"}"#;
    format!(
        r#"{{"schema_version": 1, "name": "shoe", "mesh": {{"kind": "gmsh", "file": "shoe.msh"}},
        "material": {{{material}}}, "clamped": ["pivot"],
        "contact": {{"part": "drum face", "friction": {{"law": "tresca", "bound": 2e4}}}},
        "loads": [{{"name": "cam", "kind": "traction", "part": "cam", "direction": [1, -1]}}],
        "time": {{"step": 0.05}}}}"#
    )
}

fn last_error() -> String {
    let mut buffer = [0u8; 1024];
    // SAFETY: the buffer is as long as it is said to be
    let length = unsafe { stickslip_last_error(buffer.as_mut_ptr().cast(), buffer.len()) };
    String::from_utf8_lossy(&buffer[..length.min(1023)]).into_owned()
}

/// A scene that names a mesh compiles from its folder and from memory to one model, and not without its file.
#[test]
fn files_come_from_the_folder_of_the_scene_or_from_memory() {
    let folder = std::env::temp_dir().join(format!("stickslip-capi-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("scene.json"), shoe()).unwrap();
    std::fs::write(folder.join("shoe.msh"), SHOE).unwrap();
    let c = |text: &str| CString::new(text).unwrap();
    let (path, text, name) = (
        c(folder.join("scene.json").to_str().unwrap()),
        c(&shoe()),
        c("shoe.msh"),
    );
    let file = stickslip_file {
        name: name.as_ptr(),
        bytes: SHOE.as_ptr(),
        length: SHOE.len(),
    };
    let mut models = [null_mut(); 3];
    let mut watch = Watch {
        seen: vec![],
        last: usize::MAX,
    };
    let data = std::ptr::from_mut(&mut watch).cast();
    // SAFETY: texts, files and places outlive the calls, the handles are live
    unsafe {
        let code = stickslip_model_compile_file(path.as_ptr(), None, null_mut(), &mut models[0]);
        assert_eq!(code, STICKSLIP_OK, "{}", last_error());
        let code = stickslip_model_compile_files(
            text.as_ptr(),
            &file,
            1,
            Some(progress),
            data,
            &mut models[1],
        );
        assert_eq!(code, STICKSLIP_OK, "{}", last_error());
        // saved and loaded, the model carries the file
        let mut length = 0;
        assert_eq!(
            stickslip_model_save(models[1], null_mut(), 0, &mut length),
            STICKSLIP_OK
        );
        let mut bytes = vec![0; length];
        let code = stickslip_model_save(models[1], bytes.as_mut_ptr(), length, &mut length);
        assert_eq!(code, STICKSLIP_OK);
        assert!(bytes.windows(SHOE.len()).any(|w| w == SHOE));
        assert_eq!(
            stickslip_model_load(bytes.as_ptr(), length, &mut models[2]),
            STICKSLIP_OK
        );
        let prints = models.map(|model| {
            let mut info = std::mem::zeroed::<stickslip_model_info>();
            assert_eq!(stickslip_model_get_info(model, &mut info), STICKSLIP_OK);
            stickslip_model_free(model);
            info.fingerprint
        });
        assert_eq!(prints, [prints[0]; 3]);
    }
    assert_eq!(watch.seen.last(), Some(&(3, 1.0)));
    let refused = |code: i32, model: *mut stickslip_model, said: &str| {
        assert_eq!((code, model.is_null()), (ErrorCode::Scene as i32, true));
        assert!(last_error().contains(said), "{}", last_error());
    };
    // SAFETY: as above
    unsafe {
        let mut model = null_mut();
        let code = stickslip_model_compile(text.as_ptr(), &mut model);
        refused(
            code,
            model,
            "at mesh.file: found \"shoe.msh\", which cannot be read: no files came",
        );
        let code = stickslip_model_compile_files(
            text.as_ptr(),
            std::ptr::null(),
            0,
            None,
            null_mut(),
            &mut model,
        );
        refused(code, model, "at mesh.file");
        let nowhere = c(folder.join("none.json").to_str().unwrap());
        let code = stickslip_model_compile_file(nowhere.as_ptr(), None, null_mut(), &mut model);
        refused(code, model, "none.json");
        std::fs::remove_file(folder.join("shoe.msh")).unwrap();
        let code = stickslip_model_compile_file(path.as_ptr(), None, null_mut(), &mut model);
        refused(code, model, "shoe.msh: ");
        let code = stickslip_model_compile_files(
            text.as_ptr(),
            std::ptr::null(),
            1,
            None,
            null_mut(),
            &mut model,
        );
        assert_eq!((code, model.is_null()), (ErrorCode::Null as i32, true));
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
