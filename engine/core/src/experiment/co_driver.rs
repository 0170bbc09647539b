//! A used policy while it drives: what it perceives, with views, stages and memory of its own.
//!
//! It begins when its use begins to hold, as its own script does after a recovery: in its first stage, with nothing remembered.
//! Its rules are judged for the stages that they lead to, not for their values; where they end an attempt, it begins again.
//! Nothing of it is worked out while it does not drive.

use super::eyes::moved;
use super::telling::{LaserTold, StepTold, tell};
use super::{Eyes, Plan, UsedPolicy};
use crate::allowed::Allowed;
use crate::diagnostic::{Diagnostic, Result, printable};
use crate::geometry::Twist;
use crate::judge::{Judge, NO_ACTION};
use crate::saved::{Passed, Passing};
use crate::sensors::observation::Observation;
use filter_api::Format;

/// A policy that is to choose now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hand {
    /// The use that holds, by its place in the script.
    pub(super) by: usize,
    /// The policy, by its place among those that the script names.
    pub(super) policy: usize,
    /// The state that it perceives.
    pub(super) state: usize,
    /// Which of its own actions may be taken: at least one.
    pub(super) allowed: Allowed,
    /// The action that it goes on with, if its step is longer than the robot's.
    pub(super) held: Option<usize>,
}

/// The policies that a script uses, and which of them is to drive.
pub(super) struct CoDrivers {
    drivers: Vec<CoDriver>,
    /// By use: its policy.
    policies: Vec<usize>,
    /// The use that holds.
    by: Option<usize>,
}

impl CoDrivers {
    /// # Errors
    /// If the filters, grids or rules of one do not work here.
    pub(super) fn new(plan: &Plan) -> Result<Self> {
        let drivers = plan.used.iter().map(|used| CoDriver::new(plan, used)).collect::<Result<_>>()?;
        Ok(Self { drivers, policies: plan.behaviour.uses().map(|(_, policy)| policy).collect(), by: None })
    }

    /// From now on the uses of another script are asked, of the same policies.
    pub(super) fn swap_uses(&mut self, plan: &Plan) {
        self.policies = plan.behaviour.uses().map(|(_, policy)| policy).collect();
        self.by = None;
    }

    pub(super) fn read_ground(&self) -> bool {
        self.drivers.iter().any(|driver| driver.judge.reads_ground())
    }

    /// What their filters read.
    pub(super) fn like(&self) -> impl Iterator<Item = Format> {
        self.drivers.iter().flat_map(|driver| driver.eyes.likes())
    }

    /// Looks at the first observation of the run, by which scripts calibrate.
    pub(super) fn calibrate(&mut self, observation: &Observation) -> Result<()> {
        self.drivers.iter_mut().try_for_each(|driver| driver.calibrate(observation))
    }

    /// Whether one of them is to drive.
    pub(super) fn drive(&self) -> bool {
        self.by.is_some()
    }

    /// The use by which one of them is to drive.
    pub(super) fn by(&self) -> Option<usize> {
        self.by
    }

    /// Takes note of the use that holds now: who takes over begins anew, who goes on looks at what came of `motion`, which
    /// the robot did since; there is none after a recovery.
    pub(super) fn ask(&mut self, by: Option<usize>, observation: &Observation, motion: Option<usize>) -> Result<()> {
        let before = std::mem::replace(&mut self.by, by);
        let policy = |by: Option<usize>| by.and_then(|by| self.policies.get(by).copied());
        let (last, now) = (policy(before), policy(by));
        let Some(driver) = now.and_then(|now| self.drivers.get_mut(now)) else { return Ok(()) };
        match motion.filter(|_| last == now) {
            Some(motion) => driver.go_on(observation, motion),
            None => driver.begin(observation),
        }
    }

    /// What the one that is to drive chooses from, where the guards of the script leave these of the plan's motions.
    pub(super) fn hand(&self, left: Allowed) -> Option<Hand> {
        let by = self.by?;
        let policy = *self.policies.get(by)?;
        Some(self.drivers.get(policy)?.hand(by, policy, left))
    }

    /// Passes who is to drive, and what each of them remembers.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.option(&mut self.by, Passing::size)?;
        by.all(&mut self.drivers, |by, driver| driver.pass(by))
    }

    /// What the one that is to drive perceives: its state, and that in words.
    pub(super) fn described(&self) -> Option<(usize, String)> {
        let driver = self.drivers.get(*self.policies.get(self.by?)?)?;
        Some((driver.state, driver.eyes.map.describe(driver.state).text))
    }
}

/// A used policy's own eyes and script, on the robot of another.
struct CoDriver {
    eyes: Eyes,
    judge: Judge,
    laser: LaserTold,
    period_s: f64,
    /// Its actions, and their places among the plan's motions.
    actions: Vec<Twist>,
    motions: Vec<usize>,
    /// The slowest of its actions.
    slowest: usize,
    /// Steps of the robot that one of its own takes, and how many of the present one are done.
    every: u32,
    done: u32,
    /// Its own steps since it took over.
    steps: u64,
    last: Option<usize>,
    state: usize,
}

impl CoDriver {
    /// # Errors
    /// If its filters, grids or rules do not work here.
    fn new(plan: &Plan, used: &UsedPolicy) -> Result<Self> {
        let (judge, mut eyes) = (used.plan.judge()?, used.plan.eyes()?);
        eyes.look_for(judge.looks());
        eyes.go_on_from(used.policy.kept())?;
        let Some(every) = used.every(plan.settings.run.period_s) else {
            let message = format!("policy \"{}\" cannot drive in steps of this length", printable(&used.name));
            return Diagnostic::new("E-POLICY", message).help("leave --set run.period_s out").fail();
        };
        let actions = used.plan.settings.actions.clone();
        let speed = |action: &usize| (actions[*action].linear_m_per_s.abs(), actions[*action].angular_rad_per_s.abs());
        let slowest = (0..actions.len()).min_by(|a, b| {
            let (a, b) = (speed(a), speed(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        Ok(Self {
            eyes,
            judge,
            laser: LaserTold::of(&plan.settings.laser),
            period_s: plan.settings.run.period_s,
            motions: plan.motions_of(used),
            slowest: slowest.unwrap_or(0),
            every,
            actions,
            done: 0,
            steps: 0,
            last: None,
            state: 0,
        })
    }

    fn calibrate(&mut self, observation: &Observation) -> Result<()> {
        self.eyes.look(observation)?;
        self.tell(observation, NO_ACTION);
        self.judge.calibrate()
    }

    /// Takes over.
    fn begin(&mut self, observation: &Observation) -> Result<()> {
        (self.done, self.steps, self.last) = (0, 0, None);
        self.eyes.forget();
        if self.eyes.keep() {
            self.eyes.moved(&moved(observation, self.period_s, true))?;
        }
        self.eyes.look(observation)?;
        self.rest(observation)
    }

    /// Goes on after a step of the robot in which it was to drive; `motion` is what the robot did.
    fn go_on(&mut self, observation: &Observation, motion: usize) -> Result<()> {
        self.last = self.motions.iter().position(|own| *own == motion);
        self.done += 1;
        if self.eyes.keep() {
            self.eyes.moved(&moved(observation, self.period_s, false))?;
        }
        if self.done < self.every {
            return Ok(());
        }
        (self.done, self.steps) = (0, self.steps + 1);
        self.eyes.look(observation)?;
        if !self.judge.remembers() {
            self.state = self.eyes.state(observation, self.judge.digits())?;
            return Ok(());
        }
        self.tell(observation, self.last.unwrap_or(NO_ACTION));
        if self.judge.judge()?.then.is_some() {
            // The grids begin anew with the next image.
            self.eyes.forget();
            self.steps = 0;
            return self.rest(observation);
        }
        self.state = self.eyes.state(observation, self.judge.digits())?;
        Ok(())
    }

    /// What it is to choose from, where the guards of the script leave these of the plan's motions.
    fn hand(&self, by: usize, policy: usize, left: Allowed) -> Hand {
        let all = Allowed::of_bits(u64::MAX >> (64 - self.actions.len().clamp(1, 64)));
        let of = |kept: &dyn Fn(usize) -> bool| {
            let kept = (0..self.actions.len()).filter(|action| kept(*action));
            kept.fold(Allowed::NONE, Allowed::with)
        };
        let own = self.judge.leave().allowed;
        let by_script = of(&|action| left.contains(self.motions[action]));
        let by_both = of(&|action| by_script.contains(action) && own.contains(action));
        let fit = [by_both, by_script, Allowed::NONE.with(self.slowest)];
        let allowed = fit.into_iter().find(|set| set.bits() != 0).unwrap_or(all);
        let held = self.last.filter(|last| self.done > 0 && allowed.contains(*last));
        let allowed = if allowed == all { Allowed::ALL } else { allowed };
        Hand { by, policy, state: self.state, allowed, held }
    }

    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        self.eyes.pass(by)?;
        self.judge.pass(by)?;
        by.small(&mut self.done)?;
        by.whole(&mut self.steps)?;
        by.option(&mut self.last, Passing::size)?;
        by.size(&mut self.state)
    }

    fn rest(&mut self, observation: &Observation) -> Result<()> {
        if self.judge.remembers() {
            self.judge.recovered();
            self.tell(observation, NO_ACTION);
            self.judge.take()?;
        }
        self.state = self.eyes.state(observation, self.judge.digits())?;
        Ok(())
    }

    fn tell(&mut self, observation: &Observation, action: usize) {
        let twist = self.actions.get(action).copied().unwrap_or_default();
        let (step, state) = (self.steps, self.state);
        let told = StepTold { action, twist, step, since_recovery: step, state };
        tell(&mut self.judge, &mut self.eyes, observation, self.laser, told);
    }
}
