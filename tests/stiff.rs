//! Steps far larger than the relaxation times, k r = 1e3 to 1e6, on a column that relaxes at the single rate r: closed forms of
//! the schemes and of the column. The trapezoid rings there, TR-BDF2 and backward Euler do not.

mod common;

use common::{column, scene, start, value};
use serde_json::{Value, json};
use stickslip::Simulator;

/// Relaxation rate of the column, 1/s: two_mu_B = 4.8 = r two_mu_A, lambda_B = 1.2 = r lambda_A.
const RATE: f64 = 2.4;
const FRICTION: f64 = 0.1;

fn stiff(scheme: &str, interpolation: &str, friction: Value, product: f64) -> Value {
    let time = json!({"scheme": scheme, "step": product / RATE});
    let mut value = column(friction, time);
    value["material"]["elasticity"]["young"] = json!(5.6);
    value["material"]["elasticity"]["poisson"] = json!(1.0 / 6.0);
    value["loads"][0]["interpolation"] = json!(interpolation);
    value
}

fn step(simulator: &mut Simulator, load: f64, k: f64) -> f64 {
    simulator.set_inputs(&[load]).unwrap();
    simulator.do_step(simulator.time(), k).unwrap();
    value(simulator, "contact.slip_rate")
}

/// What a step makes of the velocity of a mode, `z = k r`: (1 - z/2)/(1 + z/2), 1/(1 + z), and Hosea and Shampine's for TR-BDF2.
fn amplification(scheme: &str, z: f64) -> f64 {
    let d = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
    match scheme {
        "trapezoid" => (1.0 - 0.5 * z) / (1.0 + 0.5 * z),
        "backward_euler" => 1.0 / (1.0 + z),
        _ => {
            let middle = (1.0 - d * z) / (1.0 + d * z);
            (1.0 - 0.5 * std::f64::consts::FRAC_1_SQRT_2 * z * (1.0 + middle)) / (1.0 + d * z)
        }
    }
}

/// A load switched on, without friction: every step multiplies the velocity by the amplification of its scheme, which
/// tends to -1 for the trapezoid and to 0 for the others.
#[test]
fn velocity_after_a_jump() {
    for product in [1e3, 1e4, 1e5, 1e6] {
        for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
            let frictionless = json!({"law": "frictionless"});
            let mut value_of_scene = stiff(scheme, "hold", frictionless, product);
            value_of_scene["loads"][0]["start"] = json!(0.7);
            let mut simulator = start(&scene(&value_of_scene));
            let first = value(&simulator, "contact.slip_rate");
            let factor = amplification(scheme, product);
            let mut expected = first;
            for _ in 0..3 {
                expected *= factor;
                let found = step(&mut simulator, 0.7, product / RATE);
                // what is left of a displacement of the size first / r, seen through k
                let rounding = 1e-13 * first;
                assert!(
                    (found - expected).abs() <= 1e-9 * expected.abs() + rounding,
                    "{scheme} {product:e}: {found:e} {expected:e}"
                );
            }
            let rings = expected < -0.98 * first;
            let is_quiet = expected.abs() < 1e-6 * first;
            assert!(if scheme == "trapezoid" {
                rings
            } else {
                is_quiet
            });
            if scheme != "trapezoid" {
                // the displacement at rest: half of the drag against the shear stiffness, see tests/closed_forms.rs
                let slip = value(&simulator, "contact.slip");
                assert!((slip / (0.7 / 4.8) - 1.0).abs() < 1e-6, "{scheme}: {slip}");
            }
        }
    }
}

/// A load that grows at a constant rate, with friction: the column follows it at rest, `w = F' / (r A)`. Per unit of slip rate
/// the drag must grow by 4.8 per second.
#[test]
fn velocity_under_a_ramp() {
    for product in [1e3, 1e4, 1e5, 1e6] {
        let k = product / RATE;
        let run = |scheme: &str| -> Vec<f64> {
            let friction = json!({"law": "tresca", "bound": FRICTION});
            let mut simulator = start(&scene(&stiff(scheme, "linear", friction, product)));
            let load = |n: i32| 0.7 * f64::from(n);
            let exact = 0.7 / k / 4.8;
            (1..=6)
                .map(|n| step(&mut simulator, load(n), k) / exact - 1.0)
                .collect()
        };
        // the first steps hold the onset of slip
        for scheme in ["tr_bdf2", "backward_euler"] {
            let errors = run(scheme);
            let late = errors[2..].iter().all(|e| e.abs() < 1e-4);
            assert!(late, "{scheme} {product:e}: {errors:?}");
        }
        let errors = run("trapezoid");
        let rings = errors[2..].windows(2).all(|e| e[0] * e[1] < 0.0);
        assert!(rings && errors[5].abs() > 0.3, "{product:e}: {errors:?}");
    }
}

/// With a tolerance all of them follow the jump and the ramp, in a bounded number of solves: the transient is resolved, and
/// then steps are large again.
#[test]
fn chosen_steps_resolve_the_transient_and_grow() {
    for product in [1e3, 1e6] {
        let k = product / RATE;
        for scheme in ["trapezoid", "tr_bdf2"] {
            for interpolation in ["hold", "linear"] {
                let friction = json!({"law": "tresca", "bound": FRICTION});
                let mut value_of_scene = stiff(scheme, interpolation, friction, product);
                value_of_scene["time"]["tolerance"] = json!(1e-3);
                let mut simulator = start(&scene(&value_of_scene));
                let rate = if interpolation == "hold" {
                    0.0
                } else {
                    0.7 / k
                };
                for n in 1..=5 {
                    let load = if rate == 0.0 { 0.7 } else { 0.7 * f64::from(n) };
                    let before = simulator.stage_solves();
                    let found = step(&mut simulator, load, k);
                    let scale = if rate == 0.0 { 0.25 } else { rate / 4.8 };
                    let error = (found - rate / 4.8).abs() / scale;
                    assert!(
                        error < 1e-3,
                        "{scheme} {interpolation} {product:e}: {error:e}"
                    );
                    let solves = simulator.stage_solves() - before;
                    let most = if n == 1 { 600 } else { 6 };
                    assert!(solves <= most, "{scheme} {interpolation} {n}: {solves}");
                }
                assert!(value(&simulator, "solver.error_estimate") < 1e-3);
                assert!(
                    simulator.factorizations() < 60,
                    "{}",
                    simulator.factorizations()
                );
            }
        }
    }
}

/// Beyond that the velocity after a jump, times the step, takes digits from the displacement. The step says how many: the slip
/// after it, first / r times (1 - amplification), is off by no more than that, and backward Euler loses nothing.
#[test]
fn lost_digits_are_told() {
    let mut worst: f64 = 0.0;
    for product in [1e5, 1e9, 1e12] {
        for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
            let frictionless = json!({"law": "frictionless"});
            let mut value_of_scene = stiff(scheme, "hold", frictionless, product);
            value_of_scene["loads"][0]["start"] = json!(0.7);
            let mut simulator = start(&scene(&value_of_scene));
            let first = value(&simulator, "contact.slip_rate");
            step(&mut simulator, 0.7, product / RATE);
            let is_lossy = scheme != "backward_euler" && product > 1e6;
            let shown = simulator.get_by_name("solver.lost_digits");
            assert_eq!(shown.is_ok(), is_lossy, "{scheme} {product:e}");
            assert_eq!(simulator.lost_digits().is_some(), is_lossy);
            let right = first / RATE * (1.0 - amplification(scheme, product));
            let off = (value(&simulator, "contact.slip") / right - 1.0).abs();
            match simulator.lost_digits() {
                Some(lost) => {
                    assert_eq!(shown.unwrap(), [lost]);
                    let most = f64::EPSILON * product;
                    assert!(lost > 2e-8 && lost < 2.0 * most, "{scheme}: {lost:e}");
                    assert!(off < 3.0 * lost, "{scheme} {product:e}: {off:e} {lost:e}");
                    worst = worst.max(off);
                }
                None => assert!(off < 1e-9, "{scheme} {product:e}: {off:e}"),
            }
        }
    }
    // a note about nothing would be none
    assert!(worst > 1e-6, "{worst:e}");
}

/// A step of 1e15 relaxation times runs, and says that nothing of its displacement is right.
#[test]
fn a_ratio_of_1e15_runs_with_the_note() {
    let text = include_str!("cases/trapezoid_ratio_1e15.json");
    let scene = stickslip::Scene::from_json(text, "trapezoid_ratio_1e15").unwrap();
    let mut simulator = start(&scene);
    for _ in 0..6 {
        simulator.do_step(simulator.time(), 0.02).unwrap();
        let lost = simulator.lost_digits().unwrap();
        assert!(lost > 1e-3 && lost <= 1.0, "{lost:e}");
    }
}

#[cfg(feature = "capi")]
#[test]
#[allow(unsafe_code)]
fn the_note_has_a_code_in_c() {
    use std::ffi::{CStr, CString};
    use stickslip::capi::*;
    let text = CString::new(include_str!("cases/trapezoid_ratio_1e15.json")).unwrap();
    let (mut model, mut simulator) = (std::ptr::null_mut(), std::ptr::null_mut());
    // SAFETY: handles live until they are freed, texts as long as they are read
    unsafe {
        assert_eq!(stickslip_model_compile(text.as_ptr(), &mut model), 0);
        assert_eq!(stickslip_new(model, &mut simulator), 0);
        assert_eq!(stickslip_init(simulator, 0.0), 0);
        assert_eq!(
            stickslip_do_step(simulator, 0.0, 0.02),
            STICKSLIP_DIGITS_LOST
        );
        let name = CStr::from_ptr(stickslip_code_name(STICKSLIP_DIGITS_LOST));
        assert_eq!(name, c"DIGITS_LOST");
        let mut said = [0; 512];
        stickslip_last_error(said.as_mut_ptr(), said.len());
        let said = CStr::from_ptr(said.as_ptr()).to_str().unwrap();
        assert!(
            said.contains("lost about") && said.contains("backward_euler"),
            "{said}"
        );
        stickslip_free(simulator);
        stickslip_model_free(model);
    }
}
