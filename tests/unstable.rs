//! The explicit scheme beyond its stability limit: refused when the scene is compiled, whoever compiles it.

mod common;

use common::{paper, started, steps, values};
use stickslip::{Error, ErrorCode, Model, compile};

fn explicit(step: &str, more: &[(&str, &str)]) -> stickslip::Scene {
    let all = [&[("time.scheme", "rectangle"), ("time.step", step)], more].concat();
    paper(4, &all)
}

#[test]
fn a_step_beyond_the_limit_is_refused_by_every_model_with_both_numbers() {
    // k r < 2 for the fastest rate of the material, 14.56 1/s
    for model in ["full", "condensed", "reduced", "auto"] {
        let model = [("fidelity.model", model)];
        match compile(&explicit("1.0", &model)).err() {
            Some(Error::Unstable { step, limit }) => {
                assert_eq!(step, 1.0);
                assert!((limit - 2.0 / 14.560_439_56).abs() < 1e-6, "{limit}");
            }
            other => panic!("{other:?}"),
        }
        assert!(compile(&explicit("0.138", &model)).is_err());
        assert!(compile(&explicit("0.137", &model)).is_ok());
    }
    let error = compile(&explicit("1.0", &[])).err().unwrap();
    assert_eq!(error.code(), ErrorCode::Unstable);
    assert!(error.to_string().contains("time.force"), "{error}");
}

#[test]
fn implicit_schemes_have_no_limit() {
    for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
        assert!(compile(&paper(4, &[("time.scheme", scheme), ("time.step", "1e3")])).is_ok());
    }
}

#[test]
fn a_scene_may_insist_and_its_model_travels_as_bytes() {
    let scene = explicit("0.25", &[("time.force", "true")]);
    let model = compile(&scene).unwrap();
    let loaded = Model::from_bytes(&model.to_bytes()).unwrap();
    assert!(loaded.scene().time.force);
    assert_eq!(loaded.fingerprint(), model.fingerprint());
    let mut simulator = started(model);
    steps(&mut simulator, 0.25, 60);
    let grown = common::largest(&values(&simulator, "contact.slip"));
    assert!(grown > 1e3, "{grown}");
    // a scene that does not say so reads and writes as it did
    assert!(!explicit("0.1", &[]).to_json().contains("force"));
}
