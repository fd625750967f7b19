//! Derivatives of the outputs at the end of the last step by its inputs, whatever they mean: the consistent tangent.
//!
//! Every formula of the step is differentiated where the step was solved. All of them are linear in the tangents except
//! the friction problem, whose tangents `dw` and `dLambda` are those of `contact::solve::tangent`. The last step is
//! taken once more from the state before it, so that a step without derivatives costs nothing extra; the repeated step
//! is the same bit for bit. Where a node is just about to change between stick and slip the outputs have a kink: the
//! derivative is then that of the branch on which the step ended. An input enters as its course over the step has it
//! (`input_course`): with its share of the step, with its jump at the beginning, with the slope that it is continued with.
//! Internal steps that `time.tolerance` chose are held fixed: the derivative is that of the step with these sizes, and a
//! refused pair of steps is undone in the tangents too.

use super::pressed::Level;
use super::tangent::Tangents;
use crate::contact::problem::norm;
use crate::error::{Error, Result};
use crate::linalg::dot;
use crate::model::motions::Approach;
use crate::ports::Tangent as PortTangent;
use crate::ports::readout;
use crate::scene::Start;
use crate::simulator::Simulator;
use crate::state::State;
use std::ops::Range;

impl Simulator {
    /// Derivative of all outputs (as [`Simulator::get_outputs`] orders them) at the end of the last step by its inputs (with the
    /// meaning they have: at its end or its beginning), along `seed` (one value per input): `out = (d outputs / d inputs) seed`. Counts, indicators and solver figures have
    /// the derivative 0. Costs one step and allocates.
    ///
    /// # Errors
    /// [`Error::CallOrder`] when the state is not the end of a step, [`Error::Length`], [`Error::Value`], [`Error::Overflow`].
    pub fn directional_derivative(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        check("seed of the inputs", seed, self.model().input_count())?;
        check_len("outputs", out.len(), self.output_len())?;
        let mut tangents = Tangents::new(self.model(), [seed.to_vec()]);
        self.repeat_last_step(&mut tangents)?;
        let mut column = vec![0.0; out.len()];
        for tangent in &tangents.list {
            self.tangent_outputs(&tangent.state, &mut column);
        }
        self.hand_out(&column, out)
    }

    /// The transposed derivative: `out = (d outputs / d inputs)^T seed`, `seed` one value per output, `out` one per input.
    /// Takes the tangent of every input in one repetition of the step.
    ///
    /// # Errors
    /// Those of [`Simulator::directional_derivative`].
    pub fn adjoint_derivative(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        let inputs = self.model().input_count();
        check("seed of the outputs", seed, self.output_len())?;
        check_len("inputs", out.len(), inputs)?;
        let mut tangents = Tangents::new(self.model(), unit_seeds(inputs));
        self.repeat_last_step(&mut tangents)?;
        self.weigh(&tangents, seed, out)
    }

    /// Derivative of all outputs at this instant by the loads at this instant, along `seed`: that of the velocity and the contact
    /// forces that are consistent with them at fixed displacement. Displacements, slips and energies have the derivative 0,
    /// and so has everything where `time.start` is `zero`. Needs no step; costs one solution of the friction problem's tangent
    /// and allocates.
    ///
    /// # Errors
    /// [`Error::CallOrder`] before initialization, [`Error::Length`], [`Error::Value`].
    pub fn instant_derivative(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        check("seed of the inputs", seed, self.model().input_count())?;
        check_len("outputs", out.len(), self.output_len())?;
        let tangents = self.instant_tangents([seed.to_vec()])?;
        let mut column = vec![0.0; out.len()];
        for tangent in &tangents.list {
            self.tangent_outputs(&tangent.state, &mut column);
        }
        self.hand_out(&column, out)
    }

    /// The transposed derivative of [`Simulator::instant_derivative`]: `out = (d outputs / d loads)^T seed`.
    ///
    /// # Errors
    /// Those of [`Simulator::instant_derivative`].
    pub fn instant_adjoint(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        let inputs = self.model().input_count();
        check("seed of the outputs", seed, self.output_len())?;
        check_len("inputs", out.len(), inputs)?;
        let tangents = self.instant_tangents(unit_seeds(inputs))?;
        self.weigh(&tangents, seed, out)
    }

    fn instant_tangents(&mut self, seeds: impl IntoIterator<Item = Vec<f64>>) -> Result<Tangents> {
        let mut tangents = Tangents::new(self.model(), seeds);
        self.solve_here("instant_derivative", |model, state, ws| {
            if model.start() == Start::Zero {
                return Ok(());
            }
            let approach = model.motions().approach(&state.loads);
            for t in &mut tangents.list {
                let approach = model.motions().approach(&t.load);
                t.level = Level::Velocity {
                    approach,
                    velocity: Approach::NONE,
                };
            }
            tangents.settle(model, state, ws, approach)?;
            for t in &mut tangents.list {
                t.velocities[0].store_into(&mut t.state);
            }
            Ok(())
        })?;
        Ok(tangents)
    }

    /// Sums of the outputs' tangents, weighed by `seed`: one per tangent, if all of them are finite.
    fn weigh(&self, tangents: &Tangents, seed: &[f64], out: &mut [f64]) -> Result<()> {
        let mut column = vec![0.0; seed.len()];
        let mut row = vec![0.0; out.len()];
        for (entry, tangent) in row.iter_mut().zip(&tangents.list) {
            self.tangent_outputs(&tangent.state, &mut column);
            *entry = dot(seed, &column);
        }
        self.hand_out(&row, out)
    }

    /// Writes a derivative, if all of it is finite.
    fn hand_out(&self, derivative: &[f64], out: &mut [f64]) -> Result<()> {
        if derivative.iter().any(|v| !v.is_finite()) {
            return Err(Error::Overflow {
                what: "a derivative".into(),
                time: self.time(),
            });
        }
        out.copy_from_slice(derivative);
        Ok(())
    }

    fn tangent_outputs(&self, tangent: &State, out: &mut [f64]) {
        let mut rest = out;
        for port in self.model().ports().outputs() {
            let (head, tail) = rest.split_at_mut(port.len());
            rest = tail;
            match port.quantity.tangent() {
                PortTangent::Linear => readout::read(self.model(), tangent, port, head),
                PortTangent::Gap => {
                    readout::read(self.model(), tangent, port, head);
                    let gaps = &self.model().contact().gaps[port.nodes(self.model().contact())];
                    head.iter_mut().zip(gaps).for_each(|(d, gap)| *d -= gap);
                }
                PortTangent::Balance => {
                    readout::read(self.model(), tangent, port, head);
                    if let Some(initial) = self.model().initial() {
                        head[0] -= initial.energy;
                    }
                }
                PortTangent::Zero => head.fill(0.0),
                PortTangent::LargestRate => {
                    let nodes = port.nodes(self.model().contact());
                    head[0] = self.tangent_of_largest_rate(tangent, nodes);
                }
            }
        }
    }

    /// That of the largest slip rate of some of the contact nodes.
    fn tangent_of_largest_rate(&self, tangent: &State, nodes: Range<usize>) -> f64 {
        let c = self.model().contact().components;
        let own = nodes.start * c..nodes.end * c;
        let rates = self.state().main.instant.slip_rate[own.clone()].chunks_exact(c);
        let mut largest = (0.0, 0.0);
        for (w, dw) in rates.zip(tangent.main.instant.slip_rate[own].chunks_exact(c)) {
            let rate = norm(w);
            if rate > largest.0 {
                largest = (rate, dot(w, dw) / rate);
            }
        }
        largest.1
    }
}

fn unit_seeds(inputs: usize) -> impl Iterator<Item = Vec<f64>> {
    (0..inputs).map(move |i| (0..inputs).map(|j| f64::from(u8::from(i == j))).collect())
}

fn check_len(what: &'static str, found: usize, expected: usize) -> Result<()> {
    if found == expected {
        Ok(())
    } else {
        Err(Error::Length {
            what,
            expected,
            found,
        })
    }
}

fn check(what: &'static str, seed: &[f64], expected: usize) -> Result<()> {
    check_len(what, seed.len(), expected)?;
    match seed.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(&found) => Err(Error::Value {
            what: what.into(),
            found,
            allowed: "finite numbers",
        }),
    }
}
