//! Where bodies are, and what happened to them.

use crate::geometry::{Isometry3, Pose, Twist, rotation};
use nalgebra::{Translation3, UnitQuaternion};

/// Where a robot's body is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Its place and heading on the floor plan.
    pub pose: Pose,
    /// Height of the ground under its origin, metres.
    pub z_m: f64,
    /// Nose down when positive, radians.
    pub pitch_rad: f64,
    /// Right side down when positive, radians.
    pub roll_rad: f64,
}

impl Body {
    /// The transform from the robot's axes, whose origin lies on the ground, to the world's.
    #[must_use]
    pub fn world_from_robot(&self) -> Isometry3 {
        let turn = UnitQuaternion::from_rotation_matrix(&rotation(self.pose.yaw_rad, self.pitch_rad, self.roll_rad));
        Isometry3::from_parts(Translation3::new(self.pose.x_m, self.pose.y_m, self.z_m), turn)
    }
}

/// What happened to a body in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// It touched something, or something touched it.
    pub contact: bool,
    /// It lies below an edge, since this period or an earlier one.
    pub fallen: bool,
    /// Mean speed of the wheels, as encoders measure it: before slip.
    pub odometry: Twist,
}
