//! What the wheels counted since the attempt began: it drifts, since slip and noise are in it.

use crate::geometry::{Pose, Twist, wrap_angle};
use crate::saved::{Passed, Passing};

/// Sums of what the wheels measured, since the robot was put where it started.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Odometry {
    /// Way, backward too, metres.
    pub distance_m: f64,
    /// Way ahead, backward subtracted, metres.
    pub forward_m: f64,
    /// Turn, positive to the left, not wrapped, radians.
    pub turned_rad: f64,
    /// Where the robot is by dead reckoning, in the axes of its start.
    pub pose: Pose,
}

impl Odometry {
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.numbers([&mut self.distance_m, &mut self.forward_m, &mut self.turned_rad])?;
        by.pose(&mut self.pose)
    }

    /// One more period with the speeds that the wheels measured.
    pub(crate) fn advance(&mut self, measured: Twist, period_s: f64) {
        let forward_m = measured.linear_m_per_s * period_s;
        self.distance_m += forward_m.abs();
        self.forward_m += forward_m;
        self.turned_rad += measured.angular_rad_per_s * period_s;
        self.pose = self.pose.moved(measured, period_s);
    }

    /// Straight distance to the start, metres.
    #[must_use]
    pub(super) fn away_m(&self) -> f64 {
        libm::hypot(self.pose.x_m, self.pose.y_m)
    }

    /// The bearing of the start from straight ahead, degrees, positive to the left; 0 at the start itself.
    #[must_use]
    pub(super) fn bearing_deg(&self) -> f64 {
        if self.away_m() == 0.0 {
            return 0.0;
        }
        wrap_angle(libm::atan2(-self.pose.y_m, -self.pose.x_m) - self.pose.yaw_rad).to_degrees()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn way_turn_and_the_way_home_are_summed() {
        let mut odometry = Odometry::default();
        odometry.advance(Twist::new(1.0, 0.0), 2.0);
        odometry.advance(Twist::new(0.0, std::f64::consts::FRAC_PI_2), 1.0);
        odometry.advance(Twist::new(-1.0, 0.0), 1.0);
        assert_eq!((odometry.distance_m, odometry.forward_m), (3.0, 1.0));
        assert!((odometry.turned_rad.to_degrees() - 90.0).abs() < 1e-12);
        // At (2, -1), looking along y: the start lies 2 to the left and 1 ahead.
        assert!((odometry.away_m() - 5.0_f64.sqrt()).abs() < 1e-12);
        assert!((odometry.bearing_deg() - 63.434_948_822_922).abs() < 1e-9, "{}", odometry.bearing_deg());
    }
}
