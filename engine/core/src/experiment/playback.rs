//! A recorded run driven again: from the seed and the recorded actions comes back all that was seen, step by step.
//!
//! ```text
//! let mut playback = Playback::new(&plan, seed, Phase::Learning, &ledger)?;
//! playback.seek(1200)?;                       // as the robot stood when it chose the action of step 1200
//! let before = Snapshot::of(playback.cycle()); //   image, mask, grid, state; cycle().stages(): each filter's picture
//! playback.advance()?;                        // step 1200 itself, before any recovery
//! playback.cycle();                           // ... scan (observation), facts, fired, evidence, truth (robot().world())
//! playback.difference();                      // None: the step is its record, bit for bit
//! ```
//!
//! A step takes as long as one of learning, about 8 microseconds; going back plays from the beginning.

use super::drive::{advance, recover};
use super::{Choice, Cycle, Ledger, Plan, Recall, Recorded, Step, ValueReasons};
use crate::diagnostic::{Diagnostic, Result};
use crate::learner::{Carry, Rejudged};
use crate::robot::{Robot, SimulatedRobot};

/// Added to the seed, so that the noise of the test is not the noise of learning again.
const TEST_SEED_OFFSET: u64 = 0x5eed_0000_0000_0000;

/// What a ledger holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Steps of learning.
    Learning,
    /// Steps of the frozen policy's test.
    Test,
}

impl Phase {
    /// The simulated robot that this phase of a run begins with.
    ///
    /// # Errors
    /// If no start is safe, or the camera shows nothing from there.
    pub fn robot(self, plan: &Plan, seed: u64) -> Result<SimulatedRobot> {
        let mut settings = plan.settings.clone();
        if self == Self::Test {
            // The test uses all of them.
            settings.starts.widen = None;
        }
        SimulatedRobot::in_worlds(&plan.worlds, &settings, self.seed(seed))
    }

    /// The seed of its simulator, of a run's seed.
    pub(super) fn seed(self, seed: u64) -> u64 {
        match self {
            Self::Learning => seed,
            Self::Test => seed.wrapping_add(TEST_SEED_OFFSET),
        }
    }
}

/// A recorded phase, driven again.
pub struct Playback<'a, R = SimulatedRobot> {
    plan: &'a Plan,
    phase: Phase,
    ledger: &'a Ledger,
    /// Makes the robot as it was before the first step.
    robots: Box<dyn Fn() -> Result<R> + Send + 'a>,
    cycle: Cycle<R>,
    /// How many of the plan's swaps were done.
    swapped: usize,
    /// The record of the last step as it came out now.
    played: Ledger,
    done: usize,
    must_recover: bool,
    seed: u64,
    /// What learned, led along.
    recall: Option<Recall>,
}

impl<'a> Playback<'a> {
    /// Stands before the first step of a recorded phase in the simulator.
    ///
    /// # Errors
    /// If the plan does not work.
    pub fn new(plan: &'a Plan, seed: u64, phase: Phase, ledger: &'a Ledger) -> Result<Self> {
        Self::judged_by(plan, seed, phase, ledger, None)
    }

    /// A playback beside which the rules of another plan judge along until it goes back.
    pub(super) fn judged_by(
        plan: &'a Plan,
        seed: u64,
        phase: Phase,
        ledger: &'a Ledger,
        rules: Option<&Plan>,
    ) -> Result<Self> {
        let made = Self::made(plan, phase, ledger, move || phase.robot(plan, seed), rules)?;
        Ok(Self { seed, ..made })
    }

    /// Of learning: with what learned led along, if it remembers its steps. Then [`Playback::value_of`] tells why an action has
    /// its value.
    ///
    /// # Errors
    /// If the plan does not work, or the run that it goes on from does not come out as it was recorded.
    pub fn recalling(mut self) -> Result<Self> {
        if self.phase == Phase::Learning {
            self.recall = Recall::new(self.plan, self.seed)?;
        }
        Ok(self)
    }

    /// Of learning that is recalled: what learned, as it was at its end; nothing if not every step was recorded.
    ///
    /// # Errors
    /// If a step cannot be played again.
    pub fn into_recall(mut self) -> Result<Option<Recall>> {
        if self.recall.is_none() || self.ledger.len() as u64 != self.ledger.steps() {
            return Ok(None);
        }
        while self.advance()?.is_some() {}
        if let Some(recall) = &mut self.recall {
            recall.finish();
        }
        Ok(self.recall)
    }

    /// Of a test: with what had learned before it.
    #[must_use]
    pub fn with_recall(mut self, recall: Option<Recall>) -> Self {
        self.recall = recall.filter(|_| self.phase == Phase::Test).or(self.recall);
        self
    }
}

impl<'a, R: Robot> Playback<'a, R> {
    /// Stands before the first step of a recorded phase of any robot; `robots` puts it where it began.
    ///
    /// # Errors
    /// If the plan or the robot does not work.
    pub fn with_robots(
        plan: &'a Plan,
        phase: Phase,
        ledger: &'a Ledger,
        robots: impl Fn() -> Result<R> + Send + 'a,
    ) -> Result<Self> {
        Self::made(plan, phase, ledger, robots, None)
    }

    fn made(
        plan: &'a Plan,
        phase: Phase,
        ledger: &'a Ledger,
        robots: impl Fn() -> Result<R> + Send + 'a,
        rules: Option<&Plan>,
    ) -> Result<Self> {
        let (first, others) = before(plan, phase, rules);
        let (cycle, played) = (Cycle::watched(first, robots()?, &others, ledger.kept())?, Ledger::new(first, 1));
        let (robots, recall) = (Box::new(robots), None);
        let (swapped, done, must_recover, seed) = (0, 0, false, 0);
        Ok(Self { plan, phase, ledger, robots, cycle, swapped, played, done, must_recover, seed, recall })
    }

    /// What the rules have said that were the first to judge along.
    pub(super) fn dismiss_witness(&mut self) -> Vec<Rejudged> {
        self.cycle.dismiss_witness()
    }

    /// Stands before the first step again.
    fn rewind(&mut self) -> Result<()> {
        let (first, others) = before(self.plan, self.phase, None);
        self.cycle = Cycle::watched(first, (self.robots)()?, &others, self.ledger.kept())?;
        if self.phase == Phase::Learning && self.recall.is_some() {
            self.recall = Recall::new(self.plan, self.seed)?;
        }
        self.played = Ledger::new(first, 1);
        (self.swapped, self.done, self.must_recover) = (0, 0, false);
        Ok(())
    }

    /// How many steps have been played.
    #[must_use]
    pub fn done(&self) -> usize {
        self.done
    }

    /// The robot with its sensors, filters, grid and script, as they are now.
    #[must_use]
    pub fn cycle(&self) -> &Cycle<R> {
        &self.cycle
    }

    /// The plan under which the last step was done: that of its leg.
    #[must_use]
    pub fn plan(&self) -> &'a Plan {
        match self.phase {
            Phase::Learning => self.plan.leg_of(self.done.saturating_sub(1) as u64),
            Phase::Test => self.plan,
        }
    }

    /// The records that are played.
    #[must_use]
    pub(super) fn ledger(&self) -> &'a Ledger {
        self.ledger
    }

    /// Goes to where the action of a step was chosen: after the step before it, and its recovery.
    ///
    /// # Errors
    /// If a sensor, a filter or the script fails, or there are fewer steps.
    pub fn seek(&mut self, step: usize) -> Result<()> {
        if step < self.done {
            self.rewind()?;
        }
        while self.done < step {
            if self.advance()?.is_none() {
                let message = format!("the log has {} steps, no step {step}", self.ledger.len());
                let last = self.ledger.len().saturating_sub(1);
                let help = format!("steps are counted from 0 to {last}");
                return Diagnostic::new("E-LOG-STEP", message).help(help).fail();
            }
        }
        self.make_ready()
    }

    /// Plays one more step, or none after the last.
    ///
    /// # Errors
    /// If a sensor, a filter or the script fails, or the recorded action is not one of the plan's.
    pub fn advance(&mut self) -> Result<Option<Step>> {
        let Some(record) = self.ledger.record(self.done) else {
            if self.done < self.ledger.len() {
                let message = format!("step {} of the log cannot be read any more", self.done);
                return Diagnostic::new("E-LOG-FILE", message).help("copy the folder of the run again").fail();
            }
            return Ok(None);
        };
        self.make_ready()?;
        let action = usize::from(record.action);
        if action >= self.cycle.motions() {
            let message = format!("step {} of the log has action {action}, which the run does not have", self.done);
            return Diagnostic::new("E-LOG-FILE", message).help("run the behaviour again").fail();
        }
        self.played.clear();
        let mut recorded = Recorded(Choice { action, explored: record.explored });
        let (step, _) = advance(&mut self.cycle, &mut recorded, &mut self.played)?;
        self.done += 1;
        self.must_recover = step.moves();
        if let Some(recall) = self.recall.as_mut().filter(|_| self.phase == Phase::Learning) {
            recall.follow(&step);
        }
        Ok(Some(step))
    }

    /// Why an action has its value in a state, as of now; nothing if nobody is led along who could tell.
    #[must_use]
    pub fn value_of(&self, choice: [usize; 2]) -> Option<ValueReasons> {
        self.recall.as_ref().and_then(|recall| recall.of(choice))
    }

    /// The first field in which the last step differs from its record.
    #[must_use]
    pub fn difference(&self) -> Option<&'static str> {
        let last = self.done.checked_sub(1)?;
        self.ledger.field_that_differs(last, &self.played, 0)
    }

    /// What comes between two steps: recovery, then the swap of the reward.
    fn make_ready(&mut self) -> Result<()> {
        if std::mem::take(&mut self.must_recover) {
            recover(&mut self.cycle, &mut Recorded(Choice { action: 0, explored: false }), &mut ())?;
        }
        let plan = self.plan;
        if self.phase == Phase::Test || self.swapped == plan.earlier.len() {
            return Ok(());
        }
        for (_, carry, leg, _) in plan.swaps().skip(self.swapped).take_while(|(from, ..)| *from <= self.done as u64) {
            let said = if carry == Carry::Rescore { self.cycle.dismiss_witness() } else { Vec::new() };
            if let Some(recall) = &mut self.recall {
                recall.swap(leg, carry, &said)?;
            }
            self.cycle.swap_judge(leg)?;
            self.played = Ledger::new(leg, 1);
            self.swapped += 1;
        }
        Ok(())
    }
}

/// The plan of the first step, and whose rules judge along from there: those by which steps will be judged anew.
fn before<'a>(plan: &'a Plan, phase: Phase, rules: Option<&'a Plan>) -> (&'a Plan, Vec<&'a Plan>) {
    if phase == Phase::Test {
        return (plan, rules.into_iter().collect());
    }
    (plan.first_leg(), plan.rescored().chain(rules).collect())
}
