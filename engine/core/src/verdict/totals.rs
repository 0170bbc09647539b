//! Of a test, what each rule, stage and measure came to.

use serde::{Deserialize, Serialize};

/// What one rule did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RuleTotal {
    /// The rule's name.
    pub name: String,
    /// How often it fired.
    pub fired: u64,
    /// Sum of what it added.
    pub total: f64,
}

/// How often one stage was reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageTotal {
    /// The stage's name.
    pub name: String,
    /// Share of the attempts, the unfinished one included, in which a rule entered it.
    pub rate: f64,
}

/// What one measure came to, over all steps; true counts 1, false 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasureTotal {
    /// The measure's name.
    pub name: String,
    /// Its mean.
    pub mean: f64,
    /// The least value.
    pub least: f64,
    /// The greatest value.
    pub greatest: f64,
}
