//! The formula of a law that a scene writes out: its program, the contact nodes that it is about, what samples say of its curve.

use super::misfit::{Misfit, Wrong};
use crate::expression::{COORDINATES, Fault, Program};
use crate::message::number;

/// Variables of the formula of a law: slip rate m/s, accumulated slip m, pressure Pa, coordinates m. Derivatives are by the first three.
pub const VARIABLES: [&str; 6] = ["r", "s", "p", "x", "y", "z"];
const SLIP: usize = 1;
const FIRST_COORDINATE: usize = 3;

/// Samples of the slip rate, m/s, and of accumulated slip, m, and pressure, Pa: 0 and powers of ten between these exponents, with
/// so many in a decade.
const RATES: Samples = Samples(-9, 3, 40);
const SLIPS: Samples = Samples(-6, 1, 1);
const PRESSURES: Samples = Samples(3, 9, 2);
/// Samples of the slip rate beside slip or pressure.
const FEW_RATES: Samples = Samples(-9, 3, 4);

#[derive(Clone, Copy)]
struct Samples(i32, i32, i32);

impl Samples {
    fn all(self) -> impl Iterator<Item = f64> {
        let Samples(first, last, share) = self;
        let powers = first * share..=last * share;
        let powers = powers.map(move |n| 10.0_f64.powf(f64::from(n) / f64::from(share)));
        std::iter::once(0.0).chain(powers)
    }
}

/// What samples say of the curve of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// Steepest fall by the slip rate and by the accumulated slip.
    pub falls: [f64; 2],
    /// Largest and smallest value over the slip rate before any slip, without pressure.
    pub extremes: [f64; 2],
}

/// A formula on contact nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    program: Program,
    /// Coordinates of the nodes; one of them where the formula does not depend on them.
    points: Vec<[f64; 3]>,
    curves: Vec<Curve>,
}

/// What a formula says at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Said {
    pub value: f64,
    /// Derivatives by slip rate, accumulated slip and pressure.
    pub slopes: [f64; 3],
}

impl Formula {
    /// The formula of a coefficient of a law; where the nodes are not known yet and it depends on them, it is only
    /// parsed, and NaN.
    ///
    /// # Errors
    /// A text that is no formula; values that are negative or not finite, or infinite slopes, at a sample of the slip rate before
    /// any slip and without pressure.
    pub fn new(
        text: &str,
        coefficient: usize,
        points: Option<&[[f64; 3]]>,
    ) -> Result<Formula, Misfit> {
        let program =
            Program::parse(text, &VARIABLES).map_err(|fault| of_fault(coefficient, fault))?;
        let is_local = (FIRST_COORDINATE..VARIABLES.len()).any(|place| program.uses(place));
        let is_known = points.is_some() || !is_local;
        let points = match points {
            Some(points) if is_local => points.to_vec(),
            None if is_local => vec![[f64::NAN; 3]],
            _ => vec![[0.0; 3]],
        };
        let mut formula = Formula {
            program,
            points,
            curves: Vec::new(),
        };
        for node in 0..formula.points.len() {
            if is_known {
                formula.check(node, is_local, coefficient)?;
            }
            let curve = formula.sample(node);
            formula.curves.push(curve);
        }
        Ok(formula)
    }

    /// Whether the accumulated slip is in it.
    pub fn uses_slip(&self) -> bool {
        self.program.uses(SLIP)
    }

    /// How many nodes differ.
    pub fn nodes(&self) -> usize {
        self.points.len()
    }

    fn place(&self, node: usize) -> usize {
        if self.points.len() == 1 { 0 } else { node }
    }

    /// Value and slopes at a node. Below zero the value is cut there, so that a solver may pass on its way to values that it can
    /// accept ([`Formula::fault`]); NaN where it is not finite.
    pub fn at(&self, node: usize, rate: f64, slip: f64, pressure: f64) -> Said {
        let [x, y, z] = self.points[self.place(node)];
        let (value, slopes) = self.program.derivatives(&[rate, slip, pressure, x, y, z]);
        if value < 0.0 {
            Said {
                value: 0.0,
                slopes: [0.0; 3],
            }
        } else if value.is_finite() {
            Said { value, slopes }
        } else {
            Said {
                value: f64::NAN,
                slopes: [f64::NAN; 3],
            }
        }
    }

    /// The value where it is none that friction can have: negative or not finite.
    pub fn fault(&self, node: usize, rate: f64, slip: f64, pressure: f64) -> Option<f64> {
        let [x, y, z] = self.points[self.place(node)];
        let value = self.program.value(&[rate, slip, pressure, x, y, z]);
        (!(value >= 0.0 && value.is_finite())).then_some(value)
    }

    /// What samples say of the curve of a node.
    pub fn curve(&self, node: usize) -> Curve {
        self.curves[self.place(node)]
    }

    fn check(&self, node: usize, is_local: bool, coefficient: usize) -> Result<(), Misfit> {
        let [x, y, z] = self.points[node];
        for rate in RATES.all() {
            let (value, slopes) = self.program.derivatives::<3>(&[rate, 0.0, 0.0, x, y, z]);
            let place = if is_local {
                format!(" at contact node {node}")
            } else {
                String::new()
            };
            let here = format!("r = {}, s = 0, p = 0{place}", number(rate));
            let found = if !(value >= 0.0 && value.is_finite()) {
                format!("the value {} for {here}", number(value))
            } else if slopes.iter().any(|slope| !slope.is_finite()) {
                format!("an infinite slope for {here}")
            } else {
                continue;
            };
            return Err(Misfit {
                coefficient,
                wrong: Wrong::Number,
                found: value,
                rule: "a value >= 0",
                allowed: "a value >= 0 with finite slopes at slip rates from 0 to 1000 m/s".into(),
                beside: None,
                words: Some(found),
            });
        }
        Ok(())
    }

    fn sample(&self, node: usize) -> Curve {
        let mut curve = Curve {
            falls: [0.0; 2],
            extremes: [0.0, f64::INFINITY],
        };
        let mut last = 0.0;
        for rate in RATES.all() {
            let said = self.at(node, rate, 0.0, 0.0);
            curve.add(said);
            let [largest, smallest] = curve.extremes;
            curve.extremes = [largest.max(said.value), smallest.min(said.value)];
            last = said.slopes[0];
        }
        if last > 0.0 {
            // rises without end, as far as samples say
            curve.extremes[0] = f64::INFINITY;
        }
        let used = |samples: Samples, place: usize| {
            let count = if self.program.uses(place) {
                usize::MAX
            } else {
                1
            };
            samples.all().take(count)
        };
        for slip in used(SLIPS, 1) {
            for pressure in used(PRESSURES, 2) {
                if slip > 0.0 || pressure > 0.0 {
                    let rates = FEW_RATES.all();
                    rates.for_each(|rate| curve.add(self.at(node, rate, slip, pressure)));
                }
            }
        }
        curve
    }
}

impl Curve {
    /// Counts a sample; one that is no number counts for nothing.
    fn add(&mut self, said: Said) {
        for (fall, slope) in self.falls.iter_mut().zip(said.slopes) {
            *fall = fall.max(-slope);
        }
    }
}

/// The expression of a coefficient at every node.
///
/// # Errors
/// A text that is no formula of x, y, z.
pub fn field(text: &str, coefficient: usize, points: &[[f64; 3]]) -> Result<Vec<f64>, Misfit> {
    let program =
        Program::parse(text, &COORDINATES).map_err(|fault| of_fault(coefficient, fault))?;
    Ok(points.iter().map(|point| program.value(point)).collect())
}

fn of_fault(coefficient: usize, fault: Fault) -> Misfit {
    Misfit {
        coefficient,
        wrong: Wrong::Number,
        found: f64::NAN,
        rule: "a formula",
        words: Some(format!("{} at character {}", fault.found, fault.position)),
        allowed: fault.allowed,
        beside: None,
    }
}
