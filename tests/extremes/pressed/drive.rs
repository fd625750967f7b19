//! What goes to an extreme.

use super::case::{Case, Condition, Gap, Held, Law, Motion, Path};
use super::friction::{Coefficient, Friction};
use crate::random::Random;

/// What can be driven to an extreme.
pub const EXTREMES: [&str; 15] = [
    "coefficient",
    "decay",
    "gap",
    "stiffness",
    "tau",
    "branch",
    "step",
    "loads",
    "motions",
    "sign flips",
    "no loads",
    "jumps",
    "young",
    "size",
    "state",
];

/// Whether the case has what is named.
pub fn drive(case: &mut Case, extreme: &str, random: &mut Random) -> bool {
    let mut applies = false;
    match extreme {
        "coefficient" => {
            for contact in &mut case.contacts {
                let value = if random.chance(0.1) {
                    0.0
                } else {
                    random.power(-9.0, 0.7)
                };
                match &mut contact.friction {
                    Friction::Coulomb {
                        coefficient: Coefficient::Number(x),
                        ..
                    } => *x = value,
                    Friction::Coulomb {
                        coefficient:
                            Coefficient::Exponential { rest, fast, .. }
                            | Coefficient::Stribeck { rest, fast, .. },
                        ..
                    } => {
                        (*rest, *fast) = (value, value * random.unit());
                    }
                    Friction::Coulomb {
                        coefficient: Coefficient::Weakening { rest, worn, .. },
                        ..
                    } => {
                        (*rest, *worn) = (value, value * random.unit());
                    }
                    _ => continue,
                }
                applies = true;
            }
        }
        "decay" => {
            let factor = random.power(-9.0, 9.0);
            for contact in &mut case.contacts {
                let (Friction::Bound(coefficient) | Friction::Coulomb { coefficient, .. }) =
                    &mut contact.friction;
                match coefficient {
                    Coefficient::Exponential { decay: x, .. }
                    | Coefficient::Stribeck { velocity: x, .. }
                    | Coefficient::Weakening { distance: x, .. } => {
                        *x *= factor;
                    }
                    _ => continue,
                }
                applies = true;
            }
        }
        "state" => {
            for contact in &mut case.contacts {
                let (Friction::Bound(coefficient) | Friction::Coulomb { coefficient, .. }) =
                    &mut contact.friction;
                if let Coefficient::Creeping {
                    rate,
                    distance,
                    a,
                    b,
                    ..
                } = coefficient
                {
                    (*rate, *distance) = (random.power(-12.0, 3.0), random.power(-9.0, 6.0));
                    *a *= random.power(-2.0, 1.0);
                    *b *= random.power(-2.0, 1.0);
                    applies = true;
                }
            }
        }
        "gap" | "stiffness" => {
            for contact in &mut case.contacts {
                match &mut contact.condition {
                    Condition::Unilateral(gap) | Condition::Compliance { gap, .. }
                        if extreme == "gap" =>
                    {
                        let size = random.power(-12.0, 0.0);
                        *gap = Gap(size * random.unit(), size);
                    }
                    Condition::Compliance { stiffness, .. } if extreme == "stiffness" => {
                        *stiffness = random.power(-6.0, 12.0)
                    }
                    _ => continue,
                }
                applies = true;
            }
        }
        "tau" | "branch" => {
            for branch in case.materials.iter_mut().flat_map(|m| &mut m.memory) {
                applies = true;
                if extreme == "tau" {
                    branch.tau = random.power(-9.0, 9.0);
                } else {
                    let factor = random.power(-6.0, 6.0);
                    branch.shear *= factor;
                    branch.bulk *= factor;
                }
            }
        }
        "step" => {
            case.step = random.power(-12.0, 6.0);
            applies = true;
        }
        "loads" => {
            let factor = random.power(-12.0, 12.0);
            applies = true;
            case.loads
                .iter_mut()
                .flat_map(|load| &mut load.course)
                .for_each(|x| *x *= factor);
        }
        "motions" => {
            let factor = random.power(-12.0, 6.0);
            let driven = match &mut case.held {
                Held::Driven { motions, .. } => motions.as_mut_slice(),
                Held::Clamped(_) => &mut [],
            };
            let motions = driven
                .iter_mut()
                .chain(case.contacts.iter_mut().flat_map(|c| &mut c.foundation));
            for x in motions.flat_map(|motion| &mut motion.course) {
                applies = true;
                *x *= factor;
            }
        }
        "sign flips" => {
            applies = true;
            for (i, x) in case
                .courses_mut()
                .flat_map(|course| course.iter_mut().enumerate().skip(1))
            {
                *x = x.abs() * if i % 2 == 0 { 1.0 } else { -1.0 };
            }
        }
        "no loads" => {
            applies = true;
            case.loads.iter_mut().for_each(|load| load.course.fill(0.0));
        }
        "jumps" => {
            applies = true;
            case.holds = true;
        }
        "young" => {
            applies = true;
            let factor = random.power(-6.0, 6.0);
            for material in &mut case.materials {
                match &mut material.elasticity {
                    Law::Isotropic { young: x, .. } | Law::Orthotropic { scale: x, .. } => {
                        *x *= factor
                    }
                    Law::Matrix(rows) => rows.iter_mut().flatten().for_each(|x| *x *= factor),
                    Law::VonMises { young, beta, .. } => {
                        (*young, *beta) = (*young * factor, *beta * factor)
                    }
                    Law::Hencky {
                        bulk, rest, far, ..
                    } => (*bulk, *rest, *far) = (*bulk * factor, *rest * factor, *far * factor),
                    Law::Viscous { .. } | Law::Carreau { .. } => unreachable!("no elasticity"),
                }
            }
        }
        "size" => {
            applies = true;
            let factor = random.power(-6.0, 6.0);
            let move_centre = |motion: &mut Motion| {
                if let Path::Rotation(centre) = &mut motion.path {
                    centre.iter_mut().for_each(|x| *x *= factor);
                }
            };
            case.size.iter_mut().for_each(|x| *x *= factor);
            case.contacts
                .iter_mut()
                .flat_map(|c| &mut c.foundation)
                .for_each(move_centre);
            if let Held::Driven { motions, .. } = &mut case.held {
                motions.iter_mut().for_each(move_centre);
            }
        }
        other => unreachable!("{other}"),
    }
    applies
}
