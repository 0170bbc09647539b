//! Uses: while something holds, a policy that was learned before drives in place of the script's own table.

use super::expression::{Flag, StepFacts};
use super::readings::Part;
use super::rule::RuleText;

/// A use, ready to be asked.
#[derive(Debug)]
pub(crate) struct CompiledUse {
    /// Its name is that of the policy.
    pub text: RuleText,
    /// The policy, by its place among those that the script names.
    pub policy: usize,
    /// The stages in which it may hold, a bit for each; nothing for all.
    pub stages: Option<u32>,
    /// While this holds; nothing for always.
    pub condition: Option<Flag>,
    /// What the condition reads.
    pub parts: Vec<Part>,
}

impl CompiledUse {
    /// Whether it holds whatever happens, so that nothing below it is ever asked.
    pub(crate) const fn is_always(&self) -> bool {
        self.stages.is_none() && self.condition.is_none()
    }

    fn holds(&self, stage: usize, inputs: StepFacts<'_>) -> bool {
        self.stages.is_none_or(|stages| stages & (1 << stage) != 0)
            && self.condition.as_ref().is_none_or(|condition| condition.holds(inputs))
    }
}

/// The first use that holds now. Allocates nothing.
pub(crate) fn first_that_holds(uses: &[CompiledUse], stage: usize, inputs: StepFacts<'_>) -> Option<usize> {
    uses.iter().position(|one| one.holds(stage, inputs))
}
