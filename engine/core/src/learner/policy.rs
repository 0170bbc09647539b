//! A learned table that learns no more.

use super::{QTable, Softmax};
use crate::random::Random;
use crate::settings::LearnerSettings;

/// The visited states of a learned table.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    actions: usize,
    /// By state; `None` where the state was never visited.
    rows: Vec<Option<PolicyRow>>,
}

/// What was learned about one state.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyRow {
    /// How often it was visited.
    pub visits: u64,
    /// The value of each action.
    pub values: Vec<f64>,
}

impl Policy {
    /// A policy from its rows, by state.
    #[must_use]
    pub fn new(actions: usize, rows: Vec<Option<PolicyRow>>) -> Self {
        Self { actions, rows }
    }

    pub(super) fn from_table(table: &QTable) -> Self {
        let row = |(state, visits): (usize, &u64)| {
            (*visits > 0).then(|| PolicyRow { visits: *visits, values: table.row(state).to_vec() })
        };
        Self::new(table.actions(), table.visits().iter().enumerate().map(row).collect())
    }

    /// What was learned about each state.
    #[must_use]
    pub fn rows(&self) -> &[Option<PolicyRow>] {
        &self.rows
    }

    /// How many states it knows.
    #[must_use]
    pub fn states_met(&self) -> usize {
        self.rows.iter().flatten().count()
    }

    /// How many actions there are.
    #[must_use]
    pub const fn actions(&self) -> usize {
        self.actions
    }

    /// The best action of a state and its value, if the state was ever visited.
    #[must_use]
    pub fn best(&self, state: usize) -> Option<(usize, f64)> {
        self.rows.get(state)?.as_ref().map(|row| super::q_table::best_of(&row.values))
    }

    /// An action by softmax at the lowest temperature; any action, equally likely, in a state never visited.
    pub(crate) fn choose(&self, state: usize, softmax: &mut Softmax, random: &mut Random) -> usize {
        match self.rows.get(state) {
            Some(Some(row)) => softmax.choose(&row.values, u64::MAX, random),
            _ => random.below(self.actions as u32) as usize,
        }
    }

    /// The softmax that fits this policy.
    #[must_use]
    pub(crate) fn softmax(&self, settings: &LearnerSettings) -> Softmax {
        Softmax::new(settings, self.actions)
    }
}
