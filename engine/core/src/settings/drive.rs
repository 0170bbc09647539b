//! What a robot's drive can do: how fast it drives and turns, and how a steered one turns only on the way.

use crate::geometry::Twist;

/// What an action may ask of a robot's drive, either way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Fastest it drives, m/s.
    pub greatest_m_per_s: f64,
    /// Fastest it turns, rad/s.
    pub greatest_rad_per_s: f64,
    /// How it steers, if it does; wheels that differ in speed turn it on the spot otherwise.
    pub bicycle: Option<Bicycle>,
}

/// Front wheels that steer: it turns about the middle of its rear axle, and only while it drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bicycle {
    /// From the rear axle to the front axle, metres.
    pub wheelbase_m: f64,
    /// How far the front wheels turn to either side, degrees.
    pub steer_deg: f64,
}

impl Bicycle {
    /// The sharpest turn, radians for each metre of way.
    #[must_use]
    pub(crate) fn turn_rad_per_m(self) -> f64 {
        libm::tan(self.steer_deg.to_radians()) / self.wheelbase_m
    }
}

impl Default for DriveLimits {
    /// Wheels that differ in speed, and what every robot may be asked for that names no body.
    fn default() -> Self {
        Self { greatest_m_per_s: 2.0, greatest_rad_per_s: 6.0, bicycle: None }
    }
}

impl DriveLimits {
    /// The action nearest to this one that it can do, to a hundredth towards 0.
    #[must_use]
    pub(crate) fn nearest(&self, action: Twist) -> Twist {
        let held = |value: f64, most: f64| (value.clamp(-most, most) * 100.0).trunc() / 100.0;
        let linear = held(action.linear_m_per_s, self.greatest_m_per_s);
        let sharpest = self.bicycle.map_or(f64::INFINITY, |bicycle| linear.abs() * bicycle.turn_rad_per_m());
        Twist::new(linear, held(action.angular_rad_per_s, self.greatest_rad_per_s.min(sharpest)))
    }

    /// Why an action is beyond this drive, in words; nothing if it can be carried out.
    #[must_use]
    pub(crate) fn refuses(&self, action: Twist) -> Option<String> {
        let Twist { linear_m_per_s: linear, angular_rad_per_s: angular } = action;
        let (drives, turns) = (self.greatest_m_per_s, self.greatest_rad_per_s);
        let within = |value: f64, most: f64| (-most..=most).contains(&value);
        if !within(linear, drives) || !within(angular, turns) {
            return Some(format!("[{linear}, {angular}]: at most {drives} m/s and {turns} rad/s, either way"));
        }
        let Bicycle { wheelbase_m, steer_deg } = self.bicycle?;
        let most = linear.abs() * self.bicycle?.turn_rad_per_m();
        // What is written with two digits shall be allowed.
        (angular.abs() > most + 0.005).then(|| {
            format!(
                "[{linear}, {angular}]: a bicycle with a wheelbase of {wheelbase_m} m and {steer_deg} degrees of steering turns \
                 by {most:.2} rad/s at most at {} m/s, found {}",
                linear.abs(),
                angular.abs()
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bicycle_turns_only_as_sharply_as_its_wheels_steer() {
        let bicycle = Some(Bicycle { wheelbase_m: 0.33, steer_deg: 24.0 });
        let drive = DriveLimits { greatest_m_per_s: 4.0, bicycle, ..DriveLimits::default() };
        // tan(24 degrees) / 0.33 m is 1.349 rad/m: 0.54 rad/s at 0.4 m/s.
        let why = drive.refuses(Twist::new(0.4, 0.8)).unwrap();
        assert!(
            why.ends_with("0.33 m and 24 degrees of steering turns by 0.54 rad/s at most at 0.4 m/s, found 0.8"),
            "{why}"
        );
        assert_eq!(drive.refuses(Twist::new(-0.4, 0.54)), None);
        assert_eq!(drive.nearest(Twist::new(0.4, 0.8)), Twist::new(0.4, 0.53));
        assert!(drive.refuses(Twist::new(0.0, 0.1)).is_some());
        assert!(drive.refuses(Twist::new(4.1, 0.0)).unwrap().contains("at most 4 m/s and 6 rad/s"));
    }

    #[test]
    fn without_steering_a_robot_turns_on_the_spot() {
        assert_eq!(DriveLimits::default().refuses(Twist::new(0.0, -6.0)), None);
        assert!(DriveLimits::default().refuses(Twist::new(f64::NAN, 0.0)).is_some());
    }
}
