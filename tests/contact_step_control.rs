//! Steps chosen by `time.tolerance` where nodes open, close and start to slip under pressure: they end, and they are as accurate as
//! asked.

mod common;

use common::{largest, values};
use stickslip::simulator::drive::Drive;
use stickslip::{Scene, Simulator, compile};

/// The run of an example, and the displacement of a probe at its communication points.
fn run(name: &str, probe: &str, overrides: &[(&str, &str)]) -> (Simulator, Vec<f64>) {
    let text = stickslip::scene::example(name).unwrap();
    let all: Vec<(String, String)> = overrides
        .iter()
        .map(|(path, value)| (path.to_string(), value.to_string()))
        .collect();
    let scene = Scene::with_overrides(text, name, &all).unwrap();
    let mut simulator = Simulator::new(compile(&scene).unwrap());
    let mut drive = Drive::start(&scene, &mut simulator).unwrap();
    let mut course = Vec::new();
    while let Some(simulator) = drive.step().unwrap() {
        course.extend(values(simulator, probe));
    }
    (simulator, course)
}

/// Slip is that of the foundation for the most part: what the body does is seen at a probe.
#[test]
fn tolerances_are_met_where_contact_opens_and_closes() {
    // a body that begins far from the foundation, one that closes and opens, one that weakens
    for (name, cells, fine, probe) in [
        ("disc_brake", "[16, 4]", "5e-5", "leading_edge.displacement"),
        ("snap", "[16, 4]", "5e-5", "tip.displacement"),
        ("belt", "[16, 8]", "2e-4", "tip.displacement"),
    ] {
        let common = [
            ("mesh.cells", cells),
            ("run.until", "0.7"),
            ("run.step", "0.01"),
        ];
        let (_, expected) = run(name, probe, &[&common[..], &[("time.step", fine)]].concat());
        for (tolerance, most) in [("1e-2", 2e-2), ("1e-3", 2e-3)] {
            let chosen = [("time.step", "0.01"), ("time.tolerance", tolerance)];
            let (sim, found) = run(name, probe, &[&common[..], &chosen].concat());
            let difference: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
            let error = largest(&difference) / largest(&expected);
            let (steps, refused) = (sim.internal_steps(), sim.refused_pairs());
            println!(
                "{name} {tolerance}: {error:.1e}, {steps} internal steps, {refused} pairs refused"
            );
            assert!(steps < 5000, "{name} {tolerance}: {steps}");
            assert!(error < most, "{name} {tolerance}: {error:e}");
        }
    }
}
