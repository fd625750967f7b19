//! Compiled models as bytes: the same model bit for bit, and nothing else.

mod common;

use common::{paper, started, steps};
use proptest::prelude::*;
use std::sync::Arc;
use stickslip::{Model, Scene, compile};

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
        let compiled = compile(&scene).unwrap();
        let bytes = compiled.to_bytes();
        let loaded = Model::from_bytes(&bytes).unwrap();
        assert_eq!(loaded.fingerprint(), compiled.fingerprint());
        assert_eq!(loaded.ports(), compiled.ports());
        assert_eq!(loaded.contact(), compiled.contact());
        assert_eq!(loaded.certificate(), compiled.certificate());
        assert_eq!(loaded.summary(), compiled.summary());
        assert!(loaded.to_bytes() == bytes);
        assert_eq!(
            compile(&scene).unwrap().fingerprint(),
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// Bytes whose checksum is right but whose content is not: refused or a model, never a panic.
    #[test]
    fn forged_bytes_never_panic(word in 4_usize..4000, value: u64, kind in 0_usize..3) {
        let scene = &paper(4, &[("fidelity.model", ["reduced", "condensed", "full"][kind])]);
        let mut bytes = compile(scene).unwrap().to_bytes();
        let end = bytes.len() - 8;
        let at = 32 + (word * 8) % (end - 32);
        let at = at.min(end - 8);
        for value in [value, value % 64, u64::MAX] {
            bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            let payload = xxhash_rust::xxh3::xxh3_64(&bytes[32..end]);
            bytes[16..24].copy_from_slice(&payload.to_le_bytes());
            let checksum = xxhash_rust::xxh3::xxh3_64(&bytes[..end]);
            bytes[end..].copy_from_slice(&checksum.to_le_bytes());
            let _ = Model::from_bytes(&bytes);
        }
    }
}
