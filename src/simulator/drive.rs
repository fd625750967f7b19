//! The loop over a scene's own run: a simulator is started, and stepped from communication point to communication point on the
//! signals of the scene.
//!
//! Within a step signals are followed as they are, bends at points of their tables included.
//!
//! The step that ends where a signal jumps ends with the load before the jump; then the load jumps, and the next step begins
//! with the load after it.

use super::Simulator;
use super::course::Points;
use crate::error::{Error, Result};
use crate::scene::{Inputs, Scene, Signal};

/// A simulator on its way through the run of a scene.
///
/// ```
/// use stickslip::simulator::drive::Drive;
/// use stickslip::{Scene, Simulator, compile};
///
/// let scene = Scene::from_json(stickslip::scene::example("kazmi2014").unwrap(), "kazmi2014")?;
/// let mut simulator = Simulator::new(compile(&scene)?);
/// let mut drive = Drive::start(&scene, &mut simulator)?;
/// let mut fastest = 0.0_f64;
/// while let Some(simulator) = drive.step()? {
///     fastest = fastest.max(simulator.get_by_name("contact.max_slip_rate")?[0]);
/// }
/// assert!(fastest > 0.05);
/// # Ok::<(), stickslip::Error>(())
/// ```
pub struct Drive<'a> {
    scene: &'a Scene,
    points: Points,
    simulator: &'a mut Simulator,
    /// Communication points passed, the start apart.
    passed: u64,
    values: Vec<f64>,
}

impl<'a> Drive<'a> {
    /// Initializes the simulator, which has just been made or reset, at the first communication point.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a run of too many steps, see [`Points::checked`]; those of [`Simulator::init`].
    pub fn start(scene: &'a Scene, simulator: &'a mut Simulator) -> Result<Drive<'a>> {
        let points = Points::checked(scene)?;
        let start = points.at(0);
        let mut drive = Drive {
            values: vec![0.0; scene.inputs().count()],
            scene,
            points,
            simulator,
            passed: 0,
        };
        drive.simulator.reserve_bends(points_of(scene));
        drive.set_inputs_at(start)?;
        drive.simulator.init(start)?;
        Ok(drive)
    }

    /// Goes on with a simulator that has been restored to a state of such a run. Where a signal jumps at the time of the state the loads
    /// are those behind the jump, also when the state is the end of a run that went no further.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] as for [`Drive::start`]; [`crate::Error::CallOrder`] before initialization; those of
    /// [`Simulator::jump_inputs`].
    pub fn resume(scene: &'a Scene, simulator: &'a mut Simulator) -> Result<Drive<'a>> {
        let points = Points::checked(scene)?;
        if simulator.state().is_initialized == 0 {
            return Err(Error::CallOrder {
                call: "resume",
                expected: "init, or a restored state",
            });
        }
        simulator.reserve_bends(points_of(scene));
        let time = simulator.time();
        let mut drive = Drive {
            values: vec![0.0; scene.inputs().count()],
            passed: points.passed_at(time),
            scene,
            points,
            simulator,
        };
        if let Some([_, last]) = drive.points.jump_at(time)
            && drive.simulator.inputs_meaning() == Inputs::EndOfStep
            && drive.passed < drive.points.count
        {
            drive.evaluate(|signal| signal.at(last));
            drive.simulator.jump_inputs(&drive.values)?;
        }
        Ok(drive)
    }

    /// The communication points.
    pub fn points(&self) -> &Points {
        &self.points
    }

    /// Number of the last communication point passed; the start is number 0.
    pub fn passed(&self) -> u64 {
        self.passed
    }

    /// The simulator where it stands now.
    pub fn simulator(&self) -> &Simulator {
        self.simulator
    }

    /// Takes the next step, to a communication point or to a jump of a signal on the way there, and shows the simulator; `None`
    /// at the end of the run. Where a signal jumps the outputs are those before the jump.
    ///
    /// # Errors
    /// Those of [`Simulator::do_step`]; the simulator then stands where it stood.
    pub fn step(&mut self) -> Result<Option<&Simulator>> {
        if self.passed == self.points.count {
            return Ok(None);
        }
        let from = self.simulator.time();
        let (to, is_point) = self.points.stop_after(from, self.passed + 1);
        if self.simulator.inputs_meaning() == Inputs::EndOfStep {
            let jump = self.points.jump_at(to).filter(|_| to < self.points.until);
            let end = jump.map_or(to, |[first, _]| first);
            self.set_inputs(|signal| signal.before(end))?;
            self.bend_inputs(from, end);
            self.simulator.do_step(from, to - from)?;
            if let Some([_, last]) = jump {
                self.evaluate(|signal| signal.at(last));
                self.simulator.jump_inputs(&self.values)?;
            }
        } else {
            // the loads are those at the beginning, behind a jump there
            self.set_inputs_at(from)?;
            self.simulator.do_step(from, to - from)?;
        }
        self.passed += u64::from(is_point);
        Ok(Some(self.simulator))
    }

    /// Takes one step to the next communication point as a master does that knows nothing of jumps: the inputs are set once, for
    /// the end of the step or its beginning as the simulator understands them. `None` at the end of the run.
    ///
    /// # Errors
    /// Those of [`Simulator::do_step`].
    pub fn step_as_master(&mut self) -> Result<Option<&Simulator>> {
        if self.passed == self.points.count {
            return Ok(None);
        }
        let from = self.points.at(self.passed);
        let to = self.points.at(self.passed + 1);
        self.set_inputs_at(match self.simulator.inputs_meaning() {
            Inputs::EndOfStep => to,
            Inputs::Hold | Inputs::Continue => from,
        })?;
        self.simulator.do_step(from, to - from)?;
        self.passed += 1;
        Ok(Some(self.simulator))
    }

    /// Inputs of the scene at a time, behind a jump there, in the order of the inputs.
    pub fn loads_at(&mut self, time: f64) -> &[f64] {
        self.evaluate(|signal| signal.at(time));
        &self.values
    }

    /// Signals bend at the points of their tables, also within a step.
    fn bend_inputs(&mut self, from: f64, to: f64) {
        for (input, (name, _)) in self.scene.inputs().enumerate() {
            let Some(Signal::Table(points)) = self.scene.run.signals.get(name) else {
                continue;
            };
            let first = points.partition_point(|point| point[0] <= from);
            for [time, value] in points[first..].iter().take_while(|point| point[0] < to) {
                let fraction = (time - from) / (to - from);
                if fraction > 0.0 && fraction < 1.0 {
                    self.simulator.bend_input(input, fraction, *value);
                }
            }
        }
    }

    fn set_inputs_at(&mut self, time: f64) -> Result<()> {
        self.set_inputs(|signal| signal.at(time))
    }

    fn set_inputs(&mut self, value: impl Fn(&Signal) -> f64) -> Result<()> {
        self.evaluate(value);
        self.simulator.set_inputs(&self.values)
    }

    fn evaluate(&mut self, value: impl Fn(&Signal) -> f64) {
        let signals = &self.scene.run.signals;
        for (to, (name, start)) in self.values.iter_mut().zip(self.scene.inputs()) {
            *to = signals.get(name).map_or(start, &value);
        }
    }
}

/// Points of all tables.
fn points_of(scene: &Scene) -> usize {
    let tables = scene.run.signals.values().map(|signal| match signal {
        Signal::Constant(_) => 0,
        Signal::Table(points) => points.len(),
    });
    tables.sum()
}
