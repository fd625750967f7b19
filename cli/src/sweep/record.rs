//! What is recorded of a run: ports, each reduced to numbers over the communication points.

use super::refuse;
use stickslip::ports::Causality;
use stickslip::{Model, Result, Simulator};

/// How the values of a port at the communication points become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reduction {
    /// The value at the end of the run.
    End,
    /// The least and the largest value.
    Min,
    Max,
    /// The mean over time, of values that are linear between communication points.
    Mean,
}

const REDUCTIONS: [(&str, Reduction); 4] = [
    ("end", Reduction::End),
    ("min", Reduction::Min),
    ("max", Reduction::Max),
    ("mean", Reduction::Mean),
];

/// One port with its reduction.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Name of the port.
    port: String,
    /// Number of its values.
    len: usize,
    reduction: Reduction,
}

impl Recorded {
    /// Reads `PORT` (its end) or `PORT:REDUCTION`.
    ///
    /// # Errors
    /// [`stickslip::Error::Unknown`] for a port that is not there, [`stickslip::Error::Scene`] for another reduction.
    fn parse(text: &str, model: &Model) -> Result<Recorded> {
        let (port, word) = text.rsplit_once(':').unwrap_or((text, "end"));
        let known = REDUCTIONS.iter().find(|(known, _)| *known == word);
        let Some((_, reduction)) = known else {
            let allowed = "PORT:end, PORT:min, PORT:max, PORT:mean";
            return Err(refuse("record", text, allowed));
        };
        let port = model.ports().find(port)?;
        Ok(Recorded {
            port: port.name.clone(),
            len: port.len(),
            reduction: *reduction,
        })
    }

    /// Names of its columns: the port, with its reduction unless that is the end, and the place of an element from 1.
    fn columns(&self) -> impl Iterator<Item = String> + '_ {
        let suffix = REDUCTIONS
            .iter()
            .find(|(_, reduction)| *reduction == self.reduction && *reduction != Reduction::End)
            .map_or(String::new(), |(word, _)| format!(":{word}"));
        (0..self.len).map(move |i| match self.len {
            1 => format!("{}{suffix}", self.port),
            _ => format!("{}[{}]{suffix}", self.port, i + 1),
        })
    }
}

/// All that is recorded of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Record(Vec<Recorded>);

impl Record {
    /// What the texts say; without any, every scalar output at the end.
    ///
    /// # Errors
    /// Those of the ports.
    pub fn new(texts: &[String], model: &Model) -> Result<Record> {
        if !texts.is_empty() {
            let all = texts.iter().map(|text| Recorded::parse(text, model));
            return all.collect::<Result<_>>().map(Record);
        }
        let scalars = model.ports().all().iter();
        let scalars = scalars.filter(|p| p.causality == Causality::Output && p.shape.is_empty());
        Ok(Record(
            scalars
                .map(|port| Recorded {
                    port: port.name.clone(),
                    len: 1,
                    reduction: Reduction::End,
                })
                .collect(),
        ))
    }

    /// Names of the columns.
    pub fn columns(&self) -> Vec<String> {
        self.0.iter().flat_map(Recorded::columns).collect()
    }

    /// Whether all of it is there on every mesh.
    pub fn is_scalar(&self) -> bool {
        self.0.iter().all(|recorded| recorded.len == 1)
    }

    /// What watches runs of a model.
    ///
    /// # Errors
    /// [`stickslip::Error::Unknown`] for a port that this model has not, [`stickslip::Error::Length`] for one of another length.
    pub fn watch(&self, model: &Model) -> Result<Watch> {
        let places = self.0.iter().map(|recorded| {
            let port = model.ports().find(&recorded.port)?;
            if port.len() != recorded.len {
                return Err(stickslip::Error::Length {
                    what: "values of a port that is recorded",
                    expected: recorded.len,
                    found: port.len(),
                });
            }
            Ok((port.reference, recorded.len, recorded.reduction))
        });
        let places = places.collect::<Result<Vec<_>>>()?;
        let len = places.iter().map(|(_, len, _)| len).sum();
        Ok(Watch {
            places,
            now: vec![0.0; len],
            before: vec![0.0; len],
            values: vec![0.0; len],
            start: 0.0,
            time: 0.0,
        })
    }
}

/// The numbers of a run so far.
pub struct Watch {
    /// Reference, length and reduction of every port.
    places: Vec<(u32, usize, Reduction)>,
    /// Values now and at the point before.
    now: Vec<f64>,
    before: Vec<f64>,
    /// What they have been reduced to; of a mean the integral over time.
    values: Vec<f64>,
    /// Time at the start and now, s.
    start: f64,
    time: f64,
}

impl Watch {
    /// A run begins.
    ///
    /// # Errors
    /// Those of [`Simulator::get`].
    pub fn begin(&mut self, simulator: &Simulator) -> Result<()> {
        self.read(simulator)?;
        self.before.copy_from_slice(&self.now);
        self.values.copy_from_slice(&self.now);
        (self.start, self.time) = (simulator.time(), simulator.time());
        let mut at = 0;
        for (_, len, reduction) in &self.places {
            if *reduction == Reduction::Mean {
                self.values[at..at + len].fill(0.0);
            }
            at += len;
        }
        Ok(())
    }

    /// A communication point is reached.
    ///
    /// # Errors
    /// Those of [`Simulator::get`].
    pub fn pass(&mut self, simulator: &Simulator) -> Result<()> {
        self.read(simulator)?;
        let step = simulator.time() - self.time;
        let mut at = 0;
        for (_, len, reduction) in &self.places {
            for i in at..at + len {
                let (now, value) = (self.now[i], &mut self.values[i]);
                match reduction {
                    Reduction::End => *value = now,
                    Reduction::Min => *value = value.min(now),
                    Reduction::Max => *value = value.max(now),
                    Reduction::Mean => *value += 0.5 * step * (now + self.before[i]),
                }
            }
            at += len;
        }
        std::mem::swap(&mut self.now, &mut self.before);
        self.time = simulator.time();
        Ok(())
    }

    /// The numbers of the run, in the order of the columns.
    pub fn finish(&self) -> Vec<f64> {
        let mut values = self.values.clone();
        let mut at = 0;
        for (_, len, reduction) in &self.places {
            if *reduction == Reduction::Mean {
                for value in &mut values[at..at + len] {
                    *value /= self.time - self.start;
                }
            }
            at += len;
        }
        values
    }

    fn read(&mut self, simulator: &Simulator) -> Result<()> {
        let mut rest = &mut self.now[..];
        for (reference, len, _) in &self.places {
            let (head, tail) = rest.split_at_mut(*len);
            simulator.get(*reference, head)?;
            rest = tail;
        }
        Ok(())
    }
}
