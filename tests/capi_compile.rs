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
