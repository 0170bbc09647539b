//! The base line: what a robot that knows nothing does in the same test.

use std::sync::atomic::AtomicBool;

use super::{Choice, Chooser, Plan, test_choices};
use crate::allowed::Allowed;
use crate::diagnostic::Result;
use crate::learner::any_of;
use crate::random::{Random, Stream};
use crate::verdict::TestFigures;

/// So many steps are enough to know.
const MOST_STEPS: u64 = 2000;

/// Tests a policy that knows no state: every action is equally likely, in 2,000 steps of the plan's test at most.
///
/// # Errors
/// If a sensor, a filter or the script fails.
pub fn test_untrained(plan: &Plan, seed: u64, stop: &AtomicBool) -> Result<TestFigures> {
    let mut plan = plan.clone();
    plan.settings.run.test_steps = plan.settings.run.test_steps.min(MOST_STEPS);
    let random = Random::new(seed, Stream::Untrained);
    let mut chooser = Untrained { actions: plan.settings.actions.len(), random };
    Ok(test_choices(&plan, seed, stop, &mut chooser, &mut ())?.figures)
}

struct Untrained {
    actions: usize,
    random: Random,
}

impl Chooser for Untrained {
    fn choose(&mut self, _: &[usize], allowed: Allowed) -> Result<Choice> {
        Ok(Choice { action: any_of(self.actions, allowed, &mut self.random), explored: true })
    }
}
