//! How an attempt ends: what a script may say of it, and what that means.

use crate::saved::{Passed, Passing, Unfit};
use crate::settings::RecoverTo;
use std::iter::Sum;

/// What a script says after `then`: the attempt ends, and the robot is put somewhere else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Then {
    /// `then recover`: the reward of the step says how it ended.
    Recover,
    /// `then fail`: it went wrong.
    Fail,
    /// `then goal`: what is wanted was reached.
    Goal,
    /// `then restart`: neither, such as a time that is up.
    Restart,
}

/// Where a script says the next attempt begins: what stands behind `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Destination {
    /// As a word of recovery says.
    Word(RecoverTo),
    /// At the world's start with this index.
    Start(usize),
}

/// Passes where the next attempt begins.
pub(crate) fn pass_destination(by: &mut Passing<'_>, to: &mut Option<Destination>) -> Passed {
    let words = RecoverTo::ALL;
    let mut number = match *to {
        None => 0,
        Some(Destination::Word(word)) => 1 + words.iter().position(|own| *own == word).unwrap_or(0),
        Some(Destination::Start(start)) => 1 + words.len() + start,
    };
    by.size(&mut number)?;
    *to = number.checked_sub(1).map(|place| match words.get(place) {
        Some(word) => Destination::Word(*word),
        None => Destination::Start(place - words.len()),
    });
    Ok(())
}

/// Passes what a script said of an attempt's end.
pub(crate) fn pass_then(by: &mut Passing<'_>, then: &mut Option<Then>) -> Passed {
    pass_one_of(by, then, &Then::ALL.map(|(_, then)| then))
}

/// Passes how an attempt ended.
pub(crate) fn pass_ending(by: &mut Passing<'_>, ending: &mut Option<Ending>) -> Passed {
    pass_one_of(by, ending, &[Ending::Failure, Ending::Goal, Ending::Restart, Ending::Neither])
}

fn pass_one_of<T: Copy + PartialEq>(by: &mut Passing<'_>, one: &mut Option<T>, all: &[T]) -> Passed {
    let mut place = one.and_then(|one| all.iter().position(|other| *other == one)).map_or(0, |place| place + 1);
    by.size(&mut place)?;
    *one = match place.checked_sub(1) {
        None => None,
        Some(place) => Some(*all.get(place).ok_or(Unfit)?),
    };
    Ok(())
}

impl Destination {
    /// What a name means in a world whose starts have these names.
    #[must_use]
    pub fn of(name: &str, starts: &[impl AsRef<str>]) -> Option<Self> {
        let start = || starts.iter().position(|start| start.as_ref() == name).map(Self::Start);
        RecoverTo::of(name).map(Self::Word).or_else(start)
    }
}

/// How an attempt ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Something went wrong.
    Failure,
    /// What the script wants was reached.
    Goal,
    /// Neither: it was broken off, and could have gone on from there.
    Restart,
    /// Neither, by `then recover` with a reward of exactly 0: counted as a restart, but nothing is expected after it.
    Neither,
}

impl Then {
    /// Every word of a script, with what it says.
    pub const ALL: [(&'static str, Self); 4] =
        [("recover", Self::Recover), ("fail", Self::Fail), ("goal", Self::Goal), ("restart", Self::Restart)];

    /// What a word of a script says.
    #[must_use]
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(own, _)| *own == word).map(|(_, then)| *then)
    }

    /// The word of a script.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Recover => "recover",
            Self::Fail => "fail",
            Self::Goal => "goal",
            Self::Restart => "restart",
        }
    }

    /// How an attempt ends in a step with this reward.
    #[must_use]
    pub fn ending(self, reward: f64) -> Ending {
        match self {
            Self::Recover if reward < 0.0 => Ending::Failure,
            Self::Recover if reward > 0.0 => Ending::Goal,
            Self::Recover => Ending::Neither,
            Self::Fail => Ending::Failure,
            Self::Goal => Ending::Goal,
            Self::Restart => Ending::Restart,
        }
    }
}

impl Ending {
    /// Whether nothing is to be expected after it. A restart only breaks an attempt off: the state in which it did still has
    /// its value.
    #[must_use]
    pub fn is_terminal(self) -> bool {
        self != Self::Restart
    }

    /// Its name in reports.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Failure => "failure",
            Self::Goal => "goal",
            Self::Restart | Self::Neither => "restart",
        }
    }
}

/// How attempts ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Endings {
    /// Something went wrong.
    pub failures: u64,
    /// What the script wants was reached.
    pub goals: u64,
    /// Neither.
    pub restarts: u64,
    /// No outcome: the robot had stayed as long as it may, and went on elsewhere.
    pub hops: u64,
}

impl Endings {
    /// One more.
    pub fn count(&mut self, ending: Option<Ending>) {
        match ending {
            None => {}
            Some(Ending::Failure) => self.failures += 1,
            Some(Ending::Goal) => self.goals += 1,
            Some(Ending::Restart | Ending::Neither) => self.restarts += 1,
        }
    }

    /// All that had an outcome.
    #[must_use]
    pub fn attempts(&self) -> u64 {
        self.failures + self.goals + self.restarts
    }

    /// Goals as a share of all attempts, those included that were broken off before they had an outcome; 0 without any.
    #[must_use]
    pub fn goal_rate(&self) -> f64 {
        self.goals as f64 / (self.attempts() + self.hops).max(1) as f64
    }
}

impl Sum for Endings {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            failures: sum.failures + one.failures,
            goals: sum.goals + one.goals,
            restarts: sum.restarts + one.restarts,
            hops: sum.hops + one.hops,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovery_ends_as_its_reward_says_and_the_other_words_say_it_themselves() {
        let endings = |then: Then| [-0.5, 0.0, 0.001].map(|reward| then.ending(reward));
        assert_eq!(endings(Then::Recover), [Ending::Failure, Ending::Neither, Ending::Goal]);
        assert_eq!(endings(Then::Fail), [Ending::Failure; 3]);
        assert_eq!(endings(Then::Goal), [Ending::Goal; 3]);
        assert_eq!(endings(Then::Restart), [Ending::Restart; 3]);
        assert!(Ending::Neither.is_terminal() && !Ending::Restart.is_terminal());
    }

    #[test]
    fn every_word_is_read_as_what_it_says() {
        for (word, then) in Then::ALL {
            assert_eq!((Then::of(word), then.word()), (Some(then), word));
        }
        assert_eq!(Then::of("stop"), None);
    }
}
