//! What may go along with a step: nothing in a run, the tangents when a step is repeated for its derivatives.

use super::memory::Span;
use super::pressed::Level;
use super::scheme::Stage;
use super::workspace::Workspace;
use crate::error::Result;
use crate::model::Model;
use crate::state::State;

/// What goes along with a step and may look at it, but not change it: nothing, or its tangents.
pub(crate) trait Companion {
    /// The communication step begins; jumps at its beginning have been made.
    fn start(&mut self, model: &Model, state: &State, ws: &mut Workspace) -> Result<()>;
    /// A part of the communication step begins that may be refused: what [`Companion::go_back`] returns to.
    fn keep(&mut self);
    /// The part was refused.
    fn go_back(&mut self);
    /// An internal step begins, at this fraction of the communication step.
    fn begin(&mut self, fraction: f64);
    /// A stage has been solved; its place and its fraction of the communication step.
    fn stage(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        place: StagePlace,
    ) -> Result<()>;
    /// The internal step of size `k` is complete.
    fn end(&mut self, model: &Model, state: &State, ws: &Workspace, k: f64);
    /// What holds at its end has been solved for, where no stage has it; at this fraction of the communication step.
    fn settle_end(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        fraction: f64,
    ) -> Result<()>;
}

/// Which stage of an internal step.
pub(crate) struct StagePlace<'a> {
    pub stage: &'a Stage,
    /// Place in `Workspace::velocities`.
    pub index: usize,
    /// Fraction of the communication step.
    pub fraction: f64,
    /// That of the end of the internal step.
    pub end: f64,
    /// What the gap was a condition on.
    pub level: Level,
    /// How long the memory of the friction law was moved.
    pub span: Span,
}

/// A step without a companion.
pub(crate) struct Alone;

impl Companion for Alone {
    fn start(&mut self, _: &Model, _: &State, _: &mut Workspace) -> Result<()> {
        Ok(())
    }
    fn keep(&mut self) {}
    fn go_back(&mut self) {}
    fn begin(&mut self, _: f64) {}
    fn stage(
        &mut self,
        _: &Model,
        _: &State,
        _: &mut Workspace,
        _: f64,
        _: StagePlace,
    ) -> Result<()> {
        Ok(())
    }
    fn end(&mut self, _: &Model, _: &State, _: &Workspace, _: f64) {}
    fn settle_end(
        &mut self,
        _: &Model,
        _: &State,
        _: &mut Workspace,
        _: f64,
        _: f64,
    ) -> Result<()> {
        Ok(())
    }
}
