//! How far a robot has come along a route: signed and unwrapped, so that turning back and circling show.

use super::route::Route;
use crate::geometry::Point2;

/// The nearest place is sought this far along the route on both sides of the last one, plus twice the distance moved.
const REACH_M: f64 = 2.0;
/// Another stretch of the route takes over when it is nearer by this much.
const NEARER_M: f64 = 1.0;

/// Signed, unwrapped distance along one route. Driving back counts down; driving round it twice counts two laps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RouteProgress {
    at: Point2,
    along_m: f64,
    net_m: f64,
}

impl RouteProgress {
    /// No progress yet, beginning at the place of the route nearest to `at`.
    #[must_use]
    pub(crate) fn new(route: &Route, at: Point2) -> Self {
        Self { at, along_m: route.nearest(at).0, net_m: 0.0 }
    }

    /// Counts the way from the last place to `at`.
    ///
    /// The nearest place is followed, not sought anew: far from the route it leaps between stretches, and circling in
    /// the middle of a room would count as laps. A change to a much nearer stretch counts nothing.
    pub(crate) fn update(&mut self, route: &Route, at: Point2) {
        let reach_m = (REACH_M + 2.0 * (at - self.at).norm()).min(0.49 * route.length_m());
        let (mut along_m, distance_m) = route.nearest_between(at, self.along_m - reach_m, self.along_m + reach_m);
        let step = along_m - self.along_m;
        // Only far from the route can another stretch be that much nearer.
        let other = Some(route).filter(|_| distance_m > NEARER_M).map(|route| route.nearest(at));
        match other.filter(|(_, nearest_m)| distance_m > nearest_m + NEARER_M) {
            Some((elsewhere_m, _)) => along_m = elsewhere_m,
            None => self.net_m += step,
        }
        if route.closed {
            along_m -= route.length_m() * (along_m / route.length_m()).floor();
        }
        (self.at, self.along_m) = (at, along_m);
    }

    /// RouteProgress so far, metres; negative if it is against the route's direction.
    #[must_use]
    pub(crate) fn net_m(&self) -> f64 {
        self.net_m
    }

    /// Goes on from `at` without counting the way there: the robot was put there.
    pub(crate) fn jump(&mut self, route: &Route, at: Point2) {
        (self.at, self.along_m) = (at, route.nearest(at).0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route() -> Route {
        let points = [(0.0, 0.0), (10.0, 0.0), (10.0, 8.0), (0.0, 8.0)];
        Route::new("lap", points.iter().map(|&(x, y)| Point2::new(x, y)).collect(), true)
    }

    fn drive(progress: &mut RouteProgress, from_m: f64, to_m: f64) {
        let steps = 400;
        for step in 1..=steps {
            let pose = route().pose_at(from_m + (to_m - from_m) * f64::from(step) / f64::from(steps));
            progress.update(&route(), Point2::new(pose.x_m, pose.y_m));
        }
    }

    #[test]
    fn two_laps_forward_and_one_back_are_one_lap() {
        let mut progress = RouteProgress::new(&route(), Point2::new(0.0, 0.0));
        drive(&mut progress, 0.0, 72.0);
        assert!((progress.net_m() - 72.0).abs() < 1e-9);
        drive(&mut progress, 72.0, 36.0);
        assert!((progress.net_m() - 36.0).abs() < 1e-9);
    }

    #[test]
    fn circling_in_the_middle_is_no_progress() {
        let at = |angle: f64| Point2::new(5.0 + 0.3 * libm::cos(angle), 4.0 + 0.3 * libm::sin(angle));
        let mut progress = RouteProgress::new(&route(), at(0.0));
        for step in 0..2000 {
            progress.update(&route(), at(f64::from(step) * 0.1));
        }
        assert!(progress.net_m().abs() < 0.61, "{}", progress.net_m());
    }

    #[test]
    fn a_recovery_counts_nothing() {
        let mut progress = RouteProgress::new(&route(), Point2::new(1.0, 0.0));
        progress.jump(&route(), Point2::new(10.0, 4.0));
        progress.update(&route(), Point2::new(10.0, 4.5));
        assert_eq!(progress.net_m(), 0.5);
    }
}
