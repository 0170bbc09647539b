//! The table of values Q(s, a).

use crate::allowed::Allowed;

/// A value for each action in each state, and how often each state was visited.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct QTable {
    actions: usize,
    values: Vec<f64>,
    visits: Vec<u64>,
}

impl QTable {
    /// A table filled with first values, state by state.
    #[must_use]
    pub(super) fn new(states: usize, actions: usize, mut initial: impl FnMut() -> f64) -> Self {
        let values = (0..states * actions).map(|_| initial()).collect();
        Self { actions, values, visits: vec![0; states] }
    }

    /// How many states it has.
    #[must_use]
    pub(super) fn states(&self) -> usize {
        self.visits.len()
    }

    /// How many actions it has.
    #[must_use]
    pub(super) const fn actions(&self) -> usize {
        self.actions
    }

    /// The values of a state's actions.
    #[must_use]
    pub(super) fn row(&self, state: usize) -> &[f64] {
        &self.values[state * self.actions..(state + 1) * self.actions]
    }

    /// All values, state by state.
    #[must_use]
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value of one action in one state.
    #[must_use]
    pub(super) fn value(&self, state: usize, action: usize) -> f64 {
        self.values[state * self.actions + action]
    }

    /// Adds to the value of one action in one state.
    pub(super) fn add(&mut self, state: usize, action: usize, amount: f64) {
        self.values[state * self.actions + action] += amount;
    }

    /// The best of some actions of a state and its value; the first of equals.
    #[must_use]
    pub(super) fn best_among(&self, state: usize, allowed: Allowed) -> (usize, f64) {
        best_among(self.row(state), allowed)
    }

    /// Counts a visit of a state and tells how many there were before.
    pub(super) fn visit(&mut self, state: usize) -> u64 {
        let before = self.visits[state];
        self.visits[state] += 1;
        before
    }

    /// All values and all visits, to be filled with what was saved.
    pub(super) fn parts_mut(&mut self) -> (&mut [f64], &mut [u64]) {
        (&mut self.values, &mut self.visits)
    }

    /// Halves what is known: every value, and the visits of each state, of which no more than `most` count.
    pub(super) fn halve(&mut self, most: u64) {
        self.values.iter_mut().for_each(|value| *value *= 0.5);
        self.visits.iter_mut().for_each(|visits| *visits = (*visits).min(most) / 2);
    }

    /// How often each state was visited.
    #[must_use]
    pub(super) fn visits(&self) -> &[u64] {
        &self.visits
    }
}

/// The greatest of the values that are allowed and its place; the first of equals.
#[must_use]
pub(super) fn best_among(values: &[f64], allowed: Allowed) -> (usize, f64) {
    if allowed.is_all() {
        return best_of(values);
    }
    let some = values.iter().enumerate().filter(|(action, _)| allowed.contains(*action));
    let best = some.fold(None, |best: Option<(usize, f64)>, (action, value)| match best {
        Some((_, greatest)) if *value <= greatest => best,
        _ => Some((action, *value)),
    });
    best.unwrap_or_else(|| best_of(values))
}

/// The index and value of the greatest of `values`; the first of equals.
pub(super) fn best_of(values: &[f64]) -> (usize, f64) {
    let mut best = (0, f64::NEG_INFINITY);
    for (action, value) in values.iter().enumerate() {
        if *value > best.1 {
            best = (action, *value);
        }
    }
    best
}
