//! A script, loaded and checked.

use super::compile::Needs;
use super::draft::Draft;
use super::explain;
use super::judge::Judge;
use super::outline::Outline;
use super::reach;
use super::readings::Part;
use super::rule::{Rule, RuleText};
use super::setup::Places;
use super::source::Code;
use crate::diagnostic::{Mistakes, Result, SourceText};
use crate::settings::{LaserSettings, Settings};
use rhai::{AST, Dynamic, Engine, Position, Scope};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A script, loaded and checked; shared by all seeds.
#[derive(Debug)]
pub struct Behaviour {
    name: String,
    settings: Settings,
    places: Places,
    rules: Vec<RuleText>,
    outline: Outline,
    loaded: Arc<Loaded>,
}

/// What judging needs of a script.
#[derive(Debug)]
pub(super) struct Loaded {
    pub code: Code,
    pub engine: Engine,
    pub ast: AST,
    pub constants: Scope<'static>,
    pub rules: Vec<Rule>,
    pub needs: Needs,
    /// Where the name of `fn reward` stands, if there is one.
    pub reward: Option<Range<usize>>,
    /// What `fn reward` reads.
    pub reward_parts: Vec<Part>,
    /// Where the name of `fn calibrate` stands, if there is one.
    pub calibrate: Option<Range<usize>>,
}

impl Behaviour {
    /// Loads a script and checks it.
    ///
    /// # Errors
    /// If the file cannot be read as a script, or anything in it is wrong: each mistake in the user's own line, with what
    /// to write.
    pub fn load(path: &Path) -> Result<Self> {
        Draft::load(path)?.end()
    }

    /// The same from a text.
    ///
    /// # Errors
    /// If anything in it is wrong.
    pub fn parse(name: &str, source: SourceText) -> Result<Self> {
        Draft::read(name, source)?.end()
    }

    pub(super) fn new(name: &str, settings: Settings, places: Places, outline: Outline, loaded: Loaded) -> Self {
        let mut rules: Vec<RuleText> = loaded.rules.iter().map(|rule| rule.text.clone()).collect();
        let source = &loaded.code.source;
        rules.extend(loaded.reward.clone().map(|span| {
            let (line, _) = source.position(span.start);
            let text = source.text[source.line_range(line)].trim().to_owned();
            RuleText { name: "reward".to_owned(), line, text }
        }));
        Self { name: name.to_owned(), settings, places, rules, outline, loaded: Arc::new(loaded) }
    }

    /// Checks that every rule can fire with this laser, on a floor at most `drop_m` metres below the robot's own ground;
    /// infinite where that is not known.
    ///
    /// # Errors
    /// `E-SCRIPT-RULE` at the condition of every rule that never can.
    pub fn check_reach(&self, laser: &LaserSettings, drop_m: f64) -> Result<()> {
        let mut mistakes = Mistakes::new(self.source());
        self.find_unreachable(laser, drop_m, &mut mistakes);
        mistakes.end()
    }

    /// Adds every rule that can never fire, unless there is a mistake in its condition already.
    pub(crate) fn find_unreachable(&self, laser: &LaserSettings, drop_m: f64, mistakes: &mut Mistakes) {
        let (limits, source) = (reach::Limits::new(laser, drop_m), self.source());
        for rule in &self.loaded.rules {
            if !mistakes.within(source, &rule.condition_span) {
                mistakes.take(reach::check(source, rule, &limits));
            }
        }
    }

    /// The name: the file's, without its ending.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    #[must_use]
    pub fn source(&self) -> &SourceText {
        &self.loaded.code.source
    }

    /// What the set-up calls said, over the defaults.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Where a setting was set: `world`, `actions`, `filter:0`, `filter:0.threshold`, `camera.tilt_deg`.
    #[must_use]
    pub fn place_of(&self, setting: &str) -> Option<Range<usize>> {
        self.places.get(setting).cloned()
    }

    /// The rules in their order, and last `reward` if the script has `fn reward`.
    #[must_use]
    pub fn rules(&self) -> &[RuleText] {
        &self.rules
    }

    /// What it says, for whoever looks for mistakes in it.
    #[must_use]
    pub fn outline(&self) -> &Outline {
        &self.outline
    }

    /// What a rule adds whenever it fires; nothing if that depends on the step, as with `fn reward`.
    #[must_use]
    pub fn fixed_value(&self, rule: usize) -> Option<f64> {
        self.loaded.rules.get(rule)?.fixed_value()
    }

    /// A judge with fresh counters, for one seed; `period_s` is the time between two steps, in seconds.
    ///
    /// # Errors
    /// If a rule names a beam that a laser with `beams` beams does not have.
    pub fn judge(&self, period_s: f64, beams: usize) -> Result<Judge> {
        self.loaded.check_beams(beams)?;
        Ok(self.unchecked_judge(period_s, beams))
    }

    /// The same for rules that may name beams that there are not: these must not be judged.
    pub(super) fn unchecked_judge(&self, period_s: f64, beams: usize) -> Judge {
        Judge::new(Arc::clone(&self.loaded), period_s, beams)
    }

    pub(super) fn loaded(&self) -> &Loaded {
        &self.loaded
    }
}

impl Loaded {
    /// Checks that every beam that is named exists.
    ///
    /// # Errors
    /// For each that does not.
    pub(super) fn check_beams(&self, beams: usize) -> Result<()> {
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
    pub(super) fn check_cells(&self, (rows, columns): (usize, usize)) -> Result<()> {
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
        let source = &self.code.source;
        let mut mistakes = Mistakes::new(source);
        for (position, message, found) in wrong {
            mistakes.add(explain::mistake(source, "E-SCRIPT-FACT", position, message, found));
        }
        mistakes.end()
    }
}

/// The value of one top-level variable.
pub(super) fn variable(constants: &Scope<'_>, index: usize) -> Option<(String, Dynamic)> {
    constants.iter().nth(index).map(|(name, _, value)| (name.to_owned(), value))
}
