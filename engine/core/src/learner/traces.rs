//! Eligibility traces over the last distinct states, equation (2).

use super::QTable;
use crate::saved::{Loading, Saving, Unfit};

/// One remembered pair and how much of an error it takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trace {
    pub(super) state: usize,
    /// The last action that was chosen in the state.
    pub(super) action: usize,
    /// 1 for the present state, less for earlier ones.
    pub(super) weight: f64,
}

/// The last `window` distinct states, latest first.
#[derive(Debug, Clone)]
pub(super) struct Traces {
    window: usize,
    decay: f64,
    recent: Vec<Trace>,
}

impl Traces {
    /// Traces of at most `window` states that fade by `decay` (discount times lambda) in each step.
    pub(super) fn new(window: usize, decay: f64) -> Self {
        Self { window, decay, recent: Vec::with_capacity(window + 1) }
    }

    /// Fades all traces and sets that of the present state to 1.
    pub(super) fn visit(&mut self, state: usize, action: usize) {
        for trace in &mut self.recent {
            trace.weight *= self.decay;
        }
        self.recent.retain(|trace| trace.state != state);
        self.recent.insert(0, Trace { state, action, weight: 1.0 });
        self.recent.truncate(self.window);
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Trace> {
        self.recent.iter()
    }

    /// Writes all traces.
    pub(super) fn save(&self, to: &mut Saving) {
        to.whole(self.recent.len() as u64);
        for trace in &self.recent {
            to.whole(trace.state as u64);
            to.whole(trace.action as u64);
            to.number(trace.weight);
        }
    }

    /// Takes traces that were saved.
    pub(super) fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit> {
        let count = from.index(self.window + 1)?;
        self.recent.clear();
        for _ in 0..count {
            let (state, action) = (from.index(table.states())?, from.index(table.actions())?);
            self.recent.push(Trace { state, action, weight: from.number()? });
        }
        Ok(())
    }

    pub(super) fn clear(&mut self) {
        self.recent.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(traces: &Traces) -> Vec<(usize, usize, f64)> {
        traces.iter().map(|trace| (trace.state, trace.action, trace.weight)).collect()
    }

    #[test]
    fn weights_are_1_0_891_and_0_7939_as_table_1_gives() {
        let mut traces = Traces::new(3, 0.99 * 0.9);
        for state in 0..4 {
            traces.visit(state, 0);
        }
        let found = weights(&traces);
        assert_eq!(found.len(), 3);
        assert_eq!((found[0].0, found[1].0, found[2].0), (3, 2, 1));
        assert!((found[1].2 - 0.891).abs() < 1e-12 && (found[2].2 - 0.793_881).abs() < 1e-12);
    }

    #[test]
    fn a_revisited_state_keeps_one_trace_with_its_last_action() {
        let mut traces = Traces::new(3, 0.5);
        traces.visit(7, 0);
        traces.visit(8, 1);
        traces.visit(7, 2);
        assert_eq!(weights(&traces), [(7, 2, 1.0), (8, 1, 0.5)]);
    }

    #[test]
    fn staying_in_a_state_does_not_push_others_out() {
        let mut traces = Traces::new(2, 0.5);
        traces.visit(1, 0);
        for _ in 0..3 {
            traces.visit(2, 0);
        }
        assert_eq!(weights(&traces), [(2, 0, 1.0), (1, 0, 0.125)]);
    }
}
