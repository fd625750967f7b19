//! Figure 7: friction stress against slip rate at the point (1, 0), ten steps of k = 1/10 from zero velocity, with the
//! iterates of Problem 7.4 (the bound frozen at the last iterate).

use super::example;
use crate::contact_table::write_columns;
use crate::course;
use crate::failure::Failure;
use crate::pictures::{Axis, Curves, Mark, Panel, Series, Sheet, sequential};
use std::path::Path;
use stickslip::contact::{Bounds, SlipPath};
use stickslip::{Simulator, compile};

const STEPS: u32 = 10;

/// Iterates of one step: magnitudes of slip rate and stress.
type Path2 = Vec<(f64, f64)>;

pub fn draw(out: &Path) -> Result<(), Failure> {
    let mut overrides = example::sizes(32, STEPS);
    overrides.extend(example::problem_7_4("displacement_and_stress"));
    let scene = example::scene(&overrides)?;
    let model = compile(&scene).map_err(Failure::of(example::NAME))?;
    let contact = model.contact();
    // the contact nodes go along x: the last one is the point (1, 0)
    let tip = contact.node_count() - 1;
    let mut simulator = Simulator::new(std::sync::Arc::clone(&model));
    simulator.keep_iterates();
    let mut steps: Vec<Path2> = Vec::new();
    course::follow(&scene, example::NAME, &mut simulator, |simulator, _| {
        let iterates = simulator.iterates();
        steps.push(
            iterates
                .map(|(rates, forces)| (rates[tip].abs(), contact.stress(tip, forces[tip]).abs()))
                .collect(),
        );
        Ok(())
    })?;
    // the start has nothing to iterate
    steps.remove(0);
    write(out, &steps)?;

    let still = SlipPath {
        base: 0.0,
        per_rate: 0.0,
    };
    let bounds = model.friction().bounds();
    let bound = |rate: f64| bounds.evaluate(tip, rate, still).bound;
    let fastest = steps.iter().flatten().map(|p| p.0).fold(0.0, f64::max);
    let panel = |heading: &str, end: f64| {
        let law = Series {
            name: "friction law g".to_owned(),
            colour: (150, 150, 150),
            mark: Mark::Line,
            points: (0..=400)
                .map(|i| end * f64::from(i) / 400.0)
                .map(|r| (r, bound(r)))
                .collect(),
        };
        let drawn = steps.iter().enumerate().map(|(i, iterates)| Series {
            name: format!("step {}", i + 1),
            colour: sequential(0.95 * i as f64 / f64::from(STEPS)),
            mark: Mark::Beads,
            points: iterates.clone(),
        });
        Panel::Curves(Curves {
            heading: heading.to_owned(),
            x: Axis::new("slip rate", "m/s").between(-0.02 * end, end),
            y: Axis::new("friction stress", "Pa").between(0.0008, 0.0032),
            series: [law].into_iter().chain(drawn).collect(),
        })
    };
    Sheet {
        title: "Figure 7: iterates of Problem 7.4 at the point (1, 0), h = 1/32, k = 1/10"
            .to_owned(),
        width: 1240,
        height: 620,
        rows: vec![(
            1.0,
            vec![
                panel("All steps", 1.05 * fastest),
                panel("Near the transition to stick", 0.06),
            ],
        )],
    }
    .save(out, "figure7")
}

fn write(out: &Path, steps: &[Path2]) -> Result<(), Failure> {
    let rows = steps.iter().enumerate().flat_map(|(step, iterates)| {
        iterates
            .iter()
            .enumerate()
            .map(move |(i, (rate, stress))| vec![step as f64 + 1.0, i as f64 + 1.0, *rate, *stress])
    });
    write_columns(
        &out.join("figure7.csv"),
        &["step", "iterate", "slip_rate", "friction_stress"],
        rows,
    )
}
