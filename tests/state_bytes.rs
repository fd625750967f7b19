//! Bytes of states that another program has written, with a valid checksum: they are refused, or what follows is finite or
//! an error; nothing panics, nothing hangs, nothing is lost.
//!
//! The number of mutations per model is `STICKSLIP_MUTATIONS` (default 2000).

mod common;

use common::paper;
use std::sync::Arc;
use stickslip::{Error, ErrorCode, Model, Scene, Simulator, compile};
use xxhash_rust::xxh3::xxh3_64;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }
}

/// Magic, format, fingerprint and length come before the words of the state; the checksum comes after them.
const HEADER: usize = 32;
/// Words of counters: time, steps, recorded, initialized, to be settled.
const COUNTERS: usize = 5;

fn sealed(bytes: &[u8]) -> Vec<u8> {
    let end = bytes.len() - 8;
    let mut out = bytes.to_vec();
    let checksum = xxh3_64(&out[..end]);
    out[end..].copy_from_slice(&checksum.to_le_bytes());
    out
}

fn with_word(bytes: &[u8], word: usize, value: u64) -> Vec<u8> {
    let mut out = bytes.to_vec();
    out[HEADER + 8 * word..][..8].copy_from_slice(&value.to_le_bytes());
    sealed(&out)
}

fn word(bytes: &[u8], word: usize) -> u64 {
    u64::from_le_bytes(bytes[HEADER + 8 * word..][..8].try_into().unwrap())
}

fn outputs(simulator: &Simulator) -> Vec<f64> {
    let mut out = vec![0.0; simulator.output_len()];
    simulator.get_outputs(&mut out).unwrap();
    out
}

fn is_finite(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_finite())
}

/// Offers bytes to a simulator and, where they are taken, goes on from them. Whether they were taken.
fn offer(simulator: &mut Simulator, bytes: &[u8], what: &str) -> bool {
    let before = simulator.to_bytes();
    if let Err(error) = simulator.restore_bytes(bytes) {
        assert_eq!(error.code(), ErrorCode::Bytes, "{what}: {error}");
        assert!(simulator.to_bytes() == before, "{what} changed the state");
        return false;
    }
    assert!(is_finite(&outputs(simulator)), "{what}: outputs");
    for past in simulator.slip_history(0).unwrap() {
        assert!(
            past.time.is_finite() && is_finite(past.slip_rate) && is_finite(past.slip),
            "{what}: past"
        );
    }
    let check = |simulator: &Simulator, kept: &[u8], result: &Result<(), Error>| {
        assert!(is_finite(&outputs(simulator)), "{what}: {result:?}");
        assert!(
            result.is_ok() || simulator.to_bytes() == kept,
            "{what}: {result:?} changed the state"
        );
    };
    let kept = simulator.to_bytes();
    let started = simulator.init(0.0);
    check(simulator, &kept, &started);
    for _ in 0..3 {
        let kept = simulator.to_bytes();
        let taken = simulator.do_step(simulator.time(), 0.01);
        check(simulator, &kept, &taken);
        let mut derivative = vec![0.0; simulator.output_len()];
        if taken.is_err() {
            break;
        }
        if simulator
            .directional_derivative(&[1.0], &mut derivative)
            .is_ok()
        {
            assert!(is_finite(&derivative), "{what}: derivative");
        }
    }
    true
}

/// States along a run of the model: before the start, at it, after steps that stick and slip.
fn states(model: &Arc<Model>) -> Vec<Vec<u8>> {
    let mut simulator = Simulator::new(Arc::clone(model));
    let mut all = vec![simulator.to_bytes()];
    simulator.init(0.5).unwrap();
    all.push(simulator.to_bytes());
    for n in 0..24 {
        simulator
            .set_inputs(&[-0.3 + 0.2 * f64::from(n).sin()])
            .unwrap();
        simulator.do_step(simulator.time(), 0.03).unwrap();
        if n % 6 == 5 {
            all.push(simulator.to_bytes());
        }
    }
    all
}

fn models() -> Vec<Arc<Model>> {
    let of = |changes: &[(&str, &str)]| compile(&paper(6, changes)).unwrap();
    let text = stickslip::scene::example("brake_pad_3d").unwrap();
    let changes = [
        ("mesh.cells", "[3,1,2]"),
        (
            "loads",
            r#"[{"name": "drag", "kind": "traction", "part": "left", "direction": [1, 0, 0]}]"#,
        ),
        ("run.signals", "{}"),
    ];
    let changes = changes.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let space = Scene::with_overrides(text, "pad", &changes).unwrap();
    vec![
        of(&[]),
        of(&[("time.error_estimate", "true"), ("history.capacity", "3")]),
        of(&[("time.tolerance", "1e-3"), ("history.capacity", "0")]),
        of(&[("fidelity.model", "full"), ("time.scheme", "tr_bdf2")]),
        of(&[(
            "fidelity.solver",
            r#"{"kind": "fixed_point", "max_iterations": 50}"#,
        )]),
        of(&[("fidelity.multiplicity_test", "true")]),
        compile(&space).unwrap(),
    ]
}

/// Words that are likely to hurt.
const EVIL: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    1e308,
    -1e308,
    1e160,
    1e-310,
    -0.0,
    0.0,
    1.0,
    -1.0,
    1e20,
    -1e-9,
    5e-324,
];

#[test]
fn mutated_states_are_refused_or_stay_finite() {
    let asked = std::env::var("STICKSLIP_MUTATIONS").ok();
    let count: usize = asked.and_then(|n| n.parse().ok()).unwrap_or(2000);
    let mut random = Random(14);
    let (mut taken, mut refused) = (0_u64, 0_u64);
    for (number, model) in models().iter().enumerate() {
        let states = states(model);
        let mut simulator = Simulator::new(Arc::clone(model));
        for i in 0..count {
            let mut bytes = states[random.below(states.len())].clone();
            let words = (bytes.len() - HEADER - 8) / 8;
            for _ in 0..1 + random.below(3) {
                let at = match random.below(4) {
                    0 => random.below(COUNTERS),
                    _ => random.below(words),
                };
                let value = match random.below(4) {
                    0 => word(&bytes, at) ^ 1 << random.below(64),
                    1 => random.next(),
                    2 => random.next() >> random.below(64),
                    _ => EVIL[random.below(EVIL.len())].to_bits(),
                };
                bytes = with_word(&bytes, at, value);
            }
            match offer(
                &mut simulator,
                &bytes,
                &format!("model {number}, mutation {i}"),
            ) {
                true => taken += 1,
                false => refused += 1,
            }
        }
    }
    println!("{taken} taken, {refused} refused");
    assert!(
        taken > 1000 && refused > 1000,
        "{taken} taken, {refused} refused"
    );
}

/// A number that is none is refused wherever it stands, and so are counters that fit nothing.
#[test]
fn numbers_that_are_none_are_refused_everywhere() {
    for model in models() {
        let states = states(&model);
        let mut simulator = Simulator::new(Arc::clone(&model));
        for bytes in &states {
            simulator.restore_bytes(bytes).unwrap();
            let words = (bytes.len() - HEADER - 8) / 8;
            for at in (0..1).chain(COUNTERS..words) {
                for value in [f64::NAN, f64::NEG_INFINITY] {
                    let changed = with_word(bytes, at, value.to_bits());
                    let error = simulator.restore_bytes(&changed).unwrap_err();
                    assert_eq!(error.code(), ErrorCode::Bytes, "word {at}");
                }
            }
            let is_initialized = word(bytes, 3);
            for (at, value) in [
                (1, u64::MAX),
                (1, word(bytes, 1) + 1),
                (2, word(bytes, 2) + 1),
                (3, 1 - is_initialized),
                (3, 2),
                (4, 2),
                (4, u64::MAX),
            ] {
                // without a recorded past its counter stays 0, and the steps fit any
                let is_free = model.history_capacity() == 0 && at == 1 && value != u64::MAX;
                let outcome = simulator.restore_bytes(&with_word(bytes, at, value));
                if !is_free || is_initialized == 0 {
                    let fits = at == 3 && value == 1 && outcome.is_ok();
                    assert!(outcome.is_err() || fits, "counter {at} = {value}");
                }
                simulator.restore_bytes(bytes).unwrap();
            }
            assert!(simulator.to_bytes() == *bytes);
        }
    }
}

/// A proposed step size of zero would stay zero, and every step take a billion of the smallest ones.
#[test]
fn a_proposed_step_size_out_of_range_is_refused() {
    let model = compile(&paper(4, &[("time.tolerance", "1e-3")])).unwrap();
    let bytes = states(&model).pop().unwrap();
    let words = (bytes.len() - HEADER - 8) / 8;
    let mut simulator = Simulator::new(model);
    for (value, most) in [(0.0_f64, 1), (1e3, words)] {
        let refused = (COUNTERS..words).filter(|at| {
            let outcome = simulator.restore_bytes(&with_word(&bytes, *at, value.to_bits()));
            outcome.is_err_and(|error| error.to_string().contains("proposed step size"))
        });
        let count = refused.count();
        assert!((1..=most).contains(&count), "{value}: {count}");
    }
}

/// Finite but absurd: the next step ends in an error, and what is read before it is finite.
#[test]
fn absurd_states_end_in_an_error() {
    let model = compile(&paper(6, &[])).unwrap();
    let bytes = states(&model).pop().unwrap();
    let words = (bytes.len() - HEADER - 8) / 8;
    let mut simulator = Simulator::new(model);
    let mut errors = 0;
    for at in COUNTERS..words {
        for value in [1e308_f64, -1e308] {
            let changed = with_word(&bytes, at, value.to_bits());
            if simulator.restore_bytes(&changed).is_err() {
                errors += 1;
                continue;
            }
            assert!(is_finite(&outputs(&simulator)), "word {at}");
            errors += u64::from(simulator.do_step(simulator.time(), 0.01).is_err());
            assert!(is_finite(&outputs(&simulator)), "word {at} after a step");
        }
    }
    assert!(errors > 50, "{errors}");
}
