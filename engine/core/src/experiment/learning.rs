//! Learning: the whole method on one screen, [`Learning::run`].

use std::sync::atomic::{AtomicBool, Ordering};

use super::digest::StateHash;
use super::legs::with_gone;
use super::trail::{Recorder, Trail};
use super::{Cycle, Ledger, Plan, Tally, WINDOW_STEPS};
use crate::diagnostic::{Diagnostic, Result};
use crate::learner::{Carry, Learner, Policy, Transition};
use crate::random::{Random, Stream};
use crate::robot::SimulatedRobot;

/// How far a seed has come, told at the end of every window.
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
    /// Hash over every step and the table, 64 hexadecimal digits.
    pub state_hash: String,
    /// Why learning ended early, if a filter, a sensor or the script failed.
    pub fault: Option<Box<Diagnostic>>,
}

impl Learned {
    /// The same, if nothing failed.
    ///
    /// # Errors
    /// The failure that ended learning early.
    pub fn whole(mut self) -> Result<Self> {
        self.fault.take().map_or(Ok(self), Err)
    }
}

/// Learns a plan under a seed, until its steps are done, `stop` is set, or a sensor, a filter or the script fails: what was
/// learned before is kept, and the failure with it.
///
/// # Errors
/// If it fails before the first step is done.
pub fn learn(plan: &Plan, seed: u64, stop: &AtomicBool, report: &(dyn Fn(Progress) + Sync)) -> Result<Learned> {
    learn_into(plan, seed, stop, report, &mut Ledger::off())
}

/// The same, with every step kept in a ledger.
///
/// # Errors
/// As [`learn`].
pub fn learn_into(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    ledger: &mut Ledger,
) -> Result<Learned> {
    let mut learning = Learning::new(plan.first_leg(), seed)?;
    learning.run(plan.first_steps(), stop, report, ledger)?;
    for (from, carry, leg, steps) in plan.swaps() {
        if learning.steps < from {
            break;
        }
        learning.swap(leg, carry, ledger)?;
        learning.run(steps, stop, report, ledger)?;
    }
    Ok(learning.finish())
}

/// A robot that learns: for some steps, then for more, under the same reward or another.
pub struct Learning {
    seed: u64,
    cycle: Cycle<SimulatedRobot>,
    learner: Learner,
    failure_is_terminal: bool,
    /// The names of the rules that the tally counts, of earlier legs too.
    rules: Vec<String>,
    tally: Tally,
    early: Recorder,
    hash: StateHash,
    steps: u64,
    fault: Option<Box<Diagnostic>>,
}

impl Learning {
    /// A robot at its start that knows nothing; earlier legs of the plan are not looked at.
    ///
    /// # Errors
    /// If the plan does not work.
    pub fn new(plan: &Plan, seed: u64) -> Result<Self> {
        let settings = &plan.settings;
        let robot = SimulatedRobot::new(&plan.layout, settings, seed)?;
        let cycle = Cycle::new(plan, robot)?;
        let random = Random::new(seed, Stream::Learner);
        let mut learner = Learner::new(&settings.learner, cycle.grid().states(), settings.actions.len(), random);
        if let Some(mirror) = plan.mirror()? {
            learner = learner.with_mirror(&settings.learner, mirror);
        }
        Ok(Self {
            seed,
            learner,
            failure_is_terminal: settings.learner.failure_is_terminal,
            rules: plan.own_rule_names().collect(),
            tally: Tally::new(plan.behaviour.rules().len(), settings.run.steps),
            early: Recorder::new(WINDOW_STEPS, cycle.robot().world()),
            hash: StateHash::default(),
            cycle,
            steps: 0,
            fault: None,
        })
    }

    /// Steps done, in all legs.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Learns for so many more steps, or until `stop` is set at the end of a window, or something fails.
    ///
    /// # Errors
    /// What failed, if it was the first step; a later failure is told by [`Learning::finish`].
    pub fn run(
        &mut self,
        steps: u64,
        stop: &AtomicBool,
        report: &(dyn Fn(Progress) + Sync),
        ledger: &mut Ledger,
    ) -> Result<()> {
        let Self { cycle, learner, tally, early, hash, .. } = self;
        let until = if self.fault.is_some() { self.steps } else { self.steps.saturating_add(steps) };
        while self.steps < until {
            let action = learner.choose(cycle.state());
            let explored = learner.table().best(cycle.state()).0 != action;
            let step = match cycle.step(action) {
                Ok(step) => step,
                Err(error) if self.steps == 0 => return Err(error),
                Err(error) => {
                    self.fault = Some(error);
                    break;
                }
            };
            learner.learn(&Transition {
                state: step.state,
                action: step.action,
                reward: step.reward,
                next_state: step.next_state,
                terminal: step.recover && self.failure_is_terminal,
            });
            self.steps += 1;
            ledger.add(cycle, &step, explored);
            hash.step(&step, cycle.robot().world().body(0).pose);
            early.follow(cycle.robot().world(), step.failed());
            if step.recover {
                learner.forget();
                self.fault = cycle.recover().err();
                if self.fault.is_some() {
                    break;
                }
                early.jump(cycle.robot().world());
            }
            if tally.count(&step, cycle.fired()) {
                let reinforcement = tally.windows.last().map_or(0.0, |window| window.reinforcement);
                report(Progress { seed: self.seed, steps: self.steps, reinforcement });
                if stop.load(Ordering::Relaxed) {
                    break;
                }
            }
        }
        Ok(())
    }

    /// Goes on under the reward and the learner's settings of another plan, which differs in nothing else: from where the
    /// robot is, the table as `carry` says. Nothing happens after a failure.
    ///
    /// # Errors
    /// If the new script fails on what the robot sees.
    pub fn swap(&mut self, plan: &Plan, carry: Carry, ledger: &mut Ledger) -> Result<()> {
        if self.fault.is_some() {
            return Ok(());
        }
        let settings = &plan.settings;
        self.learner.swap_reward(&settings.learner, plan.mirror()?, carry);
        self.failure_is_terminal = settings.learner.failure_is_terminal;
        self.cycle.swap_judge(plan)?;
        let rules = with_gone(plan.own_rule_names().collect(), self.rules.iter().cloned());
        self.tally.swap_rules(&self.rules, &rules, settings.run.steps);
        self.rules = rules;
        ledger.begin_leg(plan, settings.run.steps);
        Ok(())
    }

    /// What is known now; learning can go on as if nobody had looked.
    #[must_use]
    pub fn snapshot(&self) -> Learned {
        Learned {
            seed: self.seed,
            steps: self.steps,
            tally: self.tally.clone(),
            policy: self.learner.policy(),
            early: self.early.clone().finish(),
            state_hash: self.hash.clone().finish(self.learner.table().values()),
            fault: self.fault.clone(),
        }
    }

    /// Ends the learning, or a leg of it: what the memory of earlier states still holds is learned too.
    #[must_use]
    pub fn finish(&mut self) -> Learned {
        self.learner.forget();
        self.snapshot()
    }
}
