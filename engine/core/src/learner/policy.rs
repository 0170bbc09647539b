//! A learned table that learns no more.

use super::{QTable, Softmax};
use crate::allowed::Allowed;
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

    /// The best of some actions of a state and its value, if the state was ever visited.
    pub(crate) fn best_among(&self, state: usize, allowed: Allowed) -> Option<(usize, f64)> {
        self.rows.get(state)?.as_ref().map(|row| super::q_table::best_among(&row.values, allowed))
    }

    /// An action by softmax at the lowest temperature; any action, equally likely, in a state never visited. Only actions that are allowed.
    pub(crate) fn choose(&self, state: usize, allowed: Allowed, softmax: &mut Softmax, random: &mut Random) -> usize {
        match self.rows.get(state) {
            Some(Some(row)) => softmax.choose(&row.values, allowed, u64::MAX, random),
            _ => any_of(self.actions, allowed, random),
        }
    }

    /// The softmax that fits this policy.
    #[must_use]
    pub(crate) fn softmax(&self, settings: &LearnerSettings) -> Softmax {
        Softmax::new(settings, self.actions)
    }
}

/// One of the actions that are allowed, each as likely as the others.
pub(crate) fn any_of(actions: usize, allowed: Allowed, random: &mut Random) -> usize {
    if allowed.is_all() {
        return random.below(actions as u32) as usize;
    }
    let count = allowed.count(actions).max(1);
    allowed.nth(random.below(count as u32) as usize).unwrap_or(0)
}
