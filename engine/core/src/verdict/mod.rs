//! Whether what was learned is a success, and by which figures: nothing of it comes from the reward alone.
//!
//! ```text
//!   measured.rs (what a test measures) --> figures.rs (its figures by name) --> term.rs (a condition over figures) -->
//!   window.rs (windows of learning) -->
//!     success.rs (the conditions of a script, or the default) --> judged.rs (the verdict)
//! ```

mod asked;
mod base_lines;
mod default;
mod figures;
mod judged;
mod measured;
mod own_word;
mod possible;
mod success;
mod term;
mod totals;
mod window;

pub use asked::{AskedFigure, Probe, Request};
pub use base_lines::{BaseLines, BlindFigures};
pub use figures::{FIGURES, TestFigure};
pub use judged::{Because, ConditionVerdict, FigureVerdict, SuccessVerdict};
pub use measured::TestFigures;
pub use success::{Success, SuccessCondition};
pub use term::Subject;
pub use totals::{MeasureTotal, RuleTotal, StageTotal};
pub use window::{WINDOW_STEPS, Window, WindowCounts};

pub(crate) use default::Endable;
pub(crate) use figures::Takes;
pub(crate) use own_word::OwnWord;
pub(crate) use possible::{exclude, why_never};
pub(crate) use term::{FigureOf, FigureUse, Term};
