//! Where everything that drives by itself was, along the records of a phase.

use std::sync::Arc;

use super::{Ledger, Phase, Plan, Record};
use crate::geometry::{Point2, Pose};
use crate::world::Movements;

/// The movers of a recorded phase. They follow from its seed and its records: nothing is simulated again.
#[derive(Clone)]
pub struct RecordedMovers<'a> {
    plan: &'a Plan,
    seed: u64,
    movements: Movements,
    /// Records that were followed.
    done: usize,
    /// The last of them ended its attempt.
    ended: bool,
}

impl<'a> RecordedMovers<'a> {
    /// As they are before the first step of a phase of a seed.
    #[must_use]
    pub fn new(plan: &'a Plan, seed: u64, phase: Phase) -> Self {
        let seed = phase.seed(seed);
        Self { plan, seed, movements: movements(plan, seed), done: 0, ended: false }
    }

    /// Goes to the end of a recorded step, before any recovery; back to an earlier one if need be.
    pub fn seek(&mut self, ledger: &Ledger, step: usize) {
        let period_s = self.plan.settings.run.period_s;
        if !self.movements.live() {
            self.movements.advance((step + 1) as f64 * period_s, std::iter::empty());
            return;
        }
        if step + 1 < self.done {
            *self = Self { movements: movements(self.plan, self.seed), done: 0, ended: false, ..*self };
        }
        while self.done <= step
            && let Some(record) = ledger.record(self.done)
        {
            self.follow(&record, period_s);
        }
    }

    fn follow(&mut self, record: &Record, period_s: f64) {
        if self.ended {
            self.movements.begin();
        }
        self.done += 1;
        let robot = Point2::new(record.pose.x_m, record.pose.y_m);
        self.movements.advance(self.done as f64 * period_s, std::iter::once(robot));
        self.ended = record.then.is_some();
    }

    /// Where they are, in the order of the world file.
    pub fn poses(&self) -> impl Iterator<Item = Pose> + '_ {
        self.movements.poses()
    }
}

fn movements(plan: &Plan, seed: u64) -> Movements {
    Movements::new(Arc::clone(&plan.layout), seed, plan.settings.movers.speed)
}
