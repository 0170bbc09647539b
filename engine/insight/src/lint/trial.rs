//! A few thousand steps, with what each rule did in them: chosen at random, then while learning.

use std::sync::atomic::AtomicBool;

use engine::diagnostic::Result;
use engine::experiment::{ByState, Cycle, Each, Ledger, Plan, Step, TestRun, in_parallel, learn_into, test_choices};
use engine::judge::{FactId, FactRead};
use engine::learner::Policy;
use engine::outcome::Ending;
use engine::random::{Random, Stream};
use engine::robot::Robot;
use engine::settings::LearnerKind;
use engine::state::MAX_STATES;

/// Steps with actions at random.
pub(super) const RANDOM_STEPS: u64 = 1_000;
/// Steps of learning.
const LEARNING_STEPS: u64 = 2_400;
/// The seed of all trials.
pub(super) const SEED: u64 = 0x11_47;

/// One step of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialStep {
    /// The state in which the action was chosen.
    pub state: usize,
    /// The action.
    pub action: usize,
    /// The reward.
    pub reward: f64,
    /// Whether the robot was brought back.
    pub recover: bool,
    /// How the attempt ended, if it did.
    pub ending: Option<Ending>,
    /// Whether the body touched something.
    pub contact: bool,
    /// The state in which the next action was chosen, after any recovery; nothing after the last step.
    pub next: Option<usize>,
}

/// What one rule did.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RuleTrial {
    /// Steps in which it fired.
    pub fired: u64,
    /// Steps in which no earlier rule recovered, so that it was asked.
    pub reached: u64,
    /// Steps in which its condition was looked at, and of these those in which it held.
    pub looked: u64,
    pub held: u64,
    /// Steps in which it held but an earlier rule recovered.
    pub forestalled: u64,
    /// The longest time for which it held, steps.
    pub longest: u64,
    /// The greatest value that it added, either way.
    pub largest: f64,
    /// The least and the greatest value that it added; nothing if it never fired.
    pub values: Option<(f64, f64)>,
    /// The sum of what it added.
    pub total: f64,
    /// What its condition read.
    pub facts: Vec<FactTrial>,
    now: u64,
}

/// What one fact was in the steps in which a rule was looked at.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FactTrial {
    /// As it stands in the script.
    pub name: String,
    /// Nothing for what was calibrated.
    pub id: Option<FactId>,
    /// In words; empty for flags.
    pub unit: &'static str,
    pub least: f64,
    pub greatest: f64,
    /// Whether the part of the condition that reads it ever held.
    pub held: bool,
}

impl From<FactRead> for FactTrial {
    fn from(FactRead { name, id, unit, value, .. }: FactRead) -> Self {
        Self { name, id, unit, least: value, greatest: value, held: false }
    }
}

/// What one drive left.
#[derive(Debug, Clone)]
pub(super) struct TrialDrive {
    pub run: TestRun,
    pub steps: Vec<TrialStep>,
    pub rules: Vec<RuleTrial>,
}

/// Steps that were tried.
#[derive(Debug, Clone)]
pub struct LintTrial {
    /// All steps, drive after drive.
    pub transitions: Vec<TrialStep>,
    /// What the short learning came to.
    pub(super) learned: Option<Policy>,
    pub(super) rules: Vec<RuleTrial>,
}

impl LintTrial {
    /// Drives at random and learns for a while, both at once; both end early once `stop` is set.
    ///
    /// # Errors
    /// If a sensor, a filter or the script fails.
    pub fn run(plan: &Plan, threads: usize, stop: &AtomicBool) -> Result<Self> {
        // In so few steps a table tries more than a learner that remembers, and to try is what this is for.
        let mut by_table = plan.clone();
        by_table.settings.learner.kind = LearnerKind::Ttd;
        let remembers = plan.settings.learner.kind == LearnerKind::Memory;
        let both = remembers && plan.state_map()?.states() <= MAX_STATES;
        let kinds: &[u64] = if both { &[0, 1, 2] } else { &[0, 2] };
        let drives = in_parallel(kinds, threads, |kind| match kind {
            0 => random(plan, stop).map(|drive| (drive.steps, drive.rules, None)),
            1 => learning(&by_table, stop).map(|(steps, rules, policy)| (steps, rules, Some(policy))),
            _ => learning(plan, stop).map(|(steps, rules, policy)| (steps, rules, Some(policy))),
        })?;
        let rules = vec![RuleTrial::default(); plan.behaviour.rules().len()];
        let mut trial = Self { transitions: Vec::new(), learned: None, rules };
        for (steps, rules, policy) in drives {
            trial.add(&steps, &rules);
            trial.learned = trial.learned.or(policy);
        }
        Ok(trial)
    }

    /// How many steps were tried.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.transitions.len() as u64
    }

    /// The steps with actions at random.
    pub(super) fn random(&self) -> &[TrialStep] {
        self.transitions.get(..RANDOM_STEPS as usize).unwrap_or_default()
    }

    /// Adds one more drive.
    pub(super) fn add(&mut self, steps: &[TrialStep], rules: &[RuleTrial]) {
        self.transitions.extend_from_slice(steps);
        for (sum, rule) in self.rules.iter_mut().zip(rules) {
            sum.merge(rule);
        }
    }
}

impl RuleTrial {
    fn merge(&mut self, other: &Self) {
        self.fired += other.fired;
        self.total += other.total;
        self.reached += other.reached;
        self.looked += other.looked;
        self.held += other.held;
        self.forestalled += other.forestalled;
        self.longest = self.longest.max(other.longest);
        if other.largest.abs() > self.largest.abs() {
            self.largest = other.largest;
        }
        if let Some((least, greatest)) = other.values {
            self.range(least, greatest);
        }
        for fact in &other.facts {
            self.read(fact.clone());
        }
    }

    fn range(&mut self, least: f64, greatest: f64) {
        let (low, high) = self.values.unwrap_or((least, greatest));
        self.values = Some((low.min(least), high.max(greatest)));
    }

    pub(super) fn read(&mut self, read: FactTrial) {
        match self.facts.iter_mut().find(|fact| fact.name == read.name) {
            Some(fact) => {
                fact.least = fact.least.min(read.least);
                fact.greatest = fact.greatest.max(read.greatest);
                fact.held |= read.held;
            }
            None => self.facts.push(read),
        }
    }

    fn fire(&mut self, value: f64) {
        self.fired += 1;
        self.total += value;
        self.range(value, value);
        if value.abs() > self.largest.abs() {
            self.largest = value;
        }
    }
}

/// Drives by `choose` for some steps, with a look at every rule in each.
pub(super) fn drive(
    plan: &Plan,
    steps: u64,
    seed: u64,
    stop: &AtomicBool,
    choose: impl FnMut(usize) -> usize,
) -> Result<TrialDrive> {
    let mut plan = plan.clone();
    plan.settings.run.test_steps = steps;
    let recovers: Vec<bool> = plan.behaviour.outline().rules.iter().map(|rule| rule.then.is_some()).collect();
    let mut rules = vec![RuleTrial::default(); plan.behaviour.rules().len()];
    let mut kept: Vec<TrialStep> = Vec::with_capacity(steps as usize);
    let mut watch = Each(|cycle: &Cycle<_>, step: &Step| {
        if let Some(last) = kept.last_mut() {
            last.next = Some(step.state);
        }
        let (Step { state, action, reward, contact, .. }, recover) = (*step, step.then.is_some());
        kept.push(TrialStep { state, action, reward, recover, ending: step.ending(), contact, next: None });
        look(cycle, recover, &recovers, &mut rules);
    });
    let run = test_choices(&plan, seed, stop, &mut ByState(choose), &mut watch)?;
    Ok(TrialDrive { run, steps: kept, rules })
}

/// Notes what every rule did in a step.
fn look<R: Robot>(cycle: &Cycle<R>, recovered: bool, recovers: &[bool], rules: &mut [RuleTrial]) {
    let (judge, mut forestalled) = (cycle.judge(), false);
    for (index, (rule, fired)) in rules.iter_mut().zip(cycle.fired()).enumerate() {
        rule.reached += u64::from(!forestalled);
        if let Some(value) = fired {
            rule.fire(*value);
        }
        let Some(recovering) = recovers.get(index) else { continue };
        rule.looked += 1;
        if judge.holds(index) {
            rule.held += 1;
            rule.now += 1;
            rule.longest = rule.longest.max(rule.now);
            rule.forestalled += u64::from(forestalled);
        } else {
            rule.now = 0;
        }
        if recovered {
            rule.now = 0;
        }
        forestalled |= *recovering && fired.is_some();
        // A rule that fires needs no explanation.
        if rule.fired == 0 {
            for part in judge.evidence(index) {
                let held = part.holds == Some(true);
                part.facts.into_iter().for_each(|fact| rule.read(FactTrial { held, ..fact.into() }));
            }
        }
    }
}

fn random(plan: &Plan, stop: &AtomicBool) -> Result<TrialDrive> {
    let (mut random, actions) = (Random::new(SEED, Stream::Test), plan.settings.actions.len() as u32);
    drive(plan, RANDOM_STEPS, SEED, stop, |_| random.below(actions) as usize)
}

fn learning(plan: &Plan, stop: &AtomicBool) -> Result<(Vec<TrialStep>, Vec<RuleTrial>, Policy)> {
    let mut plan = plan.clone();
    plan.settings.run.steps = LEARNING_STEPS;
    let mut ledger = Ledger::new(&plan, LEARNING_STEPS);
    let learned = learn_into(&plan, SEED, stop, &|_| (), &mut ledger)?;
    let mut rules = vec![RuleTrial::default(); plan.behaviour.rules().len()];
    let recovers: Vec<bool> = plan.behaviour.outline().rules.iter().map(|rule| rule.then.is_some()).collect();
    let mut steps: Vec<TrialStep> = Vec::with_capacity(ledger.len());
    for (index, record) in ledger.records().enumerate() {
        let (state, action) = (record.state as usize, usize::from(record.action));
        if let Some(last) = steps.last_mut() {
            last.next = Some(state);
        }
        let (reward, recover, contact) = (record.reward, record.then.is_some(), record.contact);
        let ending = record.then.map(|then| then.ending(reward));
        steps.push(TrialStep { state, action, reward, recover, ending, contact, next: None });
        let mut asked = rules.len();
        for (rule, value) in ledger.fired(index) {
            rules[rule].fire(value);
            if recovers.get(rule) == Some(&true) {
                asked = rule + 1;
            }
        }
        rules.iter_mut().take(asked).for_each(|rule| rule.reached += 1);
    }
    Ok((steps, rules, learned.policy))
}
