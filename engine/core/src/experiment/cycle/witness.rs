//! Other rules that judge along: what they say of each step that the robot does under its own.

use std::collections::VecDeque;

use super::Cycle;
use crate::diagnostic::Result;
use crate::experiment::parts::Parts;
use crate::experiment::telling::tell;
use crate::experiment::{Plan, Step};
use crate::judge::{Judge, Look, NO_ACTION};
use crate::learner::{Rejudged, Transition};
use crate::outcome::Then;
use crate::robot::Robot;
use crate::saved::{Passed, Passing};

/// What is said of one step by who judges along.
#[derive(Debug, Clone, Copy)]
pub(in crate::experiment) struct Witnessed {
    pub transition: Transition,
    /// What these rules say if the attempt ends here by them.
    pub then: Option<Then>,
    /// The use that holds at its end.
    pub driver: Option<usize>,
}

/// A judge that looks on.
pub(in crate::experiment) struct Witness {
    judge: Judge,
    /// What its delayed rules have built up.
    potential: f64,
    /// What it said of the latest steps that were the script's own, the oldest first.
    said: VecDeque<Rejudged>,
    /// The last of these goes on while used policies drive.
    goes_on: bool,
    /// What it said of the last step, whoever drove.
    last: Option<Witnessed>,
    /// So many are kept.
    most: usize,
}

impl Witness {
    /// The rules of a plan as a judge of what the robot of another plan does.
    ///
    /// # Errors
    /// If they read what that robot does not have.
    fn new(rules: &Plan, under: &Plan) -> Result<Self> {
        let parts = Parts { behaviour: &rules.behaviour, settings: &under.settings, filters: &under.filters };
        let judge = parts.judge()?.in_worlds(under.names_of_starts());
        let own = under.settings.actions.len();
        let judge = if under.used.is_empty() { judge } else { judge.with_actions(&under.motions(), own) };
        let most = under.settings.learner.memory_steps as usize;
        Ok(Self { judge, potential: 0.0, said: VecDeque::new(), goes_on: false, last: None, most })
    }

    fn looks(&self) -> &[Look] {
        self.judge.looks()
    }

    pub(super) fn reads_views(&self) -> bool {
        self.judge.reads_views()
    }

    pub(super) fn reads_ground(&self) -> bool {
        self.judge.reads_ground()
    }

    /// Judges the facts that it was told, after a step.
    fn judge(&mut self, step: &Step) -> Result<()> {
        let verdict = self.judge.judge()?;
        let (before, after) = (self.potential, self.judge.potential());
        self.potential = after;
        let transition = Transition {
            reward: verdict.reward,
            ending: verdict.then.map(|then| then.ending(verdict.reward)),
            potential: before,
            next_potential: after,
            next_allowed: self.judge.leave().allowed,
            ..step.transition()
        };
        self.last = Some(Witnessed { transition, then: verdict.then, driver: self.judge.driver() });
        self.note(Rejudged { transition, moved: step.moves() }, step);
        if verdict.then.is_some() && !step.moves() {
            // Its attempt has ended, though the robot goes on from where it is.
            self.begin();
        }
        Ok(())
    }

    /// Keeps what it said of a step of the script's own; a hand-over to a used policy belongs to the step before it, as it does
    /// for who learns.
    fn note(&mut self, said: Rejudged, step: &Step) {
        match (step.driver, self.said.back_mut().filter(|_| self.goes_on)) {
            (None, _) => {
                if self.said.len() == self.most {
                    self.said.pop_front();
                }
                self.said.push_back(said);
            }
            (Some(_), Some(own)) => {
                let Rejudged { transition, moved } = said;
                let Transition { state, action, reward, potential, .. } = own.transition;
                own.transition = Transition { state, action, potential, ..transition };
                own.transition.reward += reward;
                own.moved = moved;
            }
            (Some(_), None) => return,
        }
        let ended = self.last.is_some_and(|last| last.then.is_some()) || step.moves();
        self.goes_on = step.hands_over && !ended;
    }

    /// Passes what goes on from step to step; what it said of the last step is said anew of the next.
    pub(super) fn pass(&mut self, world: usize, by: &mut Passing<'_>) -> Passed {
        self.judge.go_to(world);
        self.judge.pass(by)?;
        by.number(&mut self.potential)?;
        let mut said = std::mem::take(&mut self.said).into();
        by.list(&mut said, |by: &mut Passing<'_>, said: &mut Rejudged| said.pass(by))?;
        self.said = said.into();
        by.flag(&mut self.goes_on)
    }

    /// By rule: what each added in the last step, if it fired.
    pub(in crate::experiment) fn fired(&self) -> &[Option<f64>] {
        self.judge.fired()
    }

    /// What it said of the last step.
    pub(in crate::experiment) fn last(&self) -> Option<Witnessed> {
        self.last
    }

    /// Another attempt begins.
    fn begin(&mut self) {
        self.judge.recovered();
        self.potential = 0.0;
    }
}

impl<R: Robot> Cycle<R> {
    /// A cycle beside which the rules of other plans judge along, and whose eyes go on from what others kept.
    ///
    /// # Errors
    /// As [`Cycle::new`], and if the other rules read what this robot does not have.
    pub(in crate::experiment) fn watched(plan: &Plan, robot: R, others: &[&Plan], kept: &[u8]) -> Result<Self> {
        let mut eyes = plan.eyes()?;
        eyes.go_on_from(kept)?;
        let witnesses = others.iter().map(|rules| Witness::new(rules, plan)).collect::<Result<_>>()?;
        Self::before(plan, robot, eyes, Vec::new(), witnesses)
    }

    /// What the witness that was called first has said; it looks on no more.
    pub(in crate::experiment) fn dismiss_witness(&mut self) -> Vec<Rejudged> {
        if self.witnesses.is_empty() { Vec::new() } else { self.witnesses.remove(0).said.into() }
    }

    /// The first of those that judge along.
    pub(in crate::experiment) fn witness(&self) -> Option<&Witness> {
        self.witnesses.first()
    }

    /// The use by which a policy is to drive now.
    pub(in crate::experiment) fn driver(&self) -> Option<usize> {
        self.co_drivers.by()
    }

    /// Looks for all that anybody who judges reads.
    pub(super) fn look(&mut self) {
        let mut looks = self.judge.looks().to_vec();
        for witness in &self.witnesses {
            let wanted = witness.looks();
            looks.resize(looks.len().max(wanted.len()), Look::default());
            for (look, wanted) in looks.iter_mut().zip(wanted) {
                *look = Look { patch: look.patch || wanted.patch, line: look.line || wanted.line };
            }
        }
        self.eyes[0].look_for(&looks);
        self.observation.ground = self.reads_ground().then(Default::default);
    }

    /// All witnesses judge a step.
    pub(super) fn ask_witnesses(&mut self, step: &Step) -> Result<()> {
        self.witnesses.iter_mut().try_for_each(|witness| witness.judge(step))
    }

    /// Tells all witnesses what is known of a step.
    pub(super) fn tell_witnesses(&mut self, action: usize, step: u64) {
        let told = self.told(action, step);
        for witness in &mut self.witnesses {
            tell(&mut witness.judge, &mut self.eyes[0], &self.observation, self.laser, told);
        }
    }

    /// The robot stands where an attempt begins.
    pub(super) fn set_witnesses_out(&mut self) -> Result<()> {
        if self.witnesses.is_empty() {
            return Ok(());
        }
        let world = self.robot.world_index();
        for witness in &mut self.witnesses {
            witness.judge.go_to(world);
            witness.begin();
        }
        self.tell_witnesses(0, self.steps);
        for witness in self.witnesses.iter_mut().filter(|witness| !witness.judge.is_calibrated()) {
            witness.judge.calibrate()?;
        }
        self.tell_witnesses(NO_ACTION, self.steps);
        self.witnesses.iter_mut().filter(|witness| witness.judge.remembers()).try_for_each(|one| one.judge.take())
    }
}
