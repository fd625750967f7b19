//! One isotropic material whose numbers stay free: what its operators are of the two forms that all isotropic laws share.
//!
//! Every operator of one isotropic material over the whole body is
//!
//! ```text
//! two_mu K_eps + lambda K_tr,   K_eps = int eps : eps,   K_tr = int tr(eps) tr(eps)
//! ```
//!
//! viscosity, elasticity and every branch of its memory alike. So a body compiled for the pair (K_eps, K_tr) has all of them, and
//! its moduli, viscosities and relaxation times are numbers that may be set afterwards. What the response of the body then is
//! depends on the ratio `lambda / two_mu` of the operator of a stage, `M = A + theta k B + sum_j w_j C_j` with `0 <= w_j <= theta k`,
//! and is compiled for the ratios of [`RATIOS`].

use super::form::Form;
use super::{Elasticity, Law, Material, Memory, Operators, ParameterKind, Viscosity};
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure};

/// Ratios lambda / 2 mu of stages that a body is compiled for: Poisson's ratios of -0.5 to 0.4999 (0.49999 in 3D, 0.49998 in plane
/// strain).
pub const RATIOS: [f64; 2] = [-0.25, 1e4];

/// A number of the material that stays free.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeNumber {
    /// Its path in the scene.
    pub path: String,
    /// SI unit; `1` for a number.
    pub unit: &'static str,
    /// Meaning.
    pub text: &'static str,
    /// Its key in its law.
    key: Key,
}

/// The numbers of isotropic laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Key {
    Mu1,
    Mu2,
    Young,
    Poisson,
    /// Of a branch of the memory.
    Tau(usize),
    Shear(usize),
    Bulk(usize),
}

/// What the operators of a material are of K_eps and K_tr.
#[derive(Debug, Clone, PartialEq)]
pub struct Blend {
    /// Of A, Pa s.
    pub viscosity: Share,
    /// Of B, Pa.
    pub elasticity: Share,
    /// Relaxation time (s) and C (Pa) of the branches of the memory; those beyond what the material has are 0.
    pub branches: Vec<(f64, Share)>,
}

/// `on_strain K_eps + on_trace K_tr`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    pub on_strain: f64,
    pub on_trace: f64,
}

/// Time of a branch that does nothing, s.
const NO_TIME: f64 = 1.0;

impl FreeNumber {
    /// Those of a material at `material` of a scene: viscosity, elasticity, branches in moduli. What follows from a data sheet has
    /// no numbers of its own.
    pub fn all(material: &Material) -> Vec<FreeNumber> {
        let declared = material.operators().parameters().into_iter();
        let number = |(path, parameter): (String, super::Parameter)| match parameter.kind {
            ParameterKind::Number(unit) => Some(FreeNumber {
                key: Key::of(&path)?,
                path: format!("material.{path}"),
                unit,
                text: parameter.text,
            }),
            ParameterKind::Choice(_) => None,
        };
        declared.filter_map(number).collect()
    }

    /// What it may be by itself; `None` where `value` is.
    pub fn fault(&self, value: f64) -> Option<&'static str> {
        let (holds, allowed) = match self.key {
            Key::Mu1 => (true, "a finite number"),
            Key::Mu2 | Key::Young | Key::Tau(_) => (value > 0.0, "a finite number > 0"),
            Key::Poisson => (value > -1.0 && value < 0.5, "a number > -1 and < 0.5"),
            Key::Shear(_) | Key::Bulk(_) => (value >= 0.0, "a finite number >= 0"),
        };
        (!holds || !value.is_finite()).then_some(allowed)
    }

    /// Its value.
    pub fn value(&self, material: &Material) -> f64 {
        let mut material = material.clone();
        self.slot(&mut material).map_or(f64::NAN, |slot| *slot)
    }

    /// Where it stands in a material; nowhere in one of other laws.
    pub fn slot<'a>(&self, material: &'a mut Material) -> Option<&'a mut f64> {
        let Material {
            viscosity,
            elasticity,
            memory,
        } = material;
        let branch = |memory: &'a mut Memory, at: usize| match memory {
            Memory::Branches(branches) => branches.get_mut(at).map(|branch| branch.isotropic()),
            _ => None,
        };
        match (self.key, viscosity, elasticity) {
            (Key::Mu1, Viscosity::Isotropic(law), _) => Some(&mut law.mu1),
            (Key::Mu2, Viscosity::Isotropic(law), _) => Some(&mut law.mu2),
            (Key::Young, _, Elasticity::Isotropic(law)) => Some(&mut law.young),
            (Key::Poisson, _, Elasticity::Isotropic(law)) => Some(&mut law.poisson),
            (Key::Tau(at), ..) => branch(memory, at).map(|law| &mut law.tau),
            (Key::Shear(at), ..) => branch(memory, at).map(|law| &mut law.shear),
            (Key::Bulk(at), ..) => branch(memory, at).map(|law| &mut law.bulk),
            _ => None,
        }
    }
}

impl Key {
    /// By its path below a material; `None` for what is no number of an isotropic law.
    fn of(path: &str) -> Option<Key> {
        match path {
            "viscosity.mu1" => return Some(Key::Mu1),
            "viscosity.mu2" => return Some(Key::Mu2),
            "elasticity.young" => return Some(Key::Young),
            "elasticity.poisson" => return Some(Key::Poisson),
            _ => {}
        }
        let (at, key) = path.strip_prefix("memory[")?.split_once("].")?;
        let at = at.parse().ok()?;
        match key {
            "tau" => Some(Key::Tau(at)),
            "shear" => Some(Key::Shear(at)),
            "bulk" => Some(Key::Bulk(at)),
            _ => None,
        }
    }
}

impl Material {
    /// Its operators.
    pub(crate) fn operators(&self) -> Operators<'_> {
        Operators {
            viscosity: &self.viscosity,
            elasticity: &self.elasticity,
            memory: &self.memory,
        }
    }
}

impl Operators<'_> {
    /// Refuses a material whose operators are not in the span of the two forms, or not for the ratios that a body is compiled for;
    /// `path` is its place in the scene.
    pub(crate) fn check_free(&self, path: &str) -> Verdict {
        let refuse = |key: &str, found: &str| {
            let allowed =
                "isotropic laws that do not vary over the body, with fidelity.free_material";
            Err(Refusal::new(format!("{path}.{key}"), found, allowed))
        };
        if !matches!(self.viscosity, Viscosity::Isotropic(_)) {
            return refuse("viscosity.law", "a viscosity that is not isotropic");
        }
        if !matches!(self.elasticity, Elasticity::Isotropic(_)) {
            return refuse("elasticity.law", "an elasticity that is not isotropic");
        }
        let varies = |law: &dyn Law| !law.variation().is_none();
        for (key, _, law) in self.laws() {
            if varies(law) {
                return refuse(key, "a law that varies over the body");
            }
        }
        if !self.has_dashpot() {
            let allowed = "> 0 with fidelity.free_material";
            return Err(Refusal::new(format!("{path}.viscosity.mu2"), 0, allowed));
        }
        match Blend::of(self, self.branch_count()) {
            Some(blend) => blend.check(path),
            None => refuse("viscosity", "a law that is not isotropic"),
        }
    }

    /// Branches that it has room for, however its numbers are chosen.
    pub(crate) fn branch_count(&self) -> usize {
        match self.memory {
            _ if self.is_plate() => 1,
            Memory::Branches(branches) => branches.len(),
            _ => self.branches().len(),
        }
    }
}

impl Blend {
    /// That of a material with room for `count` branches; `None` for laws that are not isotropic, and for more branches.
    pub(crate) fn of(operators: &Operators, count: usize) -> Option<Blend> {
        let [a, b] = operators.forms();
        let found = operators.branches();
        let mut branches = found
            .iter()
            .map(|(tau, form)| Some((*tau, Share::of(form)?)))
            .collect::<Option<Vec<_>>>()?;
        if branches.len() > count {
            return None;
        }
        branches.resize(count, (NO_TIME, Share::ZERO));
        Some(Blend {
            viscosity: Share::of(&a)?,
            elasticity: Share::of(&b)?,
            branches,
        })
    }

    /// Refuses operators of stages with ratios that the body is not compiled for. With the weights of a stage every branch counts by
    /// a share of 0 to 1 of its own in the elasticity; distances from both ends of the interval are linear in them.
    fn check(&self, path: &str) -> Verdict {
        let distance = |end: usize, share: &Share| match end {
            0 => share.on_trace - RATIOS[0] * share.on_strain,
            _ => RATIOS[1] * share.on_strain - share.on_trace,
        };
        let total = |end: usize| {
            let branches = self.branches.iter().map(|(_, c)| distance(end, c).min(0.0));
            distance(end, &self.elasticity) + branches.sum::<f64>()
        };
        let is_within = |holds: [bool; 2]| holds.iter().all(|holds| *holds);
        let allowed = format!(
            "{} to {} with fidelity.free_material",
            number(RATIOS[0]),
            number(RATIOS[1])
        );
        ensure(
            is_within([0, 1].map(|end| distance(end, &self.viscosity) >= 0.0)),
            || {
                let found = format!("mu1 / mu2 = {}", number(self.viscosity.ratio()));
                Refusal::new(format!("{path}.viscosity.mu1"), found, &allowed)
            },
        )?;
        ensure(is_within([0, 1].map(|end| total(end) >= 0.0)), || {
            let found = match self.branches.is_empty() {
                true => format!("lambda / 2 mu = {}", number(self.elasticity.ratio())),
                false => {
                    let glassy = self
                        .branches
                        .iter()
                        .fold(self.elasticity, |sum, (_, c)| Share {
                            on_strain: sum.on_strain + c.on_strain,
                            on_trace: sum.on_trace + c.on_trace,
                        });
                    format!(
                        "lambda / 2 mu = {}, and {} with the memory",
                        number(self.elasticity.ratio()),
                        number(glassy.ratio())
                    )
                }
            };
            Refusal::new(format!("{path}.elasticity.poisson"), found, &allowed)
        })
    }
}

impl Share {
    const ZERO: Share = Share {
        on_strain: 0.0,
        on_trace: 0.0,
    };

    fn of(form: &Form) -> Option<Share> {
        match form {
            Form::Isotropic { lambda, two_mu } => Some(Share {
                on_strain: *two_mu,
                on_trace: *lambda,
            }),
            Form::Matrix(_) => None,
        }
    }

    fn ratio(self) -> f64 {
        self.on_trace / self.on_strain
    }

    /// The form with this ratio that counts the strain itself once.
    pub(crate) fn end(ratio: f64) -> Form {
        Form::Isotropic {
            lambda: ratio,
            two_mu: 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, example};

    fn material(changes: &[(&str, &str)]) -> Material {
        let owned = |(p, v): &(&str, &str)| ((*p).to_owned(), (*v).to_owned());
        let changes: Vec<_> = changes.iter().map(owned).collect();
        let text = example("kazmi2014").unwrap();
        let scene = Scene::with_overrides(text, "kazmi2014", &changes).unwrap();
        scene.material.unwrap()
    }

    const MEMORY: &str = r#"[{"tau": 0.5, "law": "isotropic", "shear": 0.3, "bulk": 0.1},
        {"tau": 0.5, "law": "isotropic", "shear": 0.2, "bulk": 0.0}]"#;

    #[test]
    fn numbers_are_found_by_their_paths_and_set_where_they_stand() {
        let mut material = material(&[("material.memory", MEMORY)]);
        let all = FreeNumber::all(&material);
        let paths: Vec<&str> = all.iter().map(|n| n.path.as_str()).collect();
        assert_eq!(paths.len(), 4 + 2 * 3);
        assert!(paths.contains(&"material.memory[1].shear"), "{paths:?}");
        for (i, number) in all.iter().enumerate() {
            *number.slot(&mut material).unwrap() = 0.1 + i as f64;
        }
        let values: Vec<f64> = all.iter().map(|n| n.value(&material)).collect();
        let expected: Vec<f64> = (0..10).map(|i| 0.1 + f64::from(i)).collect();
        assert_eq!(values, expected);
        let poisson = all.iter().find(|n| n.path.ends_with("poisson")).unwrap();
        assert!(poisson.fault(0.4999).is_none() && poisson.fault(0.5).is_some());
        assert!(poisson.fault(f64::NAN).is_some());
    }

    /// Branches with the same time are one, and there is room for the other.
    #[test]
    fn a_blend_has_room_for_every_branch() {
        let material = material(&[("material.memory", MEMORY)]);
        let operators = material.operators();
        assert_eq!(operators.branch_count(), 2);
        let blend = Blend::of(&operators, 2).unwrap();
        assert!((blend.branches[0].1.on_strain - 1.0).abs() < 1e-15);
        assert_eq!(blend.branches[1], (NO_TIME, Share::ZERO));
        assert!(Blend::of(&operators, 0).is_none());
    }

    #[test]
    fn ratios_beyond_the_interval_are_refused() {
        let check = |changes: &[(&str, &str)]| material(changes).operators().check_free("material");
        assert!(check(&[]).is_ok());
        assert!(check(&[("material.elasticity.poisson", "0.4999")]).is_ok());
        assert!(check(&[("material.elasticity.poisson", "0.49999")]).is_err());
        assert!(check(&[("material.viscosity.mu1", "-0.03")]).is_err());
        let shear = r#"[{"tau": 0.5, "law": "isotropic", "shear": 30, "bulk": 0}]"#;
        assert!(check(&[("material.memory", shear)]).is_err());
    }
}
