//! A recorded run under another reward: what every rule would have said, and what would have been learned from it.
//!
//! The recorded steps stay as they are: the robot did not know the new reward. Learning again is the run's own learner,
//! led along the recorded states and actions in their order. So the same script gives the stored table bit for bit, and
//! whatever changes is the reward's doing. To draw more out of the steps, `passes` goes over them again and again; this is
//! one-step Q-learning, for both rewards, because traces credit what a policy did, and repeated over steps that no policy
//! answers for any more they diverge: 30 passes of the paper's learner over a run of the wall ended at values of 1e12.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::choosers::Learns;
use super::cycle::Witnessed;
use super::legs::first_fixed_difference;
use super::relay::UsedDrivers;
use super::{Chooser, Ledger, Phase, Plan, Playback, Step};
use crate::diagnostic::{Diagnostic, Result, printable};
use crate::learner::{Learner, Policy, Transition, shipped_learner};
use crate::script::Behaviour;
use crate::settings::{LearnerKind, SETTINGS, apply};

/// One rule over a whole run.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct RuleScore {
    /// How often it fired.
    pub fired: u64,
    /// Sum of what it added.
    pub total: f64,
}

/// One rule before and after.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct RuleChange {
    /// Its name.
    pub name: String,
    /// In the recorded run; null if the old script has no rule of this name.
    pub before: Option<RuleScore>,
    /// Under the new script; null if that has no rule of this name.
    pub after: Option<RuleScore>,
}

/// A recorded run under another reward.
#[derive(Debug, Clone)]
pub struct Rescored {
    /// Rules of both scripts, those of the new one first.
    pub rules: Vec<RuleChange>,
    /// Sum of the rewards as recorded.
    pub reward_before: f64,
    /// Sum of the rewards under the new script.
    pub reward_after: f64,
    /// Steps whose reward changes.
    pub steps_changed: u64,
    /// Steps in which only the new script asks for recovery; the recorded robot went on from there.
    pub new_recoveries: u64,
    /// Steps in which only the old script asked for recovery.
    pub old_recoveries: u64,
    /// Steps after which the new script would hand the robot to another policy, or to none; who drove in the record drives on.
    pub other_hands: u64,
    /// What the old reward teaches.
    pub policy_before: Policy,
    /// What the new reward teaches.
    pub policy_after: Policy,
    /// By state and action: how often the recorded run did it.
    tries: BTreeMap<(usize, usize), u64>,
}

impl Rescored {
    /// How often the recorded run took an action in a state.
    #[must_use]
    pub fn tries(&self, state: usize, action: usize) -> u64 {
        self.tries.get(&(state, action)).copied().unwrap_or(0)
    }

    /// How often the recorded run chose in a state.
    #[must_use]
    pub fn visits(&self, state: usize) -> u64 {
        (0..self.policy_before.actions()).map(|action| self.tries(state, action)).sum()
    }

    /// The states whose best action changes, the most visited first.
    #[must_use]
    pub fn changed_states(&self) -> Vec<usize> {
        let best = |policy: &Policy, state| policy.best(state).map(|(action, _)| action);
        let met = |state: &usize| self.policy_before.is_met(*state) || self.policy_after.is_met(*state);
        let states = self.policy_before.rows().chain(self.policy_after.rows()).map(|(state, _)| state).filter(met);
        let mut changed: Vec<usize> =
            states.filter(|state| best(&self.policy_before, *state) != best(&self.policy_after, *state)).collect();
        changed.sort_by_key(|state| (std::cmp::Reverse(self.visits(*state)), *state));
        changed.dedup();
        changed
    }
}

/// The plan of a recorded run with the rules of another script.
///
/// # Errors
/// `E-RESCORE` if the scripts differ in what the recorded run saw or did, so that its steps say nothing about the other.
pub fn plan_with_rules_of(plan: &Plan, behaviour: Arc<Behaviour>) -> Result<Plan> {
    let (old, new) = (plan.behaviour.settings(), behaviour.settings());
    let mut settings = plan.settings.clone();
    if let Some((what, place)) = first_fixed_difference(old, new) {
        return other(&behaviour, &what, &place).fail();
    }
    if plan.behaviour.hands_over() != behaviour.hands_over() || behaviour.always_hands_over() {
        return other(&behaviour, "who drives", "policy:0").fail();
    }
    for row in SETTINGS.iter().filter(|row| row.group == "learner" && (row.get)(old) != (row.get)(new)) {
        let value = (row.get)(new);
        if apply(&mut settings, row.group, row.key, &value).is_err() {
            return other(&behaviour, &row.name(), &row.name()).fail();
        }
    }
    let new = Plan::with_worlds(behaviour, settings, plan.worlds.clone(), Arc::clone(&plan.filters))?;
    Ok(Plan { origins: plan.origins.clone(), ..new }.with_used(plan.used.clone()))
}

fn other(behaviour: &Behaviour, what: &str, place: &str) -> Diagnostic {
    let message = format!("'{}' sets {what} otherwise than the recorded run did", printable(behaviour.name()));
    let error = Diagnostic::new("E-RESCORE", message)
        .help("a record can be judged again, not seen again: change rules only, or learn anew with engine run");
    match behaviour.place_of(place) {
        Some(span) => error.at(behaviour.source(), span, "the recorded run had something else"),
        None => error,
    }
}

/// Judges the learning steps of a recorded run by the rules of `new`, and learns both rewards again from these steps: with
/// the run's own learner in one pass, with one-step Q-learning in more.
///
/// # Errors
/// If the run cannot be played, or the new script fails on its facts.
pub fn rescore(plan: &Plan, new: &Plan, seed: u64, ledger: &Ledger, passes: u64) -> Result<Rescored> {
    let mut playback = Playback::judged_by(plan, seed, Phase::Learning, ledger, Some(new))?;
    let mut scores = [
        vec![RuleScore::default(); plan.behaviour.rules().len()],
        vec![RuleScore::default(); new.behaviour.rules().len()],
    ];
    let mut judged: [Vec<Step>; 2] = [Vec::with_capacity(ledger.len()), Vec::with_capacity(ledger.len())];
    let mut other_hands = 0;
    while let Some(step) = playback.advance()? {
        let cycle = playback.cycle();
        let Some((witness, said)) = cycle.witness().and_then(|witness| Some((witness, witness.last()?))) else { break };
        let policies = [(plan, cycle.driver()), (new, said.driver)].map(|(plan, by)| policy_of(plan, by));
        other_hands += u64::from(!step.moves() && policies[0] != policies[1]);
        for (scores, fired) in scores.iter_mut().zip([cycle.fired(), witness.fired()]) {
            for (score, value) in scores.iter_mut().zip(fired) {
                score.fired += u64::from(value.is_some());
                score.total += value.unwrap_or(0.0);
            }
        }
        judged[0].push(step);
        judged[1].push(under_other_rules(&step, &said));
    }
    let [before, after] = judged;
    let pairs = || before.iter().zip(&after);
    let count = |is: fn((&Step, &Step)) -> bool| pairs().filter(|pair| is(*pair)).count() as u64;
    let sum = |steps: &[Step]| steps.iter().map(|step| step.reward).sum();
    Ok(Rescored {
        rules: rule_changes(plan, new, &scores),
        reward_before: sum(&before),
        reward_after: sum(&after),
        steps_changed: count(|(old, new)| old.reward != new.reward),
        new_recoveries: count(|(old, new)| old.then.is_none() && new.then.is_some()),
        old_recoveries: count(|(old, new)| old.then.is_some() && new.then.is_none()),
        other_hands,
        policy_before: learn_along(plan, seed, &before, passes)?,
        policy_after: learn_along(new, seed, &after, passes)?,
        tries: tries(ledger),
    })
}

/// A recorded step with what other rules say of it: the robot is put elsewhere where it was in the record.
fn under_other_rules(step: &Step, said: &Witnessed) -> Step {
    let Transition { reward, potential, next_potential, next_allowed, .. } = said.transition;
    Step { reward, then: said.then, potential, next_potential, next_allowed, hop: step.moves(), ..*step }
}

/// The policy that a use hands the robot to, by its place among those of the script.
fn policy_of(plan: &Plan, by: Option<usize>) -> Option<usize> {
    plan.behaviour.uses().nth(by?).map(|(_, policy)| policy)
}

fn rule_changes(old: &Plan, new: &Plan, scores: &[Vec<RuleScore>; 2]) -> Vec<RuleChange> {
    let find = |plan: &Plan, scores: &[RuleScore], name: &str| {
        let index = plan.behaviour.rules().iter().position(|rule| rule.name == name)?;
        scores.get(index).copied()
    };
    let names = new.behaviour.rules().iter().chain(old.behaviour.rules()).map(|rule| rule.name.as_str());
    let mut rules: Vec<RuleChange> = Vec::new();
    for name in names {
        if !rules.iter().any(|rule| rule.name == name) {
            let (before, after) = (find(old, &scores[0], name), find(new, &scores[1], name));
            rules.push(RuleChange { name: name.to_owned(), before, after });
        }
    }
    rules
}

/// What a plan's learner learns when it is led along recorded steps once; one-step Q-learning over more passes.
fn learn_along(plan: &Plan, seed: u64, steps: &[Step], passes: u64) -> Result<Policy> {
    let mut settings = plan.settings.learner.clone();
    if passes > 1 {
        settings.kind = LearnerKind::Q;
        settings.replay = 0;
    }
    let map = plan.state_map()?;
    // What a run had learned that this one goes on from, it knows here too.
    let mut learner = match passes {
        1 => plan.first_learner(&*map, seed)?,
        _ => shipped_learner(&settings, plan.task(&*map, seed)?),
    };
    let mut used = UsedDrivers::new(plan, seed);
    for _ in 0..passes {
        for step in steps {
            if step.driver.is_none() {
                learner.visit(step.state);
            }
            used.with(Learns(&mut learner)).learn(step);
            // What follows does not follow from this step if the robot was put elsewhere.
            if step.moves() {
                learner.forget();
            }
        }
        used.settle(&mut Learns(&mut learner));
        learner.forget();
    }
    Ok(learner.policy())
}

fn tries(ledger: &Ledger) -> BTreeMap<(usize, usize), u64> {
    let mut tries = BTreeMap::new();
    // What used policies chose was no choice of the script's own.
    for record in ledger.records().filter(|record| record.driver.is_none()) {
        *tries.entry((record.state as usize, usize::from(record.action))).or_default() += 1;
    }
    tries
}
