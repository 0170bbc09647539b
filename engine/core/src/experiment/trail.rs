//! The robot's path, kept for drawing.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Step};
use crate::geometry::Pose;
use crate::outcome::Ending;
use crate::robot::Robot;
use crate::saved::{Passed, Passing};

/// A path in the home world: legs between recoveries, and where it failed and reached its goals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trail {
    /// Places in the order of time, metres; a new leg begins after each recovery.
    pub legs: Vec<Vec<[f32; 2]>>,
    /// Where attempts failed.
    pub failures: Vec<[f32; 2]>,
    /// Where the robot stands at the end, if anything knows.
    pub last: Option<Pose>,
    /// Where they reached their goals.
    pub goals: Vec<[f32; 2]>,
    /// Where everything that drives by itself was at the end.
    pub movers: Vec<Pose>,
}

impl Trail {
    /// How many steps it holds: each ends at a place, and each leg begins at one.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.legs.iter().map(|leg| leg.len().saturating_sub(1)).sum()
    }
}

/// Records a trail of so many steps.
#[derive(Debug, Clone)]
pub(super) struct Recorder {
    trail: Trail,
    left: u64,
}

impl Recorder {
    /// A trail of at most `steps` steps that begins where the robot is.
    pub(super) fn new(steps: u64, robot: &impl Robot) -> Self {
        let mut leg = Vec::with_capacity(steps as usize + 1);
        leg.extend(place(robot));
        let movers = (0..).map_while(|index| robot.mover(index)).collect();
        Self { trail: Trail { legs: vec![leg], movers, ..Trail::default() }, left: steps }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        let point = |by: &mut Passing<'_>, [x, y]: &mut [f32; 2]| {
            by.single(x)?;
            by.single(y)
        };
        let Trail { legs, failures, last, goals, movers } = &mut self.trail;
        by.list(legs, |by, leg| by.list(leg, point))?;
        by.list(failures, point)?;
        by.list(goals, point)?;
        by.option(last, Passing::pose)?;
        by.list(movers, Passing::pose)?;
        by.whole(&mut self.left)
    }

    pub(super) fn finish(self) -> Trail {
        self.trail
    }
}

impl<R: Robot> Observer<R> for Recorder {
    /// Adds the robot's place after a step.
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        if cycle.robot().world_index() > 0 {
            return ControlFlow::Continue(());
        }
        if self.left > 0
            && let Some(place) = place(cycle.robot())
        {
            self.trail.last = cycle.robot().whereabouts().map(|here| here.pose);
            if let Some(leg) = self.trail.legs.last_mut() {
                leg.push(place);
            }
            match step.ending() {
                Some(Ending::Failure) => self.trail.failures.push(place),
                Some(Ending::Goal) => self.trail.goals.push(place),
                _ => {}
            }
            for (index, mover) in self.trail.movers.iter_mut().enumerate() {
                *mover = cycle.robot().mover(index).unwrap_or(*mover);
            }
        }
        self.left = self.left.saturating_sub(1);
        ControlFlow::Continue(())
    }

    /// Begins a new leg where the robot was put.
    fn recovered(&mut self, cycle: &Cycle<R>) {
        if self.left > 0 && cycle.robot().world_index() == 0 {
            self.trail.legs.push(place(cycle.robot()).into_iter().collect());
        }
    }
}

fn place(robot: &impl Robot) -> Option<[f32; 2]> {
    robot.whereabouts().map(|here| point(here.pose))
}

fn point(pose: Pose) -> [f32; 2] {
    [pose.x_m as f32, pose.y_m as f32]
}
