//! A scene of the second sweep: contact with a pressure, moving foundations and parts, bodies with memory, regions and laws that are
//! not linear.

use super::friction::Friction;

/// Elasticity or viscosity. Moduli are multiples of Pa or Pa s.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// `lambda` or mu1, and the coefficient of the strain.
    Isotropic {
        young: f64,
        poisson: f64,
    },
    Viscous {
        mu1: f64,
        mu2: f64,
    },
    Orthotropic {
        scale: f64,
        ratios: [f64; 3],
        angle: f64,
    },
    /// Symmetric, in Voigt's order.
    Matrix(Vec<Vec<f64>>),
    Carreau {
        mu1: f64,
        rest: f64,
        fast: f64,
        rate: f64,
    },
    VonMises {
        young: f64,
        poisson: f64,
        beta: f64,
        kappa: f64,
    },
    Hencky {
        bulk: f64,
        rest: f64,
        far: f64,
        strain: f64,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    pub tau: f64,
    pub shear: f64,
    pub bulk: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub viscosity: Law,
    pub elasticity: Law,
    pub memory: Vec<Branch>,
}

/// Gap of the undeformed body, linear along x: at x = 0 and at x = length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap(pub f64, pub f64);

#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    Bilateral,
    Unilateral(Gap),
    Compliance {
        gap: Gap,
        stiffness: f64,
        exponent: f64,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    Translation(Vec<f64>),
    /// About z through the centre in the plane; about y in space.
    Rotation(Vec<f64>),
    Approach,
}

/// Motion of a foundation or of a driven part; its course is an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    pub path: Path,
    pub course: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    pub part: &'static str,
    pub condition: Condition,
    pub friction: Friction,
    pub foundation: Vec<Motion>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// `None`: a body force.
    pub part: Option<&'static str>,
    pub direction: Vec<f64>,
    pub course: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Held {
    Clamped(&'static str),
    Driven {
        part: &'static str,
        input: &'static str,
        motions: Vec<Motion>,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub size: Vec<f64>,
    pub cells: Vec<u32>,
    pub element: &'static str,
    /// One for the body, or of the lower half and of the rest.
    pub materials: Vec<Material>,
    pub held: Held,
    pub contacts: Vec<Contact>,
    pub loads: Vec<Load>,
    /// Whether loads jump at the beginning of a communication step.
    pub holds: bool,
    pub scheme: &'static str,
    pub step: f64,
    /// Internal steps of a communication step.
    pub cuts: u32,
    pub model: &'static str,
    pub tolerance: f64,
    pub friction_tolerance: f64,
    pub extremes: Vec<&'static str>,
}

impl Case {
    pub fn dimension(&self) -> usize {
        self.size.len()
    }

    /// Communication steps.
    pub fn count(&self) -> usize {
        self.courses().next().map_or(2, |course| course.len() - 1)
    }

    /// What stands for one contact in the names of its ports.
    pub fn prefix(&self, contact: usize) -> String {
        match self.contacts.len() {
            1 => "contact".to_owned(),
            _ => format!("c{contact}"),
        }
    }

    /// Names of the inputs with their courses.
    pub fn inputs(&self) -> Vec<(String, &[f64])> {
        let mut inputs = Vec::new();
        for (i, load) in self.loads.iter().enumerate() {
            inputs.push((format!("load{i}"), load.course.as_slice()));
        }
        if let Held::Driven { motions, .. } = &self.held {
            for (i, motion) in motions.iter().enumerate() {
                inputs.push((format!("drive{i}"), motion.course.as_slice()));
            }
        }
        for (c, contact) in self.contacts.iter().enumerate() {
            for (i, motion) in contact.foundation.iter().enumerate() {
                inputs.push((format!("move{c}_{i}"), motion.course.as_slice()));
            }
        }
        inputs
    }

    fn courses(&self) -> impl Iterator<Item = &Vec<f64>> {
        let driven = match &self.held {
            Held::Driven { motions, .. } => motions.as_slice(),
            Held::Clamped(_) => &[],
        };
        let foundations = self.contacts.iter().flat_map(|c| &c.foundation);
        let motions = driven.iter().chain(foundations).map(|m| &m.course);
        self.loads.iter().map(|load| &load.course).chain(motions)
    }

    /// Courses of all inputs, to be changed.
    pub fn courses_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let driven = match &mut self.held {
            Held::Driven { motions, .. } => motions.as_mut_slice(),
            Held::Clamped(_) => &mut [],
        };
        let foundations = self.contacts.iter_mut().flat_map(|c| &mut c.foundation);
        let motions = driven.iter_mut().chain(foundations);
        let loads = self.loads.iter_mut().map(|load| &mut load.course);
        loads.chain(motions.map(|m| &mut m.course))
    }

    /// Whether a material is not linear.
    pub fn is_nonlinear(&self) -> bool {
        let is_curved = |law: &Law| {
            matches!(
                law,
                Law::Carreau { .. } | Law::VonMises { .. } | Law::Hencky { .. }
            )
        };
        self.materials
            .iter()
            .any(|m| is_curved(&m.viscosity) || is_curved(&m.elasticity))
    }

    pub fn is_bilateral(&self) -> bool {
        self.contacts
            .iter()
            .all(|c| c.condition == Condition::Bilateral)
    }

    /// Stress that the largest motions of contact, parts and foundations would make in a cell: what stresses are rounding of where a
    /// body moves as a whole, Pa. `rate` and `displacement` are the largest that the run shows.
    pub fn natural_stress(&self, rate: f64, displacement: f64) -> f64 {
        let sides = self
            .size
            .iter()
            .zip(&self.cells)
            .map(|(x, n)| x / f64::from(*n));
        let cell = sides.fold(f64::INFINITY, f64::min);
        let largest =
            |path: fn(&Material) -> f64| self.materials.iter().map(path).fold(0.0, f64::max);
        let elasticity = largest(|m| {
            m.elasticity.scale() + m.memory.iter().map(|b| b.shear + b.bulk).sum::<f64>()
        });
        let duration = self.step * f64::from(self.cuts);
        let (mut rate, mut displacement) = (rate, displacement);
        if let Held::Driven { input, motions, .. } = &self.held {
            for motion in motions {
                let arm = if matches!(motion.path, Path::Rotation(_)) {
                    self.size[0]
                } else {
                    1.0
                };
                let size = arm * motion.course.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                if *input == "velocity" {
                    rate = rate.max(size);
                } else {
                    (rate, displacement) =
                        (rate.max(2.0 * size / duration), displacement.max(size));
                }
            }
        }
        displacement = displacement.max(rate * duration * self.count() as f64);
        (largest(|m| m.viscosity.scale()) * rate + elasticity * displacement) / cell
    }

    /// About what a unit of slip rate meets in stress, Pa s/m: the least viscosity over the longest side.
    pub fn resistance(&self) -> f64 {
        let longest = self.size.iter().copied().fold(0.0, f64::max);
        self.materials
            .iter()
            .map(|m| m.viscosity.scale())
            .fold(f64::INFINITY, f64::min)
            / longest
    }

    /// Whether a foundation moves along its normal.
    pub fn approaches(&self) -> bool {
        let motions = self.contacts.iter().flat_map(|c| &c.foundation);
        motions.into_iter().any(|m| m.path == Path::Approach)
    }
}

impl Law {
    /// Largest modulus.
    fn scale(&self) -> f64 {
        match self {
            Law::Isotropic { young, poisson } => young / (1.0 - 2.0 * poisson),
            Law::Viscous { mu1, mu2 } => mu1 + mu2,
            Law::Orthotropic { scale, ratios, .. } => {
                scale * ratios.iter().fold(1.0, |m: f64, x| m.max(*x))
            }
            Law::Matrix(rows) => rows.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs())),
            Law::Carreau { mu1, rest, .. } => mu1 + rest,
            Law::VonMises { young, beta, .. } => young + beta,
            Law::Hencky { bulk, rest, .. } => bulk + rest,
        }
    }
}

impl Gap {
    pub fn largest(self) -> f64 {
        self.0.abs().max(self.1.abs())
    }
}
