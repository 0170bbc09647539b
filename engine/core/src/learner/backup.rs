//! What a lesson teaches: the one update that every way of learning shares.

use super::QTable;
use super::traces::Traces;
use crate::allowed::Allowed;
use crate::saved::{Loading, Saving, Unfit};

/// One step, as a table learns from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lesson {
    /// The state in which the action was chosen.
    pub state: usize,
    /// The action.
    pub action: usize,
    /// The reward of the step.
    pub reward: f64,
    /// The state at the end of the step; after a failure, the state of the failure.
    pub next_state: usize,
    /// Whether nothing is to be expected after this step.
    pub terminal: bool,
    /// The actions that may be taken in that state.
    pub next_allowed: Allowed,
}

impl Lesson {
    /// The value of the best action that may be taken in the state at the end.
    #[must_use]
    pub(super) fn next_best(&self, table: &QTable) -> f64 {
        table.best_among(self.next_state, self.next_allowed).1
    }

    /// The TD target: reward plus the discounted value of what follows.
    #[must_use]
    pub(super) fn target(&self, discount: f64, next_value: f64) -> f64 {
        if self.terminal { self.reward } else { self.reward + discount * next_value }
    }
}

/// A way of learning.
pub(super) trait Backup: Send {
    /// Changes the table by one step.
    fn learn(&mut self, table: &mut QTable, lesson: &Lesson);
    /// Ends the memory of earlier steps, after learning what they still hold.
    fn forget(&mut self, table: &mut QTable);
    /// Writes the memory of earlier steps.
    fn save(&self, to: &mut Saving);
    /// Takes a memory that was saved, of steps over `table`.
    ///
    /// # Errors
    /// If the bytes are not those of this way of learning.
    fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit>;
}

impl Lesson {
    pub(super) fn save(&self, to: &mut Saving) {
        to.whole(self.state as u64);
        to.whole(self.action as u64);
        to.number(self.reward);
        to.whole(self.next_state as u64);
        to.whole(u64::from(self.terminal));
        to.whole(self.next_allowed.bits());
    }

    pub(super) fn load(from: &mut Loading<'_>, table: &QTable) -> Result<Self, Unfit> {
        let (state, action) = (from.index(table.states())?, from.index(table.actions())?);
        let reward = from.number()?;
        let (next_state, terminal) = (from.index(table.states())?, from.index(2)? == 1);
        let next_allowed = Allowed::of_bits(from.whole()?);
        Ok(Self { state, action, reward, next_state, terminal, next_allowed })
    }
}

/// Equation (1): every traced pair moves by `step_size * td_error * trace`.
pub(super) fn credit(table: &mut QTable, traces: &Traces, step_size: f64, td_error: f64) {
    for trace in traces.iter() {
        table.add(trace.state, trace.action, step_size * td_error * trace.weight);
    }
}
