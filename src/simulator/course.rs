//! The course of a scene's own run: its communication points. Where a signal jumps there is one too.

use crate::error::{Error, Result};
use crate::message::number;
use crate::scene::{Scene, Signal};

/// Most steps of a run, internal ones included: hours at the microseconds of a small model. Runs that would take more are
/// refused before they begin; a run that must be longer is taken in parts.
pub const MOST_STEPS: f64 = 1e9;
/// Share of a communication step within which two times are the same.
const SAME_TIME: f64 = 1e-9;

/// The communication points of a scene: every `run.step` (default `time.step`) up to `run.until`, and where signals jump.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Communication step, s.
    pub step: f64,
    /// End of the run, s.
    pub until: f64,
    /// Number of communication steps; the last one may be shorter.
    pub count: u64,
    /// First and last time of the jumps that are at the same time.
    jumps: Vec<[f64; 2]>,
}

impl Points {
    pub fn of(scene: &Scene) -> Points {
        let step = scene.run.step.unwrap_or(scene.time.step);
        let until = scene.run.until;
        // a step that divides the interval must not leave a rounding error behind as a step of its own
        let steps = until / step;
        let rounding = (SAME_TIME * steps).min(1e-3);
        let count = (steps - rounding).ceil().max(1.0) as u64;
        let mut times: Vec<f64> = scene.run.signals.values().flat_map(Signal::jumps).collect();
        times.retain(|time| *time > 0.0 && *time < until);
        times.sort_by(f64::total_cmp);
        let mut jumps: Vec<[f64; 2]> = Vec::new();
        for time in times {
            match jumps.last_mut() {
                Some(last) if time - last[1] <= SAME_TIME * step => last[1] = time,
                _ => jumps.push([time, time]),
            }
        }
        Points {
            step,
            until,
            count,
            jumps,
        }
    }

    /// The points of a run that will end.
    ///
    /// # Errors
    /// [`Error::Scene`] at `run.until` for more than [`MOST_STEPS`] steps, communication steps or internal ones.
    pub fn checked(scene: &Scene) -> Result<Points> {
        let points = Points::of(scene);
        let communication = points.until / points.step;
        let internal = points.until / points.step.min(scene.time.step);
        let (steps, path, step) = if communication > MOST_STEPS {
            let path = match scene.run.step {
                Some(_) => "run.step",
                None => "time.step",
            };
            (communication, path, points.step)
        } else {
            (internal, "time.step", scene.time.step)
        };
        if steps <= MOST_STEPS {
            return Ok(points);
        }
        Err(Error::Scene {
            source_name: scene.name.clone(),
            path: "run.until".to_owned(),
            found: format!(
                "{}, which takes {:.1e} steps of {path} = {}",
                number(points.until),
                steps.min(f64::MAX),
                number(step)
            ),
            allowed: format!("a run of at most {MOST_STEPS:e} steps"),
        })
    }

    /// Time of point `n`, s; the start is point 0 at time 0.
    pub fn at(&self, n: u64) -> f64 {
        if n >= self.count {
            return self.until;
        }
        let time = n as f64 * self.step;
        match self.jump_at(time) {
            Some([_, last]) if n > 0 => last,
            _ => time,
        }
    }

    /// End of the next step from `time` on the way to point `n`: a jump on the way, or else the point, and whether it is that.
    pub(super) fn stop_after(&self, time: f64, n: u64) -> (f64, bool) {
        let to = self.at(n);
        let next = self.jumps.partition_point(|jump| jump[1] <= time);
        match self.jumps.get(next) {
            Some(jump) if jump[1] < to - SAME_TIME * self.step => (jump[1], false),
            _ => (to, true),
        }
    }

    /// Number of the last communication point that is not after a time.
    pub(super) fn passed_at(&self, time: f64) -> u64 {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low).div_ceil(2);
            if self.at(middle) <= time + SAME_TIME * self.step {
                low = middle;
            } else {
                high = middle - 1;
            }
        }
        low
    }

    /// First and last time of the jumps at a time.
    pub(super) fn jump_at(&self, time: f64) -> Option<[f64; 2]> {
        let slack = SAME_TIME * self.step;
        let next = self.jumps.partition_point(|jump| jump[1] < time - slack);
        let jump = self.jumps.get(next)?;
        (jump[0] <= time + slack).then_some(*jump)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(step: f64, until: f64, table: &[[f64; 2]]) -> Points {
        let text = crate::scene::example("kazmi2014").unwrap_or_default();
        let mut scene = Scene::from_json(text, "kazmi2014").unwrap();
        scene.run.step = Some(step);
        scene.run.until = until;
        let signal = Signal::Table(table.to_vec());
        scene.run.signals.insert("press".to_owned(), signal);
        scene.validate("test").unwrap();
        Points::of(&scene)
    }

    fn all(points: &Points) -> Vec<f64> {
        let (mut times, mut time, mut n) = (Vec::new(), points.at(0), 1);
        while n <= points.count {
            let is_point;
            (time, is_point) = points.stop_after(time, n);
            times.push(time);
            n += u64::from(is_point);
        }
        times
    }

    #[test]
    fn steps_end_where_signals_jump() {
        let table = [[0.0, 0.0], [0.25, 1.0], [0.25, 2.0], [0.3, 3.0], [0.3, 1.0]];
        let found = points(0.1, 0.5, &table);
        // 3 * 0.1 is above 0.3: the point is where the signal jumps
        assert_eq!(all(&found), [0.1, 0.2, 0.25, 0.3, 0.4, 0.5]);
        assert_eq!(found.at(3), 0.3);
        // at the start and at the end there is nothing before or after; equal values are no jump
        let table = [
            [0.0, 1.0],
            [0.0, 2.0],
            [0.15, 2.0],
            [0.15, 2.0],
            [0.2, 2.0],
            [0.2, 0.0],
        ];
        assert_eq!(all(&points(0.1, 0.2, &table)), [0.1, 0.2]);
        assert_eq!(all(&points(0.1, 0.25, &table)), [0.1, 0.2, 0.25]);
        // several jumps within a step
        let table = [[0.01, 0.0], [0.01, 1.0], [0.02, 1.0], [0.02, 0.0]];
        assert_eq!(all(&points(0.1, 0.1, &table)), [0.01, 0.02, 0.1]);
    }

    #[test]
    fn a_time_lies_behind_the_points_that_it_has_passed() {
        let found = points(0.1, 0.55, &[[0.0, 0.0], [0.3, 3.0], [0.3, 1.0]]);
        for n in 0..=found.count {
            assert_eq!(found.passed_at(found.at(n)), n);
            assert_eq!(found.passed_at(found.at(n) + 0.04), n);
        }
    }

    #[test]
    fn a_signal_has_two_values_at_a_jump() {
        let signal = Signal::Table(vec![[0.0, 1.0], [1.0, 3.0], [1.0, -1.0], [2.0, -2.0]]);
        for (time, before, after) in [
            (-1.0, 1.0, 1.0),
            (0.0, 1.0, 1.0),
            (0.5, 2.0, 2.0),
            (1.0, 3.0, -1.0),
            (1.5, -1.5, -1.5),
            (2.0, -2.0, -2.0),
            (3.0, -2.0, -2.0),
        ] {
            assert_eq!((signal.before(time), signal.at(time)), (before, after));
        }
        assert_eq!(signal.jumps().collect::<Vec<_>>(), [1.0]);
    }
}
