//! Axes, units and the few shapes of motion that every room shares.
//!
//! Metres, radians, seconds. x points forward, y left, z up, right-handed; yaw turns anticlockwise from +x, pitch tips
//! the nose down when positive, roll lowers the right side when positive (a right-handed turn about +y and +x). Truth is
//! `f64`; what a sensor measures is `f32`.

mod pose;

pub(crate) use pose::rotation;
pub use pose::{Pose, Twist, wrap_angle};

/// A point of the floor plan, metres.
pub type Point2 = nalgebra::Point2<f64>;
/// A point, metres.
pub type Point3 = nalgebra::Point3<f64>;
/// A direction or a displacement, metres.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A rotation matrix.
type Rotation3 = nalgebra::Rotation3<f64>;
/// A rigid transform: `world_from_robot * point`.
pub type Isometry3 = nalgebra::Isometry3<f64>;
