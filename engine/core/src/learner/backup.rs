//! What a transition teaches: the one update that every way of learning shares.

use super::QTable;
use super::traces::Traces;

/// One step, as the learner sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
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
}

impl Transition {
    /// The TD target: reward plus the discounted value of what follows.
    #[must_use]
    pub fn target(&self, discount: f64, next_value: f64) -> f64 {
        if self.terminal { self.reward } else { self.reward + discount * next_value }
    }
}

/// A way of learning.
pub trait Backup: Send {
    /// Changes the table by one step.
    fn learn(&mut self, table: &mut QTable, transition: &Transition);
    /// Ends the memory of earlier steps, after learning what they still hold.
    fn forget(&mut self, table: &mut QTable);
}

/// Equation (1): every traced pair moves by `step_size * td_error * trace`.
pub(super) fn credit(table: &mut QTable, traces: &Traces, step_size: f64, td_error: f64) {
    for trace in traces.iter() {
        table.add(trace.state, trace.action, step_size * td_error * trace.weight);
    }
}
