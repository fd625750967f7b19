//! A restored simulation and the original stay bit-identical.
#![cfg(feature = "capi")]
#![allow(unsafe_code)]

use std::ffi::CString;
use std::ptr::null_mut;
use stickslip::capi::*;

/// Step sizes and loads that change from step to step.
fn step_of(n: u32) -> (f64, f64) {
    let h = 0.03125 * [1.0, 0.5, 2.7, 0.01, 1.3, 0.25][(n as usize * 7 + n as usize / 11) % 6];
    (h, -0.3 + 0.2 * f64::from(n).sin())
}

#[test]
fn restored_deserialized_and_cloned_runs_stay_in_lockstep_for_1000_steps() {
    for meaning in [
        STICKSLIP_INPUTS_END_OF_STEP,
        STICKSLIP_INPUTS_HOLD,
        STICKSLIP_INPUTS_CONTINUE,
    ] {
        run_in_lockstep(meaning);
    }
}

fn run_in_lockstep(meaning: i32) {
    let text = CString::new(stickslip::scene::example("kazmi2014").unwrap()).unwrap();
    // SAFETY: handles are live until the end, arrays as long as said
    unsafe {
        let mut model = null_mut();
        assert_eq!(stickslip_model_compile(text.as_ptr(), &mut model), 0);
        let mut info = std::mem::zeroed();
        assert_eq!(stickslip_model_get_info(model, &mut info), 0);
        let mut sims = [null_mut(); 4];
        for sim in &mut sims[..3] {
            assert_eq!(stickslip_new(model, sim), 0);
        }
        // the others take the meaning of inputs from the state
        assert_eq!(stickslip_set_inputs_meaning(sims[0], meaning), 0);
        for sim in &sims[..3] {
            assert_eq!(stickslip_init(*sim, 0.0), 0);
        }
        assert!(stickslip_set_inputs_meaning(sims[0], meaning) < 0);
        let step = |sim: *mut stickslip_simulator, n| {
            let (h, load) = step_of(n);
            let mut time = 0.0;
            assert_eq!(stickslip_get_time(sim, &mut time), 0);
            assert_eq!(stickslip_set_inputs(sim, &load, 1), 0);
            assert_eq!(stickslip_do_step(sim, time, h), 0);
        };
        for n in 0..20 {
            step(sims[0], n);
        }
        let mut state = null_mut();
        assert_eq!(stickslip_state_new(sims[0], &mut state), 0);
        assert_eq!(stickslip_save_state(sims[0], state), 0);
        let bytes_of = |sim: *mut stickslip_simulator| {
            let mut bytes = vec![0; info.state_bytes];
            let mut length = 0;
            assert_eq!(
                stickslip_serialize(sim, bytes.as_mut_ptr(), bytes.len(), &mut length),
                0
            );
            assert_eq!(length, bytes.len());
            bytes
        };
        let bytes = bytes_of(sims[0]);
        assert_eq!(stickslip_restore_state(sims[1], state), 0);
        assert_eq!(
            stickslip_deserialize(sims[2], bytes.as_ptr(), bytes.len()),
            0
        );
        assert_eq!(stickslip_clone(sims[0], &mut sims[3]), 0);
        for n in 20..1020 {
            for sim in sims {
                step(sim, n);
            }
            // detours that are rolled back leave no trace
            if n % 3 == 0 {
                assert_eq!(stickslip_save_state(sims[1], state), 0);
                step(sims[1], n + 5);
                step(sims[1], n + 9);
                assert_eq!(stickslip_restore_state(sims[1], state), 0);
            }
            let expected = bytes_of(sims[0]);
            for sim in &sims[1..] {
                assert!(bytes_of(*sim) == expected, "step {n}");
            }
        }
        // any damage is refused and changes nothing
        for at in (0..bytes.len())
            .step_by(97)
            .chain([0, 8, 16, bytes.len() - 1])
        {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            let before = bytes_of(sims[0]);
            assert!(stickslip_deserialize(sims[0], damaged.as_ptr(), damaged.len()) < 0);
            assert!(stickslip_deserialize(sims[0], bytes.as_ptr(), at) < 0);
            assert!(bytes_of(sims[0]) == before);
        }
        stickslip_state_free(state);
        for sim in sims {
            stickslip_free(sim);
        }
        stickslip_model_free(model);
    }
}
