//! Where everything that drives by itself was, along the records of a phase.

use std::sync::Arc;

use super::{Ledger, Phase, Plan, Record};
use crate::geometry::{Point2, Pose};
use crate::robot::speeds_of_movers;
use crate::world::Movements;

/// The movers of a recorded phase. They follow from its seed and its records: nothing is simulated again.
#[derive(Clone)]
pub struct RecordedMovers<'a> {
    plan: &'a Plan,
    seed: u64,
    /// By world, with the periods for which the robot was there.
    movements: Vec<(Movements, u64)>,
    /// The world of the last record.
    at: usize,
    /// Records that were followed.
    done: usize,
    /// The last of them ended its attempt.
    ended: bool,
}

impl<'a> RecordedMovers<'a> {
    /// As they are before the first step of a phase of a seed.
    #[must_use]
    pub fn new(plan: &'a Plan, seed: u64, phase: Phase) -> Self {
        Self::begun(plan, phase.seed(seed))
    }

    fn begun(plan: &'a Plan, seed: u64) -> Self {
        let scale = plan.settings.movers.speed;
        let worlds = plan.worlds.layouts().iter().enumerate();
        let movements = worlds.map(|(world, layout)| {
            (Movements::new(Arc::clone(layout), crate::robot::seed_of_world(seed, world), scale), 0)
        });
        Self { plan, seed, movements: movements.collect(), at: 0, done: 0, ended: false }
    }

    /// Goes to the end of a recorded step, before any recovery; back to an earlier one if need be.
    pub fn seek(&mut self, ledger: &Ledger, step: usize) {
        let period_s = self.plan.settings.run.period_s;
        if !self.plan.varies() && !self.movements[0].0.live() {
            self.movements[0].0.advance((step + 1) as f64 * period_s, std::iter::empty());
            return;
        }
        if step + 1 < self.done {
            *self = Self::begun(self.plan, self.seed);
        }
        while self.done <= step
            && let Some(record) = ledger.record(self.done)
        {
            self.follow(ledger, &record, period_s);
        }
    }

    fn follow(&mut self, ledger: &Ledger, record: &Record, period_s: f64) {
        let attempt = ledger.attempt(self.done);
        self.at = attempt.as_ref().map_or(0, |attempt| attempt.world).min(self.movements.len() - 1);
        let (movements, periods) = &mut self.movements[self.at];
        if let Some(attempt) = attempt.as_ref().filter(|_| self.ended || self.done == 0) {
            let movers = &self.plan.worlds.layouts()[self.at].movers;
            for (mover, speed) in speeds_of_movers(&self.plan.settings, &attempt.drawn, movers).enumerate() {
                movements.set_scale(mover, speed);
            }
        }
        if self.ended {
            movements.begin();
        }
        self.done += 1;
        *periods += 1;
        let robot = Point2::new(record.pose.x_m, record.pose.y_m);
        movements.advance(*periods as f64 * period_s, std::iter::once(robot));
        self.ended = record.then.is_some() || attempt.is_some_and(|attempt| attempt.hop);
    }

    /// Where they are, in the order of the world file; of several worlds, in that of the last step.
    pub fn poses(&self) -> impl Iterator<Item = Pose> + '_ {
        self.movements[self.at].0.poses()
    }
}
