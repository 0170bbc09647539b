//! Learning in legs: the reward was swapped while the robot learned, and the robot went on.
//!
//! A plan with earlier legs means: learn under these first, each for its steps, then under the plan itself. So all that
//! learns, replays or stores a plan does the swaps at the same steps again, bit for bit.

use super::Plan;
use crate::diagnostic::SourceText;
use crate::learner::Carry;
use crate::script::Behaviour;
use crate::settings::{LearnerKind, SETTINGS, Settings};
use std::sync::Arc;

/// A part of learning under one script, before the reward was swapped.
#[derive(Clone)]
pub struct Leg {
    /// Its script with its settings; it has no earlier legs.
    pub plan: Plan,
    /// Steps that were learned under it.
    pub steps: u64,
    /// What became of the table at its end.
    pub then: Carry,
}

impl Plan {
    /// This plan after these legs.
    #[must_use]
    pub fn after(self, earlier: Vec<Leg>) -> Self {
        Self { earlier, ..self }
    }

    /// This plan, with all that another one and its legs have in the same words shared with them: worlds, filters, the script.
    /// Hundreds of legs take hardly more memory than one.
    #[must_use]
    pub fn sharing(mut self, other: &Self) -> Self {
        let same = |one: &SourceText, other: &SourceText| one.text == other.text && one.path == other.path;
        let (own, known) = (self.worlds.layouts(), other.worlds.layouts());
        let alike =
            own.len() == known.len() && own.iter().zip(known).all(|(own, known)| same(&own.source, &known.source));
        if alike && self.settings.robot.body == other.settings.robot.body {
            self.layout = Arc::clone(&other.layout);
            self.worlds = other.worlds.clone();
        }
        if Arc::ptr_eq(&self.filters, &other.filters) || self.filters.is_linked_in() && other.filters.is_linked_in() {
            self.filters = Arc::clone(&other.filters);
        }
        let known = other.earlier.iter().rev().map(|leg| &leg.plan.behaviour);
        let own = &self.behaviour;
        let is_same = |known: &&Arc<Behaviour>| {
            same(known.source(), own.source())
                && known.params() == own.params()
                && known.edition() == own.edition()
                && known.settings() == own.settings()
        };
        if let Some(known) = std::iter::once(&other.behaviour).chain(known).find(is_same) {
            self.behaviour = Arc::clone(known);
        }
        self
    }

    /// The plan under which learning begins.
    #[must_use]
    pub fn first_leg(&self) -> &Self {
        self.earlier.first().map_or(self, |leg| &leg.plan)
    }

    /// The swaps in their order: the step before which it happens, what becomes of the table, the plan from there on, and
    /// the steps that this one is to be learned for.
    pub fn swaps(&self) -> impl Iterator<Item = (u64, Carry, &Self, u64)> {
        let last = (self, self.settings.run.steps);
        let after = self.earlier.iter().skip(1).map(|leg| (&leg.plan, leg.steps)).chain([last]);
        self.earlier.iter().zip(after).scan(0, |before, (leg, (plan, steps))| {
            *before += leg.steps;
            Some((*before, leg.then, plan, steps))
        })
    }

    /// The plans of the legs by whose rules the steps before them are judged anew, in their order.
    pub(super) fn rescored(&self) -> impl Iterator<Item = &Self> {
        self.swaps().filter(|(_, carry, ..)| *carry == Carry::Rescore).map(|(_, _, leg, _)| leg)
    }

    /// Steps of the first leg.
    #[must_use]
    pub fn first_steps(&self) -> u64 {
        self.earlier.first().map_or(self.settings.run.steps, |leg| leg.steps)
    }

    /// Steps of all earlier legs.
    #[must_use]
    fn earlier_steps(&self) -> u64 {
        self.earlier.iter().map(|leg| leg.steps).sum()
    }

    /// Steps of learning, in all legs.
    #[must_use]
    pub fn learning_steps(&self) -> u64 {
        self.earlier_steps() + self.settings.run.steps
    }

    /// The plan under which a step of learning was done.
    #[must_use]
    pub fn leg_of(&self, step: u64) -> &Self {
        self.swaps().take_while(|(from, ..)| *from <= step).last().map_or(self.first_leg(), |(_, _, plan, _)| plan)
    }

    /// The names of all rules: the plan's own in their order, then those that only earlier legs had.
    #[must_use]
    pub fn rule_names(&self) -> Vec<String> {
        let own = self.behaviour.rules().iter().map(|rule| rule.name.clone()).collect();
        // The latest of the gone ones first, as a learner's counts have them.
        self.earlier.iter().rev().fold(own, |names, leg| with_gone(names, leg.plan.own_rule_names()))
    }

    pub(super) fn own_rule_names(&self) -> impl Iterator<Item = String> {
        self.behaviour.rules().iter().map(|rule| rule.name.clone())
    }

    /// In which of the things that a robot sees or does a plan differs from another, in words; nothing if only rules, the
    /// learner's settings and the numbers of steps do, so that learning can go on from one to the other.
    #[must_use]
    pub fn differs_beyond_reward(&self, other: &Self) -> Option<String> {
        let digests = |plan: &Self| -> Vec<Option<String>> {
            let entries =
                plan.settings.views().flat_map(|view| &view.filters).map(|filter| plan.filters.find(&filter.name).ok());
            entries.map(|entry| entry.and_then(|entry| entry.sha256.clone())).collect()
        };
        let texts = |plan: &Self| -> Vec<Arc<str>> {
            plan.worlds.layouts().iter().map(|layout| layout.source.text.clone()).collect()
        };
        let same_world = texts(other) == texts(self);
        let fixed = first_fixed_difference(&other.settings, &self.settings).map(|(what, _)| what);
        let remembers = |plan: &Self| plan.settings.learner.kind == LearnerKind::Memory;
        fixed
            .or_else(|| (!self.uses_the_policies_of(other)).then(|| "the policies that it uses".to_owned()))
            .or_else(|| (remembers(other) != remembers(self)).then(|| "the way of learning".to_owned()))
            .or_else(|| (!same_world).then(|| "the world".to_owned()))
            .or_else(|| (digests(other) != digests(self)).then(|| "the filters".to_owned()))
    }
}

impl Plan {
    /// Whether the same policies may drive in both, asked in the same order; when they do may differ.
    fn uses_the_policies_of(&self, other: &Self) -> bool {
        let uses = |plan: &Self| plan.behaviour.uses().map(|(_, policy)| policy).collect::<Vec<_>>();
        let texts = |plan: &Self| -> Vec<Arc<str>> {
            plan.used.iter().flat_map(|used| &used.texts).map(|source| source.text.clone()).collect()
        };
        uses(self) == uses(other) && texts(self) == texts(other)
    }
}

/// Names, and those of `others` that are not among them.
pub(super) fn with_gone(mut names: Vec<String>, others: impl Iterator<Item = String>) -> Vec<String> {
    for name in others {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Whether a setting may change while a robot learns, and a recorded run may be judged again under another value of it.
pub(super) fn may_swap(group: &str, key: &str) -> bool {
    group == "learner" || (group == "run" && key != "period_s")
}

/// The first of the settings that may not change, with the place that sets it.
pub(super) fn first_fixed_difference(old: &Settings, new: &Settings) -> Option<(String, String)> {
    let row = SETTINGS.iter().find(|row| !may_swap(row.group, row.key) && (row.get)(old) != (row.get)(new));
    let row = row.map(|row| (row.name(), format!("{}.{}", row.group, row.key)));
    let parts = [
        (old.world == new.world, "the world", "world"),
        (old.worlds == new.worlds, "the worlds", "worlds"),
        (old.randomise == new.randomise, "what is drawn", "randomise"),
        (old.view.filters == new.view.filters, "the filters", "filter:0"),
        (old.view.name == new.view.name && old.further_views == new.further_views, "the views", "state"),
        (old.state == new.state, "the parts of the state", "state"),
        (old.stages == new.stages, "the stages", "stages"),
        (old.actions == new.actions, "the actions", "actions"),
        (old.starts == new.starts, "the starts", "starts"),
        (old.recovery.at == new.recovery.at, "the start of recovery", "recovery.to"),
        (old.policies == new.policies, "the policies", "policy:0"),
    ];
    let part = || parts.into_iter().find(|(same, ..)| !same);
    row.or_else(|| part().map(|(_, what, place)| (what.to_owned(), place.to_owned())))
}
