//! Windows of learning, as far as their figures can be asked for.

use crate::outcome::Endings;

/// Steps in a window: each point of the paper's Figure 3 is the reinforcement of the last 400 steps.
pub const WINDOW_STEPS: u64 = 400;

/// One window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// Steps that it holds; fewer than 400 only in the last window of a run.
    pub steps: u64,
    /// Sum of the rewards.
    pub reinforcement: f64,
    /// Attempts that ended in it.
    pub endings: Endings,
    /// Steps in which the body touched something.
    pub contacts: u64,
    /// Changes of the stage that rules made.
    pub stages: u64,
    /// Of these, changes to the first stage.
    pub rounds: u64,
    /// Steps in whose choice a guard took an action away.
    pub guarded: u64,
}

/// A window with how often each rule fired in it.
#[derive(Debug, Clone, Copy)]
pub struct WindowCounts<'a> {
    /// The window.
    pub window: Window,
    /// By rule.
    pub fired: &'a [u32],
}

impl WindowCounts<'_> {
    pub(super) fn per_1000(&self, count: u64) -> f64 {
        count as f64 * 1000.0 / self.window.steps.max(1) as f64
    }

    pub(super) fn goal_rate(&self) -> f64 {
        self.window.endings.goal_rate()
    }
}
