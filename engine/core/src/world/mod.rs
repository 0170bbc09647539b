//! TRUTH: what stands, what moves, and what the robot's body does among it.
//!
//! [`Layout`] is a world file, read once; [`World`] is the state of one robot in it. Sensors look at it through
//! [`World::layout`], [`World::moving`] and [`World::body`]; rewards and states never do.

mod contact;
mod drivetrain;
mod layout;
mod mover;
mod obstacle;
mod route;
mod route_progress;
pub mod scene;
mod stance;
mod terrain;
#[cfg(test)]
mod tests;
mod vehicle;

pub use layout::Layout;
pub use mover::Mover;
pub use route::Route;
pub use route_progress::RouteProgress;

use crate::geometry::{Isometry3, Pose, Twist, rotation};
use crate::settings::RobotSettings;
use drivetrain::Drivetrain;
use mover::Traffic;
use nalgebra::{Translation3, UnitQuaternion};
use scene::Solid;
use stance::Stance;
use std::sync::Arc;
use vehicle::Vehicle;

/// Where the robot's body is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Its place and heading on the floor plan.
    pub pose: Pose,
    /// Height of the ground under its centre, metres.
    pub z_m: f64,
    /// Nose down when positive, radians.
    pub pitch_rad: f64,
    /// Right side down when positive, radians.
    pub roll_rad: f64,
}

impl Body {
    /// The transform from the robot's axes, whose origin lies on the ground under its centre, to the world's.
    #[must_use]
    pub fn world_from_robot(&self) -> Isometry3 {
        let turn = UnitQuaternion::from_rotation_matrix(&rotation(self.pose.yaw_rad, self.pitch_rad, self.roll_rad));
        Isometry3::from_parts(Translation3::new(self.pose.x_m, self.pose.y_m, self.z_m), turn)
    }
}

/// What happened in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// The body touched something.
    pub contact: bool,
    /// The body lies below an edge, since this period or an earlier one.
    pub fallen: bool,
    /// Mean speed of the wheels, as encoders measure it: before slip.
    pub odometry: Twist,
}

/// One robot in a world.
#[derive(Debug, Clone)]
pub struct World {
    layout: Arc<Layout>,
    robot: Vehicle,
    traffic: Traffic,
    period_s: f64,
    periods: u64,
    mover_speed: f64,
}

impl World {
    /// A robot at rest at the first start. `period_s` is the time between two commands, seconds.
    #[must_use]
    pub fn new(layout: Arc<Layout>, robot: &RobotSettings, period_s: f64, seed: u64) -> Self {
        let start = layout.starts.first().copied().unwrap_or_default();
        let drive = Drivetrain::new(robot, period_s, seed);
        let traffic = Traffic::new(&layout.movers, &layout.routes);
        Self {
            robot: Vehicle::new(robot.body, drive, &layout, start),
            traffic,
            period_s,
            periods: 0,
            mover_speed: 1.0,
            layout,
        }
    }

    /// The same world with every mover `speed` times as fast as its file says.
    #[must_use]
    pub fn with_mover_speed(self, speed: f64) -> Self {
        Self { mover_speed: speed, ..self }
    }

    /// Puts the robot at rest at `pose`, on the highest platform or ramp there or else on the floor.
    pub fn place(&mut self, pose: Pose) {
        self.robot.place(&self.layout, pose);
    }

    /// Drives for one control period. A robot that touches something stops there and tries again in the next tick; a
    /// robot that has fallen lies still until it is placed. A thing that it overlaps already does not hold it.
    pub fn advance(&mut self, command: Twist) -> Motion {
        let mut motion = self.robot.advance(&self.layout, &self.traffic, command);
        self.periods += 1;
        if !self.traffic.is_empty() {
            self.traffic.arrange(&self.layout.movers, &self.layout.routes, self.mover_time_s());
            motion.contact |= self.traffic.touches(self.robot.shape(), self.robot.stance());
        }
        motion
    }

    /// Where the robot's body is.
    #[must_use]
    pub fn body(&self) -> Body {
        let Stance { pose, z_m, slope_x, slope_y, .. } = *self.robot.stance();
        if slope_x == 0.0 && slope_y == 0.0 {
            return Body { pose, z_m, pitch_rad: 0.0, roll_rad: 0.0 };
        }
        let pitch_rad = -libm::atan(slope_x);
        Body { pose, z_m, pitch_rad, roll_rad: libm::atan(slope_y * libm::cos(pitch_rad)) }
    }

    /// The movers' solids where they are now, in world coordinates, in the order of the file.
    #[must_use]
    pub fn moving(&self) -> &[Solid] {
        self.traffic.solids()
    }

    /// Where the first mover is now.
    #[must_use]
    pub fn prey(&self) -> Option<Pose> {
        self.layout.movers.first().map(|mover| mover.pose_at(&self.layout.routes, self.mover_time_s()))
    }

    /// The route of the first mover, and how far along it the mover is now, metres.
    #[must_use]
    pub fn prey_route(&self) -> Option<(&Route, f64)> {
        let mover = self.layout.movers.first()?;
        let route = self.layout.routes.get(mover.route)?;
        Some((route, mover.along_m(route, self.mover_time_s())))
    }

    /// The time by which movers go.
    fn mover_time_s(&self) -> f64 {
        self.time_s() * self.mover_speed
    }

    /// Time since the world began, seconds. Placing the robot does not turn it back.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.periods as f64 * self.period_s
    }

    /// Whether a robot could be placed at `pose`: nothing touches it, and all of its footprint has ground below.
    #[must_use]
    pub fn is_safe(&self, pose: Pose) -> bool {
        let shape = self.robot.shape();
        let stance = self.layout.terrain().put(&self.layout.scene, shape, pose).stance;
        self.layout.obstruction(shape, pose).is_none() && !self.traffic.touches(shape, &stance)
    }

    /// What the world was made from.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }
}
