//! Whether what was learned is a success, and by which figures: nothing of it comes from the reward alone.
//!
//! ```text
//!   figures.rs (what a test measures) --> term.rs (a condition over figures) --> success.rs (the conditions of a script, or
//!   window.rs  (windows of learning)  ----------------------------------------->   the default) --> judged.rs (the verdict)
//! ```

mod default;
mod figures;
mod judged;
mod success;
mod term;
mod window;

pub use figures::{FIGURES, Figure, RuleTotal, TestFigures};
pub use judged::{ConditionVerdict, FigureVerdict, Verdict, Why};
pub use success::{Condition, Success};
pub use term::Subject;
pub use window::{Counts, WINDOW_STEPS, Window};

pub(crate) use default::Endable;
pub(crate) use term::{FigureUse, Term};
