//! Transformations of a case whose effect on the answer is known.

use super::case::{Case, Condition, Gap, Held, Law, Motion, Path};

impl Case {
    /// All inputs times `factor`.
    pub fn driven_by(&self, factor: f64) -> Case {
        let mut other = self.clone();
        other
            .courses_mut()
            .for_each(|course| course.iter_mut().for_each(|x| *x *= factor));
        other
    }

    pub fn with_model(&self, model: &'static str) -> Case {
        Case {
            model,
            ..self.clone()
        }
    }

    /// One communication step for every internal step, inputs on the straight lines between the given ones.
    pub fn split(&self) -> Case {
        let mut other = self.clone();
        let cuts = self.cuts;
        other.cuts = 1;
        for course in other.courses_mut() {
            let mut finer = vec![course[0]];
            for pair in course.windows(2) {
                for i in 1..=cuts {
                    let fraction = f64::from(i) / f64::from(cuts);
                    finer.push(if i == cuts {
                        pair[1]
                    } else {
                        pair[0] + (pair[1] - pair[0]) * fraction
                    });
                }
            }
            *course = finer;
        }
        other
    }

    /// The same in a mirror across the middle of x (in the plane: the criss-cross is its own mirror image).
    pub fn mirrored(&self) -> Case {
        let length = self.size[0];
        let opposite = |part| match part {
            "left" => "right",
            "right" => "left",
            other => other,
        };
        let turn = |motion: &mut Motion| match &mut motion.path {
            Path::Translation(direction) => direction[0] *= -1.0,
            Path::Rotation(centre) => {
                centre[0] = length - centre[0];
                motion.course.iter_mut().for_each(|x| *x *= -1.0);
            }
            Path::Approach => {}
        };
        let mut other = self.clone();
        match &mut other.held {
            Held::Clamped(part) => *part = opposite(part),
            Held::Driven { part, motions, .. } => {
                *part = opposite(part);
                motions.iter_mut().for_each(turn);
            }
        }
        for load in &mut other.loads {
            load.part = load.part.map(opposite);
            load.direction[0] *= -1.0;
        }
        for contact in &mut other.contacts {
            contact.foundation.iter_mut().for_each(turn);
            match &mut contact.condition {
                Condition::Unilateral(gap) | Condition::Compliance { gap, .. } => {
                    *gap = Gap(gap.1, gap.0)
                }
                Condition::Bilateral => {}
            }
        }
        for material in &mut other.materials {
            for law in [&mut material.viscosity, &mut material.elasticity] {
                match law {
                    Law::Orthotropic { angle, .. } => *angle *= -1.0,
                    Law::Matrix(rows) => {
                        for (i, j) in [(0, 2), (2, 0), (1, 2), (2, 1)] {
                            rows[i][j] *= -1.0;
                        }
                    }
                    _ => {}
                }
            }
        }
        other
    }
}
