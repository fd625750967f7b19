//! The parts that a communication step is cut into.
//!
//! A communication step of `h` is cut into equal panels. Without `time.tolerance` a panel is one internal step, not larger than
//! `time.step`. With it a panel is a pair of equal internal steps, and may be halved, and its halves again. So every
//! communication step ends exactly, and the sizes are those of the panel divided by powers of two: few, so that the
//! factorizations of the last ones serve again.

use crate::error::{Error, Result};
use crate::model::Model;

/// Internal steps of one communication step beyond which a call is a mistake of the caller and would seem to hang.
pub(crate) const MOST_INTERNAL_STEPS: u64 = 1_000_000;

/// A part of a communication step: one internal step, or a pair of equal ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    /// Number of the panel, and of panels.
    panel: u64,
    panels: u64,
    /// Place among the `2^level` equal parts of the panel.
    place: u64,
    level: u32,
    /// Internal steps in it.
    pub steps: u32,
    /// Size of each, s.
    pub k: f64,
}

impl Part {
    /// The fraction of the communication step at a fraction of the part.
    pub fn at(&self, fraction: f64) -> f64 {
        let in_panel = (self.place as f64 + fraction) / power(self.level);
        (self.panel as f64 + in_panel) / self.panels as f64
    }

    /// Size of the part, s.
    pub fn size(&self) -> f64 {
        f64::from(self.steps) * self.k
    }
}

/// The parts of a communication step, one after the other.
pub(crate) struct Parts {
    next: Part,
    /// Size of a panel, s.
    panel_size: f64,
    /// Size of the communication step, s.
    size: f64,
    /// Internal steps taken.
    taken: u64,
}

impl Parts {
    /// Of a communication step of `h` from the time `start`.
    pub fn of(start: f64, h: f64, model: &Model) -> Parts {
        let steps = if model.tolerance().is_some() { 2 } else { 1 };
        let (panels, panel_size) = panels(start, h, f64::from(steps) * model.largest_step());
        Parts {
            next: Part {
                panel: 0,
                panels,
                place: 0,
                level: 0,
                steps,
                k: 0.0,
            },
            panel_size,
            size: h,
            taken: 0,
        }
    }

    /// Internal steps of the communication step, where all are equal.
    pub fn internal_steps(&self) -> u64 {
        self.next.panels * u64::from(self.next.steps)
    }

    /// The next part, the largest that is not above `size` and stays in the half of the panel that it begins; the whole
    /// panel without a size. `None` at the end.
    pub fn next(&mut self, size: Option<f64>) -> Option<Part> {
        let part = &mut self.next;
        if part.panel == part.panels {
            return None;
        }
        if let Some(size) = size {
            let most = size * (1.0 + SAME_SIZE);
            let at_level = |level: u32| self.panel_size / power(level);
            while part.level > 0 && part.place.is_multiple_of(2) && at_level(part.level - 1) <= most
            {
                part.level -= 1;
                part.place /= 2;
            }
            while at_level(part.level) > most && part.level < DEEPEST {
                part.level += 1;
                part.place *= 2;
            }
        }
        part.k = self.panel_size / power(part.level) / f64::from(part.steps);
        Some(*part)
    }

    /// The part that was given last has been taken.
    ///
    /// # Errors
    /// [`Error::Step`] after [`MOST_INTERNAL_STEPS`], with the size that they came to.
    pub fn pass(&mut self) -> Result<()> {
        let part = &mut self.next;
        self.taken += u64::from(part.steps);
        if self.taken > MOST_INTERNAL_STEPS {
            return Err(Error::Step {
                what: "communication step (at most a million internal steps, which time.tolerance made so small)",
                expected: part.at(1.0) * self.size,
                found: self.size,
            });
        }
        part.place += 1;
        if part.place == 1 << part.level {
            part.panel += 1;
            part.place = 0;
            part.level = 0;
        }
        Ok(())
    }
}

/// Relative difference of sizes that count as the same.
const SAME_SIZE: f64 = 1e-9;
/// Most halvings of a panel: places stay exact as numbers.
const DEEPEST: u32 = 50;

/// How many roundings of the time the difference of two communication points may be off: two of the points, two of how a
/// host makes them.
const ROUNDINGS: f64 = 4.0;
/// Share of the largest panel that rounding of the time may make up.
const MOST_ROUNDING: f64 = 0.01;

/// Number and size of equal panels, not larger than `largest`, that make up a step of `h` from `start`.
///
/// A communication step that is a multiple of the largest panel but for the rounding of its two times is taken as that
/// multiple: it gains no panel by rounding, and its panels have the very size of those at other times.
fn panels(start: f64, h: f64, largest: f64) -> (u64, f64) {
    let resolution = f64::EPSILON * start.abs().max((start + h).abs());
    let rounding = (ROUNDINGS * resolution).min(MOST_ROUNDING * largest);
    let multiple = (h / largest).round();
    if multiple >= 1.0 && (h - multiple * largest).abs() <= rounding {
        return (multiple as u64, without_jitter(largest));
    }
    let count = ((h / largest) * (1.0 - SAME_SIZE)).ceil().max(1.0);
    (count as u64, without_jitter(h / count))
}

/// Rounds away the last bits of a step size: masters compute `t[i+1] - t[i]`, and sizes equal but for rounding must
/// share one factorization. The relative change is below 1e-12.
fn without_jitter(k: f64) -> f64 {
    f64::from_bits((k.to_bits() + 0x800) & !0xfff)
}

fn power(level: u32) -> f64 {
    (1_u64 << level) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(size: f64, panels: u64, steps: u32) -> Parts {
        Parts {
            next: Part {
                panel: 0,
                panels,
                place: 0,
                level: 0,
                steps,
                k: 0.0,
            },
            panel_size: size / panels as f64,
            size,
            taken: 0,
        }
    }

    /// Whatever sizes are proposed, the parts follow one another, none is larger, and the last ends at 1.
    #[test]
    fn parts_make_up_the_step() {
        for panels in [1, 3, 7] {
            let mut parts = parts(0.7, panels, 2);
            let (mut end, mut n) = (0.0, 0_u32);
            while let Some(part) = parts.next(Some(0.7 * 2.0_f64.powi(-((n * n) as i32 % 9)))) {
                let proposed = 0.7 * 2.0_f64.powi(-((n * n) as i32 % 9));
                assert!(part.size() <= proposed * (1.0 + 1e-9));
                assert_eq!(part.at(0.0), end);
                assert!((part.at(0.5) - end - part.k / 0.7).abs() < 1e-15);
                end = part.at(1.0);
                n += 1;
                parts.pass().unwrap();
            }
            assert_eq!(end, 1.0);
        }
    }

    /// A part is not larger than the half it begins: after a quarter comes no half.
    #[test]
    fn parts_stay_in_their_half() {
        let mut parts = parts(1.0, 1, 2);
        let mut sizes = Vec::new();
        let mut proposed = 0.125;
        while let Some(part) = parts.next(Some(proposed)) {
            sizes.push(part.size());
            proposed = 1.0;
            parts.pass().unwrap();
        }
        assert_eq!(sizes, [0.125, 0.125, 0.25, 0.5]);
    }

    /// Differences of times that a loop at a fixed rate computes, far from 0: as many panels as meant, all of one size.
    #[test]
    fn rounding_of_the_time_makes_no_panels() {
        for largest in [1e-3, 1.0 / 60.0, 0.05, 0.1, 1e-5] {
            for start in [0.0, 1.0, 16_384.0, 65_536.0, 131_072.0, 1e6, -1e6, 1.7e9] {
                let first = (start / largest) as i64;
                for i in first..first + 1000 {
                    for multiple in [1, 2, 7] {
                        let at = |i: i64| i as f64 * largest;
                        let h = at(i + multiple) - at(i);
                        // a rounding of a hundredth of the panel is more than rounding
                        if 4.0 * f64::EPSILON * at(i + multiple).abs() < 0.01 * largest {
                            let expected = (multiple as u64, without_jitter(largest));
                            assert_eq!(panels(at(i), h, largest), expected, "{largest} at {start}");
                        }
                    }
                }
            }
        }
        // what is longer is longer, at any time
        for start in [0.0, 1e6, 1e12, 1e15] {
            assert_eq!(panels(start, 0.0102, 0.01).0, 2);
            assert_eq!(panels(start, 0.25, 0.01).0, 25);
        }
        assert_eq!(panels(0.0, 0.010_000_1, 0.01).0, 2);
        // shorter steps are what they are
        assert_eq!(panels(1e6, 0.004, 0.01), (1, without_jitter(0.004)));
    }

    #[test]
    fn endless_steps_are_refused() {
        let mut parts = parts(1.0, 4_000_000, 1);
        let mut count = 0;
        let error = loop {
            assert!(parts.next(None).is_some());
            match parts.pass() {
                Ok(()) => count += 1,
                Err(error) => break error,
            }
        };
        assert_eq!(count, MOST_INTERNAL_STEPS);
        let Error::Step { expected, .. } = error else {
            panic!("{error}")
        };
        assert!((expected - 0.25).abs() < 1e-6);
    }
}
