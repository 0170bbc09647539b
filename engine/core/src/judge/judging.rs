//! One run's judging: refilled facts in, one judgement for each step out.

mod shown;

use super::budget;
use super::compiled::{CompiledScript, Look};
use super::evaluate::{Judgement, Present};
use super::facts::{Facts, NO_ACTION, StageFacts};
use super::guards::{Guarding, Leave};
use super::judged_world::JudgedWorld;
use super::memory::Memory;
use super::odometry::Odometry;
use super::readings::PartRead;
use super::sandbox::MAX_OPERATIONS;
use super::uses;
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::Twist;
use crate::outcome::Destination;
use crate::settings::ScanFan;
use std::sync::Arc;

/// One run's judging of a behaviour: counters, and what was calibrated.
#[derive(Debug)]
pub struct Judge {
    pub(super) present: Present,
    beams: usize,
    /// For each rule, how many steps its condition must hold.
    needed: Vec<u32>,
    pub(super) held: Vec<u32>,
    /// For each rule, what a step in which its condition holds builds up: its fixed value over the steps that it needs.
    built_up: Vec<f64>,
    /// For each rule, what its value is multiplied by: the period, where it is for one second.
    scale: Vec<f64>,
    /// For each rule that fires once, whether it has fired and its condition has held ever since.
    pub(super) spent: Vec<bool>,
    fired: Vec<Option<f64>>,
    /// For each rule, where the next attempt begins after it.
    destinations: Vec<Option<Destination>>,
    period_s: f64,
    pub(super) stage: StageNow,
    pub(super) odometry: Odometry,
    /// Parts of the state.
    pub(super) digits: Vec<usize>,
    /// Whether the present facts are complete and remembered.
    pub(super) is_taken: bool,
    /// Whether they become those of the step before when others are filled in.
    pub(super) is_past: bool,
    /// What guards take away of the actions.
    guarding: Guarding,
    /// What was made for each world; of the present one it is above.
    pub(super) elsewhere: Vec<JudgedWorld>,
    world: usize,
}

/// The present stage, and what the wheels had counted when it was entered.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct StageNow {
    pub(super) index: usize,
    pub(super) steps: u64,
    pub(super) distance_m: f64,
    pub(super) turned_rad: f64,
}

impl Judge {
    pub(crate) fn new(compiled: Arc<CompiledScript>, period_s: f64, fan: ScanFan) -> Self {
        let needed: Vec<u32> = compiled.rules.iter().map(|rule| rule.persistence.steps(period_s)).collect();
        let entries = needed.len() + usize::from(compiled.reward.is_some());
        let scale: Vec<f64> = compiled.rules.iter().map(|rule| if rule.per_second { period_s } else { 1.0 }).collect();
        let facts =
            Arc::new(Facts { ranges_m: vec![0.0; fan.beams], laser_view_deg: fan.view_deg, ..Facts::default() });
        let calibrated = compiled.calibrate.is_none().then(Arc::default);
        let (held, fired) = (vec![0; needed.len()], vec![None; entries]);
        let built_up = compiled.rules.iter().zip(&needed).map(|(rule, needed)| match rule.fixed_value() {
            Some(value) if *needed > 1 && rule.per_second => value * period_s / f64::from(*needed),
            Some(value) if *needed > 1 => value / f64::from(*needed),
            _ => 0.0,
        });
        let built_up = built_up.collect();
        let memory = Memory::new(&compiled.remembered, entries, period_s);
        let (previous, spent) = (Arc::clone(&facts), vec![false; needed.len()]);
        let present = Present { compiled, facts, previous, memory, calibrated, slots: Vec::new(), starts: None };
        let (stage, odometry) = (StageNow::default(), Odometry::default());
        let digits = vec![0; present.compiled.bins.len() + usize::from(!present.compiled.stages.is_empty())];
        Self {
            present,
            beams: fan.beams,
            needed,
            held,
            built_up,
            scale,
            spent,
            fired,
            destinations: Vec::new(),
            period_s,
            stage,
            odometry,
            digits,
            is_taken: false,
            is_past: false,
            guarding: Guarding::default(),
            elsewhere: Vec::new(),
            world: 0,
        }
    }

    /// This judge with guards over these actions, the first `own` of which are the script's; without, they take nothing away.
    #[must_use]
    pub(crate) fn with_actions(mut self, actions: &[Twist], own: usize) -> Self {
        self.guarding = Guarding::new(&self.present.compiled.guards, actions, own);
        self
    }

    /// The use that holds in the facts that were judged last, by its place in the script. Allocates nothing.
    #[must_use]
    pub(crate) fn driver(&self) -> Option<usize> {
        uses::first_that_holds(&self.present.compiled.uses, self.stage.index, self.present.inputs())
    }

    /// What the condition of a use reads in the present facts, part by part.
    pub(crate) fn use_evidence(&self, index: usize) -> Vec<PartRead> {
        let parts = self.present.compiled.uses.get(index).map_or(&[][..], |one| &one.parts);
        parts.iter().map(|part| part.evidence(self.present.inputs())).collect()
    }

    /// What guards leave in the facts that were judged last. Allocates nothing.
    #[must_use]
    pub(crate) fn leave(&self) -> Leave {
        self.guarding.leave(&self.present.compiled.guards, self.present.inputs())
    }

    /// What guards take away.
    pub(crate) fn guarding(&self) -> &Guarding {
        &self.guarding
    }

    /// The judge in worlds whose starts have these names, now in the first of them.
    #[must_use]
    pub(crate) fn in_worlds(mut self, worlds: impl Iterator<Item = Vec<String>>) -> Self {
        self.elsewhere = worlds.map(|starts| JudgedWorld::new(&self.present.compiled, starts)).collect();
        self.swap_world();
        self
    }

    /// From here on in another of its worlds: what was calibrated there is known again. Allocates nothing.
    pub(crate) fn go_to(&mut self, world: usize) {
        if world != self.world {
            self.swap_world();
            self.world = world;
            self.swap_world();
        }
    }

    fn swap_world(&mut self) {
        if let Some(other) = self.elsewhere.get_mut(self.world) {
            other.swap(&mut self.destinations, &mut self.present);
        }
    }

    /// Whether `fn calibrate` has run in this world, if there is one.
    #[must_use]
    pub(crate) fn is_calibrated(&self) -> bool {
        self.present.calibrated.is_some()
    }

    /// The facts of the last step.
    #[must_use]
    pub fn facts(&self) -> &Facts {
        &self.present.facts
    }

    /// The measurements of the present step, to be refilled in place.
    pub fn facts_mut(&mut self) -> &mut Facts {
        self.is_taken = false;
        if std::mem::take(&mut self.is_past) && self.present.compiled.looks_back {
            std::mem::swap(&mut self.present.facts, &mut self.present.previous);
        }
        // No script value outlives its step, so that this never copies.
        Arc::make_mut(&mut self.present.facts)
    }

    /// Runs `fn calibrate(facts)` on the present facts, if there is one; rules read its result as `calibrated`.
    ///
    /// # Errors
    /// If it fails, or its result is not what the rules need.
    pub fn calibrate(&mut self) -> Result<()> {
        budget::refill(MAX_OPERATIONS);
        self.present.calibrate()
    }

    /// Judges the present facts.
    ///
    /// # Errors
    /// If the script fails or is stopped, or a value is not a finite number: in its line of the script.
    pub fn judge(&mut self) -> Result<Judgement> {
        self.take()?;
        self.is_taken = false;
        budget::refill(MAX_OPERATIONS);
        let judgement = self.rules()?;
        if let Some(stage) = judgement.stage {
            self.enter(stage);
        }
        Ok(judgement)
    }

    /// Completes the present facts, and takes what is remembered of them; once for each step, before the rules.
    ///
    /// # Errors
    /// If the facts do not fit the script.
    pub fn take(&mut self) -> Result<()> {
        self.check_facts()?;
        if std::mem::replace(&mut self.is_taken, true) {
            return Ok(());
        }
        self.is_past = true;
        let Self { present, stage, odometry, period_s, digits, .. } = self;
        let facts = Arc::make_mut(&mut present.facts);
        facts.attempt_s = facts.since_recovery as f64 * *period_s;
        if !present.compiled.remembers() {
            present.memory.age();
            return Ok(());
        }
        let compiled = Arc::clone(&present.compiled);
        if compiled.counts_way && facts.action != NO_ACTION {
            odometry.advance(Twist::new(facts.linear_m_per_s, facts.angular_rad_per_s), *period_s);
        }
        if facts.action != NO_ACTION {
            stage.steps += 1;
            present.memory.age();
        }
        facts.odometry = *odometry;
        facts.stage = StageFacts {
            index: stage.index,
            steps: stage.steps,
            seconds: stage.steps as f64 * *period_s,
            distance_m: odometry.distance_m - stage.distance_m,
            turned_deg: (odometry.turned_rad - stage.turned_rad).to_degrees(),
        };
        for (index, remembered) in compiled.remembered.iter().enumerate() {
            let sample = remembered.sample(present.inputs());
            present.memory.take(index, sample, remembered);
        }
        for (digit, bins) in digits.iter_mut().zip(&compiled.bins) {
            *digit = bins.digit(present.inputs());
        }
        Ok(())
    }

    fn enter(&mut self, index: usize) {
        let Odometry { distance_m, turned_rad, .. } = self.odometry;
        self.stage = StageNow { index, steps: 0, distance_m, turned_rad };
        if let Some(digit) = self.digits.last_mut() {
            *digit = index;
        }
    }

    /// The number of the present stage; 0 in a script without stages.
    #[must_use]
    pub fn stage(&self) -> usize {
        self.stage.index
    }

    /// The parts of the state that the script works out: of each `bins` the number of the range, and last the stage, if it has
    /// stages.
    #[must_use]
    pub fn digits(&self) -> &[usize] {
        &self.digits
    }

    /// What the measures came to in the present facts, in their order.
    pub(crate) fn measures(&self) -> impl Iterator<Item = f64> {
        self.present.measures().map(|(index, _)| self.present.memory.value(index))
    }

    /// Whether anything of the script outlasts a step, so that the robot at rest must be looked at too.
    #[must_use]
    pub fn remembers(&self) -> bool {
        self.present.compiled.remembers()
    }

    /// Whether the script reads what the ground looks like.
    #[must_use]
    pub fn reads_ground(&self) -> bool {
        self.present.compiled.reads_ground
    }

    /// Whether the script reads a fact of any view.
    pub(crate) fn reads_views(&self) -> bool {
        self.present.compiled.reads_views
    }

    /// What the script reads of each view besides its grid.
    #[must_use]
    pub fn looks(&self) -> &[Look] {
        &self.present.compiled.looks
    }

    fn rules(&mut self) -> Result<Judgement> {
        let Self { present, held, needed, scale, spent, fired, destinations, stage, .. } = self;
        fired.fill(None);
        let mut judgement = Judgement::default();
        let compiled = Arc::clone(&present.compiled);
        let rules = &compiled.rules;
        for (index, rule) in rules.iter().enumerate() {
            if !rule.is_in(stage.index) || !present.condition(rule)? {
                (held[index], spent[index]) = (0, false);
                continue;
            }
            if spent[index] {
                continue;
            }
            held[index] += 1;
            if held[index] < needed[index] {
                continue;
            }
            (held[index], spent[index]) = (0, rule.once);
            let value = present.value(rule)? * scale[index];
            if !value.is_finite() {
                return present.not_finite(&rule.shown(), value, rule.value_span.clone()).fail();
            }
            fired[index] = Some(value);
            present.memory.note_fired(index);
            judgement.reward += value;
            judgement.stage = judgement.stage.or(rule.to_stage);
            if rule.then.is_some() {
                judgement.then = rule.then;
                judgement.to = destinations.get(index).copied().flatten();
                return Ok(judgement);
            }
        }
        if let Some(span) = &present.compiled.reward {
            let own = present.reward(span)?;
            if !own.reward.is_finite() {
                return present.not_finite("'fn reward'", own.reward, span.clone()).fail();
            }
            fired[rules.len()] = Some(own.reward);
            present.memory.note_fired(rules.len());
            judgement.stage = judgement.stage.or(own.stage);
            judgement.reward += own.reward;
            (judgement.then, judgement.to) = (own.then, own.to);
        }
        Ok(judgement)
    }

    /// The robot has been brought back: every persistence starts again, and all that was remembered is forgotten.
    pub fn recovered(&mut self) {
        self.held.fill(0);
        self.spent.fill(false);
        self.present.memory.forget();
        (self.stage, self.odometry) = (StageNow::default(), Odometry::default());
        self.digits.fill(0);
    }

    /// What the rules that must hold for a time have built up: the sum of each one's fixed value times the share of the time
    /// for which it has held.
    #[must_use]
    pub fn potential(&self) -> f64 {
        self.held.iter().zip(&self.built_up).map(|(held, value)| f64::from(*held) * value).sum()
    }

    fn check_facts(&self) -> Result<()> {
        let wrong = |message: String| Diagnostic::new("E-REWARD-FACTS", message);
        if self.present.facts.ranges_m.len() != self.beams {
            let message =
                format!("the judge was made for {} beams, found {}", self.beams, self.present.facts.ranges_m.len());
            return wrong(message).fail();
        }
        if self.present.calibrated.is_none() {
            return wrong("the script has not been calibrated yet".to_owned()).fail();
        }
        self.present.compiled.check_cells(|view| self.present.facts.view(view).grid)
    }

    pub(crate) fn present(&self) -> &Present {
        &self.present
    }
}
