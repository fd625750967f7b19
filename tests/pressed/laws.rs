//! Friction laws for the tests: a coefficient of the slip rate times a pressure.

use stickslip::contact::SlipPath;
use stickslip::contact::pressed::{PressedBound, PressedBounds};

/// What the coefficient multiplies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pressure {
    /// The pressing part of the normal force.
    Pressing,
    /// The normal force of either sign.
    Magnitude,
    /// A force that does not depend on the contact.
    Given(f64),
}

/// The coefficient of friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coefficient {
    Constant(f64),
    /// `(first - second) exp(-third r) + second`.
    Decaying(f64, f64, f64),
    /// `first asinh(r / second)`: no bound at rest.
    Creeping(f64, f64),
    /// Falls from the first to the second over the accumulated slip `third`.
    Weakening(f64, f64, f64),
}

#[derive(Debug, Clone, Copy)]
pub struct Friction {
    pub coefficient: Coefficient,
    pub pressure: Pressure,
}

impl Coefficient {
    /// Value and derivative along the stage.
    pub fn at(self, rate: f64, slip: SlipPath) -> [f64; 2] {
        match self {
            Coefficient::Constant(mu) => [mu, 0.0],
            Coefficient::Decaying(fast, slow, alpha) => {
                let decay = (-alpha * rate).exp();
                [(fast - slow) * decay + slow, -alpha * (fast - slow) * decay]
            }
            Coefficient::Creeping(a, velocity) => {
                let x = rate / velocity;
                [a * x.asinh(), a / velocity / (1.0 + x * x).sqrt()]
            }
            Coefficient::Weakening(first, last, length) => {
                let s = slip.base + slip.per_rate * rate;
                if s < length {
                    let fall = (first - last) / length;
                    [first - fall * s, -fall * slip.per_rate]
                } else {
                    [last, 0.0]
                }
            }
        }
    }

    /// Largest fall with the rate, `per_rate` being the share of the stage.
    fn weakening(self, per_rate: f64) -> f64 {
        match self {
            Coefficient::Constant(_) | Coefficient::Creeping(..) => 0.0,
            Coefficient::Decaying(fast, slow, alpha) => alpha * (fast - slow),
            Coefficient::Weakening(first, last, length) => per_rate * (first - last) / length,
        }
    }
}

impl Pressure {
    pub fn at(self, force: f64) -> [f64; 2] {
        match self {
            Pressure::Pressing if force >= 0.0 => [force, 1.0],
            Pressure::Pressing => [0.0, 0.0],
            Pressure::Magnitude => [force.abs(), 1.0_f64.copysign(force)],
            Pressure::Given(given) => [given, 0.0],
        }
    }
}

/// A law in a stage of weight `per_rate`.
pub struct Bounds {
    pub friction: Friction,
    pub per_rate: f64,
}

impl PressedBounds for Bounds {
    fn evaluate(&self, _: usize, rate: f64, force: f64, slip: SlipPath) -> PressedBound {
        let [mu, slope] = self.friction.coefficient.at(rate, slip);
        let [pressure, by_force] = self.friction.pressure.at(force);
        PressedBound {
            bound: mu * pressure,
            by_rate: slope * pressure,
            by_force: mu * by_force,
        }
    }

    fn weakening(&self, _: usize, force: f64) -> f64 {
        let [pressure, _] = self.friction.pressure.at(force);
        self.friction.coefficient.weakening(self.per_rate) * pressure
    }
}
