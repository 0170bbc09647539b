//! A script, loaded and checked.

use super::guards;
use super::outline::ScriptOutline;
use super::params::{Param, ParamValues};
use super::setup::SettingPlaces;
use crate::allowed::Allowed;
use crate::diagnostic::{Mistakes, Result, SourceText};
use crate::geometry::Twist;
use crate::judge::compiled::CompiledScript;
use crate::judge::memory::Remembered;
use crate::judge::rule::CompiledRule;
use crate::judge::uses::CompiledUse;
use crate::judge::{FactId, Judge, RuleText, reach};
use crate::outcome::Then;
use crate::settings::{Edition, LaserSettings, RunSettings, ScanFan, Settings};
use crate::verdict::{Endable, OwnWord, Success, SuccessCondition};
use std::ops::Range;
use std::sync::Arc;

/// A script, loaded and checked; shared by all seeds.
#[derive(Debug)]
pub struct Behaviour {
    name: String,
    settings: Settings,
    places: SettingPlaces,
    rules: Vec<RuleText>,
    outline: ScriptOutline,
    compiled: Arc<CompiledScript>,
    success: Vec<SuccessCondition>,
    endable: Endable,
    body: Option<SourceText>,
    params: Vec<Param>,
    edition: Edition,
}

impl Behaviour {
    pub(super) fn new(
        name: &str,
        settings: Settings,
        places: SettingPlaces,
        outline: ScriptOutline,
        compiled: CompiledScript,
    ) -> Self {
        let mut rules: Vec<RuleText> = compiled.rules.iter().map(|rule| rule.text.clone()).collect();
        let source = &compiled.source;
        rules.extend(compiled.reward.clone().map(|span| {
            let (line, _) = source.position(span.start);
            let text = source.text[source.line_range(line)].trim().to_owned();
            RuleText { name: "reward".to_owned(), line, text }
        }));
        let stages = !compiled.stages.is_empty();
        let contact_pays = pays_for_contact(&compiled.rules, &outline);
        let endable = Endable { stages, contact_pays, ..endable(&compiled.rules, outline.reward_recovers) };
        let compiled = Arc::new(compiled);
        let mut settings = settings;
        let restarts = compiled.rules.iter().any(|rule| rule.then == Some(Then::Restart));
        // An attempt that ends by itself is not broken off.
        if !places.contains_key("run.stay_steps") && (endable.goal || restarts) {
            settings.run.stay_steps = 0;
        }
        Self {
            name: name.to_owned(),
            settings,
            places,
            rules,
            outline,
            compiled,
            success: Vec::new(),
            endable,
            body: None,
            params: Vec::new(),
            edition: Edition::NEWEST,
        }
    }

    pub(super) fn with_success(self, success: Vec<SuccessCondition>, own: OwnWord) -> Self {
        Self { success, endable: Endable { own, ..self.endable }, ..self }
    }

    pub(super) fn with_body(self, body: Option<SourceText>) -> Self {
        Self { body, ..self }
    }

    /// The file of the body that it names, if it names one.
    #[must_use]
    pub fn body(&self) -> Option<&SourceText> {
        self.body.as_ref()
    }

    pub(super) fn with_params(self, params: Vec<Param>) -> Self {
        Self { params, ..self }
    }

    pub(super) fn of_edition(self, edition: Edition) -> Self {
        Self { edition, ..self }
    }

    /// The edition whose defaults it has.
    #[must_use]
    pub fn edition(&self) -> Edition {
        self.edition
    }

    /// The numbers that may be set from outside, in their order.
    #[must_use]
    pub fn params(&self) -> &[Param] {
        &self.params
    }

    /// The value of each of them.
    #[must_use]
    pub fn param_values(&self) -> ParamValues {
        self.params.iter().map(|param| (param.name.clone(), param.value)).collect()
    }

    /// What is called success in a world with a lap route or without one, in a test of so many steps.
    #[must_use]
    pub fn success(&self, has_route: bool, run: &RunSettings) -> Success {
        Success::new(&self.success, self.endable, has_route, run)
    }

    /// Its own conditions of success.
    pub(super) fn conditions(&self) -> &[SuccessCondition] {
        &self.success
    }

    /// The names of its measures, in their order.
    pub fn measures(&self) -> impl Iterator<Item = &str> {
        self.compiled.remembered.iter().filter_map(|remembered| match remembered {
            Remembered::Measure(measure) => Some(measure.name.as_str()),
            _ => None,
        })
    }

    /// Adds every rule that can never fire, and every guard and use that can never hold, with this laser, on a floor at most `drop_m` metres below the robot's own
    /// ground (infinite where that is not known), unless there is a mistake in its condition already.
    pub(crate) fn find_unreachable(&self, laser: &LaserSettings, drop_m: f64, mistakes: &mut Mistakes) {
        let (limits, source) = (reach::Limits::new(laser, drop_m), self.source());
        for rule in &self.compiled.rules {
            if !mistakes.within(source, &rule.condition_span) {
                mistakes.take(reach::check_rule(source, rule, &limits));
            }
        }
        for guard in &self.compiled.guards {
            mistakes.take(reach::check_guard(source, guard, &limits));
        }
        for one in &self.compiled.uses {
            mistakes.take(reach::check_use(source, one, &limits));
        }
    }

    /// Whether it has a `fn calibrate`, which looks at what the robot sees first in each of its worlds.
    #[must_use]
    pub fn calibrates(&self) -> bool {
        self.compiled.calibrate.is_some()
    }

    /// Whether an attempt may end in a goal.
    #[must_use]
    pub fn has_goals(&self) -> bool {
        self.endable.goal
    }

    /// The name: the file's, without its ending.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    #[must_use]
    pub fn source(&self) -> &SourceText {
        &self.compiled.source
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
    pub fn outline(&self) -> &ScriptOutline {
        &self.outline
    }

    /// What a rule adds whenever it fires; nothing if that depends on the step, as with `fn reward`.
    #[must_use]
    pub fn fixed_value(&self, rule: usize) -> Option<f64> {
        self.compiled.rules.get(rule)?.fixed_value()
    }

    /// A judge with fresh counters, for one seed; `period_s` is the time between two steps, in seconds.
    ///
    /// # Errors
    /// If a rule names a beam or a bearing that such a laser does not have.
    pub(crate) fn judge(&self, period_s: f64, fan: ScanFan) -> Result<Judge> {
        self.compiled.check_beams(fan)?;
        Ok(self.unchecked_judge(period_s, fan))
    }

    /// Checks that each guard takes some of these actions away, and leaves some.
    ///
    /// # Errors
    /// For the first that does not.
    pub(crate) fn check_guards(&self, actions: &[Twist]) -> Result<()> {
        guards::check_actions(self.source(), &self.compiled.guards, actions, self.hands_over())
    }

    /// The guards in their order.
    pub fn guards(&self) -> impl Iterator<Item = &RuleText> {
        self.compiled.guards.iter().map(|guard| &guard.text)
    }

    /// Which of these actions each guard forbids while it holds, in the order of the guards.
    pub fn forbidden(&self, actions: &[Twist]) -> impl Iterator<Item = Allowed> {
        self.compiled.guards.iter().map(|guard| guard.forbidden(actions))
    }

    /// The uses of learned policies in their order, each with the place of its policy among those that the script names.
    pub fn uses(&self) -> impl Iterator<Item = (&RuleText, usize)> {
        self.compiled.uses.iter().map(|one| (&one.text, one.policy))
    }

    /// Whether its rules, measures or functions read a fact of any view.
    #[must_use]
    pub fn reads_views(&self) -> bool {
        self.compiled.reads_views
    }

    /// Whether it ever hands the robot over to a policy that was learned before.
    #[must_use]
    pub fn hands_over(&self) -> bool {
        self.compiled.written_uses > 0
    }

    /// Whether every use that is written is understood.
    #[must_use]
    pub(crate) fn knows_its_uses(&self) -> bool {
        self.compiled.uses.len() == self.compiled.written_uses
    }

    /// Whether one of its policies always drives, so that it has nothing of its own to learn.
    #[must_use]
    pub fn always_hands_over(&self) -> bool {
        self.compiled.uses.last().is_some_and(CompiledUse::is_always)
    }

    /// A judge for rules that may name beams that the laser does not have: these must not be judged.
    pub(super) fn unchecked_judge(&self, period_s: f64, fan: ScanFan) -> Judge {
        Judge::new(Arc::clone(&self.compiled), period_s, fan)
    }

    pub(super) fn compiled(&self) -> &CompiledScript {
        &self.compiled
    }
}

/// In which ways an attempt may end; what a function or a value that changes will say is not known here.
fn endable(rules: &[CompiledRule], by_function: bool) -> Endable {
    let may = |ending: Then, other_side: fn(f64) -> bool| {
        by_function
            || rules.iter().any(|rule| match rule.then {
                Some(Then::Recover) => !rule.fixed_value().is_some_and(other_side),
                then => then == Some(ending),
            })
    };
    let (failure, goal) = (may(Then::Fail, |value| value >= 0.0), may(Then::Goal, |value| value <= 0.0));
    Endable { failure, goal, ..Endable::default() }
}

/// Whether a rule gives something good for a contact.
fn pays_for_contact(rules: &[CompiledRule], outline: &ScriptOutline) -> bool {
    let pays = |rule: &CompiledRule| rule.fixed_value().is_some_and(|value| value > 0.0);
    rules
        .iter()
        .zip(&outline.rules)
        .any(|(rule, outline)| pays(rule) && outline.condition.asks_for(FactId::RobotContact))
}
