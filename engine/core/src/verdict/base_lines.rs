//! What a test is held against: robots that know nothing, or do not look.

use serde::{Deserialize, Serialize};

use super::measured::TestFigures;

/// The tests that stand beside one test, over the same steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaseLines {
    /// A robot that knows nothing: every action is equally likely.
    pub untrained: TestFigures,
    /// Of some robots that do not look the best one; absent where the test is no success without asking them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blind: Option<BlindFigures>,
    /// Other robots that know nothing; absent unless rewards are asked for beside other figures, and all would be well.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub untrained_others: Vec<TestFigures>,
}

/// The test of a robot that does not look: what it does depends on no state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlindFigures {
    /// What it does, in words.
    pub does: String,
    /// Its test; of fewer steps if it failed far too often to go on with.
    pub test: TestFigures,
}

impl BaseLines {
    /// Only a robot that knows nothing.
    #[must_use]
    pub fn of_untrained(untrained: TestFigures) -> Self {
        Self { untrained, blind: None, untrained_others: Vec::new() }
    }
}
