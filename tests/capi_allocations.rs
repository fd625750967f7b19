//! The calls of a co-simulation loop allocate nothing.
#![cfg(feature = "capi")]
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::CString;
use std::ptr::null_mut;
use stickslip::capi::*;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: passes everything on to the system allocator
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn stepping_and_rolling_back_allocate_nothing() {
    for (model_kind, scheme) in [
        ("reduced", "trapezoid"),
        ("reduced", "tr_bdf2"),
        ("condensed", "trapezoid"),
        ("full", "backward_euler"),
    ] {
        let overrides = [
            ("fidelity.model".to_string(), model_kind.to_string()),
            ("time.scheme".to_string(), scheme.to_string()),
        ];
        let text = stickslip::scene::example("kazmi2014").unwrap();
        let scene = stickslip::Scene::with_overrides(text, "x", &overrides).unwrap();
        let text = CString::new(scene.to_json()).unwrap();
        // SAFETY: every handle is live until the end, every array as long as said
        unsafe {
            let (mut model, mut sim, mut state) = (null_mut(), null_mut(), null_mut());
            assert_eq!(stickslip_model_compile(text.as_ptr(), &mut model), 0);
            assert_eq!(stickslip_new(model, &mut sim), 0);
            assert_eq!(stickslip_state_new(sim, &mut state), 0);
            assert_eq!(stickslip_init(sim, 0.0), 0);
            let mut info = std::mem::zeroed();
            assert_eq!(stickslip_model_get_info(model, &mut info), 0);
            let mut outputs = vec![0.0; info.outputs];
            let mut bytes = vec![0; info.state_bytes];
            let k = info.largest_step;
            let mut time = 0.0;
            let mut allocations = 0;
            let mut port: stickslip_port = std::mem::zeroed();
            let name = c"contact.friction.a".as_ptr();
            assert_eq!(stickslip_model_find_port(model, name, &mut port), 0);
            let pair = [port.reference, port.reference + 1];
            for n in 0..40 {
                let before = COUNT.get();
                let load = -0.3 - 0.002 * f64::from(n);
                assert_eq!(stickslip_save_state(sim, state), 0);
                assert_eq!(stickslip_set_inputs(sim, &load, 1), 0);
                let bounds = [3e-3 - 1e-5 * f64::from(n), 1e-3 - 1e-5 * f64::from(n)];
                let (to, from) = (pair.as_ptr(), bounds.as_ptr());
                assert_eq!(stickslip_set_many(sim, to, from, 2), 0);
                assert_eq!(stickslip_do_step(sim, time, k), 0);
                assert_eq!(
                    stickslip_get_outputs(sim, outputs.as_mut_ptr(), outputs.len()),
                    0
                );
                assert_eq!(
                    stickslip_get(sim, 1, outputs.as_mut_ptr(), info.contact_nodes),
                    0
                );
                assert_eq!(stickslip_restore_state(sim, state), 0);
                assert_eq!(stickslip_do_step(sim, time, k), 0);
                let mut length = 0;
                let (to, capacity) = (bytes.as_mut_ptr(), bytes.len());
                assert_eq!(stickslip_serialize(sim, to, capacity, &mut length), 0);
                assert_eq!(stickslip_get_time(sim, &mut time), 0);
                // the first steps factor
                if n >= 2 {
                    allocations += COUNT.get() - before;
                }
            }
            assert_eq!(allocations, 0, "{model_kind} {scheme}");
            stickslip_state_free(state);
            stickslip_free(sim);
            stickslip_model_free(model);
        }
    }
}
