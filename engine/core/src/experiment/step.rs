//! What one step led to.

use crate::allowed::Allowed;
use crate::learner::Transition;
use crate::outcome::{Destination, Ending, Then, pass_destination, pass_then};
use crate::saved::{Passed, Passing};

/// One step, from the choice of an action to what the script says of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// The step's number, from 0.
    pub index: u64,
    /// The state in which the action was chosen.
    pub state: usize,
    /// The action.
    pub action: usize,
    /// The action was not the best known one of its state.
    pub explored: bool,
    /// The script's reward.
    pub reward: f64,
    /// The state at the end.
    pub next_state: usize,
    /// What delayed rules had built up before the step, see [`crate::learner::Transition::potential`].
    pub potential: f64,
    /// What they have built up after it, before any recovery.
    pub next_potential: f64,
    /// What the script says if the attempt ends here: the robot is put somewhere else.
    pub then: Option<Then>,
    /// Where the next attempt begins, if the script says so; else as `recovery` says.
    pub to: Option<Destination>,
    /// The stage that the script wants next, if a rule says one: it may be the present one.
    pub entered: Option<usize>,
    /// Whether the body touched something.
    pub contact: bool,
    /// The use under which a policy that was learned before chose; nothing if the choice was the script's own.
    pub driver: Option<usize>,
    /// Whether a use holds at the end, so that the next choice is not the script's own.
    pub hands_over: bool,
    /// Whether a guard took an action away when this one was chosen.
    pub guarded: bool,
    /// The actions that guards leave at the end.
    pub next_allowed: Allowed,
    /// The attempt is broken off here, which is no outcome: the robot has stayed as long as it may, and goes on elsewhere.
    pub hop: bool,
}

impl Step {
    /// Whether the robot is put elsewhere after it.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.hop || self.then.is_some()
    }

    /// How the attempt ended, if it did.
    #[must_use]
    pub fn ending(&self) -> Option<Ending> {
        self.then.map(|then| then.ending(self.reward))
    }

    /// The step as a learner is told of it.
    #[must_use]
    pub fn transition(&self) -> Transition {
        Transition {
            state: self.state,
            action: self.action,
            reward: self.reward,
            next_state: self.next_state,
            ending: self.ending(),
            potential: self.potential,
            next_potential: self.next_potential,
            next_allowed: self.next_allowed,
        }
    }

    /// Passes all of it: whoever is still to learn of a step keeps it.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.whole(&mut self.index)?;
        [&mut self.state, &mut self.action, &mut self.next_state].into_iter().try_for_each(|number| by.size(number))?;
        by.numbers([&mut self.reward, &mut self.potential, &mut self.next_potential])?;
        pass_then(by, &mut self.then)?;
        pass_destination(by, &mut self.to)?;
        by.option(&mut self.entered, Passing::size)?;
        by.option(&mut self.driver, Passing::size)?;
        let flags = [&mut self.explored, &mut self.contact, &mut self.hands_over, &mut self.guarded, &mut self.hop];
        flags.into_iter().try_for_each(|flag| by.flag(flag))?;
        self.next_allowed.pass(by)
    }
}
