//! The text of a case.

use super::case::{Case, Condition, Contact, Gap, Held, Law, Load, Material, Motion, Path};
use super::friction::{Coefficient, Friction};
use serde_json::{Map, Value, json};

impl Case {
    pub fn json(&self) -> Value {
        let kind = ["rectangle", "box"][self.dimension() - 2];
        let mut mesh = json!({"kind": kind, "size": self.size, "cells": self.cells});
        if self.materials.len() == 2 {
            let mut to = self.size.clone();
            to[1] *= 0.5;
            mesh["regions"] = json!([{"name": "lower", "from": vec![0.0; to.len()], "to": to}]);
        }
        let mut scene = json!({
            "schema_version": 1, "name": "extreme", "mesh": mesh, "element": self.element,
            "loads": self.loads.iter().enumerate().map(|(i, load)| self.load(i, load)).collect::<Vec<_>>(),
            "time": {"scheme": self.scheme, "step": self.step},
            "fidelity": {"model": self.model, "tolerance": self.tolerance, "friction_tolerance": self.friction_tolerance},
            "history": {"capacity": 0}
        });
        let mut materials: Vec<Value> = self.materials.iter().map(|m| self.material(m)).collect();
        if materials.len() == 2 {
            materials[0]["region"] = json!("lower");
            materials[1]["region"] = json!("body");
            scene["materials"] = json!(materials);
        } else {
            scene["material"] = materials.remove(0);
        }
        let mut contacts: Vec<Value> = self
            .contacts
            .iter()
            .enumerate()
            .map(|(i, contact)| self.contact(i, contact))
            .collect();
        if contacts.len() == 1 {
            scene["contact"] = contacts.remove(0);
        } else {
            contacts
                .iter_mut()
                .enumerate()
                .for_each(|(i, contact)| contact["name"] = json!(format!("c{i}")));
            scene["contacts"] = json!(contacts);
        }
        match &self.held {
            Held::Clamped(part) => scene["clamped"] = json!([part]),
            Held::Driven {
                part,
                input,
                motions,
            } => {
                let direction = |motion: &Motion| match &motion.path {
                    Path::Translation(direction) => json!(direction),
                    Path::Rotation(centre) if centre.len() == 3 => {
                        json!({"centre": centre, "axis": [0, 1, 0]})
                    }
                    Path::Rotation(centre) => json!({"centre": centre}),
                    Path::Approach => unreachable!("a part has no foundation"),
                };
                let named = motions
                    .iter()
                    .enumerate()
                    .map(|(i, motion)| (format!("drive{i}"), direction(motion)));
                scene["driven"] = json!([{"part": part, "input": input, "directions": named.collect::<Map<_, _>>()}]);
            }
        }
        scene
    }

    fn law(&self, law: &Law) -> Value {
        let convention = if self.dimension() == 2 {
            "plane_strain"
        } else {
            "three_dimensional"
        };
        match law {
            Law::Isotropic { young, poisson } => {
                json!({"law": "isotropic", "young": young, "poisson": poisson, "convention": convention})
            }
            Law::Viscous { mu1, mu2 } => json!({"law": "isotropic", "mu1": mu1, "mu2": mu2}),
            Law::Orthotropic {
                scale,
                ratios,
                angle,
            } => {
                let mut value = json!({
                    "law": "orthotropic", "young": ratios.map(|x| x * scale), "poisson": [0.2, 0.1, 0.15],
                    "shear": [0.4 * scale, 0.3 * scale, 0.35 * scale], "convention": convention
                });
                if self.dimension() == 2 {
                    value["angle_deg"] = json!(angle);
                }
                value
            }
            Law::Matrix(rows) => json!({"law": "matrix", "matrix": rows}),
            Law::Carreau {
                mu1,
                rest,
                fast,
                rate,
            } => json!({"law": "carreau", "mu1": mu1, "mu_0": rest, "mu_inf": fast, "c": rate}),
            Law::VonMises {
                young,
                poisson,
                beta,
                kappa,
            } => json!({
                "law": "von_mises", "beta": beta, "kappa": kappa,
                "base": {"law": "isotropic", "young": young, "poisson": poisson, "convention": convention}
            }),
            Law::Hencky {
                bulk,
                rest,
                far,
                strain,
            } => {
                json!({"law": "hencky", "bulk": bulk, "mu_0": rest, "mu_inf": far, "c": strain})
            }
        }
    }

    fn material(&self, material: &Material) -> Value {
        let mut value = json!({"viscosity": self.law(&material.viscosity), "elasticity": self.law(&material.elasticity)});
        if !material.memory.is_empty() {
            let branch = |b: &super::case::Branch| json!({"tau": b.tau, "law": "isotropic", "shear": b.shear, "bulk": b.bulk});
            value["memory"] = material.memory.iter().map(branch).collect();
        }
        value
    }

    fn gap(&self, Gap(first, last): Gap) -> Value {
        if first == last {
            return json!(first);
        }
        let length = self.size[0];
        json!({"expression": format!("{first:?} * (1 - x / {length:?}) + {last:?} * (x / {length:?})")})
    }

    fn contact(&self, index: usize, contact: &Contact) -> Value {
        let condition = match &contact.condition {
            Condition::Bilateral => json!({"kind": "bilateral"}),
            Condition::Unilateral(gap) => json!({"kind": "unilateral", "gap": self.gap(*gap)}),
            Condition::Compliance {
                gap,
                stiffness,
                exponent,
            } => {
                json!({"kind": "compliance", "gap": self.gap(*gap), "stiffness": stiffness, "exponent": exponent})
            }
        };
        let foundation = contact.foundation.iter().enumerate().map(|(i, motion)| {
            let name = format!("move{index}_{i}");
            match &motion.path {
                Path::Translation(direction) => {
                    json!({"kind": "sliding", "name": name, "direction": direction})
                }
                Path::Rotation(centre) if centre.len() == 3 => {
                    json!({"kind": "rotation", "name": name, "centre": centre, "axis": [0, 1, 0]})
                }
                Path::Rotation(centre) => {
                    json!({"kind": "rotation", "name": name, "centre": centre})
                }
                Path::Approach => json!({"kind": "approach", "name": name}),
            }
        });
        let foundation: Vec<Value> = foundation.collect();
        json!({"part": contact.part, "condition": condition, "friction": friction(&contact.friction), "foundation": foundation, "pressure": true})
    }

    fn load(&self, index: usize, load: &Load) -> Value {
        let mut value = json!({
            "name": format!("load{index}"), "direction": load.direction, "start": load.course[0],
            "kind": if load.part.is_some() { "traction" } else { "body_force" },
            "interpolation": if self.holds { "hold" } else { "linear" }
        });
        if let Some(part) = load.part {
            value["part"] = json!(part);
        }
        value
    }
}

fn coefficient(coefficient: &Coefficient) -> Value {
    match coefficient {
        Coefficient::Number(value) => json!(value),
        Coefficient::Exponential { rest, fast, decay } => {
            json!({"kind": "exponential", "static": rest, "kinetic": fast, "decay": decay})
        }
        Coefficient::Stribeck {
            rest,
            fast,
            velocity,
            exponent,
        } => {
            json!({"kind": "stribeck", "static": rest, "kinetic": fast, "velocity": velocity, "exponent": exponent})
        }
        Coefficient::Weakening {
            rest,
            worn,
            distance,
        } => {
            json!({"kind": "slip_weakening", "static": rest, "dynamic": worn, "distance": distance})
        }
        Coefficient::Creeping {
            value,
            a,
            b,
            rate,
            distance,
            evolution,
        } => json!({
            "kind": "rate_and_state", "coefficient": value, "a": a, "b": b, "rate": rate, "distance": distance, "evolution": evolution
        }),
    }
}

fn friction(friction: &Friction) -> Value {
    match friction {
        Friction::Bound(bound) => json!({"law": "bound", "bound": coefficient(bound)}),
        Friction::Coulomb {
            coefficient: value,
            cap,
            tension,
        } => {
            let mut law =
                json!({"law": "coulomb", "coefficient": coefficient(value), "tension": tension});
            if let Some(cap) = cap {
                law["cap"] = json!(cap);
            }
            law
        }
    }
}
