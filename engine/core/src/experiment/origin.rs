//! Learning on: a run that begins with what another one had learned.
//!
//! The other run is kept as its plan and its seed, and learned again: what it comes to is the same to the bit, and is held
//! against its recorded hash. So a run that goes on from others needs no file but its own.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::checkpoints::learn_through;
use super::{Checkpoints, Ledger, Plan};
use crate::diagnostic::{Diagnostic, Result, SourceText, grouped, printable};
use crate::learner::{Carry, Learner, Rejudged, ShippedLearner, shipped_learner};
use crate::settings::{LearnerKind, Settings};
use crate::state::StateMap;

/// At most so many runs go on from one another.
const MOST_RUNS: usize = 8;

/// The run that learning goes on from.
#[derive(Clone)]
pub struct Origin {
    /// Its plan, with the steps that it came to.
    pub plan: Plan,
    /// Its seed.
    pub seed: u64,
    /// Its `run.toml`.
    pub source: SourceText,
    /// Its hash over every step and what was learned.
    pub state_hash: String,
    /// What is carried on of what it learned.
    pub carry: Carry,
}

impl Origin {
    /// Steps that were learned before, in this run and in those that it goes on from.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.plan.learning_steps() + self.plan.steps_before(self.seed)
    }

    /// The run in words: `runs/wall/1 (wall in room, seed 1)`.
    #[must_use]
    pub fn name(&self) -> String {
        let folder = self.source.path.parent().map(|folder| printable(&folder.display().to_string()));
        let of = format!("{} in {}, seed {}", self.plan.behaviour.name(), self.plan.worlds.title(), self.seed);
        folder.filter(|folder| !folder.is_empty()).map_or(of.clone(), |folder| format!("{folder} ({of})"))
    }

    /// What was carried on to a plan, in words.
    #[must_use]
    pub fn carried(&self, next: &Plan) -> String {
        let remembered = self.steps().min(next.settings.learner.memory_steps);
        let memory = format!("the memory of {} steps", grouped(&remembered.to_string(), ","));
        match self.carry {
            Carry::Keep if next.settings.learner.kind != LearnerKind::Memory => {
                "kept the table and its visits".to_owned()
            }
            Carry::Keep => format!("kept {memory}, and how often"),
            Carry::Decay => {
                let what = self.plan.differs_beyond_reward(next).unwrap_or_else(|| "the world".to_owned());
                let what = what.strip_prefix("the ").map_or(what.clone(), |what| format!("another {what}"));
                format!("kept {memory}, forgot how often ({what})")
            }
            Carry::Rescore => format!("judged {memory} by the new rules, forgot how often"),
            Carry::Reset => "kept nothing".to_owned(),
        }
    }

    /// Whether a plan can go on from it.
    ///
    /// # Errors
    /// `E-FROM` if states, actions or the way of learning are others.
    pub fn check(&self, next: &Plan) -> Result<()> {
        let what = beyond_learning(&self.plan, next)?;
        let chain = std::iter::successors(Some(self), |origin| origin.plan.origins.first().map(Arc::as_ref)).count();
        let wrong = |message: String, help: &str| Diagnostic::new("E-FROM", message).help(help).fail();
        if let Some((what, old, new)) = what {
            let message = format!("'{}' has other {what}: {old}, here {new}", self.name());
            let help = "what was learned is about states and actions: go on with the same ones, or learn from nothing";
            return wrong(message, help);
        }
        if self.carry == Carry::Reset {
            let message =
                format!("'{}' has stages and rules of another form: its steps cannot be judged by these", self.name());
            return wrong(message, "keep the form of the rules, or learn from nothing: leave out --from");
        }
        let rejudged = self.carry == Carry::Rescore;
        if rejudged && next.settings.learner.kind != LearnerKind::Memory {
            return wrong(
                format!("'{}' is a run with a table, which has no steps to judge", self.name()),
                "run it again",
            );
        }
        if chain > MOST_RUNS {
            let message =
                format!("'{}' goes on from {} others, at most {MOST_RUNS} are allowed", self.name(), chain - 1);
            return wrong(message, "go on from an earlier one of them, or learn from nothing");
        }
        Ok(())
    }

    /// Learns it again, to where a plan can go on from it.
    ///
    /// # Errors
    /// `E-FROM` if it does not come out as it was recorded; if something fails.
    pub(super) fn again(&self, next: &Plan) -> Result<Reached> {
        let (never, mut off) = (AtomicBool::new(false), Ledger::off());
        let last = (self.carry == Carry::Rescore).then_some(next);
        let mut again = learn_through(&self.plan, self.seed, last, &never, &|_| (), &mut off, Checkpoints::NONE)?;
        let learned = again.finish();
        if let Some(fault) = again.fault() {
            return Err(Box::new(fault.clone()));
        }
        if learned.state_hash != self.state_hash {
            let message =
                format!("'{}' does not come out as it was recorded, so that nothing can go on from it", self.name());
            let help = "this engine, or a filter, is not the one that recorded it: run it again";
            return Diagnostic::new("E-FROM", message).help(help).fail();
        }
        let (learner, said) = again.into_learner();
        Ok(Reached { learner, said, kept: learned.policy.kept().to_vec(), carry: self.carry })
    }
}

/// Where an origin ends, and a plan goes on.
pub(super) struct Reached {
    learner: ShippedLearner,
    /// What the rules of the plan say of its latest steps, if these are judged anew.
    said: Vec<Rejudged>,
    /// What its filters kept; empty if they keep nothing.
    pub(super) kept: Vec<u8>,
    carry: Carry,
}

impl Reached {
    /// The learner of the plan that goes on.
    pub(super) fn learner(self, next: &Plan, map: &dyn StateMap, seed: u64) -> Result<ShippedLearner> {
        let Self { mut learner, said, carry, .. } = self;
        let task = next.task(map, seed)?;
        learner.swap(&next.settings.learner, task.mirror.clone(), carry);
        if carry == Carry::Rescore {
            learner.rescore(&said);
        }
        Ok(learner.with_random(task.random))
    }
}

impl Plan {
    /// This plan, going on from these runs: one for all seeds, or one for each.
    ///
    /// # Errors
    /// As [`Origin::check`].
    pub fn going_on_from(self, origins: Vec<Origin>) -> Result<Self> {
        origins.iter().try_for_each(|origin| origin.check(&self))?;
        Ok(Self { origins: origins.into_iter().map(Arc::new).collect(), ..self })
    }

    /// The run that a seed goes on from, if any.
    #[must_use]
    pub fn origin_of(&self, seed: u64) -> Option<&Origin> {
        match self.first_leg().origins.as_slice() {
            [one] => Some(one),
            many => many.iter().find(|origin| origin.seed == seed).map(Arc::as_ref),
        }
    }

    /// Steps that were learned in the runs that a seed goes on from.
    #[must_use]
    pub fn steps_before(&self, seed: u64) -> u64 {
        self.origin_of(seed).map_or(0, Origin::steps)
    }

    /// The learner that a seed begins with, over the states of a map.
    pub(super) fn first_learner(&self, map: &dyn StateMap, seed: u64) -> Result<ShippedLearner> {
        match self.origin_of(seed) {
            Some(origin) => origin.again(self)?.learner(self, map, seed),
            None => Ok(shipped_learner(&self.settings.learner, self.task(map, seed)?)),
        }
    }

    /// What the filters kept that a seed goes on from; empty if it goes on from nothing, or they keep nothing. The origin is
    /// learned again for it.
    ///
    /// # Errors
    /// As going on from it.
    pub fn kept_before(&self, seed: u64) -> Result<Vec<u8>> {
        let Some(origin) = self.origin_of(seed) else { return Ok(Vec::new()) };
        if self.first_leg().eyes()?.keep() { Ok(origin.again(self)?.kept) } else { Ok(Vec::new()) }
    }
}

/// What stands in the way of going on: what it is, what the old plan has, what the new one has.
fn beyond_learning(old: &Plan, new: &Plan) -> Result<Option<(&'static str, String, String)>> {
    let differ = |what, get: &dyn Fn(&Plan) -> String| {
        let (old, new) = (get(old), get(new));
        (old != new).then_some((what, old, new))
    };
    let filters = |plan: &Plan| {
        let names = plan.settings.views().flat_map(|view| view.filters.iter().map(|filter| filter.name.clone()));
        names.collect::<Vec<_>>().join(", ")
    };
    let actions = |settings: &Settings| {
        let pair = |twist: &crate::geometry::Twist| format!("[{}, {}]", twist.linear_m_per_s, twist.angular_rad_per_s);
        settings.actions.iter().map(pair).collect::<Vec<_>>().join(" ")
    };
    let map = |plan: &Plan| plan.state_map().map(|map| map.to_table().to_string().trim().replace('\n', ", "));
    let (old_map, new_map) = (map(old)?, map(new)?);
    let drives = |plan: &Plan| plan.behaviour.hands_over() || !plan.learns();
    if drives(old) || drives(new) {
        let says = |drives: bool| if drives { "with policies that drive" } else { "none that drive" }.to_owned();
        return Ok(Some(("policies", says(drives(old)), says(drives(new)))));
    }
    Ok(differ("ways of learning", &|plan| plan.settings.learner.kind.word().to_owned())
        .or_else(|| differ("filters", &filters))
        .or_else(|| (old_map != new_map).then(|| ("states", old_map.clone(), new_map.clone())))
        .or_else(|| differ("actions", &|plan| actions(&plan.settings))))
}
