//! Those who choose: a learner, a frozen policy, several policies as one, a function, a record.

use super::{Choice, Chooser, Disagreements, Hand, Step};
use crate::allowed::Allowed;
use crate::diagnostic::Result;
use crate::learner::{Combined, Learner, Policy, PolicyRoom};
use crate::random::Random;

/// A learner that learns from every step.
pub struct Learns<'a, L: ?Sized>(pub &'a mut L);

impl<L: Learner + ?Sized> Chooser for Learns<'_, L> {
    fn choose(&mut self, states: &[usize], allowed: Allowed) -> Result<Choice> {
        let (action, explored) = self.0.choose(states[0], allowed);
        Ok(Choice { action, explored })
    }

    fn learn(&mut self, step: &Step) {
        self.0.learn(&step.transition());
    }

    fn forget(&mut self) {
        self.0.forget();
    }
}

/// A policy that learns no more, at the lowest temperature.
pub struct Frozen<'a> {
    policy: &'a Policy,
    room: PolicyRoom,
    random: Random,
}

impl<'a> Frozen<'a> {
    /// A policy with room to choose in and a stream of its own.
    #[must_use]
    pub(super) fn new(policy: &'a Policy, room: PolicyRoom, random: Random) -> Self {
        Self { policy, room, random }
    }
}

impl Chooser for Frozen<'_> {
    fn choose(&mut self, states: &[usize], allowed: Allowed) -> Result<Choice> {
        let (action, explored) = self.policy.choose(states[0], allowed, &mut self.room, &mut self.random);
        Ok(Choice { action, explored })
    }

    fn kept(&self) -> &[u8] {
        self.policy.kept()
    }
}

/// Several policies as one, each in the state that its own eyes perceive.
pub(super) struct Together {
    combined: Combined,
    random: Random,
    disagreements: Disagreements,
}

impl Together {
    /// Policies that decide together for so many steps.
    #[must_use]
    pub(super) fn new(combined: Combined, random: Random, steps: u64) -> Self {
        let disagreements = Disagreements::new(&combined, steps);
        Self { combined, random, disagreements }
    }

    /// Where they disagreed.
    #[must_use]
    pub(super) fn into_disagreements(self) -> Disagreements {
        self.disagreements
    }
}

impl Chooser for Together {
    fn choose(&mut self, states: &[usize], allowed: Allowed) -> Result<Choice> {
        // The first state is the script's own.
        let states = &states[1..];
        let decision = self.combined.choose(states, allowed, &mut self.random);
        self.disagreements.count(states, self.combined.votes(), &decision);
        Ok(Choice { action: decision.action, explored: false })
    }
}

/// Chooses by the script's present state alone.
pub struct ByState<F>(pub F);

impl<F: FnMut(usize) -> usize> Chooser for ByState<F> {
    fn choose(&mut self, states: &[usize], _: Allowed) -> Result<Choice> {
        Ok(Choice { action: (self.0)(states[0]), explored: false })
    }
}

/// One choice that was made before.
pub(super) struct Recorded(pub Choice);

impl Chooser for Recorded {
    fn choose(&mut self, _: &[usize], _: Allowed) -> Result<Choice> {
        Ok(self.0)
    }

    fn hand_over(&mut self, _: &Hand) -> Option<Choice> {
        Some(self.0)
    }
}
