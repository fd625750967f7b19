//! The runs of a sweep: a value for every axis, on a grid, in a list, in a Latin hypercube or along a Sobol sequence. The same plan is
//! the same runs on every machine.

use super::axis::{Axis, MOST, json};
use super::refuse;
use stickslip::Result;

/// How runs are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Every value with every other one; the last axis goes fastest.
    Grid,
    /// The first values of all axes, the second ones, and so on.
    List,
    /// Latin hypercube: of `runs` equal parts of every axis each is met once.
    Latin,
    /// Sobol sequence with Owen's scrambling: evenly spread for every number of runs, best for powers of two.
    Sobol,
}

impl Sampling {
    /// All, by what they are called.
    pub const ALL: [(&'static str, Sampling); 4] = [
        ("grid", Sampling::Grid),
        ("list", Sampling::List),
        ("latin", Sampling::Latin),
        ("sobol", Sampling::Sobol),
    ];

    /// # Errors
    /// [`stickslip::Error::Scene`] for another word.
    pub fn of(name: &str) -> Result<Sampling> {
        let known = Sampling::ALL.iter().find(|(known, _)| *known == name);
        known
            .map(|(_, sampling)| *sampling)
            .ok_or_else(|| refuse("sampling", name, "grid, list, latin, sobol"))
    }
}

/// The runs of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Paths of the scene.
    pub paths: Vec<String>,
    /// For every run a value of every path, as JSON.
    pub points: Vec<Vec<String>>,
}

/// Most points of the Sobol sequence, and most axes.
const MOST_SOBOL: usize = 1 << 16;
const MOST_SOBOL_AXES: usize = sobol_burley::NUM_DIMENSIONS as usize;

impl Plan {
    /// `runs` and `seed` are for samples.
    ///
    /// # Errors
    /// [`stickslip::Error::Scene`] for axes that give no plan.
    pub fn new(axes: &[Axis], sampling: Sampling, runs: Option<usize>, seed: u32) -> Result<Plan> {
        let paths: Vec<String> = axes.iter().map(|axis| axis.path.clone()).collect();
        for (i, path) in paths.iter().enumerate() {
            if paths[..i].contains(path) {
                return Err(refuse(path, "two axes", "one axis for a path"));
            }
        }
        if axes.is_empty() {
            return Err(refuse("vary", "nothing", "one axis or more"));
        }
        let is_sampled = matches!(sampling, Sampling::Latin | Sampling::Sobol);
        match runs {
            Some(_) if !is_sampled => {
                return Err(refuse("runs", "a number", "nothing, for a grid or a list"));
            }
            None if is_sampled => return Err(refuse("runs", "nothing", "the number of samples")),
            _ => {}
        }
        if sampling == Sampling::Sobol && axes.len() > MOST_SOBOL_AXES {
            let allowed = format!("{MOST_SOBOL_AXES} axes at most");
            return Err(refuse("vary", &format!("{} axes", axes.len()), &allowed));
        }
        let runs = runs.unwrap_or(0);
        let most = match sampling {
            Sampling::Sobol => MOST_SOBOL,
            _ => MOST,
        };
        if is_sampled && (runs == 0 || runs > most) {
            let allowed = format!("1 to {most} samples");
            return Err(refuse("runs", &runs.to_string(), &allowed));
        }
        let points = match sampling {
            Sampling::Grid => grid(axes)?,
            Sampling::List => list(axes)?,
            Sampling::Latin => {
                let columns = axes.iter().enumerate();
                let columns: Vec<_> = columns.map(|(i, _)| strata(runs, seed, i)).collect();
                sampled(axes, runs, |run, axis| columns[axis][run])
            }
            Sampling::Sobol => sampled(axes, runs, |run, axis| {
                f64::from(sobol_burley::sample(run as u32, axis as u32, seed))
            }),
        };
        Ok(Plan { paths, points })
    }
}

fn sampled(axes: &[Axis], runs: usize, share: impl Fn(usize, usize) -> f64) -> Vec<Vec<String>> {
    let of_run = |run| {
        let axes = axes.iter().enumerate();
        axes.map(|(i, axis)| axis.at(share(run, i))).collect()
    };
    (0..runs).map(of_run).collect()
}

fn grid(axes: &[Axis]) -> Result<Vec<Vec<String>>> {
    let values: Vec<_> = axes.iter().map(Axis::values).collect::<Result<_>>()?;
    let runs = values
        .iter()
        .try_fold(1_usize, |n, v| n.checked_mul(v.len()));
    let Some(runs) = runs.filter(|runs| *runs <= MOST) else {
        return Err(refuse(
            "vary",
            "a grid of too many runs",
            &format!("{MOST} at most"),
        ));
    };
    let point = |run: usize| {
        let mut rest = run;
        let mut point: Vec<String> = values
            .iter()
            .rev()
            .map(|values| {
                let value = values[rest % values.len()].clone();
                rest /= values.len();
                value
            })
            .collect();
        point.reverse();
        point
    };
    Ok((0..runs).map(point).collect())
}

fn list(axes: &[Axis]) -> Result<Vec<Vec<String>>> {
    let values: Vec<_> = axes.iter().map(Axis::values).collect::<Result<_>>()?;
    let runs = values[0].len();
    for (axis, values) in axes.iter().zip(&values) {
        if values.len() != runs {
            let allowed = format!("{runs}, as many as the first axis has");
            return Err(refuse(
                &axis.path,
                &format!("{} values", values.len()),
                &allowed,
            ));
        }
    }
    let point = |run: usize| values.iter().map(|v| v[run].clone()).collect();
    Ok((0..runs).map(point).collect())
}

/// A share in each of `runs` equal parts, in a random order.
fn strata(runs: usize, seed: u32, axis: usize) -> Vec<f64> {
    let mut random = Random((u64::from(seed) << 32) ^ (axis as u64 + 1));
    let mut order: Vec<usize> = (0..runs).collect();
    for i in (1..runs).rev() {
        // the bias of a remainder of 64 bits is of no account
        order.swap(i, (random.next() % (i as u64 + 1)) as usize);
    }
    let share = |part| (part as f64 + random.share()) / runs as f64;
    order.into_iter().map(share).collect()
}

/// SplitMix64 (Steele, Lea, Flood 2014): small, the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Values as they stand in a list, of numbers as JSON.
pub fn numbers(values: &[f64]) -> Vec<String> {
    values.iter().copied().map(json).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(axes: &[&str], sampling: Sampling, runs: Option<usize>) -> Result<Plan> {
        let axes: Vec<_> = axes.iter().map(|a| Axis::parse(a).unwrap()).collect();
        Plan::new(&axes, sampling, runs, 7)
    }

    #[test]
    fn a_grid_has_every_pair_and_a_list_goes_in_step() {
        let points = plan(&["a=1,2", "b=x,y,z"], Sampling::Grid, None)
            .unwrap()
            .points;
        assert_eq!(points.len(), 6);
        assert_eq!(points[0], ["1", "x"]);
        assert_eq!(points[1], ["1", "y"]);
        assert_eq!(points[5], ["2", "z"]);
        let points = plan(&["a=1,2", "b=x,y"], Sampling::List, None)
            .unwrap()
            .points;
        assert_eq!(points, [["1", "x"], ["2", "y"]]);
        for (axes, sampling, runs) in [
            (&["a=1,2", "b=x"][..], Sampling::List, None),
            (&["a=1,2", "a=3"], Sampling::Grid, None),
            (&[], Sampling::Grid, None),
            (&["a=1,2"], Sampling::Grid, Some(2)),
            (&["a=1:2"], Sampling::Grid, None),
            (&["a=1:2"], Sampling::Latin, None),
            (&["a=1:2"], Sampling::Sobol, Some(1 << 17)),
            (&["a=0:1:10000", "b=0:1:10000"], Sampling::Grid, None),
        ] {
            assert!(plan(axes, sampling, runs).is_err(), "{axes:?} {sampling:?}");
        }
    }

    /// Each of as many equal parts as there are runs is met once, on every axis; Sobol points do it too for a power of two.
    #[test]
    fn samples_are_spread_over_every_axis() {
        for sampling in [Sampling::Latin, Sampling::Sobol] {
            let runs = 64;
            let points = plan(&["a=0:1", "b=0:64", "c=1:1e6:log"], sampling, Some(runs))
                .unwrap()
                .points;
            assert_eq!(
                points,
                plan(&["a=0:1", "b=0:64", "c=1:1e6:log"], sampling, Some(runs))
                    .unwrap()
                    .points
            );
            let share = |point: &[String]| {
                let x: Vec<f64> = point.iter().map(|x| x.parse().unwrap()).collect();
                [x[0], x[1] / 64.0, x[2].log10() / 6.0]
            };
            for axis in 0..3 {
                let parts = points
                    .iter()
                    .map(|p| (share(p)[axis] * runs as f64) as usize);
                let mut parts: Vec<_> = parts.collect();
                assert!(parts.windows(2).any(|p| p[1] < p[0]), "in order: {parts:?}");
                parts.sort_unstable();
                assert_eq!(
                    parts,
                    (0..runs).collect::<Vec<_>>(),
                    "{sampling:?}, axis {axis}"
                );
            }
        }
    }
}
