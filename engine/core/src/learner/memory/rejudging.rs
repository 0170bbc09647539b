//! The remembered steps under other rules: their rewards and endings are those of the new rules, and all is valued anew.

use super::ageing::weight_at;
use super::learner::MemoryLearner;
use super::past::Follows;
use super::scale::ReturnScale;
use crate::learner::{Learner, Rejudged};

/// Returns are renewed so often: each time they take in the values of the time before, and at most
/// 0.98 * 0.15 / (1 - 0.98 * 0.85) = 0.88 of what was wrong with these is left.
const RENEWALS: usize = 50;

impl MemoryLearner {
    /// Takes what the new rules say of the latest steps, the oldest first. Visits, age and unit are forgotten, and the values
    /// come from these rewards alone.
    pub(super) fn judge_anew(&mut self, steps: &[Rejudged]) {
        for (back, rejudged) in steps.iter().rev().take(self.past.len()).enumerate() {
            let (reward, follows) = self.earned(&rejudged.transition);
            let step = self.past.back_mut(back);
            step.reward = reward;
            step.follows = if rejudged.moved && follows == Follows::Next { Follows::Value } else { follows };
            step.next_allowed = rejudged.transition.next_allowed;
        }
        self.forget();
        (0..self.past.len()).for_each(|back| self.past.back_mut(back).gain = 0.0);
        self.visits.fill(0);
        (self.age, self.today, self.scale) = (0, 1.0, ReturnScale::default());
        self.averaged.clear();
        self.table.clear();
        self.count_all(|back, _| weight_at(-(back as f64)));
        (0..RENEWALS).for_each(|_| self.fit_all());
        self.averaged.clear();
        self.fit_all();
    }
}
