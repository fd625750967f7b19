//! What inputs mean within a step: at its end, or at its beginning, held or continued with a slope.

mod common;

use common::{larger, paper};
use stickslip::scene::Inputs;
use stickslip::{Error, Scene, Simulator, compile};

/// The paper's example under constant friction, from rest.
fn pad(interpolation: &str) -> Scene {
    paper(
        16,
        &[
            (
                "contact.friction",
                "{\"law\": \"tresca\", \"bound\": 0.002}",
            ),
            ("loads[0].start", "0"),
            ("loads[0].interpolation", interpolation),
        ],
    )
}

/// Displacement of the tip after `count` steps of `h`: `set` says what is set before the step that begins at its argument.
fn tip(
    scene: &Scene,
    meaning: Inputs,
    h: f64,
    count: usize,
    set: impl Fn(&mut Simulator, f64),
) -> Vec<f64> {
    let mut simulator = Simulator::new(compile(scene).unwrap());
    simulator.set_inputs_meaning(meaning).unwrap();
    simulator.init(0.0).unwrap();
    let step = |n: usize| {
        let t = n as f64 * h;
        set(&mut simulator, t);
        simulator.do_step(t, h).unwrap();
        simulator.get_by_name("tip.displacement").unwrap()[0]
    };
    (0..count).map(step).collect()
}

fn value(signal: impl Fn(f64) -> f64) -> impl Fn(&mut Simulator, f64) {
    move |simulator, t| simulator.set_inputs(&[signal(t)]).unwrap()
}

const H: f64 = 1.0 / 8.0;

/// A ramp by its slope is the ramp, for held and linear loads and whatever inputs mean: u = value + slope (t - tc).
#[test]
fn a_given_slope_counts_from_the_beginning_of_the_step() {
    let exact = tip(
        &pad("linear"),
        Inputs::EndOfStep,
        H,
        8,
        value(|t| -0.3 * (t + H)),
    );
    let ramp = |simulator: &mut Simulator, t: f64| {
        simulator.set_inputs(&[-0.3 * t]).unwrap();
        simulator.set_input_slope(0, Some(-0.3)).unwrap();
    };
    for kind in ["linear", "hold"] {
        for meaning in [Inputs::EndOfStep, Inputs::Hold, Inputs::Continue] {
            let found = tip(&pad(kind), meaning, H, 8, ramp);
            for (found, exact) in found.iter().zip(&exact) {
                assert!(
                    (found - exact).abs() < 1e-12,
                    "{kind} {meaning:?}: {found} {exact}"
                );
            }
        }
    }
}

/// A jump with slope 0 is a jump at the communication point, not a ramp from the old value.
#[test]
fn a_jump_is_held_from_the_communication_point() {
    let jump = |t: f64| if t < 0.5 { 0.0 } else { -0.3 };
    let exact = tip(&pad("hold"), Inputs::EndOfStep, H, 8, value(jump));
    assert!(exact[3] == 0.0 && exact[4] > 0.05);
    let with_slope = |simulator: &mut Simulator, t: f64| {
        simulator.set_inputs(&[jump(t)]).unwrap();
        simulator.set_input_slope(0, Some(0.0)).unwrap();
    };
    let linear = pad("linear");
    assert_eq!(tip(&linear, Inputs::EndOfStep, H, 8, with_slope), exact);
    assert_eq!(tip(&linear, Inputs::Hold, H, 8, value(jump)), exact);
    // continued, the slope that leads to the jump is none of the load's
    assert_eq!(tip(&linear, Inputs::Continue, H, 8, value(jump)), exact);
}

/// A smooth load set at the beginning of steps: held it lags by half a step, continued it is of second order.
#[test]
fn continued_loads_are_of_second_order_where_they_are_smooth() {
    let smooth = |t: f64| -0.15 * (1.0 - (3.0 * t).cos());
    let run = |meaning, h: f64| {
        let count = (1.0 / h).round() as usize;
        let shift = if meaning == Inputs::EndOfStep { h } else { 0.0 };
        let rows = tip(
            &pad("linear"),
            meaning,
            h,
            count,
            value(move |t| smooth(t + shift)),
        );
        let every = (H / h).round() as usize;
        rows.into_iter()
            .skip(every - 1)
            .step_by(every)
            .collect::<Vec<_>>()
    };
    let reference = run(Inputs::EndOfStep, 1.0 / 1024.0);
    let error = |meaning, h| {
        let pairs = run(meaning, h).into_iter().zip(&reference);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, larger)
    };
    let order = |meaning| (error(meaning, 1.0 / 32.0) / error(meaning, 1.0 / 64.0)).log2();
    let (hold, continued) = (order(Inputs::Hold), order(Inputs::Continue));
    assert!((0.8..1.2).contains(&hold), "{hold}");
    assert!(continued > 1.8, "{continued}");
    assert!(error(Inputs::Continue, 1.0 / 32.0) < 0.2 * error(Inputs::Hold, 1.0 / 32.0));
}

/// A load that goes linearly is continued exactly from its third communication point on, and its steps settle nothing.
#[test]
fn a_ramp_is_continued_without_another_solution() {
    let ramp = |t: f64| -0.3 * t;
    let solves = |meaning| {
        let mut simulator = Simulator::new(compile(&pad("linear")).unwrap());
        simulator.set_inputs_meaning(meaning).unwrap();
        simulator.init(0.0).unwrap();
        let mut counts = Vec::new();
        for n in 0..8 {
            let t = f64::from(n) / 32.0;
            let before = simulator.stage_solves();
            simulator.set_inputs(&[ramp(t)]).unwrap();
            simulator.do_step(t, 1.0 / 32.0).unwrap();
            counts.push(simulator.stage_solves() - before);
        }
        counts
    };
    assert_eq!(solves(Inputs::EndOfStep), [1; 8]);
    assert_eq!(solves(Inputs::Hold), [1, 2, 2, 2, 2, 2, 2, 2]);
    assert_eq!(solves(Inputs::Continue), [1, 2, 1, 1, 1, 1, 1, 1]);
}

/// Slopes are remembered by the state: a run goes on bit for bit in another simulator, and after a rollback.
#[test]
fn slopes_are_part_of_the_state() {
    let load = |t: f64| -0.3 * (5.0 * t).sin();
    let model = compile(&pad("linear")).unwrap();
    let mut simulator = Simulator::new(model.clone());
    simulator.set_inputs_meaning(Inputs::Continue).unwrap();
    simulator.init(0.0).unwrap();
    let go = |simulator: &mut Simulator, from: u32, to: u32| {
        for n in from..to {
            let t = f64::from(n) / 32.0;
            simulator.set_inputs(&[load(t)]).unwrap();
            simulator.do_step(t, 1.0 / 32.0).unwrap();
        }
    };
    go(&mut simulator, 0, 5);
    let bytes = simulator.to_bytes();
    let mut kept = simulator.new_state();
    simulator.save(&mut kept).unwrap();
    go(&mut simulator, 5, 9);
    let end = simulator.state().clone();
    let mut other = Simulator::new(model);
    other.restore_bytes(&bytes).unwrap();
    assert_eq!(other.inputs_meaning(), Inputs::Continue);
    go(&mut other, 5, 9);
    assert_eq!(*other.state(), end);
    simulator.restore(&kept).unwrap();
    go(&mut simulator, 5, 9);
    assert_eq!(*simulator.state(), end);
}

#[test]
fn meanings_and_slopes_are_refused_with_a_reason() {
    let mut simulator = Simulator::new(compile(&pad("linear")).unwrap());
    simulator.init(0.0).unwrap();
    let late = simulator.set_inputs_meaning(Inputs::Hold).unwrap_err();
    assert!(matches!(late, Error::CallOrder { .. }));
    let state = simulator.state().clone();
    let output = simulator
        .model()
        .ports()
        .find("contact.force")
        .unwrap()
        .reference;
    for (reference, slope) in [
        (output, 1.0),
        (9999, 1.0),
        (0, f64::NAN),
        (0, f64::INFINITY),
    ] {
        assert!(simulator.set_input_slope(reference, Some(slope)).is_err());
    }
    assert_eq!(*simulator.state(), state);
    simulator.set_inputs(&[1e308]).unwrap();
    simulator.set_input_slope(0, Some(1e308)).unwrap();
    let before = simulator.state().clone();
    let error = simulator.do_step(0.0, 10.0).unwrap_err();
    assert!(error.to_string().contains("press"), "{error}");
    assert_eq!(*simulator.state(), before);
    simulator.set_input_slope(0, None).unwrap();
    assert_eq!(simulator.input_slope(0), None);
}
