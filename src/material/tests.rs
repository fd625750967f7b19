//! Laws that are not linear: tangents against stresses, stresses against potentials, constants by sampling, limits in closed form.

use super::excess::Deviator;
use super::*;
use nalgebra::Vector6;

const DEVIATORS: [(Deviator, usize); 3] = [
    (Deviator::ThreeDimensional, 2),
    (Deviator::InPlane, 2),
    (Deviator::ThreeDimensional, 3),
];

fn carreau(deviator: Deviator) -> CarreauViscosity {
    CarreauViscosity {
        mu1: 0.05,
        mu_0: 0.4,
        mu_inf: 0.07,
        c: 0.05,
        deviator,
        gradient: Vec::new(),
        factor: None,
    }
}

fn hencky(deviator: Deviator) -> HenckyElasticity {
    HenckyElasticity {
        bulk: 0.9,
        mu_0: 1.3,
        mu_inf: 0.2,
        c: 0.01,
        deviator,
        gradient: Vec::new(),
        factor: None,
    }
}

fn base(dimension: usize) -> IsotropicElasticity {
    IsotropicElasticity {
        young: 1.0,
        poisson: 0.3,
        convention: match dimension {
            2 => Convention::PlaneStrain,
            _ => Convention::ThreeDimensional,
        },
        gradient: Vec::new(),
        factor: None,
    }
}

fn von_mises(deviator: Deviator, dimension: usize) -> VonMisesElasticity {
    VonMisesElasticity {
        base: Base::Isotropic(base(dimension)),
        beta: 5.0,
        kappa: 0.01,
        deviator,
        gradient: Vec::new(),
        factor: None,
    }
}

/// All laws of a deviator in a dimension, with the size of strains at which they bend.
fn laws(deviator: Deviator, dimension: usize) -> [(Box<dyn Law>, f64); 3] {
    [
        (Box::new(carreau(deviator)), 0.05),
        (Box::new(hencky(deviator)), 0.01),
        (Box::new(von_mises(deviator, dimension)), 0.01),
    ]
}

/// Strain number `n` of a dimension, of about this size.
fn strain(n: usize, dimension: usize, size: f64) -> Vector6<f64> {
    Vector6::from_fn(|i, _| {
        let is_in_plane = matches!(i, 0 | 1 | 5);
        let value = size * ((n * (2 * i + 3) + i) as f64 * 0.618 + 0.3).sin();
        if dimension == 3 || is_in_plane {
            value
        } else {
            0.0
        }
    })
}

fn stress(law: &dyn Law, strain: &Vector6<f64>) -> Vector6<f64> {
    let linear = law.form().voigt() * strain;
    law.excess()
        .map_or(linear, |excess| linear + excess.at(strain).stress)
}

fn components(dimension: usize) -> &'static [usize] {
    voigt::components(dimension)
}

#[test]
fn tangents_are_derivatives_of_stresses_and_stresses_of_potentials() {
    for (deviator, dimension) in DEVIATORS {
        for (law, size) in laws(deviator, dimension) {
            let excess = law.excess().unwrap();
            let mut bent = 0;
            for n in 0..200 {
                let at = strain(n, dimension, size * (0.2 + 0.02 * n as f64));
                let point = excess.at(&at);
                let step = 1e-6 * size;
                let moved = |j: usize, by: f64| {
                    let mut to = at;
                    to[j] += by;
                    excess.at(&to)
                };
                bent += usize::from(point.stress.amax() > 1e-3 * size);
                let stiffness = point.tangent().amax().max(1e-3);
                for &j in components(dimension) {
                    let [plus, minus] = [step, -step].map(|by| moved(j, by));
                    let potential = (plus.potential - minus.potential) / (2.0 * step);
                    let error = (potential - point.stress[j]).abs();
                    // where the law of von Mises begins to bend there is a kink in the stress
                    let is_kinked = plus.stress.amax().min(minus.stress.amax()) == 0.0
                        && plus.stress.amax().max(minus.stress.amax()) > 0.0;
                    if is_kinked {
                        continue;
                    }
                    assert!(
                        error < 1e-7 * stiffness * size,
                        "{law:?} {n} {j}: {error:e}"
                    );
                    for &i in components(dimension) {
                        let slope = (plus.stress[i] - minus.stress[i]) / (2.0 * step);
                        let error = (slope - point.tangent()[(i, j)]).abs();
                        assert!(error < 1e-6 * stiffness, "{law:?} {n} {i} {j}: {error:e}");
                    }
                }
            }
            assert!(bent > 100, "{bent}");
        }
    }
}

/// The constants of the forms bound every quotient of stresses and strains, and are reached by some.
#[test]
fn constants_are_sharp() {
    for (deviator, dimension) in DEVIATORS {
        for (law, size) in laws(deviator, dimension) {
            let lower = law.form();
            let upper = lower.plus(&law.excess().unwrap().largest());
            let (m, l) = (lower.extremes(dimension)[0], upper.extremes(dimension)[1]);
            // the Frobenius product of strains
            let product = |x: &Vector6<f64>, y: &Vector6<f64>| -> f64 {
                let weight = |i: usize| if i < 3 { 1.0 } else { 0.5 };
                (0..6).map(|i| weight(i) * x[i] * y[i]).sum()
            };
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for n in 0..4000 {
                let scale = size * 10_f64.powf(-3.0 + (n % 13) as f64 * 0.6);
                let a = strain(n, dimension, scale);
                let mut by = strain(7 * n + 1, dimension, 1e-3 * scale);
                match n % 3 {
                    0 => {
                        // spherical
                        by.fill(0.0);
                        by.iter_mut()
                            .take(dimension)
                            .for_each(|v| *v = 1e-3 * scale);
                    }
                    1 => {
                        // none of it
                        let mean = by.iter().take(3).sum::<f64>() / dimension as f64;
                        by.iter_mut().take(dimension).for_each(|v| *v -= mean);
                    }
                    _ => {}
                }
                let d = stress(law.as_ref(), &(a + by)) - stress(law.as_ref(), &a);
                let work: f64 = d.dot(&by);
                let quotient = work / product(&by, &by);
                assert!(
                    quotient > m * (1.0 - 1e-6) && quotient < l * (1.0 + 1e-6),
                    "{law:?}: {quotient} outside of {m} {l}"
                );
                least = least.min(quotient);
                most = most.max(quotient);
            }
            assert!(
                least < 1.05 * m && most > 0.95 * l,
                "{law:?}: {least} {m} {most} {l}"
            );
        }
    }
}

#[test]
fn constants_are_those_of_the_closed_forms() {
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
    let constants = |law: &dyn Law, dimension: usize| {
        let upper = law.form().plus(&law.excess().unwrap().largest());
        (
            law.form().extremes(dimension)[0],
            upper.extremes(dimension)[1],
        )
    };
    // m_A = min(mu_inf, d mu1), L_A = max(mu_0, d mu1)
    let (m, l) = constants(&carreau(Deviator::InPlane), 2);
    close(m, 0.07);
    close(l, 0.4);
    let (m, l) = constants(&carreau(Deviator::ThreeDimensional), 3);
    close(m, 0.07);
    close(l, 0.4);
    // the deviator of space in plane strain: on the identity 2 mu1 + mu / 3
    let stiff = CarreauViscosity {
        mu1: 1.0,
        ..carreau(Deviator::ThreeDimensional)
    };
    close(constants(&stiff, 2).1, 2.0 + 0.4 / 3.0);
    let soft = CarreauViscosity { mu1: 0.01, ..stiff };
    close(constants(&soft, 2).0, 0.02 + 0.07 / 3.0);
    // L_B: 2 mu + beta
    close(
        constants(&von_mises(Deviator::InPlane, 2), 2).1,
        1.0 / 1.3 + 5.0,
    );
}

/// Laws at the ends of their parameters are linear ones.
#[test]
fn limits_are_linear_laws() {
    for (deviator, dimension) in DEVIATORS {
        let same = |law: &dyn Law, linear: &Form| {
            for n in 0..50 {
                let at = strain(n, dimension, 0.03);
                let expected = linear.voigt() * at;
                let difference = stress(law, &at) - expected;
                for &i in components(dimension) {
                    assert!(difference[i].abs() < 1e-15, "{law:?}");
                }
            }
        };
        // mu_0 = mu_inf = mu: isotropic, lambda = mu1 - mu times the share of the trace
        let share = match deviator {
            Deviator::InPlane => 0.5,
            Deviator::ThreeDimensional => 1.0 / 3.0,
        };
        let newtonian = CarreauViscosity {
            mu_0: 0.07,
            ..carreau(deviator)
        };
        assert!(newtonian.excess().is_none());
        let isotropic = |lambda: f64, two_mu: f64| Form::Isotropic { lambda, two_mu };
        same(&newtonian, &isotropic(0.05 - share * 0.07, 0.07));
        let Form::Isotropic { lambda, two_mu } = base(dimension).form() else {
            panic!("an isotropic law")
        };
        let whole = VonMisesElasticity {
            kappa: 0.0,
            ..von_mises(deviator, dimension)
        };
        same(&whole, &isotropic(lambda - share * 5.0, two_mu + 5.0));
        let none = VonMisesElasticity {
            kappa: 1e300,
            ..whole.clone()
        };
        same(&none, &isotropic(lambda, two_mu));
        // below kappa not a bit is added
        let law = von_mises(deviator, dimension);
        let inside = law.excess().unwrap().at(&strain(3, dimension, 0.003));
        assert_eq!((inside.stress, inside.potential), (Vector6::zeros(), 0.0));
        assert_eq!(inside.tangent(), Voigt::zeros());
    }
}

#[test]
fn values_that_a_law_cannot_have_are_refused_by_name() {
    let refusal = |law: &dyn Law, dimension: usize| {
        let error = law.check(dimension, "material.viscosity").unwrap_err();
        error.of("scene").to_string()
    };
    let law = carreau(Deviator::ThreeDimensional);
    for (law, key) in [
        (
            CarreauViscosity {
                mu1: 0.0,
                ..law.clone()
            },
            "mu1",
        ),
        (
            CarreauViscosity {
                mu_inf: 0.0,
                ..law.clone()
            },
            "mu_inf",
        ),
        (
            CarreauViscosity {
                mu_0: 0.06,
                ..law.clone()
            },
            "mu_0",
        ),
        (CarreauViscosity { c: f64::NAN, ..law }, "c"),
    ] {
        let found = refusal(&law, 2);
        assert!(
            found.contains(&format!("material.viscosity.{key}")),
            "{found}"
        );
    }
    assert!(refusal(&carreau(Deviator::InPlane), 3).contains("viscosity.deviator"));
    let law = von_mises(Deviator::ThreeDimensional, 2);
    let negative = VonMisesElasticity {
        beta: -1.0,
        ..law.clone()
    };
    assert!(refusal(&negative, 2).contains("viscosity.beta"));
    let plane_stress = Base::Isotropic(IsotropicElasticity {
        convention: Convention::PlaneStress,
        ..base(2)
    });
    let membrane = VonMisesElasticity {
        base: plane_stress,
        ..law
    };
    assert!(refusal(&membrane, 2).contains("viscosity.deviator"));
    let in_plane = VonMisesElasticity {
        deviator: Deviator::InPlane,
        ..membrane.clone()
    };
    assert!(in_plane.check(2, "").is_ok());
    let soft = HenckyElasticity {
        bulk: -1.0,
        ..hencky(Deviator::InPlane)
    };
    assert!(refusal(&soft, 2).contains("viscosity.bulk"));
}

/// The declarations name the keys of the scene, the nested ones by their paths.
#[test]
fn parameters_are_the_keys_of_the_scene() {
    let law = Viscosity::Carreau(carreau(Deviator::InPlane));
    let of = |json: serde_json::Value, law: &dyn Law| {
        for parameter in law.parameters("Pa") {
            let pointer = format!("/{}", parameter.key.replace('.', "/"));
            assert!(json.pointer(&pointer).is_some(), "{pointer} in {json}");
        }
        let nested = json
            .get("base")
            .map_or(0, |base| base.as_object().unwrap().len() - 2);
        // the name of the law is no parameter
        assert_eq!(
            json.as_object().unwrap().len() - 1 + nested,
            law.parameters("Pa").len()
        );
    };
    of(serde_json::to_value(&law).unwrap(), law.law());
    for law in [
        Elasticity::VonMises(von_mises(Deviator::InPlane, 2)),
        Elasticity::Hencky(hencky(Deviator::InPlane)),
    ] {
        of(serde_json::to_value(&law).unwrap(), law.law());
    }
    for word in excess::DEVIATORS.words {
        let read: Result<Deviator, _> = serde_json::from_value((*word).into());
        assert!(read.is_ok(), "{word}");
    }
}
