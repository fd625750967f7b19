//! Damaged models with right checksums and fingerprints: refused, or stepped without a panic; a state of a damaged model
//! that is accepted is finite.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::{Arc, LazyLock};
use stickslip::{Error, Model, Simulator};
use stickslip_fuzz::{Input, check_outputs, damage, exercise, models, seal};

static MODELS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| models().iter().map(|model| model.to_bytes()).collect());

fuzz_target!(|data: &[u8]| {
    let mut input = Input(data);
    let number = usize::from(input.byte());
    let mut bytes = MODELS[number % MODELS.len()].clone();
    let load = input.number();
    damage(&mut bytes, &mut input);
    seal(&mut bytes);
    let mut loaded = Model::from_bytes(&bytes);
    if let Err(Error::Fingerprint { found, .. }) = loaded {
        bytes[16..24].copy_from_slice(&found.to_le_bytes());
        seal(&mut bytes);
        loaded = Model::from_bytes(&bytes);
    }
    let Ok(model) = loaded else { return };
    assert!(model.largest_step() > 0.0);
    let mut simulator = Simulator::new(Arc::new(model));
    if simulator.init(0.0).is_ok() {
        check_outputs(&simulator);
        let mut before = simulator.new_state();
        exercise(&mut simulator, &[load], number >= 128, &mut before);
    }
});
