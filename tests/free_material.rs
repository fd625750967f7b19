//! Materials that stay free: a compiled model whose moduli, viscosities and relaxation times are set before the initialization
//! moves as one compiled with them.

#![allow(unsafe_code)] // an allocator that knows its largest request

mod common;

use common::{largest, paper, relative, steps, value};
use serde_json::{Value, json};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use stickslip::{Error, MemoryFiles, Model, Scene, Simulator, compile, compile_from};

/// Keeps the largest request of a thread.
struct Watching;

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: forwards to the system allocator; only looks.
unsafe impl GlobalAlloc for Watching {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.with(|l| l.set(l.get().max(layout.size())));
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Watching = Watching;

type Changes<'a> = &'a [(&'a str, f64)];

/// Accuracy that is asked of the body, and most error of a trajectory: friction magnifies it.
const TOLERANCE: &str = "1e-9";
const MOST: f64 = 1e-7;

/// Materials without memory.
const ELASTIC: [Changes; 4] = [
    &[],
    &[
        ("material.elasticity.poisson", 0.4999),
        ("material.elasticity.young", 2.0),
    ],
    &[
        ("material.elasticity.poisson", -0.2),
        ("material.viscosity.mu1", -0.01),
        ("material.viscosity.mu2", 0.3),
    ],
    &[("material.viscosity.mu1", 3.0)],
];

/// Materials with two branches.
const RELAXING: [Changes; 4] = [
    &[],
    &[
        ("material.elasticity.poisson", 0.4999),
        ("material.memory[0].bulk", 40.0),
    ],
    &[
        ("material.memory[0].tau", 0.8),
        ("material.memory[1].tau", 0.01),
        ("material.memory[1].shear", 1.0),
        ("material.memory[0].bulk", 0.0),
        ("material.elasticity.poisson", 0.1),
    ],
    // equal times are one branch
    &[
        ("material.memory[0].tau", 0.8),
        ("material.viscosity.mu2", 0.02),
    ],
];

fn two_branches() -> Value {
    json!([{"tau": 0.05, "law": "isotropic", "shear": 0.3, "bulk": 0.5},
           {"tau": 0.8, "law": "isotropic", "shear": 0.2, "bulk": 0.1}])
}

/// Slip rates, slips and stresses, each by its largest, over a run under loads that come, turn and go.
fn course(simulator: &mut Simulator, loads: [f64; 4]) -> [Vec<f64>; 3] {
    simulator.init(0.0).unwrap();
    let mut seen: [Vec<f64>; 3] = Default::default();
    for load in loads {
        for _ in 0..5 {
            simulator.set_inputs(&[load]).unwrap();
            steps(simulator, 1.0 / 32.0, 1);
            for (seen, port) in seen
                .iter_mut()
                .zip(["slip_rate", "slip", "tangential_stress"])
            {
                seen.extend(simulator.get_by_name(&format!("contact.{port}")).unwrap());
            }
        }
    }
    seen
}

fn worst(found: &[Vec<f64>; 3], reference: &[Vec<f64>; 3]) -> f64 {
    let pairs = found.iter().zip(reference);
    pairs.map(|(f, r)| relative(f, r)).fold(0.0, f64::max)
}

fn set(simulator: &mut Simulator, changes: Changes) {
    let reference = |path: &str| simulator.model().ports().find(path).unwrap().reference;
    let references: Vec<u32> = changes.iter().map(|(path, _)| reference(path)).collect();
    let values: Vec<f64> = changes.iter().map(|(_, value)| *value).collect();
    simulator.set_many(&references, &values).unwrap();
}

/// A scene of JSON with values at paths.
fn with(scene: &Value, changes: &[(String, String)]) -> Scene {
    Scene::with_overrides(&scene.to_string(), "free", changes).unwrap()
}

fn numbers(changes: Changes) -> Vec<(String, String)> {
    let text = |(path, value): &(&str, f64)| ((*path).to_owned(), format!("{value:?}"));
    changes.iter().map(text).collect()
}

fn free_of(scene: &Value, files: &MemoryFiles) -> Arc<Model> {
    let free = [
        ("fidelity.free_material".to_owned(), "true".to_owned()),
        ("fidelity.tolerance".to_owned(), TOLERANCE.to_owned()),
    ];
    compile_from(&with(scene, &free), files).unwrap()
}

/// Compares the free model with the condensed one compiled with the numbers.
fn compare(scene: &Value, files: &MemoryFiles, loads: [f64; 4], materials: &[Changes], most: f64) {
    let model = free_of(scene, files);
    let name = scene["name"].as_str().unwrap();
    println!(
        "{name}: {} states, {:?}",
        model.states(),
        model.summary().reduction
    );
    for changes in materials {
        let mut simulator = Simulator::new(Arc::clone(&model));
        set(&mut simulator, changes);
        let found = course(&mut simulator, loads);
        let mut all = numbers(changes);
        all.push(("fidelity.model".to_owned(), "condensed".to_owned()));
        let compiled = compile_from(&with(scene, &all), files).unwrap();
        let reference = course(&mut Simulator::new(Arc::clone(&compiled)), loads);
        assert!(reference.iter().all(|seen| largest(seen) > 0.0));
        let error = worst(&found, &reference);
        println!("{changes:?}: {error:e}");
        assert!(error < most, "{name}, {changes:?}: {error:e}");

        // what the model says of its material is what the compiled one says
        let (own, others) = (simulator.model().summary(), compiled.summary());
        assert!(relative(&own.rates, &others.rates) < 1e-12);
        let (own, others) = (simulator.model().certificate(), compiled.certificate());
        assert!(
            relative(
                &[own.m_a, own.l_a, own.l_b],
                &[others.m_a, others.l_a, others.l_b]
            ) < 1e-12
        );
        assert!((own.sharp_step / others.sharp_step - 1.0).abs() < 1e-7);
        // where A and B are proportional the other one measures strains in A
        let is_proportional = name == "plate" && !changes.is_empty();
        assert!(is_proportional || (own.c0_squared / others.c0_squared - 1.0).abs() < 1e-7);
        let energy =
            |s: &Simulator| value(s, "energy.balance_error") / value(s, "energy.external_work");
        assert!(energy(&simulator).abs() < 1e-7, "{:e}", energy(&simulator));
    }
}

fn rectangle(cells: u32, memory: bool) -> Value {
    let scene = paper(cells, &[]);
    let mut scene: Value = serde_json::from_str(&scene.to_json()).unwrap();
    scene["name"] = format!("rectangle_{cells}_{memory}").into();
    if memory {
        scene["material"]["memory"] = two_branches();
    }
    scene
}

const LOADS: [f64; 4] = [-0.3, 0.2, 0.0, -0.1];

#[test]
fn a_free_material_moves_as_one_that_was_compiled() {
    let files = MemoryFiles::default();
    compare(&rectangle(32, false), &files, LOADS, &ELASTIC, MOST);
    compare(&rectangle(16, true), &files, LOADS, &RELAXING, MOST);
}

#[test]
fn a_mesh_of_gmsh_has_free_materials() {
    let mut scene = json!({
        "schema_version": 1, "name": "shoe", "mesh": {"kind": "gmsh", "file": "shoe.msh"},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 5e4, "mu2": 1e5},
            "elasticity": {"law": "isotropic", "young": 2e7, "poisson": 0.3, "convention": "plane_strain"}},
        "clamped": ["pivot"],
        "contact": {"part": "drum face", "friction": {"law": "tresca", "bound": 2e4}},
        "loads": [{"name": "cam", "kind": "traction", "part": "cam", "direction": [1, -1]}],
        "time": {"step": 0.03125, "scheme": "trapezoid"}
    });
    let files = MemoryFiles::new([("shoe.msh", &include_bytes!("meshes/shoe.msh")[..])]);
    let loads = [3e5, -2e5, 0.0, 1e5];
    let plain: [Changes; 2] = [
        &[("material.elasticity.poisson", 0.4999)],
        &[
            ("material.elasticity.young", 5e6),
            ("material.viscosity.mu1", 0.0),
        ],
    ];
    compare(&scene, &files, loads, &plain, MOST);
    scene["material"]["memory"] =
        json!([{"tau": 0.05, "law": "isotropic", "shear": 3e6, "bulk": 5e6}]);
    let relaxing: [Changes; 1] = [&[
        ("material.elasticity.poisson", 0.4999),
        ("material.memory[0].tau", 0.3),
        ("material.memory[0].bulk", 0.0),
    ]];
    compare(&scene, &files, loads, &relaxing, MOST);
}

fn small(memory: bool) -> Arc<Model> {
    free_of(&rectangle(8, memory), &MemoryFiles::default())
}

/// A model from bytes has no mesh and no matrix of the body's size, and setting its material asks for none: every request of memory
/// stays far below the operators of the body, let alone their factor.
#[test]
fn setting_a_material_needs_no_matrix_of_the_body() {
    let model = free_of(&rectangle(32, true), &MemoryFiles::default());
    let model = Arc::new(Model::from_bytes(&model.to_bytes()).unwrap());
    let body = compile(&paper(32, &[("fidelity.model", "condensed")])).unwrap();
    let mut simulator = Simulator::new(Arc::clone(&model));
    let before = value(&simulator, "material.elasticity.poisson");
    assert_eq!(before, 0.3);
    LARGEST.with(|l| l.set(0));
    set(&mut simulator, RELAXING[2]);
    simulator.init(0.0).unwrap();
    let asked = LARGEST.with(Cell::get);
    // the modes by the contact, as they are hashed with the model
    let modes = model.states() / 3 * model.contact().len() * 8;
    let whole = body.summary().bytes;
    assert!(
        asked < 3 * modes && 2 * asked < whole,
        "{asked} {modes} {whole}"
    );
    // one stage, that of the start
    assert_eq!(simulator.factorizations(), 1);
    assert_eq!(value(&simulator, "material.elasticity.poisson"), 0.1);
    // set again, they go on as before: a start over has the numbers of the scene
    simulator.reset();
    assert_eq!(value(&simulator, "material.elasticity.poisson"), 0.3);
    assert!(Arc::ptr_eq(simulator.model(), &model));
}

#[test]
fn wrong_numbers_are_refused_with_their_names_and_change_nothing() {
    let model = small(true);
    let mut simulator = Simulator::new(Arc::clone(&model));
    let before = simulator.to_bytes();
    let reference = |path: &str| model.ports().find(path).unwrap().reference;
    for (path, wrong) in [
        ("material.elasticity.poisson", 0.5),
        ("material.elasticity.poisson", -1.0),
        ("material.elasticity.young", -2.0),
        ("material.viscosity.mu2", 0.0),
        ("material.memory[1].tau", 0.0),
        ("material.memory[0].shear", -1e-3),
        ("material.memory[0].bulk", f64::NAN),
    ] {
        let error = simulator.set(reference(path), wrong).unwrap_err();
        let Error::Value { what, .. } = &error else {
            panic!("{error}");
        };
        assert!(what.contains(path), "{error}");
        assert_eq!(simulator.to_bytes(), before);
    }
    // numbers that do not fit each other, together or one by one
    let poisson = ("material.elasticity.poisson", 0.49999);
    for (pairs, name) in [
        (
            &[("material.viscosity.mu1", -0.06)][..],
            "material.viscosity.mu1",
        ),
        (
            &[("material.viscosity.mu1", -0.03)],
            "material.viscosity.mu1",
        ),
        (&[poisson], poisson.0),
        (
            &[
                ("material.memory[0].shear", 0.0),
                ("material.memory[0].bulk", 0.0),
            ],
            "material.memory[0]",
        ),
    ] {
        let references: Vec<u32> = pairs.iter().map(|(path, _)| reference(path)).collect();
        let values: Vec<f64> = pairs.iter().map(|(_, value)| *value).collect();
        let error = simulator.set_many(&references, &values).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        assert_eq!(simulator.to_bytes(), before);

        let mut single = simulator.clone();
        for (reference, value) in references.iter().zip(&values) {
            single.set(*reference, *value).unwrap();
        }
        let waiting = single.to_bytes();
        let error = single.init(0.0).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        assert_eq!(single.to_bytes(), waiting);
    }
    assert!(model.with_material(&[1.0]).is_err());
    // after the start they are what they are
    simulator.init(0.0).unwrap();
    let error = simulator
        .set(reference("material.elasticity.young"), 2.0)
        .unwrap_err();
    assert!(matches!(error, Error::CallOrder { .. }), "{error}");
    let plain = compile(&paper(4, &[])).unwrap();
    assert!(plain.free_numbers().is_empty() && plain.with_material(&[]).is_err());
}

/// A saved state brings its material with it, into simulators of the compiled model and of any other numbers.
#[test]
fn states_carry_the_numbers_they_were_made_with() {
    let model = small(true);
    let mut simulator = Simulator::new(Arc::clone(&model));
    let mut early = simulator.new_state();
    set(&mut simulator, RELAXING[2]);
    simulator.init(0.0).unwrap();
    simulator.set_inputs(&[-0.3]).unwrap();
    steps(&mut simulator, 1.0 / 16.0, 3);
    simulator.save(&mut early).unwrap();
    let bytes = simulator.to_bytes();
    steps(&mut simulator, 1.0 / 16.0, 3);
    let ended = simulator.to_bytes();

    let stored = Arc::new(Model::from_bytes(&simulator.model().to_bytes()).unwrap());
    assert_eq!(stored.fingerprint(), model.fingerprint());
    assert_eq!(stored.free_values(), simulator.model().free_values());
    for by_bytes in [false, true] {
        for (model, changes) in [(&model, None), (&model, Some(RELAXING[1])), (&stored, None)] {
            let mut other = Simulator::new(Arc::clone(model));
            if let Some(changes) = changes {
                set(&mut other, changes);
                other.init(0.0).unwrap();
            }
            match by_bytes {
                true => other.restore_bytes(&bytes).unwrap(),
                false => other.restore(&early).unwrap(),
            }
            assert_eq!(value(&other, "material.memory[1].shear"), 1.0);
            steps(&mut other, 1.0 / 16.0, 3);
            assert_eq!(other.to_bytes(), ended);
        }
    }
    // another body is another model
    let mut other = Simulator::new(free_of(&rectangle(6, true), &MemoryFiles::default()));
    assert!(matches!(
        other.restore(&early),
        Err(Error::Fingerprint { .. })
    ));
}

/// A plate with free faces is one of two forms, with a branch that its numbers make or not.
#[test]
fn a_plate_with_free_faces_stays_free() {
    let mut plate = rectangle(8, false);
    plate["name"] = "plate".into();
    plate["material"]["elasticity"]["convention"] = "plane_stress_relaxing".into();
    // mu1 / mu2 = lambda / 2 mu = poisson / (1 - 2 poisson): no branch
    let changes: [Changes; 3] = [
        &[],
        &[
            ("material.elasticity.poisson", 0.25),
            ("material.viscosity.mu1", 0.05),
        ],
        &[("material.elasticity.poisson", 0.4999)],
    ];
    compare(&plate, &MemoryFiles::default(), LOADS, &changes, MOST);
}

#[test]
fn what_does_not_stay_free_is_refused_with_its_place() {
    let plain = paper(4, &[]).to_json();
    let refused = |changes: &[(&str, &str)]| {
        let mut all = vec![("fidelity.free_material".to_owned(), "true".to_owned())];
        all.extend(
            changes
                .iter()
                .map(|(p, v)| ((*p).to_owned(), (*v).to_owned())),
        );
        match Scene::with_overrides(&plain, "free", &all) {
            Err(Error::Scene { path, .. }) => path,
            other => panic!("{other:?}"),
        }
    };
    for (changes, path) in [
        (&[("fidelity.model", "condensed")][..], "fidelity.model"),
        (
            &[("fidelity.target_error", "0.01")],
            "fidelity.target_error",
        ),
        (
            &[(
                "initial",
                r#"{"displacement": [{"expression": "0.1 * x^2"}, 0]}"#,
            )],
            "initial.displacement",
        ),
        (
            &[
                ("material.viscosity.mu1", "0"),
                ("material.viscosity.mu2", "0"),
                ("time.scheme", "tr_bdf2"),
                ("time.start", "zero"),
            ],
            "material.viscosity.mu2",
        ),
        (
            &[("material.elasticity.gradient", "[0.1, 0.0]")],
            "material.elasticity",
        ),
        (
            &[("material.elasticity.poisson", "0.49999")],
            "material.elasticity.poisson",
        ),
        (
            &[(
                "material.viscosity",
                r#"{"law": "matrix", "matrix": [[0.3, 0.1, 0], [0.1, 0.2, 0], [0, 0, 0.1]]}"#,
            )],
            "material.viscosity.law",
        ),
        // refused for its own reason: no reduced model of a law that is not linear
        (
            &[
                (
                    "material.viscosity",
                    r#"{"law": "carreau", "mu1": 0.1, "mu_0": 0.2, "mu_inf": 0.1, "c": 1, "deviator": "three_dimensional"}"#,
                ),
                ("fidelity.model", "auto"),
            ],
            "material.viscosity.law",
        ),
    ] {
        assert_eq!(refused(changes), path, "{changes:?}");
    }
}
