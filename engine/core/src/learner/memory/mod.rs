//! The learner `memory`: it remembers its last steps, and values an action by what followed when it was taken.
//!
//! The value of an action in a state is the mean of the lambda-returns that followed it, the latest counting most. Where
//! it was hardly tried, similar actions of the state stand in, then states that share a part with it (`subtuples.rs`),
//! then a cautious first value. Each stands behind the next with the weight of a few tries:
//!
//! ```text
//! q = first value                                              max(0, mean of all returns) - unit
//! q = mean over pairs of columns  (sum + 5 q) / (tries + 5)     then pairs with the other digits, then whole views, with 2
//! q = similar actions             (sum + 2 q) / (tries + 2)
//! Q = own tries                   (sum + 4 q) / (tries + 4)
//! ```
//!
//! The unit is the greatest spread that the returns have had so far, so that rewards a hundred times as large teach the
//! same. Temperatures are shares of it. A rule that must hold for a time is paid while it holds, as a potential (Ng, Harada
//! and Russell 1999): what is best stays best. What is frozen is the mean of the last tables.
//!
//! # Why not a model, or a table that is nudged
//! The states of a small grid are aliased: a Markov model of them believes ways that do not exist. On seeds 7100 to 7129,
//! which nothing was chosen by, the wall was learned in 30 of 30 seeds with 15 punishments in 2,000 steps and 0.0 failures per
//! 1,000 steps of the test (worst seed 1.0); by `ttd` in 26 of 30, with 50, and 0.3 (6.2).

mod ageing;
mod averaged;
mod chain;
mod kernel;
mod learner;
mod met;
mod past;
mod pools;
mod rejudging;
mod returns;
mod saving;
mod scale;
mod subtuples;
#[cfg(test)]
mod tests;

pub use chain::{ChainLink, PastTry, ValueChain};
pub use learner::MemoryLearner;
pub(super) use pools::PooledRow;
pub use pools::{PooledSums, Pools};

/// Steps between two fits; a recovery that was rewarded or punished is followed by one at once.
const FIT_STEPS: u64 = 20;
/// Of the remembered steps, how many of the latest have their returns renewed in every fit ...
const RECENT_STEPS: usize = 300;
/// ... and how many of the others, a block that goes round through all of them.
const BLOCK_STEPS: usize = 500;
/// Weight of what stands behind the lowest level of sub-tuples, in tries.
const FIRST_WEIGHT: f64 = 5.0;
/// Weight of a level of sub-tuples behind the level above.
const LEVEL_WEIGHT: f64 = 2.0;
/// Weight of the sub-tuples behind similar actions.
const POOLED_WEIGHT: f64 = 2.0;
/// Weight of similar actions behind an action's own tries.
const SIMILAR_WEIGHT: f64 = 4.0;
