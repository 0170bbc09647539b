//! Where something stands on the floor, and how it moves.

use super::Rotation3;
use nalgebra::Matrix3;
use std::f64::consts::{PI, TAU};

/// A place and heading on the floor plan.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Pose {
    /// Metres along the world's x axis.
    pub x_m: f64,
    /// Metres along the world's y axis.
    pub y_m: f64,
    /// Heading, anticlockwise from the x axis, radians in (-pi, pi].
    pub yaw_rad: f64,
}

impl Pose {
    /// A pose with its yaw wrapped into (-pi, pi].
    #[must_use]
    pub fn new(x_m: f64, y_m: f64, yaw_rad: f64) -> Self {
        Self { x_m, y_m, yaw_rad: wrap_angle(yaw_rad) }
    }

    /// The pose after moving with a constant twist for `seconds`, along the exact arc.
    #[must_use]
    pub fn moved(self, twist: Twist, seconds: f64) -> Self {
        let turn = twist.angular_rad_per_s * seconds;
        let length = twist.linear_m_per_s * seconds;
        // The chord of the arc points half the turn away from the heading; below 1e-6 rad the arc is its chord.
        let half = 0.5 * turn;
        let chord = if half.abs() < 1e-6 { length } else { length * libm::sin(half) / half };
        let heading = self.yaw_rad + half;
        Self::new(self.x_m + chord * libm::cos(heading), self.y_m + chord * libm::sin(heading), self.yaw_rad + turn)
    }

    /// Floor distance to another pose, metres.
    #[must_use]
    pub fn distance_m(self, other: Self) -> f64 {
        let (x, y) = (self.x_m - other.x_m, self.y_m - other.y_m);
        (x * x + y * y).sqrt()
    }
}

/// A velocity on the floor: what an action commands and what the robot does.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Twist {
    /// Forward speed, m/s.
    pub linear_m_per_s: f64,
    /// Turning speed, anticlockwise positive, rad/s.
    pub angular_rad_per_s: f64,
}

impl Twist {
    /// A twist from its two speeds.
    #[must_use]
    pub const fn new(linear_m_per_s: f64, angular_rad_per_s: f64) -> Self {
        Self { linear_m_per_s, angular_rad_per_s }
    }

    /// Both speeds are numbers.
    #[must_use]
    pub const fn is_finite(self) -> bool {
        self.linear_m_per_s.is_finite() && self.angular_rad_per_s.is_finite()
    }
}

/// The rotation that turns by `roll` about x, then `pitch` about y, then `yaw` about z (fixed axes, radians).
///
/// Its sines come from `libm`, so that every machine computes the same matrix.
#[must_use]
pub(crate) fn rotation(yaw_rad: f64, pitch_rad: f64, roll_rad: f64) -> Rotation3 {
    let (sy, cy) = libm::sincos(yaw_rad);
    let (sp, cp) = libm::sincos(pitch_rad);
    let (sr, cr) = libm::sincos(roll_rad);
    Rotation3::from_matrix_unchecked(Matrix3::new(
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    ))
}

/// An angle wrapped into (-pi, pi].
#[must_use]
pub fn wrap_angle(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    let wrapped = angle_rad - TAU * ((angle_rad - PI) / TAU).ceil();
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_quarter_circle_ends_one_radius_ahead_and_one_to_the_left() {
        let end = Pose::default().moved(Twist::new(FRAC_PI_2, FRAC_PI_2), 1.0);
        assert!((end.x_m - 1.0).abs() < 1e-12 && (end.y_m - 1.0).abs() < 1e-12);
        assert!((end.yaw_rad - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn a_straight_move_keeps_the_heading() {
        let end = Pose::new(1.0, 2.0, FRAC_PI_2).moved(Twist::new(0.4, 0.0), 0.5);
        assert!((end.x_m - 1.0).abs() < 1e-12 && (end.y_m - 2.2).abs() < 1e-12);
    }

    #[test]
    fn angles_wrap_into_one_turn() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-12);
        assert!((wrap_angle(-7.0) - (TAU - 7.0)).abs() < 1e-12);
    }

    #[test]
    fn positive_pitch_tips_the_nose_down() {
        let nose = rotation(0.0, 0.5, 0.0) * nalgebra::Vector3::x();
        assert!(nose.z < 0.0 && nose.x > 0.0);
    }
}
