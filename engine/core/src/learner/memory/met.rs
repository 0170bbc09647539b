//! Which states were met: each has a row, in the order in which they came.

use std::collections::BTreeMap;

/// The rows of the states that were met.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct StatesMet {
    rows: BTreeMap<usize, u32>,
    states: Vec<usize>,
}

impl StatesMet {
    /// The row of a state, if it was met.
    #[must_use]
    pub(super) fn row(&self, state: usize) -> Option<usize> {
        self.rows.get(&state).map(|row| *row as usize)
    }

    /// Gives a state that was not met the next row.
    pub(super) fn meet(&mut self, state: usize) -> usize {
        let row = self.states.len();
        self.rows.insert(state, row as u32);
        self.states.push(state);
        row
    }

    /// The states by row.
    #[must_use]
    pub(super) fn states(&self) -> &[usize] {
        &self.states
    }
}
