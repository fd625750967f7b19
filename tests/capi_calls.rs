//! Random sequences of calls over the C interface, NULLs, wrong sizes, numbers that are none and handles of the wrong kind
//! included: no call crashes, a refused call changes nothing and writes nothing.
//!
//! The number of sequences is `STICKSLIP_SEQUENCES` (default 2000). The simulators are those of a small scene, and live
//! on from sequence to sequence, so that a long run meets ever new states.
#![cfg(feature = "capi")]
#![allow(unsafe_code)]

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::ffi::CString;
use std::ptr::{null, null_mut};
use stickslip::capi::*;

/// One call. `simulator` and `state` choose among the handles (beyond them: NULL), `count` is taken modulo a few sizes
/// around the right one.
#[derive(Debug, Clone)]
struct Call {
    what: u8,
    simulator: u8,
    state: u8,
    count: u8,
    value: f64,
    is_null: bool,
}

fn call() -> impl Strategy<Value = Call> {
    let value = prop_oneof![
        6 => -0.5..0.5_f64,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(0.0),
        1 => any::<f64>(),
    ];
    (
        0..31_u8,
        0..5_u8,
        0..4_u8,
        0..8_u8,
        value,
        prop::bool::weighted(0.05),
    )
        .prop_map(|(what, simulator, state, count, value, is_null)| Call {
            what,
            simulator,
            state,
            count,
            value,
            is_null,
        })
}

struct World {
    model: *mut stickslip_model,
    simulators: [*mut stickslip_simulator; 4],
    states: [*mut stickslip_state; 3],
    info: stickslip_model_info,
    bytes: Vec<u8>,
    buffer: Vec<f64>,
}

const MARK: f64 = 1234.5;

impl World {
    fn new() -> World {
        let scene = |cells: &str| {
            let text = stickslip::scene::example("kazmi2014").unwrap();
            let cells = [("mesh.cells".to_string(), cells.to_string())];
            let scene = stickslip::Scene::with_overrides(text, "x", &cells).unwrap();
            CString::new(scene.to_json()).unwrap()
        };
        // SAFETY: every handle lives as long as the test
        unsafe {
            let (mut model, mut foreign) = (null_mut(), null_mut());
            assert_eq!(
                stickslip_model_compile(scene("[4, 2]").as_ptr(), &mut model),
                0
            );
            assert_eq!(
                stickslip_model_compile(scene("[6, 2]").as_ptr(), &mut foreign),
                0
            );
            let mut simulators = [null_mut(); 4];
            for (i, simulator) in simulators.iter_mut().enumerate() {
                let of = if i == 3 { foreign } else { model };
                assert_eq!(stickslip_new(of, simulator), 0);
            }
            let mut states = [null_mut(); 3];
            for (state, simulator) in states.iter_mut().zip([0, 1, 3]) {
                assert_eq!(stickslip_state_new(simulators[simulator], state), 0);
            }
            stickslip_model_free(foreign);
            let mut info = std::mem::zeroed();
            assert_eq!(stickslip_model_get_info(model, &mut info), 0);
            World {
                model,
                simulators,
                states,
                bytes: vec![0; info.state_bytes],
                buffer: vec![MARK; 4096],
                info,
            }
        }
    }

    fn make(&mut self, call: &Call) -> i32 {
        let sim = *self
            .simulators
            .get(call.simulator as usize)
            .unwrap_or(&null_mut());
        let state = *self.states.get(call.state as usize).unwrap_or(&null_mut());
        let around = |right: usize| {
            [
                right,
                right,
                right,
                right,
                0,
                right + 1,
                right.saturating_sub(1),
                3,
            ][call.count as usize]
        };
        let values = if call.is_null {
            null_mut()
        } else {
            self.buffer.as_mut_ptr()
        };
        let (v, n) = (call.value, u32::from(call.count));
        let mut length = 0_usize;
        // SAFETY: handles are live or NULL, buffers longer than any count passed
        unsafe {
            let mut time = 0.0;
            let now = if stickslip_get_time(sim, &mut time) == 0 {
                time
            } else {
                0.0
            };
            match call.what {
                0 => stickslip_init(sim, v),
                1 => {
                    let inputs = [v; 8];
                    let from = if call.is_null {
                        null()
                    } else {
                        inputs.as_ptr()
                    };
                    stickslip_set_inputs(sim, from, around(1))
                }
                2..=5 => stickslip_do_step(sim, now, v.abs().min(0.1)),
                6 => stickslip_do_step(sim, v, 0.1),
                // accepted, but long: a step of up to a million internal ones
                7 if (1.0..1e6).contains(&v.abs()) => 0,
                7 => stickslip_do_step(sim, now, v),
                8 | 9 => stickslip_get_outputs(sim, values, around(self.info.outputs)),
                10 => stickslip_get(sim, n * 3, values, around(4)),
                11 => stickslip_get(sim, u32::MAX - n, values, around(4)),
                12 => stickslip_set(sim, n * 5, v),
                13 => stickslip_save_state(sim, state),
                14 => stickslip_restore_state(sim, state),
                15 => {
                    let len = around(self.bytes.len());
                    self.bytes.resize(len.max(self.info.state_bytes), 0);
                    let to = if call.is_null {
                        null_mut()
                    } else {
                        self.bytes.as_mut_ptr()
                    };
                    stickslip_serialize(sim, to, len, &mut length)
                }
                16 => {
                    let len = around(self.info.state_bytes).min(self.bytes.len());
                    stickslip_deserialize(sim, self.bytes.as_ptr(), len)
                }
                17 => {
                    let at = (v.to_bits() % self.bytes.len() as u64) as usize;
                    self.bytes[at] ^= 1;
                    let code =
                        stickslip_deserialize(sim, self.bytes.as_ptr(), self.info.state_bytes);
                    self.bytes[at] ^= 1;
                    code
                }
                18 => {
                    let seed = [v; 8];
                    stickslip_directional_derivative(
                        sim,
                        seed.as_ptr(),
                        around(1),
                        values,
                        self.info.outputs,
                    )
                }
                19 => {
                    let seed = vec![v; self.info.outputs + 8];
                    stickslip_adjoint_derivative(
                        sim,
                        seed.as_ptr(),
                        around(self.info.outputs),
                        values,
                        1,
                    )
                }
                20 => {
                    let (rows, node) = (&mut length, call.count as usize);
                    stickslip_slip_history(
                        sim,
                        node,
                        values,
                        null_mut(),
                        values,
                        values,
                        around(16),
                        rows,
                    )
                }
                21 => {
                    let mut copy = null_mut();
                    let code = stickslip_clone(sim, &mut copy);
                    stickslip_free(copy);
                    code
                }
                22 => stickslip_reset(sim),
                // a handle of another kind, and no handle
                23 => {
                    stickslip_init(self.model.cast(), v)
                        + stickslip_model_get_info(sim.cast(), null_mut())
                }
                24 => stickslip_restore_state(sim, sim.cast()),
                25 => {
                    // the last three ports are the coefficients a, b and alpha
                    let a = self.info.ports as u32 - 3;
                    let references = [a + n % 4, a + 1, 0];
                    let values = [v, 0.5 * v, v];
                    let from = if call.is_null {
                        null()
                    } else {
                        values.as_ptr()
                    };
                    stickslip_set_many(sim, references.as_ptr(), from, around(2).min(3))
                }
                30 => {
                    let references = [self.info.ports as u32 - 3 + n % 4, 0, n];
                    let values = [v, 0.5 * v, v];
                    let (to, from) = (references.as_ptr(), values.as_ptr());
                    let from = if call.is_null { null() } else { from };
                    stickslip_set_values(sim, to, around(2).min(3), from, around(2).min(3))
                }
                26 => stickslip_set_inputs_meaning(sim, n as i32 - 1),
                27 => stickslip_set_input_slope(sim, n % 3, v),
                28 => stickslip_clear_input_slope(sim, n),
                _ => {
                    let mut port = std::mem::zeroed();
                    stickslip_model_get_port(self.model, n * 7, &mut port)
                }
            }
        }
    }

    fn snapshot(&self) -> Vec<Vec<u8>> {
        let bytes = |simulator: &*mut stickslip_simulator| {
            let mut length = 0;
            // SAFETY: live handles, a buffer as long as said
            unsafe {
                assert_eq!(
                    stickslip_serialize(*simulator, null_mut(), 0, &mut length),
                    0
                );
                let mut bytes = vec![0; length];
                assert_eq!(
                    stickslip_serialize(*simulator, bytes.as_mut_ptr(), length, &mut length),
                    0
                );
                bytes
            }
        };
        self.simulators.iter().map(bytes).collect()
    }
}

#[test]
fn no_sequence_of_calls_crashes_and_a_refused_call_changes_nothing() {
    let asked = std::env::var("STICKSLIP_SEQUENCES")
        .ok()
        .and_then(|n| n.parse().ok());
    let mut world = World::new();
    let mut codes = std::collections::BTreeMap::new();
    let config = Config {
        cases: asked.unwrap_or(2000),
        failure_persistence: None,
        ..Config::default()
    };
    let mut runner = TestRunner::new(config);
    let cell = std::cell::RefCell::new((&mut world, &mut codes));
    runner
        .run(&prop::collection::vec(call(), 1..12), |calls| {
            let (world, codes) = &mut *cell.borrow_mut();
            for call in &calls {
                let before = world.snapshot();
                world.buffer.fill(MARK);
                let code = world.make(call);
                *codes.entry(code).or_insert(0_u64) += 1;
                prop_assert!((-30..=1).contains(&code), "code {}", code);
                if code < 0 {
                    prop_assert!(
                        world.snapshot() == before,
                        "{:?} changed a state: {}",
                        call,
                        code
                    );
                    prop_assert!(
                        world.buffer.iter().all(|v| *v == MARK),
                        "{:?} wrote: {}",
                        call,
                        code
                    );
                }
            }
            Ok(())
        })
        .unwrap();
    println!("{codes:?}");
    assert!(!codes.contains_key(&-15), "a panic was caught");
    assert!(codes.len() > 6, "{codes:?}");
}
