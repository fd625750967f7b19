//! What the fuzz targets share: small models, damage to bytes with the checksum made right again, and the invariants.

pub mod words;

use std::sync::Arc;
use stickslip::{Model, Scene, Simulator, State, compile};
use xxhash_rust::xxh3::xxh3_64;

/// Smallest scenes of all models, schemes and dimensions, so that a step costs microseconds: paths and values put into embedded
/// ones.
const SCENES: [(&str, &[(&str, &str)]); 6] = [
    ("kazmi2014", &[("mesh.cells", "[2, 1]")]),
    ("kazmi2014", &[("mesh.cells", "[2, 1]"), ("fidelity.model", "condensed"), ("time.error_estimate", "true"), ("history.capacity", "3")]),
    ("kazmi2014", &[("mesh.cells", "[1, 1]"), ("fidelity.model", "full"), ("element", "p2"), ("time.scheme", "backward_euler")]),
    ("brake_pad_3d", &[("mesh.cells", "[1, 1, 1]"), ("fidelity.model", "reduced")]),
    ("seal", &[("mesh.cells", "[1, 2]"), ("fidelity.model", "condensed"), ("time.tolerance", "1e-3")]),
    ("sheared_column", &[("mesh.cells", "[1, 3]"), ("fidelity.multiplicity_test", "true"), ("fidelity.model", "full")]),
];

/// Smallest scenes of what the embedded ones do not have: contact that opens and moves, laws with a state, memory, several contacts,
/// laws of the body that are not linear.
pub const TEXTS: [(&str, &str); 6] = [
    ("opens", include_str!("../scenes/opens.json")),
    ("creeps", include_str!("../scenes/creeps.json")),
    ("two_feet", include_str!("../scenes/two_feet.json")),
    ("bends", include_str!("../scenes/bends.json")),
    ("solid", include_str!("../scenes/solid.json")),
    ("formula", include_str!("../scenes/formula.json")),
];

/// A scene with values put into it.
pub fn scene(text: &str, name: &str, overrides: &[(&str, &str)]) -> Scene {
    let overrides: Vec<_> = overrides.iter().map(|(p, v)| (p.to_string(), v.to_string())).collect();
    Scene::with_overrides(text, name, &overrides).expect("a valid scene")
}

/// The small models.
pub fn models() -> Vec<Arc<Model>> {
    let embedded = SCENES.iter().map(|(name, overrides)| {
        let text = stickslip::scene::example(name).expect("an embedded scene");
        scene(text, name, overrides)
    });
    let own = TEXTS.iter().map(|(name, text)| scene(text, name, &[]));
    embedded.chain(own).map(|scene| compile(&scene).expect("a scene that compiles")).collect()
}

/// Makes the checksum at the end of framed bytes that of what stands before it, and the announced length the true one.
pub fn seal(bytes: &mut [u8]) {
    let n = bytes.len();
    if n < 40 {
        return;
    }
    bytes[24..32].copy_from_slice(&((n - 40) as u64).to_le_bytes());
    let checksum = xxh3_64(&bytes[..n - 8]);
    bytes[n - 8..].copy_from_slice(&checksum.to_le_bytes());
}

/// Reads numbers off the input; zeros when it is used up.
pub struct Input<'a>(pub &'a [u8]);

impl Input<'_> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    pub fn word(&mut self) -> u64 {
        (0..8).fold(0, |word, i| word | u64::from(self.byte()) << (8 * i))
    }

    pub fn short(&mut self) -> usize {
        usize::from(self.byte()) | usize::from(self.byte()) << 8
    }

    /// A number of any kind: ordinary, at an edge, or any 64 bits.
    pub fn number(&mut self) -> f64 {
        const EDGES: [f64; 18] = [
            0.0, -0.0, 1.0, -1.0, 0.3, -0.3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, 1e-9, 1e9, 1e150,
            1e-150, 1e300,
        ];
        match self.byte() {
            kind @ 0..128 => f64::from(kind) / 64.0 - 1.0,
            kind @ 128..192 => EDGES[usize::from(kind) % EDGES.len()],
            192..224 => 10f64.powi(i32::from(self.byte() as i8)),
            _ => f64::from_bits(self.word()),
        }
    }
}

/// Changes `bytes` as the input says: words overwritten by words, numbers or small counts, pieces cut out, doubled.
pub fn damage(bytes: &mut Vec<u8>, input: &mut Input) {
    while !input.is_empty() {
        let kind = input.byte() % 8;
        let words = bytes.len() / 8;
        let at = 8 * ((input.short() | usize::from(input.byte()) << 16) % words.max(1));
        let word = match kind {
            0 | 1 => input.number().to_bits(),
            2 => input.word(),
            3 => u64::from(input.byte()),
            4 => {
                let bit = u32::from(input.byte() % 64);
                let old = bytes.get(at..at + 8).map_or(0, |w| u64::from_le_bytes(w.try_into().expect("eight bytes")));
                old ^ 1 << bit
            }
            5 => {
                bytes.truncate(at);
                continue;
            }
            6 => {
                let piece: Vec<u8> = bytes[at.min(bytes.len())..].iter().copied().take(usize::from(input.byte())).collect();
                bytes.extend(piece);
                continue;
            }
            _ => {
                // a byte, as text needs it
                let offset = at + usize::from(input.byte() % 8);
                let value = input.byte();
                if let Some(byte) = bytes.get_mut(offset) {
                    *byte = value;
                }
                continue;
            }
        };
        if let Some(place) = bytes.get_mut(at..at + 8) {
            place.copy_from_slice(&word.to_le_bytes());
        }
    }
}

/// All outputs are finite.
pub fn check_outputs(simulator: &Simulator) {
    let mut values = vec![0.0; simulator.output_len()];
    simulator.get_outputs(&mut values).expect("the length asked for");
    if let Some(at) = values.iter().position(|v| !v.is_finite()) {
        let ports: Vec<&str> = simulator.model().ports().outputs().flat_map(|p| std::iter::repeat_n(p.name.as_str(), p.len())).collect();
        panic!("{} is {} with every call OK", ports[at], values[at]);
    }
}

/// A step with the loads put on, and if `twice` another with the loads taken off; a refused one changes nothing, an accepted one
/// leaves finite outputs. `before` is room for what the state was.
pub fn exercise(simulator: &mut Simulator, loads: &[f64], twice: bool, before: &mut State) {
    let step = simulator.model().largest_step();
    for share in if twice { &[1.0, 0.0][..] } else { &[1.0] } {
        simulator.save(before).expect("a state of the model");
        let values: Vec<f64> = loads.iter().cycle().take(simulator.model().input_count()).map(|x| x * share).collect();
        if !loads.is_empty() && simulator.set_inputs(&values).is_err() {
            assert_unchanged(simulator, before, "refused inputs changed the state");
            continue;
        }
        simulator.save(before).expect("a state of the model");
        match simulator.do_step(simulator.time(), step) {
            Ok(()) => check_outputs(simulator),
            Err(_) => assert_unchanged(simulator, before, "a refused step changed the state"),
        }
    }
}

/// The bytes are those of the state saved before. A copy in memory is cheap, so bytes are written only after a refusal.
pub fn assert_unchanged(simulator: &mut Simulator, before: &State, complaint: &str) {
    let found = simulator.to_bytes();
    simulator.restore(before).expect("a state of the model");
    assert!(simulator.to_bytes() == found, "{complaint}");
}
