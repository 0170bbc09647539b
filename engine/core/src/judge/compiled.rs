//! What judging needs of a script.

use super::explain;
use super::expression::{Number, StepFacts};
use super::guards::CompiledGuard;
use super::memory::Remembered;
use super::needs::Needs;
use super::readings::Part;
use super::rule::CompiledRule;
use super::stopped::StopPlaces;
use super::uses::CompiledUse;
use crate::diagnostic::{Mistakes, Result, SourceText};
use crate::settings::ScanFan;
use rhai::{AST, Dynamic, Engine, Position, Scope};
use std::ops::Range;

/// What a script reads of a view besides its grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Look {
    /// The largest patch of its mask.
    pub patch: bool,
    /// The line that this shows.
    pub line: bool,
}

/// `bins(x, [edges])`: a value told apart by ranges, one digit of the state.
#[derive(Debug)]
pub(crate) struct Bins {
    pub of: Number,
    /// Where the next range begins, rising.
    pub edges: Vec<f64>,
}

impl Bins {
    /// The number of the range in which its value lies now: how many edges it has reached.
    pub(crate) fn digit(&self, inputs: StepFacts<'_>) -> usize {
        let value = self.of.value(inputs);
        self.edges.iter().take_while(|edge| value >= **edge).count()
    }
}

/// What judging needs of a script.
#[derive(Debug)]
pub(crate) struct CompiledScript {
    /// The text as the user wrote it.
    pub source: SourceText,
    pub engine: Engine,
    pub ast: AST,
    pub constants: Scope<'static>,
    pub rules: Vec<CompiledRule>,
    /// What an action must never do.
    pub guards: Vec<CompiledGuard>,
    /// When which learned policy drives.
    pub uses: Vec<CompiledUse>,
    /// How many are written; more than there are if some are wrong.
    pub written_uses: usize,
    pub needs: Needs,
    /// What is worked out before the rules, in its order.
    pub remembered: Vec<Remembered>,
    /// The names of its views, the first one first.
    pub views: Vec<String>,
    /// What must be found in the mask of each.
    pub looks: Vec<Look>,
    /// What the script tells apart by ranges, for its states.
    pub bins: Vec<Bins>,
    /// The names of its stages; none if it has no stages.
    pub stages: Vec<String>,
    /// Whether it reads what the wheels counted.
    pub counts_way: bool,
    /// Whether it reads what the ground looks like.
    pub reads_ground: bool,
    /// Whether it reads a fact of any view.
    pub reads_views: bool,
    /// Whether it reads the facts of the step before.
    pub looks_back: bool,
    /// Where the name of `fn reward` stands, if there is one.
    pub reward: Option<Range<usize>>,
    /// What `fn reward` reads.
    pub reward_parts: Vec<Part>,
    /// Where the name of `fn calibrate` stands, if there is one.
    pub calibrate: Option<Range<usize>>,
    /// Where a limit can stop it.
    pub stops: StopPlaces,
}

impl CompiledScript {
    /// Whether anything of it outlasts a step, besides how long conditions have held.
    pub(crate) fn remembers(&self) -> bool {
        let parts = !self.bins.is_empty() || !self.stages.is_empty();
        // Guards and uses must know the facts of a robot that was just put somewhere.
        let is_asked = !self.guards.is_empty() || !self.uses.is_empty();
        is_asked || self.looks_back || self.counts_way || !self.remembered.is_empty() || parts
    }

    /// Checks that every beam and every bearing that is named exists.
    ///
    /// # Errors
    /// For each that does not.
    pub(crate) fn check_beams(&self, fan: ScanFan) -> Result<()> {
        let outside = |beam: i64| usize::try_from(beam).map_or(true, |beam| beam >= fan.beams);
        let beams = self.needs.beams.iter().filter(|(beam, _)| outside(*beam)).map(|(beam, position)| {
            let message = format!("beam numbers run from 0 to {}", fan.beams.saturating_sub(1));
            (*position, message, format!("found {beam}"), None)
        });
        let unseen = self.needs.bearings.iter().filter(|(bearing_deg, _)| !fan.sees(*bearing_deg));
        let bearings = unseen.map(|(bearing_deg, position)| {
            let message = format!("the laser sees {} degrees to either side", 0.5 * fan.view_deg);
            let help = match 2.0 * bearing_deg.abs() {
                wanted if wanted <= 360.0 => {
                    format!("write laser(#{{ field_of_view_deg: {wanted} }}), or another bearing")
                }
                _ => "bearings run from -180 to 180 degrees, positive to the left".to_owned(),
            };
            (*position, message, format!("{bearing_deg} degrees are out of its view"), Some(help))
        });
        self.told(beams.chain(bearings))
    }

    /// Checks that every grid cell that is named exists; `size` gives rows and columns of a view's grid. Allocates nothing if
    /// they do.
    ///
    /// # Errors
    /// For each that does not.
    pub(crate) fn check_cells(&self, size: impl Fn(usize) -> (usize, usize)) -> Result<()> {
        let outside = |number: Option<i64>, count: usize| {
            number.is_some_and(|number| usize::try_from(number).map_or(true, |number| number >= count))
        };
        let cells = self.needs.cells.iter();
        let wrong = cells.filter(|cell| {
            let (rows, columns) = size(cell.view);
            outside(cell.row, rows) || outside(cell.column, columns)
        });
        self.told(wrong.map(|cell| {
            let (rows, columns) = size(cell.view);
            let message = format!(
                "the grid has rows 0 to {} and columns 0 to {}",
                rows.saturating_sub(1),
                columns.saturating_sub(1)
            );
            let found = match (cell.row, cell.column) {
                (Some(row), Some(column)) => format!("found row {row}, column {column}"),
                (Some(row), None) => format!("found row {row}"),
                (None, column) => format!("found column {}", column.unwrap_or_default()),
            };
            (cell.position, message, found, None)
        }))
    }

    /// Places that are wrong, each with what is wrong and what was found, as one error.
    fn told(&self, wrong: impl Iterator<Item = (Position, String, String, Option<String>)>) -> Result<()> {
        let mut wrong = wrong.peekable();
        if wrong.peek().is_none() {
            return Ok(());
        }
        let source = &self.source;
        let mut mistakes = Mistakes::new(source);
        for (position, message, found, help) in wrong {
            let mistake = explain::mistake(source, "E-SCRIPT-FACT", position, message, found);
            mistakes.add(match help {
                Some(help) => mistake.help(help),
                None => mistake,
            });
        }
        mistakes.end()
    }
}

/// The value of one top-level variable.
pub(crate) fn variable(constants: &Scope<'_>, index: usize) -> Option<(String, Dynamic)> {
    constants.iter().nth(index).map(|(name, _, value)| (name.to_owned(), value))
}
