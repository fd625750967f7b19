//! Damaged states with right checksums: refused, or continued with finite outputs.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::{Arc, LazyLock};
use stickslip::{Model, Simulator};
use stickslip_fuzz::{Input, check_outputs, damage, exercise, models, seal};

/// Models with the bytes of a state after two steps.
static STARTS: LazyLock<Vec<(Arc<Model>, Vec<u8>)>> = LazyLock::new(|| {
    let start = |model: Arc<Model>| {
        let mut simulator = Simulator::new(Arc::clone(&model));
        simulator.init(0.0).expect("a start");
        exercise(&mut simulator, &[-0.3, 0.1]);
        (model, simulator.to_bytes())
    };
    models().into_iter().map(start).collect()
});

fuzz_target!(|data: &[u8]| {
    let mut input = Input(data);
    let (model, bytes) = &STARTS[usize::from(input.byte()) % STARTS.len()];
    let load = input.number();
    let mut bytes = bytes.clone();
    damage(&mut bytes, &mut input);
    seal(&mut bytes);
    let mut simulator = Simulator::new(Arc::clone(model));
    let before = simulator.to_bytes();
    if simulator.restore_bytes(&bytes).is_err() {
        assert!(simulator.to_bytes() == before, "a refused state changed the simulator");
        return;
    }
    check_outputs(&simulator);
    exercise(&mut simulator, &[load]);
});
