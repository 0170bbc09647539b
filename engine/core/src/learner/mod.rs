//! From states, actions and rewards to values.
//!
//! [`Learner`] is the door: a step is [`Learner::choose`], then [`Learner::learn`]. The ways of learning that ship keep a
//! table ([`TableLearner`]) and differ only in what of it a step changes, each in a file of its own beside `backup.rs`. This
//! room sees numbers only: never a frame, a world, a script or a clock.
//!
//! # Beyond the paper
//! Options that are off by default and go with every way of learning: `mirror` (learn left for right too) and `replay`
//! (learn the way to a failure again). Share of 300 seeds that learned, and the median
//! step, on the seeds that the choice was made with; the paper has a window of 3 and a lambda of 0.9:
//!
//! | options | wall | corridor | platform |
//! |---|---|---|---|
//! | the paper's | 72 %, 2,800 | 75 %, 1,600 | 88 %, 1,600 |
//! | window 6, lambda 0.95 | 77 %, 2,400 | | |
//! | window 10, lambda 0.97 | | 88 %, 800 | 93 %, 1,200 |
//! | the same with `mirror` | | 88 %, 800 | 96 %, 800 |
//! | the same with `mirror` and 3 passes of `replay` | | 90 %, 800 | 97 %, 1,200 |
//!
//! Replay does harm on the wall: with a window of 6, five passes brought 76 of 100 seeds down to 49. There the wall may be
//! out of reach for seconds before it counts as lost, so that a failure is far from its cause; whether that is why was not
//! tried. Averaged tables, step sizes
//! that shrink with the visits and keeping the table that did best did not help.
//!
//! # Decisions where the paper is silent
//! Found by training some 300 configurations of the same method on wall, corridor and platform following; the shares are
//! seeds that converged, with the choice against without it.
//!
//! | choice | evidence |
//! |---|---|
//! | the trace holds the last n *distinct* states, each with its last action | wall 18/20 against 12/20 for the last n steps |
//! | a failure is not terminal: the state at the failure is bootstrapped | wall 18/20 against 6/20, platform 20/20 against 11/20 |
//! | one shared TD error for all states of the window, as equation (1) is printed | wall 4/10 against 0/10 for a target of its own for each state |
//! | revisiting a state sets its trace to 1 (replacing trace, equation 2) | as printed |
//! | traces are not cut after an exploring action | cutting was much worse, since 64 states are aliased |
//! | the temperature follows the visits of each state (equation 4) | as printed |
//! | softmax subtracts the greatest value first | exp(-1 / 0.009) underflows in single precision otherwise |

mod backup;
mod carry;
mod combined;
mod memory;
mod mirror;
mod policy;
mod policy_digest;
mod q_table;
mod replay;
mod sarsa_lambda;
mod shipped;
mod softmax;
mod table_learner;
mod task;
mod traces;
mod ttd;
mod ttd_cichosz;

use crate::allowed::Allowed;
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::LearnerSettings;

pub use carry::{Carry, Rejudged};
pub(crate) use combined::{Combined, Decision};
pub use memory::{ChainLink, MemoryLearner, PastTry, PooledSums, Pools, ValueChain};
pub use mirror::Mirror;
pub use policy::{Policy, PolicyRow};
pub(crate) use policy::{PolicyRoom, any_of};
use q_table::QTable;
pub use shipped::{ShippedLearner, shipped_learner};
use softmax::Softmax;
pub use table_learner::TableLearner;
pub use task::{Task, Transition};

/// What learns: chooses an action in a state, and is told what came of it.
///
/// States and actions are numbers; what they are made of is in the [`Task`] that a learner is made for.
pub trait Learner: Send {
    /// Chooses one of the actions that are `allowed` in `state` and counts the visit; also whether it is another one than the
    /// best known of them.
    fn choose(&mut self, state: usize, allowed: Allowed) -> (usize, bool);

    /// Counts a visit of a state in which someone else chose.
    fn visit(&mut self, state: usize);

    /// Learns from one step.
    fn learn(&mut self, transition: &Transition);

    /// The robot is put somewhere else, or learning ends: what is still held of earlier steps is learned now.
    fn forget(&mut self);

    /// Goes on under another reward, with these settings and this mirror; `carry` says what becomes of what was learned.
    fn swap(&mut self, settings: &LearnerSettings, mirror: Option<Mirror>, carry: Carry);

    /// After a swap with [`Carry::Rescore`]: values the latest steps, the oldest first, by what the new rules say of them.
    /// Whoever remembers no steps has nothing to do, and is never told.
    fn rescore(&mut self, _steps: &[Rejudged]) {}

    /// What was learned so far, without learning on.
    fn policy(&self) -> Policy;

    /// Gives every learned number to `each`, in a fixed order: the state hash of a run holds them.
    fn numbers(&self, each: &mut dyn FnMut(f64));

    /// Writes all that goes on: with it, a learner made for the same task learns on as this one would.
    fn save(&self, to: &mut Saving);

    /// Becomes the learner that was saved.
    ///
    /// # Errors
    /// If the bytes are not those of a learner for the same task.
    fn load(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit>;
}
