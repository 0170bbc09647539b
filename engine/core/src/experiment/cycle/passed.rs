//! What of a cycle goes on from step to step, for checkpoints. What it last observed is not among it: the next step looks anew.

use super::Cycle;
use crate::allowed::Allowed;
use crate::outcome::pass_destination;
use crate::robot::Robot;
use crate::saved::{Passed, Passing, Unfit};

impl<R: Robot> Cycle<R> {
    /// Passes robot, eyes, judge and counters; refused while others judge along.
    pub(in crate::experiment) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        if !self.witnesses.is_empty() {
            return Err(Unfit);
        }
        self.robot.pass(by)?;
        by.all(&mut self.eyes, |by, eyes| eyes.pass(by))?;
        by.all(&mut self.states, Passing::size)?;
        self.judge.go_to(self.robot.world_index());
        self.judge.pass(by)?;
        by.whole(&mut self.steps)?;
        by.whole(&mut self.since_recovery)?;
        by.number(&mut self.potential)?;
        self.laser.pass(by)?;
        let mut allowed = self.leave.allowed.bits();
        by.whole(&mut allowed)?;
        self.leave.allowed = Allowed::of_bits(allowed);
        by.small(&mut self.leave.guards)?;
        pass_destination(by, &mut self.ended.to)?;
        by.option(&mut self.ended.good, Passing::flag)
    }
}
