//! From the commanded speeds to the real ones: lag, noise, slip.

use crate::geometry::Twist;
use crate::random::Random;
use crate::saved::{Passed, Passing};
use crate::settings::{Bicycle, RobotSettings};

/// The drive of the robot: wheels that follow a command with a first-order lag, and a ground on which they skid.
#[derive(Debug, Clone)]
pub(super) struct Drivetrain {
    pub(super) ticks: u32,
    pub(super) tick_s: f64,
    /// Share of the difference to the command that is left after one tick, and its mean over the tick.
    left: f64,
    mean_left: f64,
    noise: f64,
    grip: f64,
    /// The sharpest turn, radians for each metre of way; infinite for wheels that turn on the spot.
    turn_rad_per_m: f64,
    wheels: Twist,
    factors: Twist,
    random: Random,
}

impl Drivetrain {
    pub(super) fn new(robot: &RobotSettings, period_s: f64, random: Random) -> Self {
        // 0.5 / 0.05 must be ten ticks, whatever its last bit says.
        let ticks = (period_s / robot.tick_s - 1e-9).ceil().max(1.0);
        let tick_s = period_s / ticks;
        let (left, mean_left) = if robot.lag_s > 0.0 {
            let left = libm::exp(-tick_s / robot.lag_s);
            (left, (1.0 - left) * robot.lag_s / tick_s)
        } else {
            (0.0, 0.0)
        };
        Self {
            ticks: ticks as u32,
            tick_s,
            left,
            mean_left,
            noise: robot.speed_noise,
            grip: 1.0 - robot.slip,
            turn_rad_per_m: robot.drive.bicycle.map_or(f64::INFINITY, Bicycle::turn_rad_per_m),
            wheels: Twist::default(),
            factors: Twist::new(1.0, 1.0),
            random,
        }
    }

    /// Becomes the drive of other settings; its random numbers go on.
    pub(super) fn change(&mut self, robot: &RobotSettings, period_s: f64) {
        let Self { wheels, factors, random, .. } = self.clone();
        *self = Self { wheels, factors, ..Self::new(robot, period_s, random) };
    }

    /// What settings do not say.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.twist(&mut self.wheels)?;
        by.twist(&mut self.factors)?;
        by.random(&mut self.random)
    }

    /// Stands still.
    pub(super) fn stop(&mut self) {
        self.wheels = Twist::default();
    }

    /// Draws the speed noise of one control period. Always two draws, so that no setting shifts later ones.
    pub(super) fn begin(&mut self) {
        let (linear, angular) = (self.random.normal(), self.random.normal());
        self.factors = Twist::new(1.0 + self.noise * linear, 1.0 + self.noise * angular);
    }

    /// How far the centre can come in a period, metres.
    pub(super) fn reach_m(&self, command: Twist) -> f64 {
        let target = command.linear_m_per_s * self.factors.linear_m_per_s;
        target.abs().max(self.wheels.linear_m_per_s.abs()) * self.tick_s * f64::from(self.ticks)
    }

    /// The mean speed of the wheels over the next tick.
    pub(super) fn tick(&mut self, command: Twist) -> Twist {
        let follow = |target: f64, speed: &mut f64| {
            let behind = *speed - target;
            *speed = target + behind * self.left;
            target + behind * self.mean_left
        };
        let mean = Twist::new(
            follow(command.linear_m_per_s * self.factors.linear_m_per_s, &mut self.wheels.linear_m_per_s),
            follow(command.angular_rad_per_s * self.factors.angular_rad_per_s, &mut self.wheels.angular_rad_per_s),
        );
        if self.turn_rad_per_m == f64::INFINITY {
            return mean;
        }
        // Wheels that steer turn the robot only as far as it drives, whatever lags behind or is noisy.
        let steered = |twist: Twist| {
            let most = twist.linear_m_per_s.abs() * self.turn_rad_per_m;
            Twist::new(twist.linear_m_per_s, twist.angular_rad_per_s.clamp(-most, most))
        };
        self.wheels = steered(self.wheels);
        steered(mean)
    }

    /// What the ground makes of the wheels' speed: a skid-steered robot loses a share of its turn.
    pub(super) fn on_ground(&self, wheels: Twist) -> Twist {
        Twist::new(wheels.linear_m_per_s, wheels.angular_rad_per_s * self.grip)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::settings::{BodyShape, DriveLimits};

    const DRIVE: DriveLimits = DriveLimits { greatest_m_per_s: 2.0, greatest_rad_per_s: 6.0, bicycle: None };
    const EXACT: RobotSettings = RobotSettings {
        body: BodyShape::pioneer2at(),
        drive: DRIVE,
        lag_s: 0.0,
        speed_noise: 0.0,
        slip: 0.0,
        tick_s: 0.05,
    };

    fn drivetrain(robot: &RobotSettings, period_s: f64) -> Drivetrain {
        Drivetrain::new(robot, period_s, Random::new(1, Stream::Drive))
    }

    fn distance(tick_s: f64) -> f64 {
        let robot = RobotSettings { lag_s: 0.15, tick_s, ..EXACT };
        let mut drive = drivetrain(&robot, 0.5);
        drive.begin();
        (0..drive.ticks).map(|_| drive.tick(Twist::new(0.4, 0.0)).linear_m_per_s * drive.tick_s).sum()
    }

    #[test]
    fn the_distance_of_a_lagging_start_does_not_depend_on_the_tick() {
        // 0.4 * (0.5 - 0.15 * (1 - exp(-0.5 / 0.15)))
        let exact = 0.4 * (0.5 - 0.15 * (1.0 - libm::exp(-0.5 / 0.15)));
        for tick_s in [0.1, 0.05, 0.01, 0.03] {
            assert!((distance(tick_s) - exact).abs() < 1e-12, "{tick_s}");
        }
    }

    #[test]
    fn a_bicycle_that_stands_still_does_not_turn_and_one_that_starts_turns_as_it_gathers_way() {
        let bicycle = Some(Bicycle { wheelbase_m: 0.33, steer_deg: 24.0 });
        let drive = DriveLimits { bicycle, ..DRIVE };
        let robot = RobotSettings { drive, lag_s: 0.3, speed_noise: 0.2, ..EXACT };
        let mut train = drivetrain(&robot, 0.5);
        train.begin();
        assert_eq!(train.tick(Twist::new(0.0, 0.8)), Twist::default());
        let mut greatest: f64 = 0.0;
        for _ in 0..20 {
            train.begin();
            for _ in 0..train.ticks {
                let twist = train.tick(Twist::new(0.4, -0.54));
                // tan(24 degrees) / 0.33 m is 1.3492 rad/m.
                assert!(twist.angular_rad_per_s.abs() <= 1.3493 * twist.linear_m_per_s, "{twist:?}");
                greatest = greatest.max(twist.angular_rad_per_s.abs());
            }
        }
        assert!(greatest > 0.4, "{greatest}");
    }

    #[test]
    fn half_a_second_has_ten_ticks_of_fifty_milliseconds() {
        let drive = drivetrain(&EXACT, 0.5);
        assert_eq!((drive.ticks, drive.tick_s), (10, 0.05));
        assert_eq!(drivetrain(&EXACT, 0.33).ticks, 7);
    }

    #[test]
    fn slip_takes_a_share_of_the_turn_only() {
        let robot = RobotSettings { slip: 0.25, ..EXACT };
        let mut drive = drivetrain(&robot, 0.5);
        drive.begin();
        let wheels = drive.tick(Twist::new(0.2, 0.8));
        assert_eq!(wheels, Twist::new(0.2, 0.8));
        let real = drive.on_ground(wheels);
        assert!(real.linear_m_per_s == 0.2 && (real.angular_rad_per_s - 0.6).abs() < 1e-12);
    }
}
