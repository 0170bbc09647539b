//! Where a body stands: a place on the floor plan and a plane above it.

use crate::geometry::Pose;
use crate::saved::{Passed, Passing};

/// A pose with the plane that the body stands on: z = `z_m` + `slope_x` * x + `slope_y` * y in the body's own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stance {
    pub(super) pose: Pose,
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) z_m: f64,
    pub(super) slope_x: f64,
    pub(super) slope_y: f64,
}

impl Stance {
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.pose(&mut self.pose)?;
        by.numbers([&mut self.sin, &mut self.cos, &mut self.z_m, &mut self.slope_x, &mut self.slope_y])
    }

    /// Level at height `z_m`.
    pub(super) fn level(pose: Pose, z_m: f64) -> Self {
        let (sin, cos) = libm::sincos(pose.yaw_rad);
        Self { pose, sin, cos, z_m, slope_x: 0.0, slope_y: 0.0 }
    }

    /// This plane carried along to another pose.
    pub(super) fn moved(self, pose: Pose) -> Self {
        Self { z_m: self.z_m, slope_x: self.slope_x, slope_y: self.slope_y, ..Self::level(pose, 0.0) }
    }

    /// A point of the body's axes in the world's.
    pub(super) fn world(&self, x: f64, y: f64) -> (f64, f64) {
        (self.pose.x_m + x * self.cos - y * self.sin, self.pose.y_m + x * self.sin + y * self.cos)
    }

    /// A point of the world in the body's axes.
    pub(super) fn local(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - self.pose.x_m, y - self.pose.y_m);
        (x * self.cos + y * self.sin, y * self.cos - x * self.sin)
    }

    /// Height of the plane at a point of the body's axes.
    pub(super) fn plane_m(&self, x: f64, y: f64) -> f64 {
        self.z_m + self.slope_x * x + self.slope_y * y
    }
}
