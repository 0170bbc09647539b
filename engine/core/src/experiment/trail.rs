//! The robot's path, kept for drawing.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Step};
use crate::geometry::Pose;
use crate::outcome::Ending;
use crate::robot::Robot;
use crate::saved::{Passed, Passing};

/// A path in one world, the home world unless another is named: legs between recoveries, and where it failed and reached its goals.
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
    /// The paths in the other worlds of a run, each with the world's number, in the order in which the robot came there.
    pub further: Vec<(usize, Self)>,
}

impl Trail {
    /// How many steps it holds: each ends at a place, and each leg begins at one.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.legs.iter().map(|leg| leg.len().saturating_sub(1)).sum()
    }

    /// The path in the world of this number; nothing if the robot never was there.
    #[must_use]
    pub fn in_world(&self, world: usize) -> Option<&Self> {
        if world == 0 {
            return Some(self);
        }
        self.further.iter().find(|(number, _)| *number == world).map(|(_, trail)| trail)
    }
}

/// Records a trail of so many steps in each world.
#[derive(Debug, Clone)]
pub(super) struct Recorder {
    trail: Trail,
    /// Steps that it still takes in the home world, and in each of the others that the robot has come to.
    left: u64,
    further_left: Vec<u64>,
    /// Steps in each of the others; 0 for a trail of the home world alone.
    most: u64,
}

impl Recorder {
    /// A trail of at most `steps` steps that begins where the robot is.
    pub(super) fn new(steps: u64, robot: &impl Robot) -> Self {
        let mut leg = Vec::with_capacity(steps as usize + 1);
        leg.extend(place(robot));
        Self {
            trail: Trail { legs: vec![leg], movers: movers(robot), ..Trail::default() },
            left: steps,
            further_left: Vec::new(),
            most: 0,
        }
    }

    /// This recorder, but it takes as many steps in every other world too.
    pub(super) fn in_every_world(self) -> Self {
        Self { most: self.left, ..self }
    }

    /// The trail in the world where the robot is, and how many steps it still takes; nothing if it takes no more.
    fn here(&mut self, robot: &impl Robot) -> Option<(&mut Trail, &mut u64)> {
        let world = robot.world_index();
        let (trail, left) = if world == 0 {
            (&mut self.trail, &mut self.left)
        } else if self.most == 0 {
            return None;
        } else {
            let further = &mut self.trail.further;
            let known = further.iter().position(|(number, _)| *number == world);
            let index = known.unwrap_or_else(|| {
                further.push((world, Trail { movers: movers(robot), ..Trail::default() }));
                self.further_left.push(self.most);
                further.len() - 1
            });
            (&mut further.get_mut(index)?.1, self.further_left.get_mut(index)?)
        };
        (*left > 0).then_some((trail, left))
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        let point = |by: &mut Passing<'_>, [x, y]: &mut [f32; 2]| {
            by.single(x)?;
            by.single(y)
        };
        // Only a test, which is never kept, follows the robot into other worlds.
        let Trail { legs, failures, last, goals, movers, further: _ } = &mut self.trail;
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
        let robot = cycle.robot();
        if let Some(place) = place(robot)
            && let Some((trail, left)) = self.here(robot)
        {
            *left -= 1;
            trail.last = robot.whereabouts().map(|here| here.pose);
            if let Some(leg) = trail.legs.last_mut() {
                leg.push(place);
            }
            match step.ending() {
                Some(Ending::Failure) => trail.failures.push(place),
                Some(Ending::Goal) => trail.goals.push(place),
                _ => {}
            }
            for (index, mover) in trail.movers.iter_mut().enumerate() {
                *mover = robot.mover(index).unwrap_or(*mover);
            }
        }
        ControlFlow::Continue(())
    }

    /// Begins a new leg where the robot was put.
    fn recovered(&mut self, cycle: &Cycle<R>) {
        if let Some((trail, _)) = self.here(cycle.robot()) {
            trail.legs.push(place(cycle.robot()).into_iter().collect());
        }
    }
}

fn movers(robot: &impl Robot) -> Vec<Pose> {
    (0..).map_while(|index| robot.mover(index)).collect()
}

fn place(robot: &impl Robot) -> Option<[f32; 2]> {
    robot.whereabouts().map(|here| point(here.pose))
}

fn point(pose: Pose) -> [f32; 2] {
    [pose.x_m as f32, pose.y_m as f32]
}
