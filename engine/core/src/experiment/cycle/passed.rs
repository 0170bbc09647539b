//! What of a cycle goes on from step to step, for checkpoints. What it last observed is not among it: the next step looks anew.

use super::Cycle;
use crate::outcome::pass_destination;
use crate::robot::Robot;
use crate::saved::{Passed, Passing};

impl<R: Robot> Cycle<R> {
    /// Passes robot, eyes, judge and counters, the policies that are used, and who judges along.
    pub(in crate::experiment) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        self.robot.pass(by)?;
        by.all(&mut self.eyes, |by, eyes| eyes.pass(by))?;
        by.all(&mut self.states, Passing::size)?;
        let world = self.robot.world_index();
        self.judge.go_to(world);
        self.judge.pass(by)?;
        self.co_drivers.pass(by)?;
        by.all(&mut self.witnesses, |by, witness| witness.pass(world, by))?;
        by.whole(&mut self.steps)?;
        by.whole(&mut self.since_recovery)?;
        by.number(&mut self.potential)?;
        self.laser.pass(by)?;
        self.leave.allowed.pass(by)?;
        by.small(&mut self.leave.guards)?;
        pass_destination(by, &mut self.ended.to)?;
        by.option(&mut self.ended.good, Passing::flag)
    }
}
