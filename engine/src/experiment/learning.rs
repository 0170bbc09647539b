//! Learning: the whole method on one screen.

use std::sync::atomic::{AtomicBool, Ordering};

use super::digest::StateHash;
use super::trail::{Recorder, Trail};
use super::{Cycle, Ledger, Plan, Tally, WINDOW_STEPS};
use crate::diagnostic::{Diagnostic, Result};
use crate::learner::{Learner, Policy, Transition};
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
    let settings = &plan.settings;
    let robot = SimulatedRobot::new(&plan.layout, settings, seed)?;
    let mut cycle = Cycle::new(plan, robot)?;
    let random = Random::new(seed, Stream::Learner);
    let mut learner = Learner::new(&settings.learner, cycle.grid().states(), settings.actions.len(), random);
    if let Some(mirror) = plan.mirror()? {
        learner = learner.with_mirror(&settings.learner, mirror);
    }
    let mut tally = Tally::new(plan.behaviour.rules().len(), settings.run.steps);
    let mut early = Recorder::new(WINDOW_STEPS, cycle.robot().world());
    let mut hash = StateHash::default();
    let (mut steps, mut fault) = (0, None);
    while steps < settings.run.steps {
        let action = learner.choose(cycle.state());
        let explored = learner.table().best(cycle.state()).0 != action;
        let step = match cycle.step(action) {
            Ok(step) => step,
            Err(error) if steps == 0 => return Err(error),
            Err(error) => {
                fault = Some(error);
                break;
            }
        };
        learner.learn(&Transition {
            state: step.state,
            action: step.action,
            reward: step.reward,
            next_state: step.next_state,
            terminal: step.recover && settings.learner.failure_is_terminal,
        });
        steps += 1;
        ledger.add(&cycle, &step, explored);
        hash.step(&step, cycle.robot().world().body().pose);
        early.follow(cycle.robot().world(), step.failed());
        if step.recover {
            learner.forget();
            fault = cycle.recover().err();
            if fault.is_some() {
                break;
            }
            early.jump(cycle.robot().world());
        }
        if tally.count(&step, cycle.fired()) {
            let reinforcement = tally.windows.last().map_or(0.0, |window| window.reinforcement);
            report(Progress { seed, steps, reinforcement });
            if stop.load(Ordering::Relaxed) {
                break;
            }
        }
    }
    learner.forget();
    Ok(Learned {
        seed,
        steps,
        tally,
        policy: learner.policy(),
        early: early.finish(),
        state_hash: hash.finish(learner.table().values()),
        fault,
    })
}
