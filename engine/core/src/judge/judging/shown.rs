//! What rules and guards said of the last step, and what they read.

use super::Judge;
use crate::judge::readings::{self, PartRead};

impl Judge {
    /// What each rule added in the last step, in the order of the behaviour's rules.
    #[must_use]
    pub fn fired(&self) -> &[Option<f64>] {
        &self.fired
    }

    /// The beam behind the last rule that fired in the last step, if it read the laser. Allocates nothing.
    #[must_use]
    pub(crate) fn fired_beam(&self) -> Option<usize> {
        let last = self.fired.iter().rposition(Option::is_some)?;
        readings::beam(self.present.parts(last), self.present.inputs())
    }

    /// What the condition of a rule reads in the present facts, part by part.
    #[must_use]
    pub fn evidence(&self, rule: usize) -> Vec<PartRead> {
        self.present.parts(rule).iter().map(|part| part.evidence(self.present.inputs())).collect()
    }

    /// What the condition of a guard reads in the present facts, part by part.
    #[must_use]
    pub fn guard_evidence(&self, guard: usize) -> Vec<PartRead> {
        let parts = self.present.compiled.guards.get(guard).map_or(&[][..], |guard| &guard.parts);
        parts.iter().map(|part| part.evidence(self.present.inputs())).collect()
    }

    /// Whether a rule's condition holds in the present facts; false where it fails.
    #[must_use]
    pub fn holds(&self, rule: usize) -> bool {
        let rule = self.present.compiled.rules.get(rule);
        rule.is_some_and(|rule| self.present.condition(rule).unwrap_or(false))
    }

    /// Whether a rule that fires once is silent because its condition has held ever since it fired.
    #[must_use]
    pub fn is_spent(&self, rule: usize) -> bool {
        self.spent.get(rule).copied().unwrap_or(false)
    }

    /// For how many steps a rule's condition has held since it last fired, and how many it needs.
    #[must_use]
    pub fn held(&self, rule: usize) -> (u32, u32) {
        (self.held.get(rule).copied().unwrap_or(0), self.needed.get(rule).copied().unwrap_or(1))
    }
}
