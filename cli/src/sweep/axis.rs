//! What is varied: paths of the scene, each with its values or its range.

use super::refuse;
use stickslip::Result;
use stickslip::message::cut;

/// Most values of one axis, and most runs of a plan.
pub const MOST: usize = 10_000_000;

/// A path of the scene and what it goes through.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Path, as `--set` takes it.
    pub path: String,
    pub course: Course,
}

/// What an axis goes through.
#[derive(Debug, Clone, PartialEq)]
pub enum Course {
    /// Values, each as JSON.
    Values(Vec<String>),
    /// From one number to another.
    Range(Range),
}

/// A range of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    pub from: f64,
    pub to: f64,
    /// Number of values on a grid, both ends included; `None` for a range that is sampled.
    pub count: Option<usize>,
    /// Whether values are evenly spaced in their logarithms.
    pub is_logarithmic: bool,
}

impl Range {
    /// The number at a share of the way, 0 to 1.
    pub fn at(&self, share: f64) -> f64 {
        let (a, b) = (self.from, self.to);
        match share {
            0.0 => a,
            1.0 => b,
            _ if self.is_logarithmic => a * (b / a).powf(share),
            _ => a + (b - a) * share,
        }
    }
}

impl Axis {
    /// Reads `PATH=A:B:N`, `PATH=A:B` (each with `:log` at the end or without) or `PATH=VALUE,VALUE,...`.
    ///
    /// # Errors
    /// [`stickslip::Error::Scene`] at the path.
    pub fn parse(text: &str) -> Result<Axis> {
        let allowed = "PATH=A:B:N, PATH=A:B, each with :log or without, or PATH=VALUE,VALUE,...";
        let Some((path, course)) = text.split_once('=').filter(|(path, _)| !path.is_empty()) else {
            return Err(refuse(text, "no path", allowed));
        };
        let parts: Vec<&str> = course.split(':').collect();
        let (parts, is_logarithmic) = match parts.split_last() {
            Some((&"log", rest)) if !rest.is_empty() => (rest.to_vec(), true),
            _ => (parts, false),
        };
        let course = match parts[..] {
            [values] if !is_logarithmic => Course::Values(split(values)),
            [from, to] | [from, to, _] => {
                let number = |text: &str| text.trim().parse::<f64>().ok();
                let count = parts.get(2).map(|n| n.trim().parse::<usize>().ok());
                match (number(from), number(to), count) {
                    (Some(from), Some(to), None | Some(Some(_))) => Course::Range(Range {
                        from,
                        to,
                        count: count.flatten(),
                        is_logarithmic,
                    }),
                    _ => return Err(refuse(path, &cut(course), allowed)),
                }
            }
            _ => return Err(refuse(path, &cut(course), allowed)),
        };
        Axis::new(path, course)
    }

    /// # Errors
    /// [`stickslip::Error::Scene`] at the path for a course that has no values.
    pub fn new(path: &str, course: Course) -> Result<Axis> {
        match &course {
            Course::Values(values) if values.is_empty() => {
                return Err(refuse(path, "no values", "one or more"));
            }
            Course::Values(_) => {}
            Course::Range(range) => {
                let (a, b) = (range.from, range.to);
                if !(a.is_finite() && b.is_finite()) {
                    return Err(refuse(path, &format!("{a} to {b}"), "finite numbers"));
                }
                if range.is_logarithmic && a * b <= 0.0 {
                    let allowed =
                        "two positive or two negative numbers where steps are logarithmic";
                    return Err(refuse(path, &format!("{a} to {b}"), allowed));
                }
                if range.count.is_some_and(|n| n == 0 || n > MOST) {
                    let found = format!("{} values", range.count.unwrap_or(0));
                    return Err(refuse(path, &found, &format!("1 to {MOST} values")));
                }
            }
        }
        Ok(Axis {
            path: path.to_owned(),
            course,
        })
    }

    /// The values of a grid, each as JSON.
    ///
    /// # Errors
    /// [`stickslip::Error::Scene`] for a range without a number of values.
    pub fn values(&self) -> Result<Vec<String>> {
        match &self.course {
            Course::Values(values) => Ok(values.clone()),
            Course::Range(range) => {
                let Some(count) = range.count else {
                    let allowed = "A:B:N, the number of values, for a grid";
                    return Err(refuse(&self.path, "a range", allowed));
                };
                let last = (count - 1).max(1) as f64;
                Ok((0..count)
                    .map(|i| json(range.at(i as f64 / last)))
                    .collect())
            }
        }
    }

    /// The value at a share, 0 to 1, for samples: of a range the number there, of values one of them.
    pub fn at(&self, share: f64) -> String {
        match &self.course {
            Course::Values(values) => {
                let place = (share * values.len() as f64) as usize;
                values[place.min(values.len() - 1)].clone()
            }
            Course::Range(range) => json(range.at(share)),
        }
    }
}

/// A number as JSON that reads back equal.
pub fn json(number: f64) -> String {
    format!("{number:?}")
}

/// The values of a list; a comma within brackets or quotes belongs to its value.
fn split(text: &str) -> Vec<String> {
    let (mut values, mut value) = (Vec::new(), String::new());
    let (mut depth, mut is_quoted) = (0_i32, false);
    for c in text.chars() {
        match c {
            '"' => is_quoted = !is_quoted,
            '[' | '{' if !is_quoted => depth += 1,
            ']' | '}' if !is_quoted => depth -= 1,
            ',' if !is_quoted && depth == 0 => {
                values.push(std::mem::take(&mut value).trim().to_owned());
                continue;
            }
            _ => {}
        }
        value.push(c);
    }
    values.push(value.trim().to_owned());
    values.retain(|value| !value.is_empty());
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_lists_are_read() {
        let values = |text: &str| Axis::parse(text).unwrap().values().unwrap();
        assert_eq!(values("a.b=1:2:3"), ["1.0", "1.5", "2.0"]);
        assert_eq!(values("a=-1:-100:3:log"), ["-1.0", "-10.0", "-100.0"]);
        assert_eq!(values("a=3:4:1"), ["3.0"]);
        assert_eq!(values("a=full, reduced"), ["full", "reduced"]);
        assert_eq!(values("a=[1,2],[3,4]"), ["[1,2]", "[3,4]"]);
        assert!(Axis::parse("a=1:2").unwrap().values().is_err());
        for wrong in [
            "a",
            "=1",
            "a=",
            "a=1:2:0",
            "a=1:2:x",
            "a=0:1:3:log",
            "a=1:inf:2",
            "a=1:2:3:4",
            "a=log",
        ] {
            let read = Axis::parse(wrong);
            assert!(read.is_err() || wrong == "a=log", "{wrong}: {read:?}");
        }
    }
}
