//! The verdict on one test: which conditions hold, by which figures, beside what chance does.

use serde::{Deserialize, Serialize};

/// Whether a test is a success, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SuccessVerdict {
    /// Null where it cannot be told.
    pub success: Option<bool>,
    /// Why.
    pub why: Because,
    /// Every condition, with its figures.
    pub conditions: Vec<ConditionVerdict>,
}

/// Why a verdict is what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Because {
    /// Every condition holds, and not all of them hold of a robot that knows nothing.
    Holds,
    /// A condition does not hold.
    Fails,
    /// A robot that knows nothing meets all conditions too.
    UntrainedToo,
    /// A robot that does not look meets all conditions too, or the one that was learned does not look.
    BlindToo,
    /// The conditions tell nothing but rewards, which are the script's own word.
    RewardOnly,
    /// Fewer than five attempts, of which a share is asked for.
    TooFew,
    /// A condition reads what the test could not measure: shares of spells of 20 s where no attempt lasts so long.
    NotMeasured,
    /// The test, or that of a robot that knows nothing, was broken off.
    BrokenOff,
    /// The script names no failure, no goal and no success.
    NothingToTellBy,
}

/// One condition in one test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConditionVerdict {
    /// Its name.
    pub name: String,
    /// What must hold.
    pub condition: String,
    /// Whether it holds.
    pub holds: bool,
    /// Whether it holds of a robot that knows nothing.
    pub untrained: bool,
    /// The figures that it reads.
    pub figures: Vec<FigureVerdict>,
}

/// One figure, beside that of a robot that knows nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FigureVerdict {
    /// Its name, as in `test.NAME`.
    pub name: String,
    /// Of the policy that was learned; null where the test does not have it.
    pub value: Option<f64>,
    /// Of one that knows nothing.
    pub untrained: Option<f64>,
}

impl SuccessVerdict {
    /// Whether it is a success, and told.
    #[must_use]
    pub fn is_success(&self) -> bool {
        self.success == Some(true)
    }
}
