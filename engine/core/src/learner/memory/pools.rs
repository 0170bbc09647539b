//! What is known of the sub-tuples of states: it answers for states that were hardly met, and for those that never were.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::subtuples::Levels;
use super::{FIRST_WEIGHT, LEVEL_WEIGHT};
use crate::saved::{Loading, Saving, Unfit};
use crate::state::Digit;

/// In the place of an entry: no state with this sub-tuple was met.
const ABSENT: u32 = u32::MAX;

/// Sums of returns by sub-tuple and action, spread over similar actions.
#[derive(Debug, Clone, PartialEq)]
pub struct Pools {
    actions: usize,
    digits: Vec<Digit>,
    levels: Levels,
    /// By sub-tuple, and by the number of its digits: where its sums stand.
    entries: Vec<BTreeMap<u64, u32>>,
    /// By entry: whether it is of the lowest level.
    lowest: Vec<bool>,
    sums: Vec<f64>,
    tries: Vec<f64>,
    /// Of entries of the lowest level: their values, as of the last settling.
    values: Vec<f64>,
    /// What stands behind the lowest level.
    first_value: f64,
    /// What one try of today weighs, inverted.
    scale: f64,
}

/// Pools as a file holds them: one try of the latest step weighs 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PooledSums {
    /// Of each digit of a state, the lowest first: its part, its column there, how many values it has.
    pub digits: Vec<[usize; 3]>,
    /// What is expected where nothing is known.
    pub first_value: f64,
    /// The sub-tuples, the lowest level first.
    pub tuple: Vec<TupleSums>,
}

/// What is known of one sub-tuple.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TupleSums {
    /// The numbers of its digits that were met.
    pub keys: Vec<u64>,
    /// By key, then by action: the weighted sum of returns.
    pub sums: Vec<f64>,
    /// By key, then by action: the sum of the weights.
    pub tries: Vec<f64>,
}

/// Room to answer in, so that answering allocates nothing.
#[derive(Debug, Clone, Default)]
pub(in crate::learner) struct PooledRow {
    members: Vec<u32>,
    pub(in crate::learner) values: Vec<f64>,
}

impl Pools {
    /// Knows nothing yet, of states with these digits.
    #[must_use]
    pub(super) fn new(digits: Vec<Digit>, actions: usize) -> Self {
        let levels = Levels::new(&digits);
        let entries = vec![BTreeMap::new(); levels.tuples.len()];
        let (lowest, sums, tries, values) = Default::default();
        Self { actions, digits, levels, entries, lowest, sums, tries, values, first_value: 0.0, scale: 1.0 }
    }

    pub(super) fn levels(&self) -> &Levels {
        &self.levels
    }

    pub(super) fn first_value(&self) -> f64 {
        self.first_value
    }

    /// Whether a state's own tries stand on sub-tuples at all.
    pub(super) fn has_levels(&self) -> bool {
        !self.levels.tuples.is_empty()
    }

    /// Finds the entries of a state's sub-tuples, and makes those that are missing.
    pub(super) fn meet(&mut self, state: usize, members: &mut Vec<u32>) {
        for (at, tuple) in self.levels.tuples.iter().enumerate() {
            let next = self.lowest.len() as u32;
            let entry = *self.entries[at].entry(tuple.key(state)).or_insert(next);
            members.push(entry);
            if entry == next {
                self.lowest.push(at < self.levels.ends[0]);
                let room = self.lowest.len() * self.actions;
                self.sums.resize(room, 0.0);
                self.tries.resize(room, 0.0);
                self.values.resize(room, self.first_value);
            }
        }
    }

    /// Adds the change of a state's sums to all of its sub-tuples.
    pub(super) fn add(&mut self, members: &[u32], action: usize, sum: f64, tries: f64) {
        for entry in members {
            let at = *entry as usize * self.actions + action;
            self.sums[at] += sum;
            self.tries[at] += tries;
        }
    }

    /// Forgets all sums.
    pub(super) fn clear(&mut self) {
        self.sums.fill(0.0);
        self.tries.fill(0.0);
        self.values.fill(self.first_value);
    }

    /// Values the lowest level, with this behind it; `scale` is the inverse of what one try of today weighs.
    pub(super) fn settle(&mut self, first_value: f64, scale: f64) {
        (self.first_value, self.scale) = (first_value, scale);
        for entry in (0..self.lowest.len()).filter(|entry| self.lowest[*entry]) {
            for at in entry * self.actions..(entry + 1) * self.actions {
                self.values[at] =
                    (self.sums[at] * scale + FIRST_WEIGHT * first_value) / (self.tries[at] * scale + FIRST_WEIGHT);
            }
        }
    }

    /// The value of one action by the sub-tuples of a level, each with what the level below says behind it.
    pub(super) fn level_value(&self, level: usize, members: &[u32], action: usize, below: f64) -> f64 {
        let each = members.iter().map(|entry| self.entry_value(level, *entry, action, below));
        each.sum::<f64>() / members.len() as f64
    }

    fn entry_value(&self, level: usize, entry: u32, action: usize, below: f64) -> f64 {
        if entry == ABSENT {
            return below;
        }
        let at = entry as usize * self.actions + action;
        if level == 0 {
            return self.values[at];
        }
        (self.sums[at] * self.scale + LEVEL_WEIGHT * below) / (self.tries[at] * self.scale + LEVEL_WEIGHT)
    }

    /// What one sub-tuple knows of an action: weighted tries, the sum of their returns, and its value with `below` behind it.
    pub(super) fn known(&self, level: usize, entry: u32, action: usize, below: f64) -> [f64; 3] {
        let at = entry as usize * self.actions + action;
        let of = |all: &[f64]| if entry == ABSENT { 0.0 } else { all[at] * self.scale };
        [of(&self.tries), of(&self.sums), self.entry_value(level, entry, action, below)]
    }

    /// What all levels say of each action in a state with these entries.
    pub(super) fn row(&self, members: &[u32], values: &mut [f64]) {
        values.fill(self.first_value);
        for (level, range) in self.levels.ranges().enumerate() {
            for (action, value) in values.iter_mut().enumerate() {
                *value = self.level_value(level, &members[range.clone()], action, *value);
            }
        }
    }

    /// The entries of a state's sub-tuples, met or not.
    pub(super) fn members(&self, state: usize, members: &mut Vec<u32>) {
        members.clear();
        let found = |(entries, tuple): (&BTreeMap<u64, u32>, &super::subtuples::SubTuple)| {
            entries.get(&tuple.key(state)).copied().unwrap_or(ABSENT)
        };
        members.extend(self.entries.iter().zip(&self.levels.tuples).map(found));
    }

    /// What is expected of each action in a state that was never met.
    pub(in crate::learner) fn answer(&self, state: usize, room: &mut PooledRow) {
        self.members(state, &mut room.members);
        room.values.resize(self.actions, 0.0);
        self.row(&room.members, &mut room.values);
    }

    /// These pools as they learn no more: one try of today weighs 1.
    pub(super) fn frozen(&self) -> Option<Self> {
        Self::from_sums(&self.to_sums(), self.actions)
    }

    /// Writes what goes on; which entries there are follows from the states that were met.
    pub(super) fn write(&self, to: &mut Saving) {
        [&self.sums, &self.tries, &self.values].into_iter().for_each(|numbers| to.numbers(numbers));
        to.number(self.first_value);
        to.number(self.scale);
    }

    /// Takes what was written.
    pub(super) fn read(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit> {
        let Self { sums, tries, values, .. } = self;
        [sums, tries, values].into_iter().try_for_each(|numbers| from.numbers(numbers))?;
        self.first_value = from.number()?;
        self.scale = from.number()?;
        Ok(())
    }

    /// Of states with the same digits: pools that know nothing.
    pub(super) fn emptied(&self) -> Self {
        Self::new(self.digits.clone(), self.actions)
    }

    /// What they hold, for a file.
    #[must_use]
    pub fn to_sums(&self) -> PooledSums {
        let tuple = |entries: &BTreeMap<u64, u32>| {
            let all = |of: &[f64]| {
                let rows = entries.values().map(|entry| *entry as usize * self.actions);
                rows.flat_map(|from| &of[from..from + self.actions]).map(|sum| sum * self.scale).collect()
            };
            TupleSums { keys: entries.keys().copied().collect(), sums: all(&self.sums), tries: all(&self.tries) }
        };
        PooledSums {
            digits: self.digits.iter().map(|digit| [digit.part, digit.column, digit.values]).collect(),
            first_value: self.first_value,
            tuple: self.entries.iter().map(tuple).collect(),
        }
    }

    /// Pools over `actions` actions from a file; nothing if it is damaged.
    #[must_use]
    pub fn from_sums(sums: &PooledSums, actions: usize) -> Option<Self> {
        let digit = |[part, column, values]: &[usize; 3]| Digit { part: *part, column: *column, values: *values };
        let fits = sums.digits.len() <= MOST_DIGITS && sums.digits.iter().all(|[_, column, _]| *column < MOST_DIGITS);
        if !fits || !sums.first_value.is_finite() {
            return None;
        }
        let mut pools = Self::new(sums.digits.iter().map(digit).collect(), actions);
        if pools.entries.len() != sums.tuple.len() {
            return None;
        }
        for (at, own) in sums.tuple.iter().enumerate() {
            let numbers = own.keys.len().checked_mul(actions)?;
            let finite = own.sums.iter().chain(&own.tries).all(|number| number.is_finite());
            if own.sums.len() != numbers || own.tries.len() != numbers || !finite {
                return None;
            }
            for key in &own.keys {
                let next = pools.lowest.len() as u32;
                pools.entries[at].insert(*key, next).is_none().then_some(())?;
                pools.lowest.push(at < pools.levels.ends[0]);
            }
            pools.sums.extend(&own.sums);
            pools.tries.extend(&own.tries);
        }
        pools.values.resize(pools.sums.len(), 0.0);
        pools.settle(sums.first_value, 1.0);
        Some(pools)
    }
}

/// More digits than any state has.
const MOST_DIGITS: usize = 256;
