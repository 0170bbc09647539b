//! What is carried on of what was learned, when the reward changes or a run goes on from another.

use super::Transition;
use crate::saved::{Passed, Passing};
use serde::{Deserialize, Serialize};

/// What becomes of the table, or of the remembered steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Carry {
    /// It stays as it is, visits included: a state that was met often hardly tries anything new.
    #[default]
    Keep,
    /// Values are halved, and so are the visits, of which no more than `learner.cooling_visits` count: what was known goes
    /// on to lead, but is tried again.
    Decay,
    /// It begins again with first values and no visits; only the robot stays where it is.
    Reset,
    /// Of a learner that remembers its steps: these are judged by the rules that come next, visits and age are forgotten.
    Rescore,
}

/// A remembered step, as the rules that come next judge it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rejudged {
    /// The step, with the reward and the ending of these rules.
    pub transition: Transition,
    /// The robot was put elsewhere after it.
    pub moved: bool,
}

impl Rejudged {
    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        self.transition.pass(by)?;
        by.flag(&mut self.moved)
    }
}

impl Carry {
    /// Every way that can be asked for, as it is written, in the order of what is left of the table.
    pub const ALL: [(&'static str, Self); 3] = [("keep", Self::Keep), ("decay", Self::Decay), ("reset", Self::Reset)];

    /// How it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Keep => "keep",
            Self::Decay => "decay",
            Self::Reset => "reset",
            Self::Rescore => "rescore",
        }
    }
}
