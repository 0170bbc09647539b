//! A script, loaded and checked.

use super::outline::Outline;
use super::setup::Places;
use crate::diagnostic::{Mistakes, Result, SourceText};
use crate::judge::loaded::Loaded;
use crate::judge::{Judge, RuleText, reach};
use crate::settings::{LaserSettings, Settings};
use std::ops::Range;
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

impl Behaviour {
    pub(super) fn new(name: &str, settings: Settings, places: Places, outline: Outline, loaded: Loaded) -> Self {
        let mut rules: Vec<RuleText> = loaded.rules.iter().map(|rule| rule.text.clone()).collect();
        let source = &loaded.source;
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
                mistakes.take(reach::check_rule(source, rule, &limits));
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
        &self.loaded.source
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

    /// A judge for rules that may name beams that the laser does not have: these must not be judged.
    pub(super) fn unchecked_judge(&self, period_s: f64, beams: usize) -> Judge {
        Judge::new(Arc::clone(&self.loaded), period_s, beams)
    }

    pub(super) fn loaded(&self) -> &Loaded {
        &self.loaded
    }
}
