//! What a learner is made for, and what it is told.

use crate::allowed::Allowed;
use crate::geometry::Twist;
use crate::outcome::{Ending, pass_ending};
use crate::random::Random;
use crate::saved::{Passed, Passing};
use crate::state::Digit;

use super::Mirror;

/// The task of a learner: its states, its actions, and chance of its own.
#[derive(Debug, Clone)]
pub struct Task {
    /// The digits of a state's number, lowest first; a learner may treat it as one number.
    pub digits: Vec<Digit>,
    /// How many states there may be: the product of all digits' values.
    pub states: usize,
    /// What each action commands.
    pub actions: Vec<Twist>,
    /// The mirror image of each state and action, if the script asks to learn left for right.
    pub mirror: Option<Mirror>,
    /// The learner's own stream of random numbers.
    pub random: Random,
}

impl Task {
    /// A task over so many plain states.
    #[must_use]
    pub fn plain(states: usize, actions: Vec<Twist>, random: Random) -> Self {
        Self { digits: vec![Digit { part: 0, column: 0, values: states }], states, actions, mirror: None, random }
    }
}

/// One step, as the learner sees it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Transition {
    /// The state in which the action was chosen.
    pub state: usize,
    /// The action.
    pub action: usize,
    /// The reward of the step.
    pub reward: f64,
    /// The state at the end of the step; after a failure, the state of the failure.
    pub next_state: usize,
    /// How the attempt ended with this step, if it did: the next step begins somewhere else.
    pub ending: Option<Ending>,
    /// What delayed rules had built up before the step: the sum, over the rules that must hold for a time and have a fixed
    /// value, of that value times the share of the time for which they have held.
    pub potential: f64,
    /// What delayed rules have built up after the step, before any recovery.
    pub next_potential: f64,
    /// The actions that guards leave after the step, before any recovery.
    pub next_allowed: Allowed,
}

impl Transition {
    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        [&mut self.state, &mut self.action, &mut self.next_state].into_iter().try_for_each(|number| by.size(number))?;
        by.numbers([&mut self.reward, &mut self.potential, &mut self.next_potential])?;
        pass_ending(by, &mut self.ending)?;
        self.next_allowed.pass(by)
    }
}
