//! `stickslip check`: what a scene offers a master, what guarantees its steps, and which step to choose.

use crate::arguments::SceneChoice;
use crate::check_material;
use crate::closing::{self, figure};
use crate::console;
use crate::failure::Failure;
use crate::source;
use comfy_table::{Table, presets};
use stickslip::message::number;
use stickslip::model::certificate::CoulombConstants;
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
    let compilation =
        console::compile(&scene, &source::files(choice)).map_err(Failure::of(choice.name()))?;
    let (scene, model) = (&compilation.scene, &compilation.model);
    let mut rows = closing::compiled(model.summary(), model);
    rows.extend(constants(model));
    rows.extend(memories(scene));
    rows.extend(check_material::free(model));
    rows.extend(steady_slip(model));
    rows.extend(step(scene, model));
    rows.extend(check_material::advice(&compilation));
    let beyond = closing::exceeded_limit(model);
    let verdict = match beyond {
        Some(_) if !is_forced => "refused for its step",
        _ => "valid",
    };
    console::say(&closing::two_columns(
        &format!("{}: {verdict}", choice.name()),
        rows,
    ))?;
    console::say(&format!("\nports\n{}", ports(model)))?;
    let step = scene.time.step;
    match beyond.map(|limit| Error::Unstable { step, limit }) {
        None => Ok(()),
        Some(error) if is_forced => {
            console::warn(&format!("warning: {}: {error}", choice.name()));
            Ok(())
        }
        Some(error) => Err(Failure::of(choice.name())(error)),
    }
}

/// The certificate, number by number.
fn constants(model: &Model) -> Vec<(&'static str, String)> {
    let c = model.certificate();
    if let Some(coulomb) = &c.coulomb {
        return coulomb_constants(model, coulomb);
    }
    let product = c.c0_squared * c.l_g;
    let theorem = match c.is_theorem_satisfied() {
        true => format!(
            "holds: c0² L_g = {} < m_A; the continuous problem has one solution",
            figure(product, 6)
        ),
        false => format!(
            "does not hold: c0² L_g = {} >= m_A; whether the continuous problem has one solution or several is not decided",
            figure(product, 6)
        ),
    };
    let (holds, meaning) = match c.is_step_unique() {
        true => ("holds", "every internal step has one solution"),
        false => (
            "does not hold",
            "whether an internal step has one solution or several is not decided",
        ),
    };
    let sharp = format!(
        "{holds} at time.step = {} s: smallest eigenvalue {} Pa s/m against L_g, margin {:+.1} %; {} as the step goes to \
         0; {meaning}",
        number(model.largest_step()),
        figure(c.sharp_step, 6),
        100.0 * c.margin(),
        figure(c.sharp_instant, 6)
    );
    let value = |value: f64, text: &str| format!("{} {text}", figure(value, 6));
    vec![
        ("c0²", value(c.c0_squared, "m (trace constant, (5.12))")),
        (
            "L_g",
            value(c.l_g, "Pa s/m (Lipschitz constant of the bound, (5.16))"),
        ),
        ("m_A", value(c.m_a, "Pa s (ellipticity of the viscosity)")),
        (
            "L_A",
            value(c.l_a, "Pa s (Lipschitz constant of the viscosity)"),
        ),
        (
            "L_B",
            value(c.l_b, "Pa (Lipschitz constant of the elasticity)"),
        ),
        ("Theorem 5.3, (2.6)", theorem),
        ("(3.6)", step_limit(c.step_limit())),
        ("sharp condition", sharp),
    ]
}

/// The same where friction follows the pressure.
fn coulomb_constants(model: &Model, coulomb: &CoulombConstants) -> Vec<(&'static str, String)> {
    let c = model.certificate();
    let step = number(model.largest_step());
    let sum = format!(
        "max P L_mu / {} + {} < 1",
        figure(c.sharp_step, 6),
        figure(coulomb.strength(), 6)
    );
    let verdict = match c.largest_pressure() {
        0.0 => "not decided: whether an internal step has one solution or several".to_owned(),
        f64::INFINITY => "proved: every internal step has one solution, at any pressure".to_owned(),
        pressure => format!(
            "proved while the pressure is below {} Pa: an internal step has one solution then; not decided beyond",
            figure(pressure, 6)
        ),
    };
    let value = |value: f64, text: &str| format!("{} {text}", figure(value, 6));
    vec![
        (
            "mu_max",
            value(coulomb.coefficient, "(largest coefficient)"),
        ),
        (
            "L_mu",
            value(
                coulomb.weakening,
                "s/m (largest rate at which it falls with the slip rate)",
            ),
        ),
        ("m", value(c.sharp_step, "Pa s/m (resistance to slip)")),
        (
            "c",
            value(
                coulomb.coupling,
                "(how far the pressure follows the friction)",
            ),
        ),
        (
            "one solution",
            format!("{verdict}; {sum} at time.step = {step} s"),
        ),
    ]
}

/// Up to which slip rate the steps of friction with a state are sure to follow it.
fn steady_slip(model: &Model) -> Option<(&'static str, String)> {
    if !model.friction().has_memory() {
        return None;
    }
    let step = number(model.largest_step());
    let text = match model.steady_slip_limit() {
        f64::INFINITY => {
            "a step at steady slip resists more the faster it slips, at any rate and step"
                .to_owned()
        }
        limit => format!(
            "a step at steady slip resists more the faster it slips up to {} m/s at time.step = {step} s; faster, it may have several \
             solutions: a smaller step, or a scheme that averages (trapezoid, tr_bdf2)",
            figure(limit, 6)
        ),
    };
    Some(("rate and state", text))
}

fn step_limit(limit: f64) -> String {
    if limit > 0.0 {
        format!("holds for trapezoidal steps below {} s", figure(limit, 6))
    } else {
        "guarantees no step".to_owned()
    }
}

/// What memory the materials have, and how well it meets what it was fitted to.
fn memories(scene: &Scene) -> Vec<(&'static str, String)> {
    let row = |(path, branches, error): (String, usize, Option<f64>)| {
        let fit = error.map_or(String::new(), |error| {
            format!(", fitted to {} % at worst", figure(100.0 * error, 2))
        });
        ("memory", format!("{path}: {branches} branches{fit}"))
    };
    scene.memories().into_iter().map(row).collect()
}

/// Relaxation rates and the step they ask for.
fn step(scene: &Scene, model: &Model) -> Vec<(&'static str, String)> {
    let [slowest, fastest] = model.summary().rates;
    let step = scene.time.step;
    let product = step * fastest;
    let mut rows = vec![(
        "relaxation rates",
        match fastest.is_finite() {
            true => format!("{} to {} 1/s", figure(slowest, 4), figure(fastest, 4)),
            false => format!(
                "{} 1/s to infinite: a material has no dashpot; tr_bdf2 and backward_euler from start zero may run",
                figure(slowest, 4)
            ),
        },
    )];
    if let Some(limit) = model.stability_limit() {
        let word = if step > limit { "UNSTABLE" } else { "stable" };
        rows.push((
            "stability limit",
            format!(
                "{} s (k r < 2): time.step = {} s is {word}",
                figure(limit, 6),
                number(step)
            ),
        ));
    }
    if fastest > 0.0 && fastest.is_finite() {
        let found = match scene.scheme() {
            _ if product <= RESOLVED => "resolves the fastest relaxation",
            Scheme::Trapezoid if product > RINGING => {
                "rings: use a smaller step, or tr_bdf2 (beyond k r = 4 in any case)"
            }
            _ => "does not resolve the fastest relaxation",
        };
        rows.push((
            "advised step",
            format!(
                "{} s (k r <= 1/2 for the fastest rate r; the trapezoid rings beyond k r = 2); \
                 time.step = {} s has k r = {} and {found}",
                figure(RESOLVED / fastest, 6),
                number(step),
                figure(product, 3)
            ),
        ));
    }
    let lost = f64::EPSILON * product;
    let keeps_velocity = matches!(scene.scheme(), Scheme::Trapezoid | Scheme::TrBdf2);
    if keeps_velocity && lost > WORTH_A_WORD {
        rows.push((
            "lost digits",
            format!(
                "slip and displacements hold to about {lost:.0e} of their largest (eps k r): after a jump of the loads the velocity \
                 is that of the viscosity alone, which the next stages take out again; backward_euler keeps the digits"
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
