//! Scene texts: as they come, or an embedded scene with values put into it. Refused, or compiled and stepped.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip::{Scene, Simulator, compile};
use stickslip_fuzz::{Input, check_outputs, exercise};

/// Places at which numbers are put.
const PLACES: [&str; 30] = [
    "mesh.size[0]", "mesh.size[1]", "mesh.grading[0]", "mesh.grading[1]", "material.viscosity.mu1", "material.viscosity.mu2", "material.elasticity.young",
    "material.elasticity.poisson", "contact.friction.a", "contact.friction.b", "contact.friction.alpha", "contact.friction.bound", "loads[0].start",
    "loads[0].direction[0]", "loads[0].direction[1]", "loads[1].start", "probes[0].at[0]", "probes[0].at[1]", "time.step", "time.tolerance",
    "fidelity.tolerance", "fidelity.friction_tolerance", "mesh.cells[0]", "mesh.cells[1]", "history.capacity", "run.until", "run.step",
    "contact.tangent[0]", "contact.tangent[1]", "mesh.size[2]",
];

/// Choices, as JSON or plain words.
const CHOICES: [(&str, &str); 24] = [
    ("time.scheme", "trapezoid"), ("time.scheme", "backward_euler"), ("time.scheme", "tr_bdf2"), ("time.scheme", "rectangle"), ("time.start", "zero"),
    ("fidelity.model", "full"), ("fidelity.model", "condensed"), ("fidelity.model", "reduced"), ("fidelity.model", "auto"), ("element", "p2"),
    ("mesh.periodic", "[\"x\"]"), ("mesh.periodic", "[\"y\"]"), ("clamped", "[\"top\"]"), ("clamped", "[\"left\", \"right\"]"), ("contact.part", "right"),
    ("contact.friction", "{\"law\": \"tresca\", \"bound\": 0.01}"), ("contact.friction", "{\"law\": \"frictionless\"}"), ("loads", "[]"), ("probes", "[]"),
    ("fidelity.multiplicity_test", "true"), ("fidelity.solver", "{\"kind\": \"fixed_point\"}"), ("time.error_estimate", "true"),
    ("fidelity.precision", "single"), ("loads[0].interpolation", "hold"),
];

/// Most cells of a scene that is compiled: what takes long is not what is looked for.
const MOST_CELLS: u64 = 4;

fuzz_target!(|data: &[u8]| {
    let scene = if data.first().is_some_and(|first| b"{[\xef \n".contains(first)) {
        let Ok(text) = std::str::from_utf8(data) else { return };
        Scene::from_json(text, "fuzz")
    } else {
        let mut input = Input(data);
        let names: Vec<&str> = stickslip::scene::example_names().filter(|name| !["brake_shoe", "lip_seal"].contains(name)).collect();
        let name = names[usize::from(input.byte()) % names.len()];
        let cells = if name == "brake_pad_3d" { "[1, 1, 1]" } else { "[2, 1]" };
        let mut overrides = vec![("mesh.cells".to_string(), cells.to_string())];
        while !input.is_empty() {
            let place = usize::from(input.byte());
            if place < 128 {
                let number = input.number();
                let whole = [22, 23, 24].contains(&(place % PLACES.len()));
                let text = if whole { format!("{}", (number.abs() * 8.0) as u32) } else { format!("{number:?}") };
                overrides.push((PLACES[place % PLACES.len()].to_string(), text));
            } else {
                let (path, value) = CHOICES[place % CHOICES.len()];
                overrides.push((path.to_string(), value.to_string()));
            }
        }
        Scene::with_overrides(stickslip::scene::example(name).expect("an embedded scene"), name, &overrides)
    };
    let Ok(scene) = scene else { return };
    let cells: u64 = scene.mesh.grid().map_or(&[][..], |grid| grid.cells).iter().map(|&n| u64::from(n)).fold(1, u64::saturating_mul);
    let has_refinement = matches!(&scene.mesh, stickslip::scene::MeshSpec::Rectangle(r) if !r.refine.is_empty());
    if cells > MOST_CELLS || has_refinement || scene.fidelity.target_error.is_some() || scene.history.capacity > 1000 {
        return;
    }
    let text = scene.to_json();
    assert!(Scene::from_json(&text, "again").expect("what was written is read") == scene, "a scene changes when it is written and read");
    let Ok(model) = compile(&scene) else { return };
    let mut simulator = Simulator::new(model);
    if simulator.init(0.0).is_ok() {
        check_outputs(&simulator);
        exercise(&mut simulator, &[-0.3, 0.1]);
    }
});
