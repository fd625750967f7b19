//! Calls through the C interface in any order, with any lengths and numbers: a code, never a panic; nothing changes in a
//! refused call; outputs of accepted steps are finite.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::ptr::{null, null_mut};
use std::sync::LazyLock;
use stickslip::capi::*;
use std::sync::atomic::{AtomicPtr, Ordering};
use stickslip_fuzz::{Input, models};

/// The models, loaded once; simulators share them.
static MODELS: LazyLock<Vec<AtomicPtr<stickslip_model>>> = LazyLock::new(|| {
    let load = |bytes: Vec<u8>| {
        let mut model = null_mut();
        assert_eq!(unsafe { stickslip_model_load(bytes.as_ptr(), bytes.len(), &mut model) }, STICKSLIP_OK);
        AtomicPtr::new(model)
    };
    models().iter().map(|model| load(model.to_bytes())).collect()
});

/// Most calls of an input.
const MOST_CALLS: usize = 16;
/// Most largest steps that one call asks for.
const MOST_STEPS: f64 = 3.0;

/// What no call may answer here: the library has panicked.
const POISONED: i32 = stickslip::ErrorCode::Poisoned as i32;

struct Client {
    info: stickslip_model_info,
    simulator: *mut stickslip_simulator,
    state: *mut stickslip_state,
    /// What the state was before a call.
    before: *mut stickslip_state,
    bytes: Vec<u8>,
}

impl Client {
    fn serialized(&self) -> Vec<u8> {
        let mut length = 0;
        let code = unsafe { stickslip_serialize(self.simulator, null_mut(), 0, &mut length) };
        assert!(code != POISONED && length <= 1 << 20);
        let mut bytes = vec![0; length];
        let code = unsafe { stickslip_serialize(self.simulator, bytes.as_mut_ptr(), length, &mut length) };
        assert_eq!(code, STICKSLIP_OK);
        bytes
    }

    fn outputs_are_finite(&self) {
        let mut values = vec![0.0; self.info.outputs];
        let code = unsafe { stickslip_get_outputs(self.simulator, values.as_mut_ptr(), values.len()) };
        assert_eq!(code, STICKSLIP_OK);
        assert!(values.iter().all(|v| v.is_finite()), "an output is not finite with every call OK");
    }

    fn remember(&self) {
        assert_eq!(unsafe { stickslip_save_state(self.simulator, self.before) }, STICKSLIP_OK);
    }

    /// The bytes are those of the state remembered.
    fn assert_unchanged(&self, complaint: &str) {
        let found = self.serialized();
        assert_eq!(unsafe { stickslip_restore_state(self.simulator, self.before) }, STICKSLIP_OK);
        assert!(self.serialized() == found, "{complaint}");
    }

    /// A call that may change the simulator: refused, it has changed nothing.
    fn change(&self, call: impl FnOnce() -> i32) -> i32 {
        self.remember();
        let code = call();
        assert_ne!(code, POISONED, "a panic");
        if code < 0 {
            self.assert_unchanged("a refused call changed the simulator");
        }
        code
    }

    /// A length: the right one, mostly.
    fn length(input: &mut Input, right: usize) -> usize {
        match input.byte() {
            0..224 => right,
            other => usize::from(other) % 8,
        }
    }

    fn call(&mut self, input: &mut Input) {
        let simulator = self.simulator;
        match input.byte() % 16 {
            0 => {
                let time = if input.byte() < 200 { 0.0 } else { input.number() };
                if self.change(|| unsafe { stickslip_init(simulator, time) }) >= 0 {
                    self.outputs_are_finite();
                }
            }
            1 => {
                self.change(|| unsafe { stickslip_reset(simulator) });
            }
            2 | 3 => {
                let count = Self::length(input, self.info.inputs);
                let values: Vec<f64> = (0..count).map(|_| input.number()).collect();
                let pointer = if input.byte() == 255 { null() } else { values.as_ptr() };
                self.change(|| unsafe { stickslip_set_inputs(simulator, pointer, count) });
            }
            4..=8 => {
                let mut time = 0.0;
                unsafe { stickslip_get_time(simulator, &mut time) };
                if input.byte() > 240 {
                    time = input.number();
                }
                let mut step = self.info.largest_step * f64::from(1 + input.byte() % 2);
                if input.byte() > 240 {
                    // as long as it cannot take long
                    step = input.number().min(MOST_STEPS * self.info.largest_step);
                }
                if self.change(|| unsafe { stickslip_do_step(simulator, time, step) }) >= 0 {
                    self.outputs_are_finite();
                }
            }
            9 => {
                let (reference, value) = (u32::from(input.byte()) % (self.info.ports as u32 + 2), input.number());
                self.change(|| unsafe { stickslip_set(simulator, reference, value) });
            }
            10 => {
                let reference = u32::from(input.byte()) % (self.info.ports as u32 + 2);
                let mut values = vec![0.0; usize::from(input.byte())];
                let code = unsafe { stickslip_get(simulator, reference, values.as_mut_ptr(), values.len()) };
                assert_ne!(code, POISONED);
            }
            11 => {
                let code = if input.byte() % 2 == 0 {
                    unsafe { stickslip_save_state(simulator, self.state) }
                } else {
                    self.change(|| unsafe { stickslip_restore_state(simulator, self.state) })
                };
                assert_ne!(code, POISONED);
            }
            12 => {
                if input.byte() % 2 == 0 {
                    self.bytes = self.serialized();
                } else {
                    let length = Self::length(input, self.bytes.len()).min(self.bytes.len());
                    self.change(|| unsafe { stickslip_deserialize(simulator, self.bytes.as_ptr(), length) });
                }
            }
            13 => {
                let (m, n) = (Self::length(input, self.info.inputs), Self::length(input, self.info.outputs));
                let is_adjoint = input.byte() % 2 == 1;
                let (seeds, results) = if is_adjoint { (n, m) } else { (m, n) };
                let seed: Vec<f64> = (0..seeds).map(|_| input.number()).collect();
                let mut result = vec![0.0; results];
                self.remember();
                let call = if is_adjoint { stickslip_adjoint_derivative } else { stickslip_directional_derivative };
                let code = unsafe { call(simulator, seed.as_ptr(), seeds, result.as_mut_ptr(), results) };
                assert_ne!(code, POISONED, "a panic");
                self.assert_unchanged("a derivative changed the simulator");
                let is_moderate = seed.iter().all(|x| x.abs() < 1e100);
                assert!(code < 0 || !is_moderate || result.iter().all(|v| v.is_finite()), "a derivative is not finite with every call OK");
            }
            14 => {
                let mut copy = null_mut();
                let code = unsafe { stickslip_clone(simulator, &mut copy) };
                assert_eq!(code, STICKSLIP_OK);
                unsafe { stickslip_free(std::mem::replace(&mut self.simulator, copy)) };
            }
            _ => {
                let node = usize::from(input.byte() % 16);
                let mut rows = 0;
                let mut values = vec![0.0; 4096];
                let room = usize::from(input.byte());
                let code = unsafe {
                    stickslip_slip_history(simulator, node, values.as_mut_ptr(), null_mut(), null_mut(), null_mut(), room, &mut rows)
                };
                assert_ne!(code, POISONED);
            }
        }
    }
}

fuzz_target!(|data: &[u8]| {
    let mut input = Input(data);
    let model = MODELS[usize::from(input.byte()) % MODELS.len()].load(Ordering::Relaxed);
    let (mut simulator, mut state, mut before) = (null_mut(), null_mut(), null_mut());
    unsafe {
        assert_eq!(stickslip_new(model, &mut simulator), STICKSLIP_OK);
        assert_eq!(stickslip_state_new(simulator, &mut state), STICKSLIP_OK);
        assert_eq!(stickslip_state_new(simulator, &mut before), STICKSLIP_OK);
        let mut info: stickslip_model_info = std::mem::zeroed();
        assert_eq!(stickslip_model_get_info(model, &mut info), STICKSLIP_OK);
        let mut client = Client { info, simulator, state, before, bytes: Vec::new() };
        for _ in 0..MOST_CALLS {
            if input.is_empty() {
                break;
            }
            client.call(&mut input);
        }
        stickslip_free(client.simulator);
        stickslip_state_free(client.state);
        stickslip_state_free(client.before);
    }
});
