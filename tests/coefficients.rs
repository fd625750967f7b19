//! Friction coefficients are a set: set in any order, checked when the set is complete, refused with nothing changed.

mod common;

use common::{paper, started};
use serde_json::json;
use std::sync::Arc;
use stickslip::{Error, Simulator, compile};

/// The pairs of values to set, in their two orders: both below the old ones (a = 0.003, b = 0.001), both above, one on either
/// side. Whatever comes first, one of the orders passes through a < b.
const PAIRS: [(f64, f64); 3] = [(5e-4, 2e-4), (0.02, 0.01), (0.0015, 5e-4)];

fn reference(simulator: &Simulator, name: &str) -> u32 {
    let name = format!("contact.friction.{name}");
    simulator.model().ports().find(&name).unwrap().reference
}

fn outputs(simulator: &Simulator) -> Vec<u64> {
    let mut out = vec![0.0; simulator.output_len()];
    simulator.get_outputs(&mut out).unwrap();
    out.iter().map(|v| v.to_bits()).collect()
}

fn step(simulator: &mut Simulator) -> Result<(), Error> {
    simulator.do_step(simulator.time(), 1.0 / 32.0)
}

/// Sets a pair one by one, `a` first or last, or with one call.
fn set_pair(simulator: &mut Simulator, (a, b): (f64, f64), order: usize) {
    let (ref_a, ref_b) = (reference(simulator, "a"), reference(simulator, "b"));
    match order {
        0 => {
            simulator.set(ref_a, a).unwrap();
            simulator.set(ref_b, b).unwrap();
        }
        1 => {
            simulator.set(ref_b, b).unwrap();
            simulator.set(ref_a, a).unwrap();
        }
        2 => simulator.set_many(&[ref_a, ref_b], &[a, b]).unwrap(),
        _ => simulator.set_many(&[ref_b, ref_a], &[b, a]).unwrap(),
    }
}

/// Before the start, a pair that was set means the scene that has it: the same bits.
#[test]
fn a_pair_set_before_the_start_is_that_of_the_scene() {
    let model = compile(&paper(8, &[])).unwrap();
    for (a, b) in PAIRS {
        let values = [
            ("contact.friction.a", a.to_string()),
            ("contact.friction.b", b.to_string()),
        ];
        let values = values.each_ref().map(|(path, v)| (*path, v.as_str()));
        let mut expected = started(compile(&paper(8, &values)).unwrap());
        let mut found: Vec<Simulator> = (0..4)
            .map(|order| {
                let mut simulator = Simulator::new(Arc::clone(&model));
                set_pair(&mut simulator, (a, b), order);
                simulator.init(0.0).unwrap();
                simulator
            })
            .collect();
        for n in 0..8 {
            for simulator in &mut found {
                assert_eq!(outputs(simulator), outputs(&expected), "{a} {b}, step {n}");
                step(simulator).unwrap();
            }
            step(&mut expected).unwrap();
        }
        assert!(expected.get_by_name("contact.max_slip_rate").unwrap()[0] > 0.0);
    }
}

/// Between steps the outputs are those of the last step until the next one, which has the new coefficients.
#[test]
fn a_pair_set_between_steps_acts_from_the_next_one() {
    let model = compile(&paper(8, &[])).unwrap();
    for pair in PAIRS {
        let mut ends = Vec::new();
        for order in 0..4 {
            let mut simulator = started(Arc::clone(&model));
            (0..3).for_each(|_| step(&mut simulator).unwrap());
            let before = outputs(&simulator);
            set_pair(&mut simulator, pair, order);
            assert_eq!(outputs(&simulator), before);
            let kept = simulator.get_by_name("contact.friction.a").unwrap();
            assert_eq!(kept, [pair.0]);
            step(&mut simulator).unwrap();
            ends.push(outputs(&simulator));
        }
        let mut unchanged = started(Arc::clone(&model));
        (0..4).for_each(|_| step(&mut unchanged).unwrap());
        assert!(ends.iter().all(|end| *end == ends[0]));
        assert_ne!(ends[0], outputs(&unchanged));
    }
}

/// A set that is not valid is refused where it would act; the state is as it was, and a valid one ends the trouble.
#[test]
fn an_invalid_set_is_refused_where_it_would_act() {
    let model = compile(&paper(8, &[])).unwrap();
    for start in ["consistent", "zero"] {
        let model = compile(&paper(8, &[("time.start", start)])).unwrap();
        let mut simulator = Simulator::new(model);
        let a = reference(&simulator, "a");
        simulator.set(a, 5e-4).unwrap();
        let before = simulator.state().clone();
        assert_named(simulator.init(0.0));
        assert!(*simulator.state() == before);
        simulator.set(a, 2e-3).unwrap();
        simulator.init(0.0).unwrap();
    }

    let mut simulator = started(model);
    step(&mut simulator).unwrap();
    let b = reference(&simulator, "b");
    simulator.set(b, 0.004).unwrap();
    let before = simulator.state().clone();
    assert_named(step(&mut simulator));
    assert_named(step(&mut simulator));
    assert!(*simulator.state() == before);
    // the last step and its derivative are still there
    let mut derivative = vec![0.0; simulator.output_len()];
    simulator
        .directional_derivative(&[1.0], &mut derivative)
        .unwrap();
    // a half-changed set survives being saved
    let bytes = simulator.to_bytes();
    let mut other = Simulator::new(Arc::clone(simulator.model()));
    other.restore_bytes(&bytes).unwrap();
    assert_named(step(&mut other));
    let a = reference(&simulator, "a");
    for simulator in [&mut simulator, &mut other] {
        simulator.set(a, 0.005).unwrap();
        step(simulator).unwrap();
    }
    assert_eq!(outputs(&simulator), outputs(&other));
}

fn assert_named(result: Result<(), Error>) {
    let error = result.unwrap_err();
    assert!(matches!(error, Error::Value { .. }), "{error}");
    let text = error.to_string();
    let names = ["contact.friction.a", "contact.friction.b", "a >= b"];
    assert!(names.iter().all(|name| text.contains(name)), "{text}");
}

/// One call sets all or nothing, and its set is checked when it ends.
#[test]
fn values_set_together_are_all_or_nothing() {
    let mut simulator = started(compile(&paper(8, &[])).unwrap());
    step(&mut simulator).unwrap();
    let (a, b) = (reference(&simulator, "a"), reference(&simulator, "b"));
    let before = simulator.state().clone();
    for (references, values) in [
        (vec![0, a, b], vec![-0.5, 5e-4, 6e-4]),
        (vec![0, a], vec![-0.5, 5e-4]),
        (vec![0, a], vec![-0.5, f64::NAN]),
        (vec![0, b], vec![-0.5, -1e-4]),
        (vec![b, 0], vec![1e-4, f64::INFINITY]),
        (vec![b, 1], vec![1e-4, 0.0]),
        (vec![b, u32::MAX], vec![1e-4, 0.0]),
        (vec![b, a], vec![1e-4]),
    ] {
        simulator.set_many(&references, &values).unwrap_err();
        assert!(*simulator.state() == before, "{references:?} {values:?}");
    }
    // of a port named twice the last value holds; loads go along
    simulator
        .set_many(&[a, 0, b, a], &[1e-4, -0.25, 6e-4, 7e-4])
        .unwrap();
    for (name, value) in [("contact.friction.a", 7e-4), ("contact.friction.b", 6e-4)] {
        assert_eq!(simulator.get_by_name(name).unwrap(), [value]);
    }
    assert_eq!(simulator.get_by_name("press").unwrap(), [-0.25]);
    simulator.set_many(&[], &[]).unwrap();
    step(&mut simulator).unwrap();
}

/// A scene whose static bound is a field and whose law is a table: arrays among its ports.
fn with_arrays() -> [Simulator; 2] {
    let field: Vec<f64> = (0..8).map(|i| 0.002 + 1e-4 * f64::from(i)).collect();
    let nodal = json!({"law": "exponential", "a": {"nodes": field}, "b": 0.001, "alpha": 100.0});
    let table = json!({"law": "bound", "bound": {"kind": "table", "rate": [0.0, 0.02, 0.5], "value": [0.003, 0.001, 0.002]}});
    [nodal, table].map(|friction| {
        let friction = friction.to_string();
        started(compile(&paper(8, &[("contact.friction", &friction)])).unwrap())
    })
}

/// Arrays are set as a whole, element by element, or with others in one call: the same steps as in the scene that has them.
#[test]
fn arrays_are_set_as_one() {
    let [simulator, _] = with_arrays();
    let model = Arc::clone(simulator.model());
    let (a, b) = (reference(&simulator, "a"), reference(&simulator, "b"));
    let port = model.ports().get(a).unwrap();
    assert_eq!((&*port.shape, port.unit), (&[8][..], "Pa"));
    assert!(model.ports().get(b).unwrap().shape.is_empty());
    // below the old kinetic bound, so that neither may come alone
    let lower: Vec<f64> = (0..8).map(|i| 5e-4 + 1e-5 * f64::from(i)).collect();
    let field = json!({ "nodes": lower }).to_string();
    let friction = [
        (
            "contact.friction",
            r#"{"law": "exponential", "a": 0.002, "b": 2e-4, "alpha": 100.0}"#,
        ),
        ("contact.friction.a", &field),
    ];
    let mut expected = started(compile(&paper(8, &friction)).unwrap());
    let mut values = lower.clone();
    values.push(2e-4);
    let ends: Vec<Vec<u64>> = (0..3)
        .map(|order| {
            let mut simulator = Simulator::new(Arc::clone(&model));
            match order {
                0 => simulator.set_many(&[a, b], &values).unwrap(),
                1 => {
                    for (node, value) in lower.iter().enumerate() {
                        simulator.set_element(a, node, *value).unwrap();
                    }
                    simulator.set(b, 2e-4).unwrap();
                }
                _ => {
                    simulator.set(b, 2e-4).unwrap();
                    simulator.set_many(&[a], &lower).unwrap();
                }
            }
            simulator.init(0.0).unwrap();
            (0..4).for_each(|_| step(&mut simulator).unwrap());
            outputs(&simulator)
        })
        .collect();
    (0..4).for_each(|_| step(&mut expected).unwrap());
    assert!(ends.iter().all(|end| *end == outputs(&expected)));
    assert!(expected.get_by_name("contact.max_slip_rate").unwrap()[0] > 0.0);
}

/// What an array cannot be is refused with its place, and nothing is changed.
#[test]
fn a_wrong_entry_of_an_array_is_named() {
    let [mut simulator, mut table] = with_arrays();
    let (a, b) = (reference(&simulator, "a"), reference(&simulator, "b"));
    let before = simulator.state().clone();
    let field = [0.002; 8];
    let mut low = field;
    low[5] = 5e-4;
    let error = simulator.set_many(&[a], &low).unwrap_err().to_string();
    let parts = [
        "contact.friction.a at contact node 5",
        "contact.friction.b is 0.001",
        "a >= b",
        "0.0005",
    ];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    for (references, values) in [
        (vec![a], vec![0.002; 7]),
        (vec![a, b], vec![0.002; 8]),
        (vec![b], vec![1e-3; 2]),
    ] {
        let error = simulator.set_many(&references, &values).unwrap_err();
        assert!(matches!(error, Error::Length { .. }), "{error}");
    }
    assert!(matches!(simulator.set(a, 0.002), Err(Error::Length { .. })));
    assert!(matches!(
        simulator.set_element(a, 8, 0.002),
        Err(Error::Length { .. })
    ));
    assert!(matches!(
        simulator.set_element(a, 7, -1.0),
        Err(Error::Value { .. })
    ));
    assert!(*simulator.state() == before);
    // an incomplete set is refused by the step
    simulator.set_element(a, 2, 5e-4).unwrap();
    let error = step(&mut simulator).unwrap_err().to_string();
    assert!(
        error.contains("contact.friction.a at contact node 2"),
        "{error}"
    );
    simulator.set_element(a, 2, 0.002).unwrap();
    step(&mut simulator).unwrap();

    let rate = reference(&table, "bound.rate");
    let error = table
        .set_many(&[rate], &[0.0, 0.6, 0.5])
        .unwrap_err()
        .to_string();
    let parts = [
        "contact.friction.bound.rate at point 2",
        "rates that increase",
        "0.5",
    ];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    table.set_many(&[rate], &[0.0, 0.4, 0.5]).unwrap();
    step(&mut table).unwrap();
    assert_eq!(
        table.get_by_name("contact.friction.bound.rate").unwrap(),
        [0.0, 0.4, 0.5]
    );
}
