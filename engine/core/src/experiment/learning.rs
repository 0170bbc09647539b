//! Learning: the loop with a learner in it, and all that is kept of it.

mod passed;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use super::checkpoints::learn_through;
use super::choosers::Learns;
use super::digest::StateHash;
use super::legs::with_gone;
use super::relay::UsedDrivers;
use super::trail::{Recorder, Trail};
use super::{Checkpoints, Cycle, Ledger, Observer, Phase, Plan, Step, Tally, WINDOW_STEPS, drive};
use crate::diagnostic::{Diagnostic, Result};
use crate::learner::{Carry, Learner, Policy, Rejudged, ShippedLearner};
use crate::robot::{Robot, SimulatedRobot};

/// How far a seed has come, said at the end of every window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Whose progress.
    pub seed: u64,
    /// Steps done.
    pub steps: u64,
    /// Reinforcement of the last 400 steps.
    pub reinforcement: f64,
}

/// What a seed learned.
#[derive(Debug, Clone)]
pub struct Learned {
    /// The seed.
    pub seed: u64,
    /// Steps done; fewer than planned if it was stopped.
    pub steps: u64,
    /// What was counted.
    pub tally: Tally,
    /// What was learned.
    pub policy: Policy,
    /// The path of the first 400 steps.
    pub early: Trail,
    /// Of a script that widens its starts: the step after which each was in use, in the order of its list.
    pub joined: Vec<u64>,
    /// Hash over every step and what was learned, 64 hexadecimal digits.
    pub state_hash: String,
}

/// Learning that a failure ended: the failure, and what was learned before it.
#[derive(Clone)]
pub struct BrokenOff {
    /// Why it ended.
    pub error: Box<Diagnostic>,
    /// What was learned; nothing if the first step failed.
    pub learned: Option<Learned>,
}

impl std::fmt::Display for BrokenOff {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.error.fmt(f)
    }
}

impl std::fmt::Debug for BrokenOff {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Debug::fmt(&self.error, f)
    }
}

impl std::error::Error for BrokenOff {}

impl From<Box<BrokenOff>> for Box<Diagnostic> {
    fn from(broken: Box<BrokenOff>) -> Self {
        broken.error
    }
}

impl From<Box<Diagnostic>> for Box<BrokenOff> {
    fn from(error: Box<Diagnostic>) -> Self {
        Self::new(BrokenOff { error, learned: None })
    }
}

/// Learns a plan under a seed, until its steps are done or `stop` is set.
///
/// # Errors
/// If a sensor, a filter or the script fails; what was learned before is in the error.
pub fn learn(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
) -> std::result::Result<Learned, Box<BrokenOff>> {
    learn_into(plan, seed, stop, report, &mut Ledger::off())
}

/// Learns, and keeps every step in a ledger.
///
/// # Errors
/// As [`learn`].
pub fn learn_into(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    ledger: &mut Ledger,
) -> std::result::Result<Learned, Box<BrokenOff>> {
    learn_kept(plan, seed, stop, report, ledger, Checkpoints::NONE)
}

/// Learns, keeps every step in a ledger, and from time to time all that goes on.
///
/// # Errors
/// As [`learn`]; `E-CHECKPOINT` if what it is to go on from does not fit, and what keeping it fails with.
pub fn learn_kept(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    ledger: &mut Ledger,
    checkpoints: Checkpoints<'_>,
) -> std::result::Result<Learned, Box<BrokenOff>> {
    let mut learning = learn_through(plan, seed, None, stop, report, ledger, checkpoints)?;
    let learned = learning.finish();
    match learning.fault {
        Some(error) => Err(Box::new(BrokenOff { error, learned: Some(learned) })),
        None => Ok(learned),
    }
}

/// A robot that learns: for some steps, then for more, under the same reward or another.
pub struct Learning<R = SimulatedRobot, L = ShippedLearner> {
    seed: u64,
    cycle: Cycle<R>,
    learner: L,
    /// The names of the rules that the tally counts, of earlier legs too.
    rules: Vec<String>,
    tally: Tally,
    /// Policies that the script uses.
    used: UsedDrivers,
    early: Recorder,
    hash: StateHash,
    joined: Joined,
    fault: Option<Box<Diagnostic>>,
    /// What the filters kept before the first step.
    pub(super) set_out_from: Vec<u8>,
}

impl Learning {
    /// A simulated robot at its start that knows nothing, or what the run had learned that the plan goes on from; earlier
    /// legs of the plan are not looked at.
    ///
    /// # Errors
    /// If the plan does not work.
    pub fn new(plan: &Plan, seed: u64) -> Result<Self> {
        Self::watched(plan, seed, &[])
    }

    /// A learning robot beside which the rules of other plans judge along.
    pub(super) fn watched(plan: &Plan, seed: u64, others: &[&Plan]) -> Result<Self> {
        let origin = plan.origin_of(seed).map(|origin| origin.again(plan)).transpose()?;
        let kept = origin.as_ref().map_or_else(Vec::new, |origin| origin.kept.clone());
        let cycle = Cycle::watched(plan, Phase::Learning.robot(plan, seed)?, others, &kept)?;
        let learner = match origin {
            Some(origin) => origin.learner(plan, cycle.state_map(), seed)?,
            None => plan.first_learner(cycle.state_map(), seed)?,
        };
        Ok(Self { set_out_from: kept, ..Self::with(plan, seed, cycle, learner) })
    }

    /// The next swap of its plan: what judged along has said what it was there for.
    ///
    /// # Errors
    /// As [`Learning::swap`].
    pub(super) fn swap_next(&mut self, plan: &Plan, carry: Carry, ledger: &mut Ledger) -> Result<()> {
        let said = if carry == Carry::Rescore { self.cycle.dismiss_witness() } else { Vec::new() };
        self.swap_rejudged(plan, carry, &said, ledger)
    }

    /// What learned, and what the rules say that judged along to the end.
    pub(super) fn into_learner(mut self) -> (ShippedLearner, Vec<Rejudged>) {
        let said = self.cycle.dismiss_witness();
        (self.learner, said)
    }
}

impl<R: Robot, L: Learner> Learning<R, L> {
    /// Any robot with any learner, as they are now. [`Plan::task`] says what the learner is made for.
    #[must_use]
    pub fn with(plan: &Plan, seed: u64, cycle: Cycle<R>, learner: L) -> Self {
        Self {
            seed,
            learner,
            rules: plan.own_rule_names().collect(),
            tally: Tally::new(plan.behaviour.rules().len(), plan.settings.run.steps),
            early: Recorder::new(WINDOW_STEPS, cycle.robot()),
            hash: StateHash::default(),
            joined: Joined::new(plan),
            used: UsedDrivers::new(plan, seed),
            cycle,
            fault: None,
            set_out_from: Vec::new(),
        }
    }

    /// Whose learning it is.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Steps done, in all legs.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.cycle.steps()
    }

    /// What failed, if something has: nothing is learned after it.
    #[must_use]
    pub fn fault(&self) -> Option<&Diagnostic> {
        self.fault.as_deref()
    }

    /// The robot that learns.
    #[must_use]
    pub fn cycle(&self) -> &Cycle<R> {
        &self.cycle
    }

    /// What learns.
    #[must_use]
    pub fn learner(&self) -> &L {
        &self.learner
    }

    /// Learns for so many more steps, or until `stop` is set, or something fails.
    ///
    /// # Errors
    /// What failed, in this run or an earlier one. What was learned before can be had all the same, see
    /// [`Learning::finish`].
    pub fn run(
        &mut self,
        steps: u64,
        stop: &AtomicBool,
        report: &(dyn Fn(Progress) + Sync),
        ledger: &mut Ledger,
    ) -> Result<()> {
        self.go_on(steps, stop, report, ledger)?;
        self.fault.clone().map_or(Ok(()), Err)
    }

    /// As [`Learning::run`], where a failure after the first step is only kept.
    pub(super) fn go_on(
        &mut self,
        steps: u64,
        stop: &AtomicBool,
        report: &(dyn Fn(Progress) + Sync),
        ledger: &mut Ledger,
    ) -> Result<()> {
        if self.fault.is_some() {
            return Ok(());
        }
        let Self { seed, cycle, learner, used, tally, early, hash, joined, .. } = self;
        let windows = Windows { seed: *seed, tally, stop, report };
        let mut observers = ((ledger, joined), (hash, (early, windows)));
        let driven = match used.is_empty() {
            true => drive(cycle, &mut Learns(learner), &mut observers, steps),
            false => drive(cycle, &mut used.with(Learns(learner)), &mut observers, steps),
        };
        match driven {
            Ok(_) => Ok(()),
            Err(error) if cycle.steps() == 0 => Err(error),
            Err(error) => {
                self.fault = Some(error);
                Ok(())
            }
        }
    }

    /// Goes on under the reward and the learner's settings of another plan, which differs in nothing else: from where the
    /// robot is, what was learned as `carry` says. Nothing happens after a failure.
    ///
    /// # Errors
    /// If the new script fails on what the robot sees.
    pub fn swap(&mut self, plan: &Plan, carry: Carry, ledger: &mut Ledger) -> Result<()> {
        self.swap_rejudged(plan, carry, &[], ledger)
    }

    /// A swap that may rescore: `said` is what the new rules say of the latest steps, see [`super::rejudge`].
    ///
    /// # Errors
    /// As [`Learning::swap`].
    pub fn swap_rejudged(&mut self, plan: &Plan, carry: Carry, said: &[Rejudged], ledger: &mut Ledger) -> Result<()> {
        if self.fault.is_some() {
            return Ok(());
        }
        let settings = &plan.settings;
        self.used.settle(&mut Learns(&mut self.learner));
        self.learner.swap(&settings.learner, plan.mirror(self.cycle.state_map())?, carry);
        if carry == Carry::Rescore {
            self.learner.rescore(said);
        }
        self.cycle.swap_judge(plan)?;
        let rules = with_gone(plan.own_rule_names().collect(), self.rules.iter().cloned());
        self.tally.swap_rules(&self.rules, &rules, settings.run.steps);
        self.rules = rules;
        ledger.begin_leg(plan, settings.run.steps);
        Ok(())
    }

    /// What is known now; learning can go on as if nobody had looked.
    #[must_use]
    pub fn snapshot(&mut self) -> Learned {
        Learned {
            seed: self.seed,
            steps: self.steps(),
            tally: self.tally.clone(),
            policy: self.learner.policy().keeping(self.cycle.kept()),
            early: self.early.clone().finish(),
            joined: self.joined.steps.clone(),
            state_hash: self.hash.clone().finish_with(&self.learner),
        }
    }

    /// Ends the learning, or a leg of it: what the memory of earlier states still holds is learned too.
    #[must_use]
    pub fn finish(&mut self) -> Learned {
        self.used.settle(&mut Learns(&mut self.learner));
        self.learner.forget();
        self.snapshot()
    }
}

/// Notes when the starts of a script that widens them came into use.
struct Joined {
    steps: Vec<u64>,
    /// How many there are to come.
    most: usize,
}

impl Joined {
    fn new(plan: &Plan) -> Self {
        let starts = &plan.settings.starts;
        let most = if starts.widen.is_some() { starts.names.len() } else { 0 };
        let mut steps = Vec::with_capacity(most);
        steps.extend((most > 0).then_some(0));
        Self { steps, most }
    }
}

impl<R: Robot> Observer<R> for Joined {
    fn stepped(&mut self, _: &Cycle<R>, _: &Step) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn recovered(&mut self, cycle: &Cycle<R>) {
        if self.steps.len() < cycle.robot().starts_in_use().min(self.most) {
            self.steps.push(cycle.steps());
        }
    }
}

/// Counts, reports at the end of every window, and looks whether to stop: after each step, since a step may be slow.
struct Windows<'a> {
    seed: u64,
    tally: &'a mut Tally,
    stop: &'a AtomicBool,
    report: &'a (dyn Fn(Progress) + Sync),
}

impl<R: Robot> Observer<R> for Windows<'_> {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        if self.tally.count(step, cycle.fired()) {
            let reinforcement = self.tally.windows.last().map_or(0.0, |window| window.reinforcement);
            (self.report)(Progress { seed: self.seed, steps: cycle.steps(), reinforcement });
        }
        if self.stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
