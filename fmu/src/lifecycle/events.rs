//! Events of FMI 3, for importers that ask for event mode: the contact as a whole changes. It begins or ceases to slip, to stick, to be
//! open or to be closed, at some node or at all of them. One event per change of these, never one per node.
//!
//! The instant is located by bisection: the step is taken anew from its beginning, shorter, until the interval in which the change
//! lies is a rounding of the step. The step then ends right after the change, if the importer allows it to return early.
//! Nothing of this runs without event mode.

use super::{Call, Instance, Phase, parameters};
use crate::fault::{Fault, Outcome};
use crate::log::Category;
use stickslip::scene::Inputs;
use stickslip::{Simulator, State};

/// Interval in which an event is located, by the length of the step.
const RESOLUTION: f64 = 1e-12;
/// The same in roundings of the time.
const ROUNDINGS: f64 = 16.0;

/// Fractions of nodes whose being none or all of them is watched, by the end of their ports' names, and what a node of them does.
const WATCHED: [(&str, &str); 2] = [(".stick_fraction", "sticks"), (".open_fraction", "is open")];

/// How many nodes of a contact do something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Share {
    None,
    Some,
    All,
}

impl Share {
    fn of(fraction: f64) -> Share {
        match fraction {
            f if f <= 0.0 => Share::None,
            f if f >= 1.0 => Share::All,
            _ => Share::Some,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Share::None => "no node",
            Share::Some => "a part of the nodes",
            Share::All => "every node",
        }
    }
}

/// A watched fraction.
struct Watched {
    port: u32,
    /// `contact: ... sticks`, around the share.
    words: (String, &'static str),
    before: Share,
}

/// What an instance in event mode keeps.
pub struct Events {
    returns_early: bool,
    watched: Vec<Watched>,
    /// The beginning of the step.
    start: State,
}

/// How a step ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StepEnd {
    pub has_event: bool,
    pub is_early: bool,
}

impl Events {
    fn new(simulator: &Simulator, returns_early: bool) -> Events {
        let ports = simulator.model().ports().all().iter();
        let watched = ports.flat_map(|port| {
            WATCHED.iter().filter_map(|(end, does)| {
                let contact = port.name.strip_suffix(end)?;
                Some(Watched {
                    port: port.reference,
                    words: (format!("{contact}: "), *does),
                    before: Share::None,
                })
            })
        });
        Events {
            returns_early,
            watched: watched.collect(),
            start: simulator.new_state(),
        }
    }

    /// Takes the shares at the beginning of a step, and its state.
    fn begin(&mut self, simulator: &Simulator) -> Outcome {
        for watched in &mut self.watched {
            watched.before = watched.share(simulator)?;
        }
        if simulator.save(&mut self.start).is_err() {
            // the model is another one: compiled with parameters, or restored
            self.start = simulator.state().clone();
        }
        Ok(())
    }

    fn has_changed(&self, simulator: &Simulator) -> Outcome<bool> {
        for watched in &self.watched {
            if watched.share(simulator)? != watched.before {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// What has changed, in words.
    fn changes(&self, simulator: &Simulator) -> Outcome<String> {
        let mut changes = Vec::new();
        for watched in &self.watched {
            let share = watched.share(simulator)?;
            if share != watched.before {
                let (contact, does) = &watched.words;
                changes.push(format!("{contact}{} {does}", share.name()));
            }
        }
        Ok(changes.join("; "))
    }
}

impl Watched {
    fn share(&self, simulator: &Simulator) -> Outcome<Share> {
        let mut fraction = [0.0];
        simulator.get(self.port, &mut fraction)?;
        Ok(Share::of(fraction[0]))
    }
}

impl Instance {
    /// Offers events from now on: right after instantiation.
    pub fn use_events(&mut self, returns_early: bool) -> Outcome {
        self.events = Some(Events::new(&self.simulator, returns_early));
        Ok(())
    }

    /// Where initialization leads.
    pub(super) fn phase_after_initialization(&self) -> Phase {
        match self.events {
            Some(_) => Phase::Event,
            None => Phase::Stepping,
        }
    }

    /// A step that may end early, at an event.
    pub fn do_step_to_event(&mut self, time: f64, step: f64) -> Outcome<StepEnd> {
        let Some(mut events) = self.events.take() else {
            self.do_step(time, step)?;
            return Ok(StepEnd::default());
        };
        let end = self.step_to_event(time, step, &mut events);
        self.events = Some(events);
        end
    }

    fn step_to_event(&mut self, time: f64, step: f64, events: &mut Events) -> Outcome<StepEnd> {
        self.permit(Call::DoStep)?;
        events.begin(&self.simulator)?;
        self.do_step(time, step)?;
        if !events.has_changed(&self.simulator)? {
            return Ok(StepEnd::default());
        }
        // inputs at the end of a step have no course until the step is known
        let has_course = parameters::inputs_meaning(&self.parameters) != Inputs::EndOfStep;
        let mut length = step;
        if events.returns_early && has_course {
            length = self.locate(time, step, events)?;
        }
        if self.log.is_on(Category::Event) {
            let changes = events.changes(&self.simulator)?;
            let message = format!("event at time {}: {changes}", self.simulator.time());
            self.log.write(0, Category::Event, &message);
        }
        Ok(StepEnd {
            has_event: true,
            is_early: length < step,
        })
    }

    /// Ends the step right after the change; its length then.
    fn locate(&mut self, time: f64, step: f64, events: &Events) -> Outcome<f64> {
        let resolution = (RESOLUTION * step).max(ROUNDINGS * f64::EPSILON * time.abs());
        let (mut low, mut high) = (0.0, step);
        let mut reached = step;
        while high - low > resolution {
            let middle = low + (high - low) / 2.0;
            self.simulator.restore(&events.start)?;
            // where a shorter step has no solution, the change is looked for after it
            reached = match self.simulator.do_step(time, middle) {
                Ok(()) => middle,
                Err(_) => f64::NAN,
            };
            if reached == middle && events.has_changed(&self.simulator)? {
                high = middle;
            } else {
                low = middle;
            }
        }
        if reached != high {
            self.simulator.restore(&events.start)?;
            self.simulator.do_step(time, high)?;
        }
        self.are_values_fresh = false;
        Ok(high)
    }

    fn has_events(&self, name: &str) -> Outcome {
        match self.events {
            Some(_) => Ok(()),
            None => Err(Fault::error(format!(
                "{name}: event mode was not asked for when the instance was made"
            ))),
        }
    }

    pub fn enter_event_mode(&mut self) -> Outcome {
        self.has_events("fmi3EnterEventMode")?;
        self.permit(Call::EnterEventMode)?;
        self.phase = Phase::Event;
        Ok(())
    }

    /// There is nothing discrete to update: what has changed has changed in the step.
    pub fn update_discrete_states(&mut self) -> Outcome {
        self.has_events("fmi3UpdateDiscreteStates")?;
        self.permit(Call::UpdateDiscreteStates)
    }

    pub fn enter_step_mode(&mut self) -> Outcome {
        self.has_events("fmi3EnterStepMode")?;
        self.permit(Call::EnterStepMode)?;
        self.phase = Phase::Stepping;
        Ok(())
    }
}
