//! Draws the scenes: an ordinary one, of which up to three quantities go to an extreme.

use super::case::{Branch, Case, Condition, Contact, Gap, Held, Law, Load, Material, Motion, Path};
use super::drive::{EXTREMES, drive};
use super::friction::{Coefficient, Friction};
use crate::random::Random;

pub fn draw(number: u64) -> Case {
    let random = &mut Random::new(number.wrapping_mul(0xA076_1D64_78BD_642F) ^ 1_400_014);
    let mut case = ordinary(random);
    for _ in 0..[0, 1, 1, 1, 2, 2, 3][random.below(7)] {
        let extreme = random.pick(&EXTREMES);
        if !case.extremes.contains(&extreme) && drive(&mut case, extreme, random) {
            case.extremes.push(extreme);
        }
    }
    case
}

fn course(random: &mut Random, count: usize, size: f64) -> Vec<f64> {
    (0..=count)
        .map(|_| size * random.between(-1.0, 1.0))
        .collect()
}

fn ordinary(random: &mut Random) -> Case {
    let is_space = random.chance(0.25);
    let (size, cells): (Vec<f64>, Vec<u32>) = if is_space {
        (
            vec![1.0, 0.5, 0.75],
            random.pick(&[[1, 1, 1], [2, 1, 1], [2, 2, 1]]).to_vec(),
        )
    } else {
        (
            vec![1.0, 0.5],
            random.pick(&[[2, 1], [3, 2], [4, 2], [6, 4]]).to_vec(),
        )
    };
    let dimension = size.len();
    let count = 2 + random.below(3);
    let has_two = random.chance(0.2);
    let holder = if has_two {
        random.pick(&["left", "right"])
    } else {
        random.pick(&["left", "right", "top"])
    };
    let is_even = cells[1].is_multiple_of(2);
    let is_driven = random.chance(0.35);
    let is_nonlinear = !is_driven && random.chance(0.2);
    let materials = (0..if is_even && random.chance(0.3) { 2 } else { 1 })
        .map(|_| material(random, dimension, is_nonlinear))
        .collect();
    let model = if is_nonlinear {
        random.pick(&["full", "condensed", "auto"])
    } else {
        random.pick(&["full", "condensed", "reduced", "auto"])
    };
    let held = if is_driven {
        driven(random, holder, &size, count)
    } else {
        Held::Clamped(holder)
    };
    let opens = random.chance(0.6);
    let parts: &[&'static str] = if has_two {
        &["bottom", "top"]
    } else {
        &["bottom"]
    };
    let contacts: Vec<Contact> = parts
        .iter()
        .map(|part| contact(random, part, &size, count, opens))
        .collect();
    let mut places: Vec<_> = ["left", "right", "top"]
        .into_iter()
        .filter(|p| *p != holder && !parts.contains(p))
        .map(Some)
        .collect();
    places.push(None);
    let loads = (0..1 + random.below(2)).map(|i| {
        let mut direction: Vec<f64> = (0..dimension).map(|_| random.between(-1.0, 1.0)).collect();
        // mostly pressed
        direction[1] = -direction[1].abs();
        let mut course = course(random, count, 0.3);
        if random.chance(0.7) {
            course.iter_mut().for_each(|x| *x = x.abs());
        }
        Load {
            part: places[(i + random.below(2)) % places.len()],
            direction,
            course,
        }
    });
    let loads: Vec<Load> = loads.collect();
    let approaches = contacts
        .iter()
        .any(|c| c.foundation.iter().any(|m| m.path == Path::Approach));
    let is_closed = contacts.iter().all(|c| c.condition == Condition::Bilateral);
    let scheme = match (
        is_closed && !approaches,
        contacts
            .iter()
            .all(|c| matches!(c.condition, Condition::Compliance { .. })),
    ) {
        (true, _) => random.pick(&["auto", "trapezoid", "midpoint", "backward_euler", "tr_bdf2"]),
        (_, false)
            if !contacts
                .iter()
                .any(|c| matches!(c.condition, Condition::Compliance { .. })) =>
        {
            random.pick(&["auto", "midpoint", "backward_euler", "tr_bdf2"])
        }
        _ => random.pick(&["auto", "backward_euler", "tr_bdf2"]),
    };
    Case {
        element: if !is_space && random.chance(0.2) {
            "p2"
        } else {
            "p1"
        },
        materials,
        held,
        contacts,
        loads,
        holds: false,
        scheme,
        step: 0.03125,
        cuts: 1 + random.below(3) as u32,
        model,
        tolerance: 1e-8,
        friction_tolerance: random.pick(&[1e-10, 1e-10, 1e-8]),
        extremes: Vec::new(),
        size,
        cells,
    }
}

fn material(random: &mut Random, dimension: usize, is_nonlinear: bool) -> Material {
    let scale = random.between(0.5, 2.0);
    let matrix = |random: &mut Random, scale: f64| {
        let n = [3, 6][dimension - 2];
        let mut rows = vec![vec![0.0; n]; n];
        let mut set = |i: usize, j: usize, value: f64| {
            rows[i][j] = scale * value;
            rows[j][i] = scale * value;
        };
        for i in 0..n {
            set(i, i, if i < dimension { 2.0 } else { 0.7 });
            for j in 0..i {
                set(i, j, 0.2 * random.between(-1.0, 1.0));
            }
        }
        Law::Matrix(rows)
    };
    let (viscosity, elasticity) = if is_nonlinear {
        let mu2 = 0.1 * scale;
        let viscosity = match random.below(2) {
            0 => Law::Viscous {
                mu1: 0.05 * scale,
                mu2,
            },
            _ => Law::Carreau {
                mu1: 0.05 * scale,
                rest: mu2,
                fast: 0.2 * mu2,
                rate: random.power(-1.5, 0.5),
            },
        };
        let elasticity = match random.below(3) {
            0 => Law::Isotropic {
                young: scale,
                poisson: 0.3,
            },
            1 => Law::VonMises {
                young: scale,
                poisson: 0.25,
                beta: scale,
                kappa: random.power(-2.0, 0.0),
            },
            _ => Law::Hencky {
                bulk: scale,
                rest: scale,
                far: 0.3 * scale,
                strain: random.power(-2.0, 0.0),
            },
        };
        (viscosity, elasticity)
    } else {
        let viscosity = match random.below(4) {
            0 => matrix(random, 0.1 * scale),
            _ => Law::Viscous {
                mu1: 0.05 * scale,
                mu2: 0.1 * scale,
            },
        };
        let elasticity = match random.below(4) {
            0 => matrix(random, scale),
            1 => Law::Orthotropic {
                scale,
                ratios: [1.0, random.between(0.5, 2.0), 0.8],
                angle: random.between(-90.0, 90.0),
            },
            _ => Law::Isotropic {
                young: scale,
                poisson: random.between(-0.2, 0.45),
            },
        };
        (viscosity, elasticity)
    };
    let branches = if random.chance(0.35) {
        1 + random.below(2)
    } else {
        0
    };
    let memory = (0..branches).map(|_| Branch {
        tau: random.power(-2.0, 0.5),
        shear: scale * random.between(0.05, 0.5),
        bulk: scale * random.between(0.0, 0.5),
    });
    Material {
        viscosity,
        elasticity,
        memory: memory.collect(),
    }
}

fn driven(random: &mut Random, part: &'static str, size: &[f64], count: usize) -> Held {
    let dimension = size.len();
    let axis = |i: usize| {
        (0..dimension)
            .map(|j| f64::from(i == j))
            .collect::<Vec<f64>>()
    };
    let input = random.pick(&["velocity", "displacement"]);
    let amount = if input == "velocity" { 0.1 } else { 0.01 };
    let mut motions: Vec<Motion> = (0..dimension)
        .map(|i| Motion {
            path: Path::Translation(axis(i)),
            course: course(random, count, amount),
        })
        .collect();
    if dimension == 2 && random.chance(0.3) {
        motions.push(Motion {
            path: Path::Rotation(size.iter().map(|x| 0.5 * x).collect()),
            course: course(random, count, amount),
        });
    }
    // a part starts where it is, at rest
    motions.iter_mut().for_each(|motion| motion.course[0] = 0.0);
    Held::Driven {
        part,
        input,
        motions,
    }
}

fn contact(
    random: &mut Random,
    part: &'static str,
    size: &[f64],
    count: usize,
    opens: bool,
) -> Contact {
    let gap = |random: &mut Random| match random.below(3) {
        0 => Gap(0.0, 0.0),
        1 => Gap(0.01, 0.01),
        _ => Gap(0.02 * random.unit(), 0.02 * random.unit()),
    };
    let condition = match (opens, random.below(3)) {
        (false, _) => Condition::Bilateral,
        (_, 0) => Condition::Compliance {
            gap: gap(random),
            stiffness: random.power(-0.5, 1.5),
            exponent: random.pick(&[1.0, 1.5, 2.0]),
        },
        _ => Condition::Unilateral(gap(random)),
    };
    let is_bound = !opens && random.chance(0.15);
    let unit = if is_bound { 0.05 } else { 1.0 };
    let rest = unit * random.between(0.1, 0.8);
    let fast = rest * random.between(0.3, 1.0);
    let coefficient = match random.below(6) {
        0 | 1 => Coefficient::Number(rest),
        2 => Coefficient::Exponential {
            rest,
            fast,
            decay: random.power(-1.0, 1.0),
        },
        3 => Coefficient::Stribeck {
            rest,
            fast,
            velocity: random.power(-1.0, 1.0),
            exponent: random.pick(&[1.0, 1.5, 2.0]),
        },
        4 => Coefficient::Weakening {
            rest,
            worn: fast,
            distance: random.power(-2.0, 0.0),
        },
        _ => Coefficient::Creeping {
            value: rest,
            a: 0.05 * unit,
            b: unit * random.between(0.01, 0.06),
            rate: random.power(-3.0, -1.0),
            distance: random.power(-2.0, 0.0),
            evolution: random.pick(&["aging", "slip"]),
        },
    };
    let friction = if is_bound {
        Friction::Bound(coefficient)
    } else {
        let cap = if random.chance(0.15) {
            Some(random.between(0.02, 0.2))
        } else {
            None
        };
        Friction::Coulomb {
            coefficient,
            cap,
            tension: !opens && random.chance(0.3),
        }
    };
    let mut foundation = Vec::new();
    if random.chance(0.4) {
        let mut direction = vec![1.0; size.len()];
        direction[1] = 0.0;
        foundation.push(Motion {
            path: Path::Translation(direction),
            course: course(random, count, 0.1),
        });
    }
    if random.chance(0.2) {
        // the axis far enough below that the motion stays within the surface
        let centre = match size {
            [x, y] => vec![
                0.5 * x,
                if part == "bottom" {
                    -4.0 * x
                } else {
                    y + 4.0 * x
                },
            ],
            _ => size.iter().map(|x| 0.5 * x).collect(),
        };
        foundation.push(Motion {
            path: Path::Rotation(centre),
            course: course(random, count, 0.05),
        });
    }
    if random.chance(0.3) {
        let mut course = course(random, count, 0.01);
        course[0] = 0.0;
        foundation.push(Motion {
            path: Path::Approach,
            course,
        });
    }
    Contact {
        part,
        condition,
        friction,
        foundation,
    }
}
