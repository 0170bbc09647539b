//! How far a robot has come along a route: signed and unwrapped, so that turning back and circling show, and only on it.

use super::route::Route;
use crate::geometry::Point2;

/// The nearest place is sought this far along the route on both sides of the last one, plus twice the distance moved.
const REACH_M: f64 = 2.0;
/// Inside a bend the nearest place goes faster than the robot: so many times the way driven on the route counts at most.
const MOST_PER_METRE: f64 = 1.2;

/// Signed, unwrapped distance along one route. Driving back counts down; driving round it twice counts two laps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RouteProgress {
    at: Point2,
    along_m: f64,
    offset_m: f64,
    is_on: bool,
    /// What the nearest place has gone, and the robot while it was on the route.
    gone_m: f64,
    driven_m: f64,
}

impl RouteProgress {
    /// No progress yet, beginning at the place of the route nearest to `at`.
    #[must_use]
    pub(crate) fn new(route: &Route, at: Point2) -> Self {
        let mut progress = Self { at, along_m: 0.0, offset_m: 0.0, is_on: false, gone_m: 0.0, driven_m: 0.0 };
        progress.jump(route, at);
        progress
    }

    /// Counts the way from the last place to `at`, if both are on the route: within its half width.
    ///
    /// The nearest place is followed, not sought anew, so that branches side by side do not mix. Off the route nothing counts:
    /// far from it the nearest place runs much faster than the robot, and a circle in the middle of a room would be a lap.
    pub(crate) fn update(&mut self, route: &Route, at: Point2) {
        let moved_m = (at - self.at).norm();
        let reach_m = (REACH_M + 2.0 * moved_m).min(0.49 * route.length_m());
        let (along_m, offset_m) = route.nearest_between(at, self.along_m - reach_m, self.along_m + reach_m);
        if !self.is_on || offset_m > route.half_width_m {
            return self.jump(route, at);
        }
        self.gone_m += along_m - self.along_m;
        self.driven_m += moved_m;
        let laps = if route.closed { (along_m / route.length_m()).floor() } else { 0.0 };
        (self.at, self.along_m, self.offset_m) = (at, along_m - laps * route.length_m(), offset_m);
    }

    /// Progress so far, metres; negative if it is against the route's direction. At most a fifth more than was driven on it.
    #[must_use]
    pub(crate) fn net_m(&self) -> f64 {
        let most_m = MOST_PER_METRE * self.driven_m;
        self.gone_m.clamp(-most_m, most_m)
    }

    /// Distance from the route, metres.
    #[must_use]
    pub(crate) fn offset_m(&self) -> f64 {
        self.offset_m
    }

    /// Whether that is within the route's half width.
    #[must_use]
    pub(crate) fn is_on(&self) -> bool {
        self.is_on
    }

    /// Goes on from the place nearest to `at` without counting the way there: the robot was put there, or has left the route.
    pub(crate) fn jump(&mut self, route: &Route, at: Point2) {
        (self.along_m, self.offset_m) = route.nearest(at);
        (self.at, self.is_on) = (at, self.offset_m <= route.half_width_m);
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

    /// A circle round a point, `radius_m` wide, in steps of a hundredth of it: net metres and metres driven.
    fn circle(centre: (f64, f64), radius_m: f64, rounds: f64) -> (f64, f64) {
        let at =
            |angle: f64| Point2::new(centre.0 + radius_m * libm::cos(angle), centre.1 + radius_m * libm::sin(angle));
        let mut progress = RouteProgress::new(&route(), at(0.0));
        let steps = (rounds * 628.0) as u32;
        (1..=steps).for_each(|step| progress.update(&route(), at(0.01 * f64::from(step))));
        (progress.net_m(), 0.01 * f64::from(steps) * radius_m)
    }

    #[test]
    fn a_circle_inside_the_route_but_off_it_is_no_lap() {
        // 3 m wide in a loop of 10 m by 8 m: it comes within 1 m of no side.
        assert_eq!(circle((5.0, 4.0), 2.9, 40.0).0, 0.0);
    }

    #[test]
    fn a_circle_on_the_route_gets_nowhere() {
        assert!(circle((5.0, 0.0), 0.8, 40.0).0.abs() < 2.0);
    }

    #[test]
    fn progress_is_never_more_than_a_fifth_above_the_way_driven() {
        // Round a corner on its inside, where the nearest place leaps.
        for (x, y) in [(9.5, 0.5), (9.2, 0.8), (0.6, 7.4)] {
            let (net_m, driven_m) = circle((x, y), 0.3, 25.0);
            assert!(net_m.abs() <= 1.2 * driven_m, "{net_m} of {driven_m}");
        }
        let mut progress = RouteProgress::new(&route(), Point2::new(9.0, 1.0));
        progress.update(&route(), Point2::new(9.05, 1.05));
        // 9.0 and 1.0 are as near as 10.0 and 0.95: the place leaps from 9 m to 11 m.
        assert!(progress.net_m().abs() <= 1.2 * 0.05 * 2.0_f64.sqrt() + 1e-12, "{}", progress.net_m());
    }

    #[test]
    fn branches_side_by_side_do_not_mix() {
        // There and back 0.8 m apart; a robot on one of them drifts towards the other.
        let points = [(0.0, 0.0), (20.0, 0.0), (20.0, 0.8), (0.0, 0.8)];
        let narrow = Route::new("lap", points.iter().map(|&(x, y)| Point2::new(x, y)).collect(), true);
        let mut progress = RouteProgress::new(&narrow, Point2::new(5.0, 0.0));
        for step in 1..=100 {
            progress.update(&narrow, Point2::new(5.0 + 0.05 * f64::from(step), 0.007 * f64::from(step)));
        }
        assert!((progress.net_m() - 5.0).abs() < 1e-9, "{}", progress.net_m());
    }
}
