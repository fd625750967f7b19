//! Compiled models as bytes: the same model bit for bit, and nothing else.

mod common;

use common::random::Random;
use common::{paper, started, steps};
use std::sync::Arc;
use stickslip::scene::ExampleFiles;
use stickslip::{Model, Scene, Simulator, compile, compile_from};

fn scenes() -> Vec<Scene> {
    let mut scenes: Vec<Scene> = ["reduced", "condensed", "full"]
        .iter()
        .map(|model| paper(8, &[("fidelity.model", model)]))
        .collect();
    let quadratic = [("element", "p2"), ("mesh.grading", "[2, 2]")];
    scenes.push(paper(8, &quadratic));
    scenes.push(paper(8, &[quadratic[0], ("fidelity.model", "full")]));
    for name in stickslip::scene::example_names().filter(|n| *n != "kazmi2014") {
        let text = stickslip::scene::example(name).unwrap();
        scenes.push(Scene::from_json(text, name).unwrap());
    }
    scenes
}

#[test]
fn a_loaded_model_is_the_compiled_one() {
    for scene in scenes() {
        let compiled = compile_from(&scene, &ExampleFiles).unwrap();
        let bytes = compiled.to_bytes();
        let loaded = Model::from_bytes(&bytes).unwrap();
        assert_eq!(loaded.fingerprint(), compiled.fingerprint());
        assert_eq!(loaded.ports(), compiled.ports());
        assert_eq!(loaded.contact(), compiled.contact());
        assert_eq!(loaded.certificate(), compiled.certificate());
        assert_eq!(loaded.summary(), compiled.summary());
        assert!(loaded.to_bytes() == bytes);
        assert_eq!(
            compile_from(&scene, &ExampleFiles).unwrap().fingerprint(),
            compiled.fingerprint()
        );
        let k = compiled.largest_step();
        let (mut a, mut b) = (started(compiled), started(Arc::new(loaded)));
        steps(&mut a, k, 5);
        steps(&mut b, k, 5);
        assert_eq!(a.state(), b.state());
        // a state travels between the two, but not to another model
        b.restore_bytes(&a.to_bytes()).unwrap();
        let mut other = started(compile(&paper(6, &[])).unwrap());
        assert!(other.restore_bytes(&a.to_bytes()).is_err());
        assert!(other.restore(a.state()).is_err());
    }
}

#[test]
fn every_truncation_and_every_damaged_byte_is_refused() {
    for scene in &scenes()[..3] {
        let bytes = compile(scene).unwrap().to_bytes();
        for at in (0..bytes.len()).step_by(1 + bytes.len() / 2000) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << (at % 8);
            assert!(Model::from_bytes(&damaged).is_err(), "byte {at}");
            assert!(
                Model::from_bytes(&bytes[..at]).is_err(),
                "truncated at {at}"
            );
        }
    }
}

/// Values that a count, an index, a size or a number must not have, or may have by chance.
fn value(random: &mut Random) -> u64 {
    let words = [
        0,
        1,
        2,
        7,
        1 << 20,
        1 << 32,
        1 << 40,
        u64::MAX,
        u64::MAX / 8,
        1 << 63,
    ];
    let numbers = [
        f64::NAN,
        f64::INFINITY,
        -1.0,
        0.0,
        -0.0,
        1e300,
        -1e300,
        1e-300,
        5e-324,
        1e17,
        1.0,
    ];
    match random.below(4) {
        0 => random.one_of(&words),
        1 => random.one_of(&numbers).to_bits(),
        2 => random.word() % 64,
        _ => random.word(),
    }
}

/// Bytes whose checksum and fingerprint are right but whose content is not: refused, or a model that steps to finite numbers or
/// says why not.
#[test]
fn forged_bytes_are_refused_or_step_to_finite_numbers() {
    // after the numbers that the fingerprint covers: no selection, no fallback, digits
    const TAIL: usize = 24;
    let mut random = Random::new(3);
    let (mut refused, mut stepped) = (0, 0);
    for model in ["reduced", "condensed", "full"] {
        let more = [
            ("fidelity.model", model),
            ("history.capacity", "3"),
            ("time.tolerance", "1e-2"),
        ];
        let bytes = compile(&paper(2, &more[..2 + random.below(2)]))
            .unwrap()
            .to_bytes();
        let end = bytes.len() - 8;
        let text = 40 + u64::from_le_bytes(bytes[32..40].try_into().unwrap()) as usize;
        for _ in 0..2500 {
            let mut forged = bytes.clone();
            for _ in 0..1 + random.below(2) {
                if random.happens(0.25) {
                    // a digit of the scene
                    let at = 40 + random.below(text - 40);
                    if forged[at].is_ascii_digit() {
                        forged[at] = b'0' + random.below(10) as u8;
                    }
                } else if random.happens(0.3) {
                    let at = text + random.below(end - text);
                    forged[at] ^= 1 << random.below(8);
                } else {
                    let at = text + 8 * random.below((end - text) / 8);
                    forged[at..at + 8].copy_from_slice(&value(&mut random).to_le_bytes());
                }
            }
            let fingerprint = xxhash_rust::xxh3::xxh3_64(&forged[32..end - TAIL]);
            forged[16..24].copy_from_slice(&fingerprint.to_le_bytes());
            common::reseal(&mut forged);
            let Ok(model) = Model::from_bytes(&forged) else {
                refused += 1;
                continue;
            };
            let mut simulator = Simulator::new(Arc::new(model));
            let step = simulator.model().largest_step();
            let mut go = || {
                simulator.init(0.0)?;
                (0..3).try_for_each(|_| simulator.do_step(simulator.time(), step))
            };
            if go().is_err() {
                continue;
            }
            stepped += 1;
            let ports: Vec<_> = simulator.model().ports().outputs().cloned().collect();
            for port in ports {
                let values = simulator.get_by_name(&port.name).unwrap();
                assert!(
                    values.iter().all(|v| v.is_finite()),
                    "{}: {values:?}",
                    port.name
                );
            }
        }
    }
    assert!(
        refused > 1000 && stepped > 1000,
        "{refused} refused, {stepped} stepped"
    );
}
