//! Other units: the discrete problem knows none.

use super::case::{Case, Condition, Gap, Held, Law, Motion, Path};
use super::friction::{Coefficient, Friction};

/// Units of stress, time and length multiplied by powers of two, and strains too: displacements are small against the body and
/// have a unit of their own.
#[derive(Debug, Clone, Copy)]
pub struct Units {
    pub stress: f64,
    pub time: f64,
    pub length: f64,
    pub strain: f64,
}

impl Units {
    pub fn of_powers([stress, time, length, strain]: [i32; 4]) -> Units {
        let power = |p: i32| 2f64.powi(p);
        Units {
            stress: power(stress),
            time: power(time),
            length: power(length),
            strain: power(strain),
        }
    }

    /// What displacements, slips and gaps are multiplied by.
    pub fn displacement(self) -> f64 {
        self.length * self.strain
    }

    /// What slip rates are multiplied by.
    pub fn rate(self) -> f64 {
        self.displacement() / self.time
    }

    /// What stresses are multiplied by; moduli are by `stress` alone.
    pub fn traction(self) -> f64 {
        self.stress * self.strain
    }

    fn law(self, law: &Law, modulus: f64) -> Law {
        match *law {
            Law::Isotropic { young, poisson } => Law::Isotropic {
                young: young * modulus,
                poisson,
            },
            Law::Viscous { mu1, mu2 } => Law::Viscous {
                mu1: mu1 * modulus,
                mu2: mu2 * modulus,
            },
            Law::Orthotropic {
                scale,
                ratios,
                angle,
            } => Law::Orthotropic {
                scale: scale * modulus,
                ratios,
                angle,
            },
            Law::Matrix(ref rows) => Law::Matrix(
                rows.iter()
                    .map(|row| row.iter().map(|x| x * modulus).collect())
                    .collect(),
            ),
            Law::Carreau {
                mu1,
                rest,
                fast,
                rate,
            } => Law::Carreau {
                mu1: mu1 * modulus,
                rest: rest * modulus,
                fast: fast * modulus,
                rate: rate * self.strain / self.time,
            },
            Law::VonMises {
                young,
                poisson,
                beta,
                kappa,
            } => Law::VonMises {
                young: young * modulus,
                poisson,
                beta: beta * modulus,
                kappa: kappa * self.strain,
            },
            Law::Hencky {
                bulk,
                rest,
                far,
                strain,
            } => Law::Hencky {
                bulk: bulk * modulus,
                rest: rest * modulus,
                far: far * modulus,
                strain: strain * self.strain,
            },
        }
    }

    fn coefficient(self, coefficient: &Coefficient, unit: f64) -> Coefficient {
        match *coefficient {
            Coefficient::Number(value) => Coefficient::Number(value * unit),
            Coefficient::Exponential { rest, fast, decay } => Coefficient::Exponential {
                rest: rest * unit,
                fast: fast * unit,
                decay: decay / self.rate(),
            },
            Coefficient::Stribeck {
                rest,
                fast,
                velocity,
                exponent,
            } => Coefficient::Stribeck {
                rest: rest * unit,
                fast: fast * unit,
                velocity: velocity * self.rate(),
                exponent,
            },
            Coefficient::Weakening {
                rest,
                worn,
                distance,
            } => Coefficient::Weakening {
                rest: rest * unit,
                worn: worn * unit,
                distance: distance * self.displacement(),
            },
            Coefficient::Creeping {
                value,
                a,
                b,
                rate,
                distance,
                evolution,
            } => Coefficient::Creeping {
                value: value * unit,
                a: a * unit,
                b: b * unit,
                rate: rate * self.rate(),
                distance: distance * self.displacement(),
                evolution,
            },
        }
    }

    fn friction(self, friction: &Friction) -> Friction {
        match friction {
            Friction::Bound(bound) => Friction::Bound(self.coefficient(bound, self.traction())),
            Friction::Coulomb {
                coefficient,
                cap,
                tension,
            } => Friction::Coulomb {
                coefficient: self.coefficient(coefficient, 1.0),
                cap: cap.map(|cap| cap * self.traction()),
                tension: *tension,
            },
        }
    }

    fn condition(self, condition: &Condition) -> Condition {
        let gap = |Gap(a, b): Gap| Gap(a * self.displacement(), b * self.displacement());
        match *condition {
            Condition::Bilateral => Condition::Bilateral,
            Condition::Unilateral(g) => Condition::Unilateral(gap(g)),
            Condition::Compliance {
                gap: g,
                stiffness,
                exponent,
            } => Condition::Compliance {
                gap: gap(g),
                stiffness: stiffness * self.traction() / self.displacement().powf(exponent),
                exponent,
            },
        }
    }

    /// `is_displacement`: whether the course of a motion is one, or a velocity.
    fn motion(self, motion: &mut Motion, is_displacement: bool) {
        let time = if is_displacement { 1.0 } else { self.time };
        let unit = match &mut motion.path {
            Path::Translation(_) => self.displacement() / time,
            Path::Approach => self.displacement(),
            Path::Rotation(centre) => {
                centre.iter_mut().for_each(|x| *x *= self.length);
                self.strain / time
            }
        };
        motion.course.iter_mut().for_each(|x| *x *= unit);
    }

    pub fn apply(self, case: &Case) -> Case {
        let mut other = case.clone();
        other.size.iter_mut().for_each(|x| *x *= self.length);
        other.step *= self.time;
        for material in &mut other.materials {
            material.viscosity = self.law(&material.viscosity, self.stress * self.time);
            material.elasticity = self.law(&material.elasticity, self.stress);
            for branch in &mut material.memory {
                branch.tau *= self.time;
                branch.shear *= self.stress;
                branch.bulk *= self.stress;
            }
        }
        for contact in &mut other.contacts {
            contact.condition = self.condition(&contact.condition);
            contact.friction = self.friction(&contact.friction);
            contact
                .foundation
                .iter_mut()
                .for_each(|motion| self.motion(motion, false));
        }
        if let Held::Driven { input, motions, .. } = &mut other.held {
            let is_displacement = *input == "displacement";
            motions
                .iter_mut()
                .for_each(|motion| self.motion(motion, is_displacement));
        }
        for load in &mut other.loads {
            let unit = if load.part.is_some() {
                self.traction()
            } else {
                self.traction() / self.length
            };
            load.course.iter_mut().for_each(|x| *x *= unit);
        }
        other
    }
}
