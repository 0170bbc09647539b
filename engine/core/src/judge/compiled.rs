//! What judging needs of a script.

use super::explain;
use super::guards::CompiledGuard;
use super::memory::Remembered;
use super::needs::Needs;
use super::readings::Part;
use super::rule::CompiledRule;
use super::stopped::StopPlaces;
use crate::diagnostic::{Mistakes, Result, SourceText};
use rhai::{AST, Dynamic, Engine, Position, Scope};
use std::ops::Range;

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
    pub needs: Needs,
    /// What is worked out before the rules, in its order.
    pub remembered: Vec<Remembered>,
    /// The names of its stages; none if it has no stages.
    pub stages: Vec<String>,
    /// Whether it reads what the wheels counted.
    pub counts_way: bool,
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
        // A guard must know the facts of a robot that was just put somewhere.
        let has_guards = !self.guards.is_empty();
        has_guards || self.looks_back || self.counts_way || !self.remembered.is_empty() || !self.stages.is_empty()
    }

    /// Checks that every beam that is named exists.
    ///
    /// # Errors
    /// For each that does not.
    pub(crate) fn check_beams(&self, beams: usize) -> Result<()> {
        let outside = |beam: i64| usize::try_from(beam).map_or(true, |beam| beam >= beams);
        let wrong = self.needs.beams.iter().filter(|(beam, _)| outside(*beam)).map(|(beam, position)| {
            let message = format!("beam numbers run from 0 to {}", beams.saturating_sub(1));
            (*position, message, format!("found {beam}"))
        });
        self.told(wrong)
    }

    /// Checks that every grid cell that is named exists. Allocates nothing if they do.
    ///
    /// # Errors
    /// For each that does not.
    pub(crate) fn check_cells(&self, (rows, columns): (usize, usize)) -> Result<()> {
        let outside = |number: i64, count: usize| usize::try_from(number).map_or(true, |number| number >= count);
        let cells = self.needs.cells.iter();
        let wrong = cells.filter(|(row, column, _)| outside(*row, rows) || outside(*column, columns));
        self.told(wrong.map(|(row, column, position)| {
            let (last_row, last_column) = (rows.saturating_sub(1), columns.saturating_sub(1));
            let message = format!("the grid has rows 0 to {last_row} and columns 0 to {last_column}");
            (*position, message, format!("found row {row}, column {column}"))
        }))
    }

    /// Places that are wrong, each with what is wrong and what was found, as one error.
    fn told(&self, wrong: impl Iterator<Item = (Position, String, String)>) -> Result<()> {
        let mut wrong = wrong.peekable();
        if wrong.peek().is_none() {
            return Ok(());
        }
        let source = &self.source;
        let mut mistakes = Mistakes::new(source);
        for (position, message, found) in wrong {
            mistakes.add(explain::mistake(source, "E-SCRIPT-FACT", position, message, found));
        }
        mistakes.end()
    }
}

/// The value of one top-level variable.
pub(crate) fn variable(constants: &Scope<'_>, index: usize) -> Option<(String, Dynamic)> {
    constants.iter().nth(index).map(|(name, _, value)| (name.to_owned(), value))
}
