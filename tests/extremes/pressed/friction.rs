//! Friction of a contact: the formulas once more.

/// A coefficient of friction, or a bound in Pa.
#[derive(Debug, Clone, PartialEq)]
pub enum Coefficient {
    Number(f64),
    Exponential {
        rest: f64,
        fast: f64,
        decay: f64,
    },
    Stribeck {
        rest: f64,
        fast: f64,
        velocity: f64,
        exponent: f64,
    },
    Weakening {
        rest: f64,
        worn: f64,
        distance: f64,
    },
    Creeping {
        value: f64,
        a: f64,
        b: f64,
        rate: f64,
        distance: f64,
        evolution: &'static str,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub enum Friction {
    Bound(Coefficient),
    Coulomb {
        coefficient: Coefficient,
        cap: Option<f64>,
        tension: bool,
    },
}

impl Coefficient {
    /// By how much the value falls with the slip rate at most, s/m; `step` is what a slip rate is multiplied with to be a slip.
    pub fn weakening(&self, step: f64) -> f64 {
        match *self {
            Coefficient::Number(_) => 0.0,
            Coefficient::Exponential { rest, fast, decay } => (rest - fast) * decay,
            Coefficient::Stribeck {
                rest,
                fast,
                velocity,
                exponent,
            } => (rest - fast) * exponent / velocity,
            Coefficient::Weakening {
                rest,
                worn,
                distance,
            } => step * (rest - worn) / distance,
            Coefficient::Creeping { b, distance, .. } => 2.0 * b * step / distance,
        }
    }

    /// Value at rest, or at the reference.
    pub fn largest(&self) -> f64 {
        match *self {
            Coefficient::Number(value) | Coefficient::Creeping { value, .. } => value,
            Coefficient::Exponential { rest, .. }
            | Coefficient::Stribeck { rest, .. }
            | Coefficient::Weakening { rest, .. } => rest,
        }
    }

    /// Value at a slip rate, with the accumulated slip and the state of the node.
    pub fn value(&self, rate: f64, slip: f64, state: f64) -> f64 {
        match *self {
            Coefficient::Number(value) => value,
            // from the nearer end, so that no digit of a small end is lost
            Coefficient::Exponential { rest, fast, decay } => from_ends(rest, fast, decay * rate),
            Coefficient::Stribeck {
                rest,
                fast,
                velocity,
                exponent,
            } => from_ends(rest, fast, (rate / velocity).powf(exponent)),
            Coefficient::Weakening {
                rest,
                worn,
                distance,
            } => worn + (rest - worn) * (1.0 - slip / distance).max(0.0),
            Coefficient::Creeping {
                value,
                a,
                b,
                rate: reference,
                distance,
                ..
            } => {
                let exponent = (value + b * (reference * state / distance).ln()) / a;
                // the product may overflow where its arsinh does not
                let logarithm = (rate / (2.0 * reference)).ln() + exponent;
                a * if logarithm > 300.0 {
                    logarithm + std::f64::consts::LN_2
                } else {
                    logarithm.exp().asinh()
                }
            }
        }
    }
}

fn from_ends(rest: f64, fast: f64, x: f64) -> f64 {
    if x < 0.5 {
        rest + (rest - fast) * (-x).exp_m1()
    } else {
        fast + (rest - fast) * (-x).exp()
    }
}

impl Friction {
    pub fn coefficient(&self) -> &Coefficient {
        match self {
            Friction::Bound(coefficient) | Friction::Coulomb { coefficient, .. } => coefficient,
        }
    }

    /// Bound under a pressure, Pa.
    pub fn bound(&self, rate: f64, slip: f64, state: f64, pressure: f64) -> f64 {
        let value = self.coefficient().value(rate, slip, state);
        match self {
            Friction::Bound(_) => value,
            Friction::Coulomb { cap, tension, .. } => {
                let pressing = if *tension {
                    pressure.abs()
                } else {
                    pressure.max(0.0)
                };
                cap.unwrap_or(f64::INFINITY).min(value * pressing)
            }
        }
    }
}
