//! Whoever chooses by itself, and the learned policies that it hands the robot over to while a use holds.
//!
//! To the script's own table a hand-over is one long step: what is earned in it is added to the reward of the action before it,
//! and it leads to the state in which the script has the robot back. So the table learns what handing over is worth, and nothing
//! from choices that were not its own. What is earned before its first choice of an attempt is nobody's.

use super::{Choice, Chooser, Hand, Plan, Step, UsedPolicy};
use crate::allowed::Allowed;
use crate::diagnostic::Result;
use crate::learner::PolicyRoom;
use crate::random::{Random, Stream};
use crate::saved::{Passed, Passing};
use std::sync::Arc;

/// The policies that a plan uses, as they choose.
pub(super) struct UsedDrivers {
    drivers: Vec<UsedDriver>,
    random: Random,
    /// The script's own last step, with what was earned since.
    owed: Option<Step>,
}

struct UsedDriver {
    used: Arc<UsedPolicy>,
    room: PolicyRoom,
    motions: Vec<usize>,
}

impl UsedDrivers {
    /// Those of a plan, in the phase of a run whose simulator has this seed.
    pub(super) fn new(plan: &Plan, seed: u64) -> Self {
        let driver = |used: &Arc<UsedPolicy>| UsedDriver {
            room: used.policy.room(&used.plan.settings.learner),
            motions: plan.motions_of(used),
            used: Arc::clone(used),
        };
        let drivers = plan.used.iter().map(driver).collect();
        Self { drivers, random: Random::new(seed, Stream::Used), owed: None }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.drivers.is_empty()
    }

    /// Whoever chooses, with these to hand over to.
    pub(super) fn with<C>(&mut self, own: C) -> Relay<'_, C> {
        Relay { own, used: self }
    }

    /// Passes what goes on from step to step.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.random(&mut self.random)?;
        by.option(&mut self.owed, |by, step| step.pass(by))
    }

    /// Tells `own` what its last step led to, if it does not know yet.
    pub(super) fn settle(&mut self, own: &mut impl Chooser) {
        if let Some(step) = self.owed.take() {
            own.learn(&step);
        }
    }
}

/// A chooser with policies to hand over to.
pub(super) struct Relay<'a, C> {
    own: C,
    used: &'a mut UsedDrivers,
}

impl<C: Chooser> Chooser for Relay<'_, C> {
    fn choose(&mut self, states: &[usize], allowed: Allowed) -> Result<Choice> {
        self.own.choose(states, allowed)
    }

    fn kept(&self) -> &[u8] {
        self.own.kept()
    }

    fn hand_over(&mut self, hand: &Hand) -> Option<Choice> {
        let UsedDrivers { drivers, random, .. } = &mut *self.used;
        let UsedDriver { used, room, motions } = drivers.get_mut(hand.policy)?;
        let (action, explored) = match hand.held {
            Some(held) => (held, false),
            None => used.policy.choose(hand.state, hand.allowed, room, random),
        };
        Some(Choice { action: *motions.get(action)?, explored })
    }

    fn learn(&mut self, step: &Step) {
        let owed = &mut self.used.owed;
        match (step.driver, owed.as_mut()) {
            (None, _) => *owed = Some(*step),
            (Some(_), Some(own)) => {
                own.reward += step.reward;
                own.next_state = step.next_state;
                own.next_potential = step.next_potential;
                own.next_allowed = step.next_allowed;
                (own.then, own.to, own.entered) = (step.then, step.to, step.entered.or(own.entered));
                own.hop = step.hop;
            }
            (Some(_), None) => return,
        }
        if step.moves() || !step.hands_over {
            self.used.settle(&mut self.own);
        }
    }

    fn forget(&mut self) {
        self.own.forget();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::Then;

    /// Keeps what it is told.
    #[derive(Default)]
    struct Told(Vec<Step>);

    impl Chooser for Told {
        fn choose(&mut self, _: &[usize], _: Allowed) -> Result<Choice> {
            Ok(Choice { action: 0, explored: false })
        }

        fn learn(&mut self, step: &Step) {
            self.0.push(*step);
        }
    }

    fn told(steps: &[Step]) -> Vec<(usize, f64, usize, bool)> {
        let mut used = UsedDrivers { drivers: Vec::new(), random: Random::new(1, Stream::Used), owed: None };
        let mut relay = used.with(Told::default());
        steps.iter().for_each(|step| relay.learn(step));
        relay.own.0.iter().map(|step| (step.state, step.reward, step.next_state, step.then.is_some())).collect()
    }

    fn step(state: usize, driver: Option<usize>, reward: f64, hands_over: bool) -> Step {
        Step { state, driver, reward, hands_over, next_state: state + 1, ..Step::default() }
    }

    #[test]
    fn a_step_that_hands_nothing_over_is_told_as_it_is() {
        assert_eq!(told(&[step(3, None, 0.5, false)]), [(3, 0.5, 4, false)]);
    }

    #[test]
    fn what_is_earned_after_a_hand_over_belongs_to_the_step_before_it() {
        let steps = [step(3, None, 0.5, true), step(4, Some(0), -0.25, true), step(5, Some(1), 2.0, false)];
        // 0.5 - 0.25 + 2, up to the state in which the script has the robot back.
        assert_eq!(told(&steps), [(3, 2.25, 6, false)]);
    }

    #[test]
    fn an_attempt_that_ends_in_other_hands_ends_the_step_before() {
        let end = Step { then: Some(Then::Fail), ..step(4, Some(0), -1.0, false) };
        // After it the first choice of an attempt is not the script's own: what that earns is nobody's.
        let steps = [step(3, None, 0.0, true), end, step(7, Some(0), 5.0, false), step(8, None, 1.0, false)];
        assert_eq!(told(&steps), [(3, -1.0, 5, true), (8, 1.0, 9, false)]);
    }
}
