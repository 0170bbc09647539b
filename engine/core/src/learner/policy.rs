//! A learned table that learns no more.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::memory::{PooledRow, Pools};
use super::{QTable, Softmax};
use crate::allowed::Allowed;
use crate::random::Random;
use crate::settings::LearnerSettings;

/// The visited states of a learned table.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    actions: usize,
    /// How many states there may be.
    states: usize,
    /// By state; none where nothing was learned about the state itself.
    rows: BTreeMap<usize, PolicyRow>,
    /// At which it chooses; that of the settings if it has none of its own.
    temperature: Option<f64>,
    /// What answers for states without a row, if anything does.
    pools: Option<Arc<Pools>>,
    /// What its eyes kept when learning ended; empty if they keep nothing.
    kept: Vec<u8>,
}

/// What was learned about one state.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyRow {
    /// How often it was visited; 0 if its values come from what is known of other states.
    pub visits: u64,
    /// The value of each action.
    pub values: Vec<f64>,
}

impl Policy {
    /// A policy from its rows, by state; `None` where nothing was learned.
    #[must_use]
    pub fn new(actions: usize, rows: Vec<Option<PolicyRow>>) -> Self {
        let mut known = Self::of_states(actions, rows.len(), BTreeMap::new());
        for (state, row) in rows.into_iter().enumerate() {
            known.rows.extend(row.map(|row| (state, row)));
        }
        known
    }

    /// A policy over `states` states, with rows of some of them.
    #[must_use]
    pub const fn of_states(actions: usize, states: usize, rows: BTreeMap<usize, PolicyRow>) -> Self {
        Self { actions, states, rows, temperature: None, pools: None, kept: Vec::new() }
    }

    /// It chooses at a temperature of its own.
    #[must_use]
    pub fn at_temperature(self, temperature: f64) -> Self {
        Self { temperature: Some(temperature), ..self }
    }

    /// For states without a row these answer.
    #[must_use]
    pub fn answering(self, pools: Option<Arc<Pools>>) -> Self {
        Self { pools, ..self }
    }

    /// Its eyes go on from this.
    #[must_use]
    pub fn keeping(self, kept: Vec<u8>) -> Self {
        Self { kept, ..self }
    }

    /// What its eyes kept when learning ended; empty if they keep nothing.
    #[must_use]
    pub fn kept(&self) -> &[u8] {
        &self.kept
    }

    /// The temperature at which it chooses, if it has one of its own.
    #[must_use]
    pub const fn temperature(&self) -> Option<f64> {
        self.temperature
    }

    /// What answers for states without a row, if anything does.
    #[must_use]
    pub fn pools(&self) -> Option<&Pools> {
        self.pools.as_deref()
    }

    pub(super) fn from_table(table: &QTable) -> Self {
        let row = |(state, visits): (usize, &u64)| {
            (*visits > 0).then(|| PolicyRow { visits: *visits, values: table.row(state).to_vec() })
        };
        Self::new(table.actions(), table.visits().iter().enumerate().map(row).collect())
    }

    /// What was learned about states, in their order.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &PolicyRow)> + Clone {
        self.rows.iter().map(|(state, row)| (*state, row))
    }

    /// What was learned about a state.
    #[must_use]
    pub fn row(&self, state: usize) -> Option<&PolicyRow> {
        self.rows.get(&state)
    }

    /// How many states there may be.
    #[must_use]
    pub const fn states(&self) -> usize {
        self.states
    }

    /// How many states were visited.
    #[must_use]
    pub fn states_met(&self) -> usize {
        self.rows.values().filter(|row| row.visits > 0).count()
    }

    /// Whether a state was visited.
    #[must_use]
    pub fn is_met(&self, state: usize) -> bool {
        self.row(state).is_some_and(|row| row.visits > 0)
    }

    /// How many actions there are.
    #[must_use]
    pub const fn actions(&self) -> usize {
        self.actions
    }

    /// The best action of a state and its value, if the state was ever visited.
    #[must_use]
    pub fn best(&self, state: usize) -> Option<(usize, f64)> {
        self.row(state).map(|row| super::q_table::best_of(&row.values))
    }

    /// What each action is worth in a state, listed or answered from what is known of others; nothing in a state of which
    /// nothing is known.
    #[must_use]
    pub fn values_of(&self, state: usize) -> Option<Vec<f64>> {
        self.values(state, &mut PooledRow::default()).map(<[f64]>::to_vec)
    }

    /// The values of a state's actions, in `room` where the state has no row of its own; nothing in a state of which it knows
    /// nothing.
    fn values<'a>(&'a self, state: usize, room: &'a mut PooledRow) -> Option<&'a [f64]> {
        match (self.row(state), &self.pools) {
            (Some(row), _) => Some(&row.values),
            (_, Some(pools)) => {
                pools.answer(state, room);
                Some(&room.values)
            }
            _ => None,
        }
    }

    /// An action by softmax at the lowest temperature, and whether it is not the best one known; any action, equally likely, in
    /// a state of which nothing is known. Only actions that are allowed.
    pub(crate) fn choose(
        &self,
        state: usize,
        allowed: Allowed,
        room: &mut PolicyRoom,
        random: &mut Random,
    ) -> (usize, bool) {
        match self.values(state, &mut room.row) {
            Some(values) => {
                let action = room.softmax.choose(values, allowed, u64::MAX, random);
                (action, super::q_table::best_among(values, allowed).0 != action)
            }
            None => (any_of(self.actions, allowed, random), true),
        }
    }

    /// Room to choose in, at the policy's temperature or that of the settings.
    #[must_use]
    pub(crate) fn room(&self, settings: &LearnerSettings) -> PolicyRoom {
        let softmax = Softmax::new(settings, self.actions);
        let softmax = match self.temperature {
            Some(temperature) => softmax.at_temperature(temperature),
            None => softmax,
        };
        PolicyRoom { softmax, row: PooledRow::default() }
    }
}

/// Room for a policy to choose in, so that choosing allocates nothing.
pub(crate) struct PolicyRoom {
    softmax: Softmax,
    row: PooledRow,
}

/// One of the actions that are allowed, each as likely as the others.
pub(crate) fn any_of(actions: usize, allowed: Allowed, random: &mut Random) -> usize {
    if allowed.is_all() {
        return random.below(actions as u32) as usize;
    }
    let count = allowed.count(actions).max(1);
    allowed.nth(random.below(count as u32) as usize).unwrap_or(0)
}
