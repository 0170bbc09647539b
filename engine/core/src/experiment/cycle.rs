//! One step of the robot, the order of which is the order of the folders: act, sense, filter, state, judge.

mod asked;
mod passed;
mod shown;
mod witness;

use crate::allowed::Allowed;
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::Twist;
use crate::judge::{Judge, Judgement, Leave, NO_ACTION};
use crate::outcome::Ending;
use crate::robot::{Ended, Robot};
use crate::sensors::observation::Observation;
use crate::state::StateMap;

use super::co_driver::CoDrivers;
use super::doors::{Asked, no_action};
use super::eyes::moved;
use super::telling::{LaserTold, StepTold, tell};
use super::{Eyes, Hand, Plan, Step};
use asked::asking_for;
use filter_api::Format;
use witness::Witness;
pub(super) use witness::Witnessed;

/// In a script without goals, an attempt of so many steps went well.
const LONG_STEPS: u64 = 400;

/// A robot with what turns its observations into states and rewards. It does not know who chooses the actions.
pub struct Cycle<R> {
    robot: R,
    /// The script's own first; the judge looks through these.
    eyes: Vec<Eyes>,
    /// Whether anything of the script itself reads what the camera sees.
    looks: bool,
    states: Vec<usize>,
    judge: Judge,
    actions: Vec<Twist>,
    observation: Observation,
    /// Steps that were done.
    steps: u64,
    since_recovery: u64,
    /// What the judge's delayed rules have built up.
    potential: f64,
    laser: LaserTold,
    /// What guards leave of the actions now.
    leave: Leave,
    /// The policies that the script uses.
    co_drivers: CoDrivers,
    /// Whether the script can reach a goal.
    has_goals: bool,
    /// What the robot is told if it is to recover now.
    ended: Ended,
    /// After so many steps an attempt is broken off.
    stay_steps: u64,
    /// Other rules that judge along.
    witnesses: Vec<Witness>,
    period_s: f64,
}

impl<R: Robot> Cycle<R> {
    /// Takes the first observation and runs the script's calibration on it.
    ///
    /// # Errors
    /// If the plan's filters, grid or script do not work, or a sensor fails.
    pub fn new(plan: &Plan, robot: R) -> Result<Self> {
        Self::with_eyes(plan, robot, plan.eyes()?, Vec::new())
    }

    /// A cycle whose eyes go on from what the filters of others kept; from nothing if that is empty.
    ///
    /// # Errors
    /// As [`Cycle::new`], and if the plan's filters do not keep such a thing.
    pub fn going_on_from(plan: &Plan, robot: R, kept: &[u8]) -> Result<Self> {
        Self::watched(plan, robot, &[], kept)
    }

    /// A cycle whose states come from another map than the plan's grid.
    ///
    /// # Errors
    /// As [`Cycle::new`].
    pub fn with_map(plan: &Plan, robot: R, map: Box<dyn StateMap>) -> Result<Self> {
        Self::with_eyes(plan, robot, plan.eyes()?.with_map(map), Vec::new())
    }

    /// A cycle that looks through its own eyes, by which the script judges too, and through those of others: one more state
    /// for each of them.
    ///
    /// # Errors
    /// As [`Cycle::new`].
    pub fn with_eyes(plan: &Plan, robot: R, own: Eyes, others: Vec<Eyes>) -> Result<Self> {
        Self::before(plan, robot, own, others, Vec::new())
    }

    /// As [`Cycle::with_eyes`], before those who judge along.
    fn before(plan: &Plan, robot: R, mut own: Eyes, mut others: Vec<Eyes>, witnesses: Vec<Witness>) -> Result<Self> {
        let settings = &plan.settings;
        let judge = plan.judge()?;
        let co_drivers = CoDrivers::new(plan)?;
        let looks = !own.are_closed();
        if witnesses.iter().any(Witness::reads_views) {
            own.open();
        }
        others.insert(0, own);
        let likes: Vec<Format> = others.iter().flat_map(Eyes::likes).chain(co_drivers.like()).collect();
        let mut cycle = Self {
            robot,
            states: vec![0; others.len()],
            eyes: others,
            looks,
            judge,
            actions: plan.motions(),
            observation: asking_for(settings, &likes),
            steps: 0,
            since_recovery: 0,
            potential: 0.0,
            laser: LaserTold::of(&settings.laser),
            leave: Leave::default(),
            co_drivers,
            has_goals: plan.behaviour.has_goals(),
            ended: Ended::default(),
            stay_steps: plan.stay_steps(),
            witnesses,
            period_s: settings.run.period_s,
        };
        cycle.measure_reach();
        cycle.look();
        cycle.perceive(true)?;
        cycle.calibrate()?;
        cycle.rest()?;
        cycle.set_witnesses_out()?;
        Ok(cycle)
    }

    /// From the next step on another script judges; it is calibrated on the present observation, as at the start of a run.
    ///
    /// # Errors
    /// If the script fails.
    pub(super) fn swap_judge(&mut self, plan: &Plan) -> Result<()> {
        self.judge = plan.judge()?;
        self.co_drivers.swap_uses(plan);
        self.look();
        if self.judge.reads_views() && !std::mem::replace(&mut self.looks, true) {
            if self.eyes[0].open() {
                self.observation.ask_anew(&asking_for(&plan.settings, &self.likes()));
            }
            self.perceive(true)?;
        }
        self.has_goals = plan.behaviour.has_goals();
        (self.potential, self.leave) = (0.0, Leave::default());
        self.judge.go_to(self.robot.world_index());
        self.calibrate()?;
        self.rest()
    }

    fn calibrate(&mut self) -> Result<()> {
        self.fill_facts(0, self.steps);
        if self.steps == 0 {
            self.co_drivers.calibrate(&self.observation)?;
        }
        self.judge.calibrate()
    }

    fn reads_ground(&self) -> bool {
        let witnesses = self.witnesses.iter().any(Witness::reads_ground);
        self.judge.reads_ground() || self.co_drivers.read_ground() || witnesses
    }

    /// The learned policy that is to choose now, if a use holds.
    #[must_use]
    pub fn hand(&self) -> Option<Hand> {
        self.co_drivers.hand(self.leave.allowed)
    }

    /// What the policy that is to choose now perceives: its state, and that in words.
    pub(super) fn handed_state(&self) -> Option<(usize, String)> {
        self.co_drivers.described()
    }

    /// What a script remembers begins with the robot at rest.
    fn rest(&mut self) -> Result<()> {
        if self.judge.remembers() {
            self.judge.recovered();
            self.fill_facts(NO_ACTION, self.steps);
            self.judge.take()?;
            self.compose()?;
            self.leave = self.judge.leave();
            self.co_drivers.ask(self.judge.driver(), &self.observation, None)?;
        }
        Ok(())
    }

    /// The states of what was looked at last.
    fn compose(&mut self) -> Result<()> {
        for (eyes, state) in self.eyes.iter_mut().zip(&mut self.states) {
            *state = eyes.state(&self.observation, self.judge.digits())?;
        }
        Ok(())
    }

    /// The present state, as the script perceives it.
    #[must_use]
    pub fn state(&self) -> usize {
        self.states[0]
    }

    /// The present states: the script's own, then one for each of the other eyes.
    #[must_use]
    pub fn states(&self) -> &[usize] {
        &self.states
    }

    /// How many things the robot can be told to do.
    pub(super) fn motions(&self) -> usize {
        self.actions.len()
    }

    /// Steps that were done.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The actions that the script's guards leave now: at least one.
    #[must_use]
    pub fn allowed(&self) -> Allowed {
        self.leave.allowed
    }

    /// An action or, if a guard forbids it now, the slowest one that may be taken.
    #[must_use]
    pub fn instead_of(&self, action: usize) -> usize {
        self.judge.guarding().instead_of(action, self.leave.allowed)
    }

    /// Whether a guard holds for the choice that comes next; guards are counted from 0 in the order of the script.
    #[must_use]
    pub fn guard_holds(&self, guard: usize) -> bool {
        self.leave.holds(guard)
    }

    /// Which actions may be taken now, and which guards hold.
    pub(super) fn leave(&self) -> Leave {
        self.leave
    }

    /// Carries out an action, whatever guards say of it, and judges what came of it.
    ///
    /// # Errors
    /// If a sensor, a filter or the script fails; the message names the step. `E-DOOR` for an action that the robot does not
    /// have, and for what a robot or a state map of somebody's own must not give.
    pub fn step(&mut self, action: usize) -> Result<Step> {
        let (index, state, potential, driver) = (self.steps, self.state(), self.potential, self.co_drivers.by());
        let Some(&twist) = self.actions.get(action) else { return no_action(action, self.actions.len()).fail() };
        self.robot.act(twist)?;
        self.since_recovery += 1;
        self.perceive(false)?;
        self.fill_facts(action, index + 1);
        self.tell_witnesses(action, index + 1);
        let stage = self.judge.stage();
        let verdict = self.judge.judge().map_err(|error| at_step(error, index))?;
        let guarded = !self.leave.allowed.is_all();
        let hop = self.since_recovery >= self.stay_steps && verdict.then.is_none();
        let moves = hop || verdict.then.is_some();
        if self.judge.remembers() {
            self.compose()?;
            self.leave = self.judge.leave();
            // Where the robot is put elsewhere, the uses are asked again there.
            if !moves {
                let asked = self.co_drivers.ask(self.judge.driver(), &self.observation, Some(action));
                asked.map_err(|error| at_step(error, index))?;
            }
        }
        self.steps += 1;
        self.potential = self.judge.potential();
        self.ended = self.ended(&verdict, hop);
        let step = Step {
            index,
            state,
            action,
            explored: false,
            reward: verdict.reward,
            next_state: self.state(),
            potential,
            next_potential: self.potential,
            then: verdict.then,
            to: verdict.to,
            entered: verdict.stage.filter(|entered| *entered != stage),
            contact: self.observation.contact,
            driver: None,
            hands_over: !moves && self.co_drivers.drive(),
            guarded,
            next_allowed: self.leave.allowed,
            hop,
        };
        // Those who judge along do so where whoever chooses hands over to the policies that are used.
        self.ask_witnesses(&Step { driver, ..step }).map_err(|error| at_step(error, index))?;
        Ok(step)
    }

    /// What the robot is told of an attempt that ends here.
    fn ended(&self, verdict: &Judgement, hop: bool) -> Ended {
        let ending = verdict.then.map(|then| then.ending(verdict.reward));
        // Who was broken off after the longest stay has lasted; whether it would have reached a goal cannot be told.
        let lasted = hop || self.since_recovery >= LONG_STEPS || ending == Some(Ending::Restart);
        let good = if self.has_goals { ending == Some(Ending::Goal) } else { lasted };
        Ended { to: verdict.to, good: (!hop || !self.has_goals).then_some(good) }
    }

    /// The laser's range may have been drawn anew.
    fn measure_reach(&mut self) {
        if let Some(max_range_m) = self.robot.laser_max_range_m() {
            self.laser.reaches(max_range_m);
        }
    }

    /// Brings the robot back to a safe pose. Not a step: nothing is judged or learned from it.
    ///
    /// # Errors
    /// If there is no safe pose, or a sensor fails.
    pub fn recover(&mut self) -> Result<()> {
        self.robot.recover_after(std::mem::take(&mut self.ended))?;
        self.judge.go_to(self.robot.world_index());
        self.measure_reach();
        self.judge.recovered();
        self.potential = 0.0;
        self.since_recovery = 0;
        self.eyes.iter_mut().for_each(Eyes::forget);
        self.perceive(true)?;
        if !self.judge.is_calibrated() {
            self.calibrate()?;
        } else if self.stay_steps < u64::MAX {
            // Whoever judges a record anew is calibrated by what is seen on arrival.
            self.fill_facts(0, self.steps);
        }
        self.rest()?;
        self.set_witnesses_out()
    }

    /// What the filters of the script's own eyes keep; empty if they keep nothing.
    pub(super) fn kept(&mut self) -> Vec<u8> {
        // Whoever goes on from nothing where there should be something is told so.
        self.eyes[0].kept().unwrap_or_default()
    }

    /// Sense, filter, state.
    fn perceive(&mut self, jumped: bool) -> Result<()> {
        let asked = Asked::of(&self.observation);
        self.robot.observe(&mut self.observation)?;
        asked.check(&self.observation)?;
        for eyes in &mut self.eyes {
            if eyes.keep() {
                eyes.moved(&moved(&self.observation, self.period_s, jumped))?;
            }
            eyes.look(&self.observation)?;
        }
        self.compose()
    }

    fn fill_facts(&mut self, action: usize, step: u64) {
        let told = self.told(action, step);
        tell(&mut self.judge, &mut self.eyes[0], &self.observation, self.laser, told);
    }

    fn told(&self, action: usize, step: u64) -> StepTold {
        let twist = self.actions.get(action).copied().unwrap_or_default();
        StepTold { action, twist, step, since_recovery: self.since_recovery, state: self.states[0] }
    }
}

fn at_step(mut error: Box<Diagnostic>, index: u64) -> Box<Diagnostic> {
    error.message = format!("{} (in step {index})", error.message);
    error
}
