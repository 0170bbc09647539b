//! What one step led to.

/// One step, from the choice of an action to what the script says of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// The step's number, from 0.
    pub index: u64,
    /// The state in which the action was chosen.
    pub state: usize,
    /// The action.
    pub action: usize,
    /// The action was not the best known one of its state.
    pub explored: bool,
    /// The script's reward.
    pub reward: f64,
    /// The state at the end.
    pub next_state: usize,
    /// What delayed rules had built up before the step, see [`crate::learner::Transition::potential`].
    pub potential: f64,
    /// What they have built up after it, before any recovery.
    pub next_potential: f64,
    /// Whether the script asks for recovery.
    pub recover: bool,
    /// Whether the body touched something.
    pub contact: bool,
}

impl Step {
    /// Whether it ended badly: the script asks for recovery and rewards nothing.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.recover && self.reward <= 0.0
    }

    /// Whether it reached what the script wants: recovery after a reward above 0.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.recover && self.reward > 0.0
    }
}
