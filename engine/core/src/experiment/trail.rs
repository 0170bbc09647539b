//! The robot's path, kept for drawing.

use crate::geometry::Pose;
use crate::world::World;

/// A path: legs between recoveries, and where it failed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trail {
    /// Places in the order of time, metres; a new leg begins after each recovery.
    pub legs: Vec<Vec<[f32; 2]>>,
    /// Where the script asked for recovery.
    pub failures: Vec<[f32; 2]>,
}

/// Records a trail of so many steps.
#[derive(Debug, Clone)]
pub(super) struct Recorder {
    trail: Trail,
    left: u64,
}

impl Recorder {
    /// A trail of at most `steps` steps that begins where the robot is.
    pub(super) fn new(steps: u64, world: &World) -> Self {
        let mut leg = Vec::with_capacity(steps as usize + 1);
        leg.push(point(world.body(0).pose));
        Self { trail: Trail { legs: vec![leg], failures: Vec::new() }, left: steps }
    }

    /// Adds the robot's place after a step.
    pub(super) fn follow(&mut self, world: &World, failed: bool) {
        if self.left == 0 {
            return;
        }
        self.left -= 1;
        let place = point(world.body(0).pose);
        if let Some(leg) = self.trail.legs.last_mut() {
            leg.push(place);
        }
        if failed {
            self.trail.failures.push(place);
        }
    }

    /// Begins a new leg where the robot was put.
    pub(super) fn jump(&mut self, world: &World) {
        if self.left > 0 {
            self.trail.legs.push(vec![point(world.body(0).pose)]);
        }
    }

    pub(super) fn finish(self) -> Trail {
        self.trail
    }
}

fn point(pose: Pose) -> [f32; 2] {
    [pose.x_m as f32, pose.y_m as f32]
}
