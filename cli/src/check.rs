//! `stickslip check`: what a scene offers a master, what guarantees its steps, and which step to choose.

use crate::arguments::SceneChoice;
use crate::closing;
use crate::console;
use crate::failure::Failure;
use crate::source;
use comfy_table::{Table, presets};
use stickslip::ports::Causality;
use stickslip::scene::{Scene, Scheme};
use stickslip::{Error, Model};

/// A step resolves a mode of relaxation rate r to a few per mille when `k r` is at most this.
const RESOLVED: f64 = 0.5;
/// Digits that the trapezoid loses are mentioned from this share of the slip on.
const WORTH_A_WORD: f64 = 1e-8;
/// The trapezoid damps a mode without changing its sign while `k r` is below this.
const RINGING: f64 = 2.0;

pub fn check(choice: &SceneChoice) -> Result<(), Failure> {
    let mut scene = source::scene(choice, &[])?;
    // a scene that is refused for its step alone is shown with its limit first
    let is_forced = std::mem::replace(&mut scene.time.force, true);
    let compilation = console::compile(&scene).map_err(Failure::of(&choice.scene))?;
    let (scene, model) = (&compilation.scene, &compilation.model);
    let mut rows = closing::compiled(model.summary(), model);
    rows.extend(constants(model));
    rows.extend(step(scene, model));
    let beyond = closing::exceeded_limit(model);
    let verdict = match beyond {
        Some(_) if !is_forced => "refused for its step",
        _ => "valid",
    };
    console::say(&closing::two_columns(
        &format!("{}: {verdict}", choice.scene),
        rows,
    ))?;
    console::say(&format!("\nports\n{}", ports(model)))?;
    let step = scene.time.step;
    match beyond.map(|limit| Error::Unstable { step, limit }) {
        None => Ok(()),
        Some(error) if is_forced => {
            console::warn(&format!("warning: {}: {error}", choice.scene));
            Ok(())
        }
        Some(error) => Err(Failure::of(&choice.scene)(error)),
    }
}

/// The certificate, number by number.
fn constants(model: &Model) -> Vec<(&'static str, String)> {
    let c = model.certificate();
    let yes = |holds: bool| if holds { "holds" } else { "does not hold" };
    vec![
        (
            "c0²",
            format!("{:.6} m (trace constant, (5.12))", c.c0_squared),
        ),
        (
            "L_g",
            format!(
                "{:.6} Pa s/m (Lipschitz constant of the bound, (5.16))",
                c.l_g
            ),
        ),
        (
            "m_A",
            format!("{:.6} Pa s (ellipticity of the viscosity)", c.m_a),
        ),
        (
            "Theorem 5.3, (2.6)",
            format!(
                "{}: c0² L_g = {:.6} against m_A; one solution of the continuous problem",
                yes(c.is_theorem_satisfied()),
                c.c0_squared * c.l_g
            ),
        ),
        ("(3.6)", step_limit(c.step_limit())),
        (
            "sharp condition",
            format!(
                "{} at time.step = {} s: smallest eigenvalue {:.6} Pa s/m against L_g, margin {:+.1} %; {:.6} as the \
                 step goes to 0",
                yes(c.is_step_unique()),
                model.largest_step(),
                c.sharp_step,
                100.0 * c.margin(),
                c.sharp_instant
            ),
        ),
    ]
}

fn step_limit(limit: f64) -> String {
    if limit > 0.0 {
        format!("holds for trapezoidal steps below {limit:.6} s")
    } else {
        "guarantees no step".to_owned()
    }
}

/// Relaxation rates and the step they ask for.
fn step(scene: &Scene, model: &Model) -> Vec<(&'static str, String)> {
    let [slowest, fastest] = model.summary().rates;
    let step = scene.time.step;
    let product = step * fastest;
    let mut rows = vec![(
        "relaxation rates",
        format!("{slowest:.4} to {fastest:.4} 1/s"),
    )];
    if let Some(limit) = model.stability_limit() {
        let word = if step > limit { "UNSTABLE" } else { "stable" };
        rows.push((
            "stability limit",
            format!("{limit:.6} s (k r < 2): time.step = {step} s is {word}"),
        ));
    }
    if fastest > 0.0 {
        let found = match scene.time.scheme {
            _ if product <= RESOLVED => "resolves the fastest relaxation",
            Scheme::Trapezoid if product > RINGING => "rings: use a smaller step or tr_bdf2",
            _ => "does not resolve the fastest relaxation",
        };
        rows.push((
            "advised step",
            format!(
                "{:.6} s (k r <= 1/2 for the fastest rate r; the trapezoid rings beyond k r = 2); \
                 time.step = {step} s has k r = {product:.3} and {found}",
                RESOLVED / fastest
            ),
        ));
    }
    let lost = f64::EPSILON * product;
    if scene.time.scheme == Scheme::Trapezoid && lost > WORTH_A_WORD {
        rows.push((
            "lost digits",
            format!(
                "slip and displacements hold to about {lost:.0e} of their largest (eps k r): far beyond k r = 2 the velocity of \
                 the trapezoid changes its sign from step to step, and its sums cancel; tr_bdf2 and backward_euler keep the digits"
            ),
        ));
    }
    rows
}

fn ports(model: &Model) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["reference", "name", "unit", "causality", "shape"]);
    for port in model.ports().all() {
        let causality = match port.causality {
            Causality::Input => "input",
            Causality::Output => "output",
            Causality::Parameter => "parameter",
        };
        let shape: Vec<_> = port.shape.iter().map(usize::to_string).collect();
        let shape = if shape.is_empty() {
            "scalar".to_owned()
        } else {
            shape.join(" x ")
        };
        table.add_row([
            port.reference.to_string(),
            port.name.clone(),
            port.unit.to_owned(),
            causality.to_owned(),
            shape,
        ]);
    }
    closing::trimmed(&table)
}
