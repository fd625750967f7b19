//! Scene texts: as they come, or a small scene with values put into it. Refused, or compiled and stepped.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::cell::RefCell;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use stickslip::scene::MeshSpec;
use stickslip::{Scene, Simulator, compile};
use stickslip_fuzz::words::{CHOICES, PLACES};
use stickslip_fuzz::{Input, TEXTS, check_outputs, exercise};

/// Most cells of a scene that is compiled: what takes long is not what is looked for.
const MOST_CELLS: u64 = 4;
/// Most scenes remembered.
const MOST_REMEMBERED: usize = 1 << 20;

thread_local! {
    /// Hashes of scenes that have been compiled: many inputs say the same.
    static COMPILED: RefCell<HashSet<u64>> = RefCell::default();
}

/// Whether a scene comes for the first time.
fn is_new(text: &str) -> bool {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    COMPILED.with_borrow_mut(|compiled| {
        if compiled.len() >= MOST_REMEMBERED {
            compiled.clear();
        }
        compiled.insert(hasher.finish())
    })
}

/// A scene as the input describes it; `None` for what is no text.
fn read(data: &[u8]) -> Option<stickslip::Result<Scene>> {
    if data.first().is_some_and(|first| b"{[\xef \n".contains(first)) {
        return Some(Scene::from_json(std::str::from_utf8(data).ok()?, "fuzz"));
    }
    let mut input = Input(data);
    let names: Vec<&str> = stickslip::scene::example_names().filter(|name| !["brake_shoe", "lip_seal"].contains(name)).collect();
    let number = usize::from(input.byte()) % (names.len() + TEXTS.len());
    let mut overrides = Vec::new();
    let (name, text) = match number.checked_sub(names.len()) {
        Some(own) => TEXTS[own],
        None => {
            let name = names[number];
            let cells = if name == "brake_pad_3d" { "[1, 1, 1]" } else { "[2, 1]" };
            overrides.push(("mesh.cells".to_string(), cells.to_string()));
            // the quickest to compile; others are among the choices
            overrides.push(("fidelity.model".to_string(), "condensed".to_string()));
            (name, stickslip::scene::example(name).expect("an embedded scene"))
        }
    };
    while !input.is_empty() {
        let place = usize::from(input.byte());
        if place < 128 {
            let path = PLACES[place % PLACES.len()];
            let number = input.number();
            let is_whole = ["mesh.cells[0]", "mesh.cells[1]", "history.capacity", "fidelity.work_limit"].contains(&path);
            let text = if is_whole { format!("{}", (number.abs() * 8.0) as u32) } else { format!("{number:?}") };
            overrides.push((path.to_string(), text));
        } else {
            let (path, value) = CHOICES[(place - 128) % CHOICES.len()];
            overrides.push((path.to_string(), value.to_string()));
        }
    }
    Some(Scene::with_overrides(text, name, &overrides))
}

fuzz_target!(|data: &[u8]| {
    let Some(Ok(scene)) = read(data) else { return };
    let cells: u64 = scene.mesh.grid().map_or(&[][..], |grid| grid.cells).iter().map(|&n| u64::from(n)).fold(1, u64::saturating_mul);
    let has_refinement = matches!(&scene.mesh, MeshSpec::Rectangle(r) if !r.refine.is_empty());
    if cells > MOST_CELLS || has_refinement || scene.fidelity.target_error.is_some() || scene.history.capacity > 1000 {
        return;
    }
    let text = scene.to_json();
    if !is_new(&text) {
        return;
    }
    assert!(Scene::from_json(&text, "again").expect("what was written is read") == scene, "a scene changes when it is written and read");
    let Ok(model) = compile(&scene) else { return };
    let mut simulator = Simulator::new(model);
    if simulator.init(0.0).is_ok() {
        check_outputs(&simulator);
        let mut before = simulator.new_state();
        exercise(&mut simulator, &[-0.3, 0.1], data.len() % 2 == 0, &mut before);
    }
});
