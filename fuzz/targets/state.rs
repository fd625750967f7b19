//! Damaged states with right checksums: refused, or continued with finite outputs.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::cell::RefCell;
use std::sync::Arc;
use stickslip::{Model, Simulator, State};
use stickslip_fuzz::{Input, assert_unchanged, check_outputs, damage, exercise, models, seal};

/// A simulator that is restored before every input, with its state after two steps and the bytes of it.
struct Start {
    simulator: Simulator,
    state: State,
    before: State,
    bytes: Vec<u8>,
}

impl Start {
    fn of(model: Arc<Model>) -> Start {
        let mut simulator = Simulator::new(model);
        simulator.init(0.0).expect("a start");
        let mut before = simulator.new_state();
        exercise(&mut simulator, &[-0.3, 0.1], true, &mut before);
        let mut state = simulator.new_state();
        simulator.save(&mut state).expect("a state of the model");
        let bytes = simulator.to_bytes();
        Start { simulator, state, before, bytes }
    }
}

thread_local! {
    static STARTS: RefCell<Vec<Start>> = RefCell::new(models().into_iter().map(Start::of).collect());
}

fuzz_target!(|data: &[u8]| {
    let mut input = Input(data);
    STARTS.with_borrow_mut(|starts| {
        let number = usize::from(input.byte());
        let count = starts.len();
        let Start { simulator, state, before, bytes } = &mut starts[number % count];
        let load = input.number();
        let mut damaged = bytes.clone();
        damage(&mut damaged, &mut input);
        seal(&mut damaged);
        simulator.restore(state).expect("a state of the model");
        if simulator.restore_bytes(&damaged).is_err() {
            assert_unchanged(simulator, state, "a refused state changed the simulator");
            return;
        }
        check_outputs(simulator);
        exercise(simulator, &[load], number >= 128, before);
    });
});
