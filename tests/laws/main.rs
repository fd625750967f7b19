//! What holds for every law in the list: formulas against each other, solves of random contact problems, whole scenes.

#[path = "../common/mod.rs"]
mod common;
mod expression;
mod pressed;
mod problems;
mod quadrature;
mod rate_and_state;
mod scenes;
mod slip_memory;

use common::random::Random;
use quadrature::integral;
use stickslip::contact::SlipPath;
use stickslip::contact::bounds::Bounds;
use stickslip::contact::evaluation::{NodalLaw, Nodes};
use stickslip::contact::law::{
    ChosenLaw, Coefficient, Extent, Given, Law, LawBounds, Omitted, Role, Unit,
};

const STILL: SlipPath = SlipPath {
    base: 0.0,
    per_rate: 0.0,
};

/// Points of slip in a random surface.
const SLIPS: usize = 4;

/// The laws with a potential.
pub fn with_potential() -> impl Iterator<Item = Law> {
    let all = Law::all().into_iter();
    all.filter(|law| law.kind().has_potential())
}

/// Those of them whose bounds do not depend on the pressure.
pub fn laws_in_pascal() -> impl Iterator<Item = Law> {
    with_potential().filter(|law| !matches!(law.role(), Role::Coulomb { .. }))
}

/// A law with random coefficients, drawn from what it declares; with `nodes` some of them are fields.
pub fn draw(law: Law, random: &mut Random, nodes: Option<usize>) -> ChosenLaw {
    loop {
        let given: Vec<Given> = law
            .coefficients()
            .enumerate()
            .map(|(i, declared)| given(declared, law.unit(i), random, nodes))
            .collect();
        let points = nodes.map(|nodes| vec![[0.0; 3]; nodes]);
        if let Ok(chosen) = ChosenLaw::new(law, &given, points.as_deref()) {
            return chosen;
        }
    }
}

fn given(declared: &Coefficient, unit: &str, random: &mut Random, nodes: Option<usize>) -> Given {
    if declared.omitted == Omitted::Without && random.happens(0.5) {
        return Given::Absent;
    }
    if declared.extent == Extent::Formula {
        let [high, low, width, steep] = [0.5, 0.3, 0.7, 2.0].map(|x| x * random.between(0.1, 1.0));
        let falling = format!("{low} + {high} * exp(-r / {width}) / (1 + {steep} * s)");
        return Given::Formula(format!("max(1e-3, {falling} * (1 + 0.1 * p) ^ (-1/3))"));
    }
    if let Extent::Choice(words) = declared.extent {
        return Given::Choice(random.below(words.len()));
    }
    let (low, high) = match unit {
        "Pa" => (-3.0, -0.5),
        "s/m" => (-1.0, 3.0),
        _ => (-2.0, 0.5),
    };
    let is_surface = declared.extent == Extent::Grid && random.happens(0.5);
    let count = match (declared.extent, nodes) {
        _ if is_surface => 6 * SLIPS,
        (Extent::Points, _) if unit == "m" => SLIPS,
        (Extent::Points | Extent::Grid, _) => 6,
        (Extent::Nodes, Some(nodes)) if random.happens(0.5) => nodes,
        _ => 1,
    };
    let one = |_| declared.range.least + 10.0_f64.powf(random.between(low, high));
    let mut values: Vec<f64> = (0..count).map(one).collect();
    match declared.extent {
        Extent::Nodes if count == 1 => Given::Number(values[0]),
        Extent::Nodes => Given::Nodes(values),
        Extent::Choice(_) | Extent::Formula => unreachable!("has no numbers"),
        Extent::Grid if is_surface => Given::Rows(values, vec![SLIPS; 6]),
        Extent::Points | Extent::Grid => {
            if random.happens(0.5) {
                values.sort_by(f64::total_cmp);
            }
            Given::Points(values)
        }
    }
}

/// Where a law may have kinks, which no quadrature may step over: slip rates, and accumulated slips.
fn kinks(chosen: &ChosenLaw) -> [Vec<f64>; 2] {
    let law = chosen.law();
    let own = law.kind().coefficients().iter().zip(chosen.places());
    ["m/s", "m"].map(|unit| {
        let points = own.clone().filter(|(declared, _)| {
            let is_point = unit == "m" || declared.extent == Extent::Points;
            is_point && declared.unit == Unit::Own(unit)
        });
        points
            .flat_map(|(_, place)| chosen.start()[place.range()].to_vec())
            .collect()
    })
}

/// Slip rates at which a stage meets kinks, in order.
fn kinks_along([rates, slips]: &[Vec<f64>; 2], path: SlipPath) -> Vec<f64> {
    let crossings = slips.iter().map(|slip| (slip - path.base) / path.per_rate);
    let all = rates.iter().copied().chain(crossings);
    let mut kinks: Vec<f64> = all.filter(|kink| kink.is_finite() && *kink > 0.0).collect();
    kinks.sort_by(f64::total_cmp);
    kinks
}

/// The steepest fall over rates and slips: near the kinks of both.
fn steepest_fall(bounds: &LawBounds, kinks: &[Vec<f64>; 2], per_rate: f64) -> f64 {
    let near = |points: &[f64]| -> Vec<f64> {
        let sides = |point: &f64| [point * (1.0 - 1e-9), point * (1.0 + 1e-9)];
        points.iter().flat_map(sides).chain([0.0]).collect()
    };
    // 0.2 % apart, or 2 % at every slip
    let share = if kinks[1].is_empty() { 1000 } else { 100 };
    let spread = (0..=12 * share).map(|i| 10.0_f64.powf(-8.0 + f64::from(i) / f64::from(share)));
    let rates: Vec<f64> = spread.chain(near(&kinks[0])).collect();
    let falls = near(&kinks[1]).into_iter().flat_map(|slip| {
        rates.iter().map(move |rate| {
            let base = slip - per_rate * rate;
            -bounds.evaluate(0, *rate, SlipPath { base, per_rate }).slope
        })
    });
    falls.fold(0.0, f64::max)
}

/// The pieces of an interval between kinks.
fn pieces(kinks: &[f64], from: f64, to: f64) -> impl Iterator<Item = [f64; 2]> {
    let inside = kinks.iter().copied().filter(move |k| *k > from && *k < to);
    let mut ends = vec![from];
    ends.extend(inside);
    ends.push(to);
    (1..ends.len()).map(move |i| [ends[i - 1], ends[i]])
}

/// Slope, potential, weakening and extremes are derivative, integral, steepest fall and range of the bound along a stage.
#[test]
fn formulas_of_a_law_agree() {
    let mut random = Random::new(7);
    for law in with_potential() {
        let mut seen = 0.0_f64;
        // the kinds are the same in both roles, their numbers are not
        let cases = match law.role() {
            Role::Own | Role::Bound => 150,
            Role::Coulomb { .. } => 30,
        };
        for case in 0..cases {
            let chosen = draw(law, &mut random, None);
            let all_kinks = kinks(&chosen);
            let bounds = chosen.bounds();
            let paths = [0.0, random.between(0.001, 1.0)].map(|per_rate| SlipPath {
                base: random.between(0.0, 0.5),
                per_rate,
            });
            for path in paths {
                let label = format!("{law:?} {case} {path:?}: {:?}", chosen.start());
                let kinks = kinks_along(&all_kinks, path);
                let at = |rate: f64| bounds.evaluate(0, rate, path);
                let bound = |rate: f64| at(rate).bound;
                assert_eq!(at(0.0).potential, 0.0, "{label}");
                assert_eq!(bound(0.0), bounds.at_rest(0, path), "{label}");
                // 12 % apart, and one within every piece of a curve
                let spread = (0..=240).map(|i| 10.0_f64.powf(-8.0 + f64::from(i) / 20.0));
                let within = kinks.windows(2).map(|ends| 0.5 * (ends[0] + ends[1]));
                let mut rates: Vec<f64> = spread.chain(within).collect();
                rates.sort_by(f64::total_cmp);
                let l = bounds.weakening(path.per_rate);
                let (mut potential, mut steepest) = (0.0, 0.0_f64);
                let [largest, smallest] = bounds.extremes(0);
                let noise = if largest.is_finite() {
                    f64::EPSILON * largest
                } else {
                    0.0
                };
                let mut before = 0.0;
                for &rate in &rates {
                    let found = at(rate);
                    potential += pieces(&kinks, before, rate)
                        .map(|[a, b]| integral(&bound, a, b, noise))
                        .sum::<f64>();
                    let scale = potential + bound(0.0) * rate;
                    assert!(
                        (found.potential - potential).abs() <= 2e-13 * scale,
                        "{label}: potential at {rate:e}: {:e} {potential:e}",
                        found.potential
                    );
                    assert!(
                        found.bound >= smallest - 1e-15 * bound(0.0)
                            && found.bound <= largest * (1.0 + 1e-14),
                        "{label}: {rate:e}"
                    );
                    // a difference, where no kink is near
                    let d = 1e-5 * rate;
                    let slopes = [at(rate - d).slope, at(rate + d).slope];
                    let difference = (bound(rate + d) - bound(rate - d)) / (2.0 * d);
                    let size = found.bound / rate;
                    if (slopes[0] - slopes[1]).abs() <= 1e-4 * (slopes[0].abs() + size) {
                        assert!(
                            (found.slope - difference).abs()
                                <= 1e-8 * size + 1e-6 * found.slope.abs(),
                            "{label}: slope {:e}, {difference:e} at {rate:e}",
                            found.slope
                        );
                    }
                    // by the slip at fixed rate
                    let moved = |by: f64| {
                        let base = path.base + by;
                        bounds.evaluate(0, rate, SlipPath { base, ..path }).bound
                    };
                    let d = 1e-6;
                    let own = bounds.slip_slope(0, rate, path);
                    let [low, high] = [-d, d].map(|d| {
                        let base = path.base + d;
                        bounds.slip_slope(0, rate, SlipPath { base, ..path })
                    });
                    if (low - high).abs() <= 1e-4 * own.abs() {
                        let difference = (moved(d) - moved(-d)) / (2.0 * d);
                        assert!(
                            (own - difference).abs() <= 1e-6 * own.abs() + 1e-9 * found.bound,
                            "{label}: by slip {own:e} {difference:e}"
                        );
                    }
                    // between two rates the mean slope is not steeper than the steepest
                    let mean = (bound(before) - found.bound) / (rate - before);
                    assert!(
                        mean <= l * (1.0 + 1e-9) + 1e-12 * bound(0.0) / rate,
                        "{label}: {mean:e} {l:e}"
                    );
                    steepest = steepest.max(-found.slope);
                    before = rate;
                    seen += found.bound;
                }
                // and it is reached
                assert!(steepest <= l * (1.0 + 1e-12), "{label}");
                let reached = steepest_fall(&bounds, &all_kinks, path.per_rate);
                assert!(
                    reached >= 0.98 * l && reached <= l * (1.0 + 1e-6),
                    "{label}: {reached:e} of {l:e}"
                );
            }
        }
        assert!(seen > 0.0 || law.name() == "frictionless");
    }
}

/// All nodes at once are the nodes one by one, whether coefficients are numbers or fields.
#[test]
fn all_nodes_at_once_are_the_nodes_one_by_one() {
    let mut random = Random::new(11);
    for law in with_potential() {
        for nodes in [None, Some(13)] {
            for _ in 0..20 {
                let chosen = draw(law, &mut random, nodes);
                let bounds = chosen.bounds();
                let mut list =
                    || -> Vec<f64> { (0..13).map(|_| random.between(1e-4, 2.0)).collect() };
                let (weights, mut rates, slip_base) = (list(), list(), list());
                rates[3] = 0.0;
                let at = Nodes {
                    weights: &weights,
                    rates: &rates,
                    slip_base: &slip_base,
                    per_rate: 0.1,
                };
                let mut all = NodalLaw::new(13);
                bounds.fill(at, &mut all);
                let mut at_rest = 0.0_f64;
                for node in 0..13 {
                    let slip = SlipPath {
                        base: slip_base[node],
                        per_rate: 0.1,
                    };
                    let one = bounds.evaluate(node, rates[node], slip);
                    assert_eq!(all.bound[node], weights[node] * one.bound, "{law:?}");
                    assert_eq!(all.slope[node], weights[node] * one.slope, "{law:?}");
                    assert_eq!(
                        all.potential[node],
                        weights[node] * one.potential,
                        "{law:?}"
                    );
                    at_rest = at_rest.max(weights[node] * bounds.at_rest(node, slip));
                }
                assert_eq!(bounds.largest_at_rest(at), at_rest, "{law:?}");
            }
        }
    }
}

/// `a + (a - b) expm1` would leave only what rounding of `a` leaves: 7e-5 of the bound at the first of these rates.
#[test]
fn a_bound_far_below_the_static_one_keeps_its_digits() {
    let (a, alpha) = (0.002_915_296_635_569_256, 15.905_690_361_416_516);
    let law = Law::find(Role::Own, "exponential").unwrap();
    for b in [0.0, 1.829_174_241_068_124_5e-13] {
        let chosen = ChosenLaw::new(law, &[a, b, alpha].map(Given::Number), None).unwrap();
        for rate in [1.752_592_413_445_908_5, 0.6, 5.0, 40.0] {
            let found = chosen.bounds().evaluate(0, rate, STILL);
            let right = b + (a - b) * (-alpha * rate).exp();
            let slope = -alpha * (a - b) * (-alpha * rate).exp();
            assert!((found.bound / right - 1.0).abs() < 1e-12, "{right:e}");
            assert!((found.slope / slope - 1.0).abs() < 1e-12);
        }
    }
}
