//! The FMU in a Rust importer, fmi-rs: every output of the paper's example at every communication point equals that of the
//! simulator bit for bit; a state taken half-way leads to the same end again.

use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;
use std::path::PathBuf;
use stickslip::scene::{self, Inputs};
use stickslip::{NoFiles, Scene, Simulator, compile};
use stickslip_fmu::{FmiVersion, Options, find_library, package};

const STEPS: usize = 32;
const STEP: f64 = 1.0 / 32.0;

/// Load at communication point `i`.
fn press(i: usize) -> f64 {
    -0.3 + 0.1 * (0.2 * i as f64).sin()
}

/// Outputs after the start and after every step, whose inputs are set at its beginning.
fn simulator_run() -> Vec<Vec<f64>> {
    let text = scene::example("kazmi2014").unwrap();
    let mut simulator =
        Simulator::new(compile(&Scene::from_json(text, "kazmi2014").unwrap()).unwrap());
    let mut values = vec![0.0; simulator.output_len()];
    let mut rows = Vec::new();
    simulator.set_inputs_meaning(Inputs::Continue).unwrap();
    for i in 0..=STEPS {
        simulator.set_inputs(&[press(i.saturating_sub(1))]).unwrap();
        if i == 0 {
            simulator.init(0.0).unwrap();
        } else {
            simulator.do_step((i - 1) as f64 * STEP, STEP).unwrap();
        }
        simulator.get_outputs(&mut values).unwrap();
        rows.push(values.clone());
    }
    rows
}

/// A folder of its own with the FMU, removed when it is dropped.
struct Packed {
    folder: PathBuf,
    fmu: PathBuf,
}

impl Packed {
    fn new(version: FmiVersion) -> Packed {
        let name = format!("stickslip_fmi_rs_{version:?}_{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).unwrap();
        // a build for tests is refused by its mark: here a copy without it is what runs
        let mut bytes = std::fs::read(find_library().unwrap()).unwrap();
        let mark = b"built with panic-injection";
        let places: Vec<usize> = bytes
            .windows(mark.len())
            .enumerate()
            .filter_map(|(at, w)| (w == mark).then_some(at))
            .collect();
        for at in places {
            bytes[at + mark.len() - 1] = b'*';
        }
        let library = folder.join("library.so");
        std::fs::write(&library, bytes).unwrap();
        let options = Options {
            version,
            library: Some(library),
            ..Options::default()
        };
        let packed = package(scene::example("kazmi2014").unwrap(), &NoFiles, &options).unwrap();
        let fmu = folder.join("pad.fmu");
        std::fs::write(&fmu, packed.bytes).unwrap();
        Packed { folder, fmu }
    }
}

impl Drop for Packed {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn same_bits(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(a, b)| a.to_bits() == b.to_bits())
}

#[test]
fn fmi_2_outputs_are_those_of_the_simulator() {
    let packed = Packed::new(FmiVersion::Fmi2);
    let builder = FMU2Builder::new(&packed.fmu).unwrap();
    let description = &builder.model_description;
    let reference = |name: &str| description.variable_by_name(name).unwrap().valueReference;
    let outputs: Vec<u32> = description
        .outputs
        .iter()
        .map(|o| {
            description
                .variable_by_index(o.index)
                .unwrap()
                .valueReference
        })
        .collect();
    let knob = [reference("press")];
    let pad = builder.instantiate_cs("pad").unwrap();
    let ok = |status: fmi2Status| assert_eq!(status, fmi2Status::Ok);
    let expected = simulator_run();
    let mut values = vec![0.0; outputs.len()];
    let mut state = std::ptr::null_mut();

    ok(pad.setupExperiment(None, 0.0, None));
    ok(pad.enterInitializationMode());
    ok(pad.setReal(&knob, &[press(0)]));
    ok(pad.exitInitializationMode());
    let mut step = |i: usize| {
        if i > 0 {
            ok(pad.setReal(&knob, &[press(i - 1)]));
            ok(pad.doStep((i - 1) as f64 * STEP, STEP, 1));
        }
        ok(pad.getReal(&outputs, &mut values));
        assert!(same_bits(&values, &expected[i]), "row {i}");
    };
    for i in 0..=STEPS {
        step(i);
        if i == STEPS / 2 {
            ok(pad.getFMUstate(&mut state));
        }
    }
    ok(pad.setFMUstate(state));
    (STEPS / 2 + 1..=STEPS).for_each(step);
    ok(pad.freeFMUstate(&mut state));
    ok(pad.terminate());
}

#[test]
fn fmi_3_outputs_are_those_of_the_simulator() {
    let packed = Packed::new(FmiVersion::Fmi3);
    let mut builder = FMU3Builder::new(&packed.fmu).unwrap();
    builder.eventModeUsed = false;
    builder.earlyReturnAllowed = false;
    let description = &builder.model_description;
    let outputs: Vec<u32> = description
        .outputs
        .iter()
        .map(|o| o.valueReference)
        .collect();
    let knob = [description
        .variable_by_name("press")
        .unwrap()
        .valueReference];
    let pad = builder.instantiate_cs("pad").unwrap();
    let ok = |status: fmi3Status| assert_eq!(status, fmi3Status::Ok);
    let expected = simulator_run();
    let mut values = vec![0.0; expected[0].len()];
    let mut state = std::ptr::null_mut();

    ok(pad.enterInitializationMode(None, 0.0, None));
    ok(pad.setFloat64(&knob, &[press(0)]));
    ok(pad.exitInitializationMode());
    let mut step = |i: usize| {
        if i > 0 {
            let (mut event, mut end, mut early, mut time) = (true, true, true, 0.0);
            ok(pad.setFloat64(&knob, &[press(i - 1)]));
            let start = (i - 1) as f64 * STEP;
            ok(pad.doStep(
                start, STEP, true, &mut event, &mut end, &mut early, &mut time,
            ));
            assert_eq!(
                (event, end, early, time),
                (false, false, false, i as f64 * STEP)
            );
        }
        ok(pad.getFloat64(&outputs, &mut values));
        assert!(same_bits(&values, &expected[i]), "row {i}");
    };
    for i in 0..=STEPS {
        step(i);
        if i == STEPS / 2 {
            ok(pad.getFMUState(&mut state));
        }
    }
    ok(pad.setFMUState(state));
    (STEPS / 2 + 1..=STEPS).for_each(step);
    ok(pad.freeFMUState(&mut state));
    ok(pad.terminate());
}
