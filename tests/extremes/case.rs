//! A scene of the sweep with its inputs, and the transformations whose effect on the answer is known.

use serde_json::{Value, json};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    Frictionless,
    Tresca(f64),
    Exponential { a: f64, b: f64, alpha: f64 },
}

impl Law {
    /// Bound at a slip rate, Pa.
    pub fn bound(self, rate: f64) -> f64 {
        match self {
            Law::Frictionless => 0.0,
            Law::Tresca(bound) => bound,
            // away from rest by the difference, so that no digit of a small bound b is lost
            Law::Exponential { a, b, alpha } => {
                if alpha * rate < 0.5 {
                    a + (a - b) * (-alpha * rate).exp_m1()
                } else {
                    b + (a - b) * (-alpha * rate).exp()
                }
            }
        }
    }
}

/// A load and its course over the communication points.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// `None`: a body force.
    pub part: Option<&'static str>,
    pub direction: Vec<f64>,
    /// Intensity at the start and at the end of every communication step.
    pub course: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub size: Vec<f64>,
    pub cells: Vec<u32>,
    pub element: &'static str,
    pub mu1: f64,
    pub mu2: f64,
    pub young: f64,
    pub poisson: f64,
    pub convention: &'static str,
    pub clamped: &'static str,
    pub law: Law,
    pub loads: Vec<Load>,
    pub scheme: &'static str,
    pub start: &'static str,
    /// Internal step, s.
    pub step: f64,
    /// Internal steps of a communication step.
    pub cuts: u32,
    pub model: &'static str,
    pub tolerance: f64,
    pub friction_tolerance: f64,
    /// First tangential direction in 3D, radians from x towards z.
    pub turn: f64,
    /// What was driven to an extreme: names for the table.
    pub extremes: Vec<&'static str>,
}

impl Case {
    pub fn dimension(&self) -> usize {
        self.size.len()
    }

    /// Communication steps.
    pub fn count(&self) -> usize {
        self.loads[0].course.len() - 1
    }

    /// The scene text.
    pub fn json(&self) -> Value {
        let kind = ["rectangle", "box"][self.dimension() - 2];
        let friction = match self.law {
            Law::Frictionless => json!({"law": "frictionless"}),
            Law::Tresca(bound) => json!({"law": "tresca", "bound": bound}),
            Law::Exponential { a, b, alpha } => {
                json!({"law": "exponential", "a": a, "b": b, "alpha": alpha})
            }
        };
        let loads: Vec<Value> = self.loads.iter().enumerate().map(load_json).collect();
        let mut contact = json!({"part": "bottom", "friction": friction});
        if self.turn != 0.0 {
            contact["tangent"] = json!([self.turn.cos(), 0.0, self.turn.sin()]);
        }
        json!({
            "schema_version": 1, "name": "extreme",
            "mesh": {"kind": kind, "size": self.size, "cells": self.cells},
            "element": self.element,
            "material": {
                "viscosity": {"law": "isotropic", "mu1": self.mu1, "mu2": self.mu2},
                "elasticity": {"law": "isotropic", "young": self.young, "poisson": self.poisson, "convention": self.convention}
            },
            "clamped": [self.clamped], "contact": contact, "loads": loads,
            "time": {"scheme": self.scheme, "start": self.start, "step": self.step},
            "fidelity": {"model": self.model, "tolerance": self.tolerance, "friction_tolerance": self.friction_tolerance},
            "history": {"capacity": 0}
        })
    }

    /// The same with all loads times `factor`.
    pub fn loaded(&self, factor: f64) -> Case {
        let mut other = self.clone();
        for load in &mut other.loads {
            load.course.iter_mut().for_each(|value| *value *= factor);
        }
        other
    }

    /// The same body seen in a mirror across the middle of x (2D: the criss-cross is its own mirror image).
    pub fn mirrored(&self) -> Case {
        let opposite = |part| match part {
            "left" => "right",
            "right" => "left",
            other => other,
        };
        let mut other = self.clone();
        other.clamped = opposite(other.clamped);
        for load in &mut other.loads {
            load.part = load.part.map(opposite);
            load.direction[0] *= -1.0;
        }
        other
    }

    /// One communication step for every internal step, inputs on the straight lines between the given ones.
    pub fn split(&self) -> Case {
        let mut other = self.clone();
        other.cuts = 1;
        for load in &mut other.loads {
            let mut course = vec![load.course[0]];
            for pair in load.course.windows(2) {
                for i in 1..=self.cuts {
                    let fraction = f64::from(i) / f64::from(self.cuts);
                    let value = pair[0] + (pair[1] - pair[0]) * fraction;
                    course.push(if i == self.cuts { pair[1] } else { value });
                }
            }
            load.course = course;
        }
        other
    }

    /// Only one of its loads acts.
    pub fn with_load_alone(&self, index: usize) -> Case {
        let mut other = self.clone();
        for (i, load) in other.loads.iter_mut().enumerate() {
            if i != index {
                load.course.fill(0.0);
            }
        }
        other
    }

    pub fn with_model(&self, model: &'static str) -> Case {
        Case {
            model,
            ..self.clone()
        }
    }
}

fn load_json((index, load): (usize, &Load)) -> Value {
    let mut value = json!({
        "name": format!("load{index}"),
        "kind": if load.part.is_some() { "traction" } else { "body_force" },
        "direction": load.direction, "start": load.course[0]
    });
    if let Some(part) = load.part {
        value["part"] = json!(part);
    }
    value
}

/// Units of force (stress in 2D and 3D alike), time and length multiplied by powers of two.
#[derive(Debug, Clone, Copy)]
pub struct Units {
    pub stress: f64,
    pub time: f64,
    pub length: f64,
}

impl Units {
    pub fn of_powers(stress: i32, time: i32, length: i32) -> Units {
        let power = |p: i32| 2f64.powi(p);
        Units {
            stress: power(stress),
            time: power(time),
            length: power(length),
        }
    }

    /// The same scene in other units: the discrete problem has this symmetry exactly, in floating point too.
    pub fn apply(self, case: &Case) -> Case {
        let Units {
            stress,
            time,
            length,
        } = self;
        let mut other = case.clone();
        other.size.iter_mut().for_each(|x| *x *= length);
        other.mu1 *= stress * time;
        other.mu2 *= stress * time;
        other.young *= stress;
        other.step *= time;
        other.law = match case.law {
            Law::Frictionless => Law::Frictionless,
            Law::Tresca(bound) => Law::Tresca(bound * stress),
            Law::Exponential { a, b, alpha } => Law::Exponential {
                a: a * stress,
                b: b * stress,
                alpha: alpha * time / length,
            },
        };
        for load in &mut other.loads {
            let factor = match load.part {
                Some(_) => stress,
                None => stress / length,
            };
            load.course.iter_mut().for_each(|value| *value *= factor);
        }
        other
    }

    /// What a slip rate is multiplied by.
    pub fn rate(self) -> f64 {
        self.length / self.time
    }

    /// What an energy is multiplied by.
    pub fn energy(self, dimension: usize) -> f64 {
        self.stress * self.length.powi(dimension as i32)
    }
}
