//! JUDGE: reward scripts, read once, checked, and asked in every step.
//!
//! A script sets up, names rules over facts, and may have functions. [`Behaviour`] is a script that has been loaded and
//! checked; it is shared. [`Judge`] is one run's judging of it: counters, and what was calibrated. Rules are compiled to
//! small native trees; what is not understood is left to the interpreter, inside limits that are counted, never timed.

mod behaviour;
mod bodies;
mod chain;
mod compile;
mod draft;
mod evaluate;
mod explain;
mod expression;
mod fact_table;
pub mod facts;
mod functions;
mod judge;
mod names;
mod outline;
mod reach;
mod readings;
mod reference;
mod rehearsal;
mod rule;
mod running;
mod sandbox;
mod setup;
mod source;
mod spoilt;
mod syntax;
mod top_level;
mod tree;
mod unknown;
mod unread;
mod views;

pub use behaviour::Behaviour;
pub use draft::Draft;
pub use fact_table::{CALLS, FACTS, Fact, FactCall, GROUPS, Getter, Reach, SECTOR, SectorFact};
pub use facts::Facts;
pub use functions::{FUNCTIONS, Function};
pub use judge::{Judge, Verdict};
pub use outline::{BeamLoop, Compared, Comparison, Condition, Gathers, Outline, RuleOutline, UnusedName};
pub use readings::{Evidence, FactRead};
pub use reference::{definitions, reference};
pub use rule::RuleText;
pub use setup::{SETUP, SetupCall};
pub use unread::Unread;

#[cfg(test)]
mod tests;
