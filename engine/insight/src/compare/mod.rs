//! Runs beside one another: what they came to and how sure that is, which states want another action, and what was changed.
//!
//! ```text
//!   folders --> side.rs (a run, read) --+--> figures.rs (values, intervals, tests: statistics.rs) --+
//!                                       +--> states.rs  (majorities of best actions)               +--> page.rs
//!                                       +--> changes.rs (settings, lines of the script)  ----------+
//! ```

mod changes;
mod figures;
mod page;
mod side;
mod states;
mod statistics;

pub use changes::{Changes, LineChange, SettingChange, script_diff};
pub use figures::{ComparedFigure, FigureSide, SuccessSide};
pub use page::{chance_words, compare_page};
pub use side::Side;
pub use states::{ComparedState, StateChoice, StateComparison};

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::WINDOW_STEPS;
use serde::Serialize;

use crate::report::{CurveGroup, compared_curves};

/// Runs beside one another; each is held against the first.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// The runs by the names that were given.
    pub runs: Vec<String>,
    /// The seeds of each run.
    pub seeds: Vec<Vec<u64>>,
    /// How many seeds of each succeed.
    pub success: Vec<SuccessSide>,
    /// The figures.
    pub figures: Vec<ComparedFigure>,
    /// For each run after the first: which states want another action than in the first.
    pub states: Vec<StateComparison>,
    /// For each run after the first: what was changed.
    pub changes: Vec<Changes>,
    /// Whether some run has curves of several seeds.
    #[serde(skip)]
    pub several: bool,
    /// The curves over one another, a whole SVG.
    #[serde(skip)]
    pub curves_svg: Option<String>,
}

impl Comparison {
    /// Holds runs against the first of them.
    ///
    /// # Errors
    /// `E-COMPARE` if there is only one; if the curves cannot be drawn.
    pub fn new(sides: &[Side]) -> Result<Self> {
        let [first, others @ ..] = sides else { return needs_two().fail() };
        if others.is_empty() {
            return needs_two().fail();
        }
        let groups: Vec<CurveGroup<'_>> = sides
            .iter()
            .map(|side| CurveGroup {
                name: &side.name,
                curves: side.seeds.iter().map(|seed| seed.summary.reinforcement_per_400.as_slice()).collect(),
            })
            .collect();
        let learned = groups.iter().any(|group| group.curves.iter().any(|curve| !curve.is_empty()));
        let curves_svg = match learned {
            true => Some(compared_curves("Reinforcement while learning", WINDOW_STEPS, &groups)?.svg),
            false => None,
        };
        Ok(Self {
            runs: sides.iter().map(|side| side.name.clone()).collect(),
            seeds: sides.iter().map(|side| side.seeds.iter().map(|seed| seed.summary.seed).collect()).collect(),
            success: figures::successes(sides),
            figures: figures::figures(sides),
            states: others.iter().map(|other| StateComparison::new(first, other)).collect(),
            changes: others.iter().map(|other| Changes::new(&first.plan, &other.plan)).collect(),
            several: sides.iter().any(|side| side.seeds.len() > 1),
            curves_svg,
        })
    }
}

fn needs_two() -> Diagnostic {
    Diagnostic::new("E-COMPARE", "a comparison needs two runs at least")
        .help("write for example: engine compare runs/wall/1-30 runs/mine/1-30")
}
