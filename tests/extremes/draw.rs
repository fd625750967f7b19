//! Draws the scenes of the sweep: an ordinary one, of which up to three quantities are driven to their extremes.

use crate::case::{Case, Law, Load};
use crate::random::Random;

/// What can be driven to an extreme.
pub const EXTREMES: [&str; 13] = [
    "step",
    "alpha",
    "bounds",
    "poisson",
    "young",
    "viscosity",
    "mu1",
    "flat",
    "tall",
    "load",
    "sign flips",
    "large load",
    "size",
];

/// Scene number `number` of the sweep.
pub fn draw(number: u64) -> Case {
    let random = &mut Random::new(number.wrapping_mul(0xA076_1D64_78BD_642F) ^ 14);
    let mut case = ordinary(random);
    for _ in 0..[0, 1, 1, 1, 2, 2, 3][random.below(7)] {
        let extreme = random.pick(&EXTREMES);
        if !case.extremes.contains(&extreme) {
            drive(&mut case, extreme, random);
            case.extremes.push(extreme);
        }
    }
    case
}

fn ordinary(random: &mut Random) -> Case {
    let is_space = random.chance(0.3);
    let (size, cells, convention): (Vec<f64>, Vec<u32>, _) = if is_space {
        let cells = random.pick(&[[1, 1, 1], [2, 1, 1], [2, 1, 2]]);
        (vec![1.0, 0.5, 0.75], cells.to_vec(), "three_dimensional")
    } else {
        let cells = random.pick(&[[2, 1], [3, 2], [4, 2], [6, 3]]);
        let convention = random.pick(&["kazmi2014", "plane_strain", "plane_stress"]);
        (vec![1.0, 0.5], cells.to_vec(), convention)
    };
    let law = match random.below(5) {
        0 => Law::Frictionless,
        1 => Law::Tresca(random.power(-3.5, -0.5)),
        _ => {
            let a = random.power(-3.5, -0.5);
            let b = if random.chance(0.2) {
                0.0
            } else {
                a * random.unit()
            };
            Law::Exponential {
                a,
                b,
                alpha: random.power(0.0, 2.5),
            }
        }
    };
    let clamped = random.pick(&["left", "right", "top"]);
    let count = 2 + random.below(3);
    let parts: Vec<_> = ["left", "right", "top"]
        .into_iter()
        .filter(|part| *part != clamped)
        .map(Some)
        .chain([None])
        .collect();
    let loads = (0..1 + random.below(2))
        .map(|i| Load {
            // different places, so that no two loads are the same input twice
            part: parts[(i + random.below(2)) % parts.len()],
            direction: (0..size.len()).map(|_| random.between(-1.0, 1.0)).collect(),
            course: (0..=count)
                .map(|_| 0.3 * random.between(-1.0, 1.0))
                .collect(),
        })
        .collect();
    Case {
        element: if !is_space && random.chance(0.3) {
            "p2"
        } else {
            "p1"
        },
        mu1: 0.05,
        mu2: 0.1,
        young: 1.0,
        poisson: random.between(-0.2, 0.45),
        clamped,
        loads,
        scheme: random.pick(&[
            "trapezoid",
            "backward_euler",
            "tr_bdf2",
            "trapezoid",
            "rectangle",
        ]),
        start: if random.chance(0.85) {
            "consistent"
        } else {
            "zero"
        },
        step: 0.03125,
        cuts: 1 + random.below(3) as u32,
        model: random.pick(&["full", "condensed", "reduced", "auto"]),
        tolerance: 1e-8,
        friction_tolerance: random.pick(&[1e-10, 1e-10, 1e-10, 1e-8, 1e-6]),
        turn: 0.0,
        extremes: Vec::new(),
        size,
        cells,
        convention,
        law,
    }
}

fn drive(case: &mut Case, extreme: &str, random: &mut Random) {
    match extreme {
        "step" => case.step = random.power(-15.0, 9.0),
        "alpha" => {
            let (a, b) = (random.power(-3.5, -0.5), random.unit());
            let alpha = if random.chance(0.1) {
                0.0
            } else {
                random.power(-3.0, 9.0)
            };
            case.law = Law::Exponential { a, b: a * b, alpha };
        }
        "bounds" => {
            let (x, y) = (random.power(-15.0, 6.0), random.power(-15.0, 6.0));
            case.law = match case.law {
                Law::Exponential { alpha, .. } => Law::Exponential {
                    a: x.max(y),
                    b: x.min(y),
                    alpha,
                },
                _ => Law::Tresca(x),
            };
        }
        "poisson" => {
            // 1 - 2 nu down to 1e-15, exact in floating point
            case.poisson = 0.5 * (1.0 - random.power(-15.0, -1.0).max(4.0 * f64::EPSILON));
            if case.convention == "plane_stress" {
                case.convention = "plane_strain";
            }
        }
        "young" => case.young = random.power(-20.0, 20.0),
        "viscosity" => {
            let factor = random.power(-20.0, 20.0);
            case.mu1 *= factor;
            case.mu2 *= factor;
        }
        "mu1" => case.mu1 = random.power(-3.0, 15.0) * case.mu2,
        "flat" => *case.size.last_mut().expect("a size") = 1.0,
        "tall" => case.size[1] *= random.power(0.0, 8.0),
        "load" => *case = case.loaded(random.power(-30.0, 30.0)),
        "large load" => *case = case.loaded(random.power(20.0, 150.0)),
        "sign flips" => {
            for load in &mut case.loads {
                for (i, value) in load.course.iter_mut().enumerate() {
                    *value = value.abs() * if i % 2 == 0 { 1.0 } else { -1.0 };
                }
            }
        }
        "size" => {
            let factor = random.power(-9.0, 9.0);
            case.size.iter_mut().for_each(|x| *x *= factor);
        }
        other => unreachable!("{other}"),
    }
    if extreme == "flat" {
        case.size[1] = case.size[0] * random.power(-9.0, 0.0);
    }
}
