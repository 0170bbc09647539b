//! What judges a robot's steps: the facts that were measured, and the rules of a script asked about them.
//!
//! The room `script` makes rules of a script, which all seeds share. [`Judge`] is one run's
//! judging of it: counters, and what was calibrated. Conditions and values are small native trees; what was not understood
//! is left to the interpreter, inside limits that are counted, never timed.

pub(crate) mod asked_range;
pub(crate) mod budget;
mod calibrated;
pub(crate) mod compiled;
mod equality;
pub(crate) mod evaluate;
pub(crate) mod explain;
pub(crate) mod expression;
pub(crate) mod fact_columns;
pub(crate) mod fact_table;
pub(crate) mod facts;
pub(crate) mod functions;
mod ground_facts;
pub(crate) mod guards;
mod judged_world;
mod judging;
mod kept_calibration;
pub(crate) mod memory;
pub(crate) mod needs;
pub(crate) mod odometry;
mod passed;
pub(crate) mod reach;
pub(crate) mod readings;
pub(crate) mod rule;
pub(crate) mod running;
pub(crate) mod sandbox;
pub(crate) mod stopped;
pub(crate) mod uses;
pub(crate) mod view_facts;
pub(crate) mod views;
pub(crate) mod withheld;

pub use compiled::Look;
pub use evaluate::Judgement;
pub use expression::Comparison;
pub use fact_columns::{Reach, Unit};
pub use fact_table::{Fact, FactId};
pub use facts::{Facts, NO_ACTION, StageFacts};
pub(crate) use guards::Leave;
pub use judging::Judge;
pub use odometry::Odometry;
pub use readings::{FactRead, PartRead};
pub use rule::RuleText;
pub use view_facts::{LineFacts, PatchFacts, ViewFacts};
