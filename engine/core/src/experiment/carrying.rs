//! The one rule for what is carried on of what was learned, from one plan to another.
//!
//! | what changes | a learner that remembers its steps | a table |
//! |---|---|---|
//! | only numbers: values, limits, times | keeps all | keeps all |
//! | world, body, senses | keeps the steps, forgets visits and age | keeps all |
//! | the form of a rule | judges the steps by the new rules, forgets visits and age | keeps all |
//!
//! So a robot that comes to another world trusts what it knows and tries again; under a small tightening it goes on as it
//! was; and steps that mean something else now are not believed. It is not good at once: what the old rules led it to do
//! says what is bad under the new ones, and little of what is good.

use super::{Ledger, Phase, Plan, Playback};
use crate::diagnostic::Result;
use crate::learner::{Carry, Rejudged};
use crate::settings::LearnerKind;

impl Plan {
    /// What becomes of what was learned under this plan when it goes on under another one.
    #[must_use]
    pub fn carries_to(&self, next: &Self) -> Carry {
        if next.settings.learner.kind != LearnerKind::Memory {
            return Carry::Keep;
        }
        if self.behaviour.reward_form() != next.behaviour.reward_form() {
            // What stage the robot was in, the old rules said.
            return if next.settings.stages.is_empty() { Carry::Rescore } else { Carry::Reset };
        }
        if self.differs_beyond_reward(next).is_some() { Carry::Decay } else { Carry::Keep }
    }
}

/// What the rules of another plan say of the recorded steps of learning, as far as the learner remembers them.
///
/// # Errors
/// If the steps cannot be played again, or the other rules fail on their facts.
pub fn rejudge(plan: &Plan, seed: u64, ledger: &Ledger, rules: &Plan) -> Result<Vec<Rejudged>> {
    let mut playback = Playback::judged_by(plan, seed, Phase::Learning, ledger, Some(rules))?;
    while playback.advance()?.is_some() {}
    Ok(playback.dismiss_witness())
}
