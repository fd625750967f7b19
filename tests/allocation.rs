//! A step of a reduced model allocates nothing: not for new step sizes, new loads, saving, restoring or reading outputs. Loading
//! a model allocates what it is made of.

#![allow(unsafe_code)] // a counting allocator

mod common;

use common::paper;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use stickslip::{Model, Simulator, compile};

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
    static BYTES: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: forwards to the system allocator; only counts.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|c| c.set(c.get() + 1));
        BYTES.with(|b| b.set(b.get() + layout.size()));
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Loading copies what was compiled, and asks once for the memory of a simulator: it assembles and factors nothing.
#[test]
fn loading_a_model_takes_little_more_than_its_bytes() {
    let spent = || (COUNT.with(Cell::get), BYTES.with(Cell::get));
    let (count, size) = spent();
    let bytes = compile(&paper(32, &[])).unwrap().to_bytes();
    let compiling = (spent().0 - count, spent().1 - size);
    let (count, size) = spent();
    let model = Model::from_bytes(&bytes).unwrap();
    let loading = (spent().0 - count, spent().1 - size);
    let size = spent().1;
    let simulator = Simulator::new(model.into());
    let own = spent().1 - size;
    drop(simulator);
    // the text of the scene is read with the schema of all scenes, whose size no model changes
    let size = spent().1;
    let schema = stickslip::scene::json_schema().len();
    let schema = spent().1 - size - schema;
    assert!(
        loading.1 < 2 * bytes.len() + 2 * own + schema,
        "{loading:?} for {}, {own} and {schema}",
        bytes.len()
    );
    // both read the text of the scene, which makes most of the allocations of a model of this size
    assert!(loading.0 < compiling.0, "{loading:?} {compiling:?}");
    assert!(20 * loading.1 < compiling.1, "{loading:?} {compiling:?}");
}

#[test]
fn steps_allocate_nothing() {
    let fixed_point = r#"{"kind": "fixed_point"}"#;
    let memory = r#"[{"tau": 0.05, "law": "isotropic", "shear": 0.3, "bulk": 0.5}]"#;
    for (overrides, cells) in [
        (vec![("fidelity.model", "reduced")], 32),
        (vec![("material.memory", memory)], 16),
        (vec![("time.scheme", "tr_bdf2")], 32),
        (vec![("fidelity.solver", fixed_point)], 16),
        (vec![("fidelity.multiplicity_test", "true")], 16),
        (vec![("fidelity.work_limit", "2")], 16),
        (vec![("loads[0].interpolation", "hold")], 64),
        (vec![("time.inputs", "continue")], 64),
        (vec![("time.error_estimate", "true")], 16),
        (vec![("time.tolerance", "1e-4")], 16),
        (bent_laws("full").to_vec(), 16),
        (bent_laws("condensed").to_vec(), 16),
    ] {
        let model = compile(&paper(cells, &overrides)).unwrap();
        let mut simulator = Simulator::new(model);
        simulator.init(0.0).unwrap();
        let mut saved = simulator.state().clone();
        let mut outputs = vec![0.0; simulator.output_len()];
        let alpha = simulator
            .model()
            .ports()
            .find("contact.friction.alpha")
            .unwrap()
            .reference;
        let before = COUNT.with(Cell::get);
        for n in 0..200_u32 {
            let load = -0.3 + 0.2 * f64::from(n).sin();
            simulator.set_inputs(&[load]).unwrap();
            if n % 50 == 7 {
                simulator.set(alpha, 100.0 + f64::from(n)).unwrap();
            }
            let step = 0.003 * f64::from(1 + n % 13);
            simulator.save(&mut saved).unwrap();
            simulator.do_step(simulator.time(), step).unwrap();
            simulator.restore(&saved).unwrap();
            simulator.do_step(simulator.time(), step).unwrap();
            simulator.get_outputs(&mut outputs).unwrap();
        }
        assert_eq!(COUNT.with(Cell::get) - before, 0, "{overrides:?}");
    }
}

/// Nor does one of the condensed model, with memory or without, once its step sizes are known.
#[test]
fn steps_of_the_whole_mesh_allocate_nothing() {
    let memory = r#"[{"tau": 0.05, "law": "isotropic", "shear": 0.3, "bulk": 0.5}, {"tau": 0.8, "law": "isotropic", "shear": 0.1, "bulk": 0}]"#;
    for (memory, model) in [("[]", "condensed"), (memory, "condensed"), (memory, "full")] {
        let overrides = [("material.memory", memory), ("fidelity.model", model)];
        let mut simulator = Simulator::new(compile(&paper(16, &overrides)).unwrap());
        simulator.init(0.0).unwrap();
        let step = simulator.model().largest_step();
        simulator.do_step(0.0, step).unwrap();
        let before = COUNT.with(Cell::get);
        for n in 0..60_u32 {
            simulator
                .set_inputs(&[-0.3 + 0.1 * f64::from(n).sin()])
                .unwrap();
            simulator.do_step(simulator.time(), step).unwrap();
        }
        assert_eq!(COUNT.with(Cell::get) - before, 0, "{model} {memory}");
    }
}

/// Laws of the body that are not linear, with a model.
fn bent_laws(model: &'static str) -> [(&'static str, &'static str); 3] {
    let viscosity = r#"{"law": "carreau", "mu1": 0.1, "mu_0": 1.0, "mu_inf": 0.1, "c": 0.05}"#;
    let elasticity = r#"{"law": "hencky", "bulk": 1.0, "mu_0": 0.8, "mu_inf": 0.2, "c": 0.05}"#;
    [
        ("fidelity.model", model),
        ("material.viscosity", viscosity),
        ("material.elasticity", elasticity),
    ]
}

/// Nor does one of a law that is a formula, has a state, or a surface of values.
#[test]
fn steps_of_other_laws_allocate_nothing() {
    let formula = r#"{"law": "bound", "bound": {"kind": "expression", "formula": "0.001 + 0.002 * exp(-r / 0.05) / (1 + s^2)"}}"#;
    let state = r#"{"law": "coulomb", "coefficient": {"kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.01, "rate": 1e-3, "distance": 0.01, "evolution": "aging"}, "cohesion": 1e-3}"#;
    let surface = r#"{"law": "bound", "bound": {"kind": "table", "rate": [0, 0.1, 1], "slip": [0, 0.05], "value": [[0.003, 0.002], [0.002, 0.001], [0.002, 0.002]]}}"#;
    for (friction, setting) in [
        (formula, ("fidelity.work_limit", "1000")),
        (state, ("fidelity.work_limit", "2")),
        (state, ("fidelity.multiplicity_test", "true")),
        (surface, ("fidelity.multiplicity_test", "false")),
    ] {
        let overrides = [
            ("contact.friction", friction),
            ("time.scheme", "tr_bdf2"),
            setting,
        ];
        let mut simulator = Simulator::new(compile(&paper(16, &overrides)).unwrap());
        simulator.init(0.0).unwrap();
        let mut outputs = vec![0.0; simulator.output_len()];
        let before = COUNT.with(Cell::get);
        for n in 0..60_u32 {
            let load = -0.3 + 0.1 * f64::from(n).sin();
            simulator.set_inputs(&[load]).unwrap();
            let step = 0.002 * f64::from(1 + n % 5);
            simulator.do_step(simulator.time(), step).unwrap();
            simulator.get_outputs(&mut outputs).unwrap();
        }
        assert_eq!(COUNT.with(Cell::get) - before, 0, "{friction}");
    }
}
