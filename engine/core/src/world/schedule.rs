//! How a mover drives that does more than follow its route at one speed: as its world file says, from time to time anew.

use super::route::Route;
use crate::saved::{Passed, Passing};

/// What a mover does beside driving on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Schedule {
    /// The least and the greatest speed, m/s: one between them is drawn for each attempt. Nothing is drawn if they are equal.
    pub(super) speed_m_per_s: [f64; 2],
    /// Speeds along the route instead of that one, by rising place; the first from 0 on.
    pub(super) paces: Vec<Pace>,
    /// Where it stands for a while, by rising place.
    pub(super) pauses: Vec<Pause>,
    /// On an open route: at both ends it turns round.
    pub(super) returns: bool,
    /// It waits until a robot is this near, metres.
    pub(super) starts_within_m: Option<f64>,
    /// It begins anew with each attempt.
    pub(super) begins: bool,
}

/// A stretch of a route with a speed of its own, to the next stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    /// Where it begins, metres along the route.
    pub(super) from_m: f64,
    pub(super) m_per_s: f64,
}

/// A place at which a mover stands whenever it comes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pause {
    /// Metres along the route.
    pub(super) at_m: f64,
    pub(super) for_s: f64,
}

/// Where one mover is, and what it is about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ride {
    /// Metres along the route, within its length.
    pub(super) along_m: f64,
    /// On its way back.
    pub(super) back: bool,
    /// What is left of a pause, seconds.
    standing_s: f64,
    /// What is left of its run, metres: 0 while it waits, infinite if it never does.
    left_m: f64,
    /// The speed of this attempt, m/s.
    pub(super) speed_m_per_s: f64,
}

impl Ride {
    /// As it begins, at a place of its route.
    pub(super) fn begun(schedule: &Schedule, route: &Route, offset_m: f64, speed_m_per_s: f64) -> Self {
        let left_m = if schedule.starts_within_m.is_some() { 0.0 } else { f64::INFINITY };
        let along_m = route.within(offset_m);
        let back = schedule.returns && along_m == route.length_m();
        Self { along_m, back, standing_s: 0.0, left_m, speed_m_per_s }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.flag(&mut self.back)?;
        by.numbers([&mut self.along_m, &mut self.standing_s, &mut self.left_m, &mut self.speed_m_per_s])
    }

    /// Whether it waits for a robot.
    pub(super) fn waits(&self) -> bool {
        self.left_m <= 0.0
    }

    /// Sets out on one run: a lap, the way there and back, or the way to the end.
    pub(super) fn set_out(&mut self, schedule: &Schedule, route: &Route) {
        self.left_m = match schedule.returns {
            true => 2.0 * route.length_m(),
            false if route.closed => route.length_m(),
            false => route.length_m() - self.along_m,
        };
    }

    /// Drives for a time, `scale` times as fast as the file says; pauses keep their length.
    pub(super) fn drive(&mut self, schedule: &Schedule, route: &Route, scale: f64, mut time_s: f64) {
        while time_s > 0.0 && !self.waits() {
            if self.standing_s > 0.0 {
                let stood_s = self.standing_s.min(time_s);
                (self.standing_s, time_s) = (self.standing_s - stood_s, time_s - stood_s);
                continue;
            }
            let speed_m_per_s = scale * self.pace(schedule);
            let Some(next_m) = self.next_m(schedule, route).filter(|_| speed_m_per_s > 0.0) else { return };
            let to_next_m = (next_m - self.along_m).abs();
            let way_m = to_next_m.min(self.left_m);
            if speed_m_per_s * time_s < way_m {
                self.go(speed_m_per_s * time_s);
                return;
            }
            time_s -= way_m / speed_m_per_s;
            self.go(way_m);
            if way_m == to_next_m {
                self.arrive(schedule, route, next_m);
            }
        }
    }

    fn go(&mut self, way_m: f64) {
        self.along_m += if self.back { -way_m } else { way_m };
        self.left_m -= way_m;
    }

    /// At a place where something changes.
    fn arrive(&mut self, schedule: &Schedule, route: &Route, place_m: f64) {
        let closes = route.closed && place_m == route.length_m();
        self.along_m = if closes { 0.0 } else { place_m };
        let here = schedule.pauses.iter().find(|pause| pause.at_m == self.along_m);
        self.standing_s = here.map_or(0.0, |pause| pause.for_s);
        if schedule.returns && (place_m == 0.0 || place_m == route.length_m()) {
            self.back = place_m > 0.0;
        }
    }

    /// The speed of the stretch that lies ahead, m/s.
    fn pace(&self, schedule: &Schedule) -> f64 {
        let begun = |pace: &&Pace| pace.from_m < self.along_m || (!self.back && pace.from_m == self.along_m);
        schedule.paces.iter().rev().find(begun).map_or(self.speed_m_per_s, |pace| pace.m_per_s)
    }

    /// The next place ahead at which something may change; none at the end of an open route without return.
    fn next_m(&self, schedule: &Schedule, route: &Route) -> Option<f64> {
        let (here, length_m) = (self.along_m, route.length_m());
        let paces = schedule.paces.iter().map(|pace| pace.from_m);
        let places = schedule.pauses.iter().map(|pause| pause.at_m).chain(paces);
        if self.back {
            return places.chain([0.0]).filter(|place| *place < here).reduce(f64::max);
        }
        places.chain([length_m]).filter(|place| *place > here).reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point2;

    fn route(closed: bool) -> Route {
        let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| Point2::new(x, y));
        Route::new("way", points[..if closed { 4 } else { 2 }].to_vec(), closed)
    }

    fn plain() -> Schedule {
        let (paces, pauses) = (Vec::new(), Vec::new());
        Schedule { speed_m_per_s: [0.5; 2], paces, pauses, returns: false, starts_within_m: None, begins: false }
    }

    /// Where it is after each of these times.
    fn places(schedule: &Schedule, route: &Route, scale: f64, times_s: &[f64]) -> Vec<(f64, bool)> {
        let mut ride = Ride::begun(schedule, route, 0.0, schedule.speed_m_per_s[0]);
        let mut gone_s = 0.0;
        let mut place = |time_s: &f64| {
            ride.drive(schedule, route, scale, time_s - gone_s);
            gone_s = *time_s;
            (ride.along_m, ride.back)
        };
        times_s.iter().map(&mut place).collect()
    }

    #[test]
    fn it_stands_at_a_pause_each_time_it_comes_by() {
        let schedule = Schedule { pauses: vec![Pause { at_m: 1.0, for_s: 3.0 }], ..plain() };
        // 2 s to the pause, gone on at 5 s; a lap of 16 m later again, from 37 s to 40 s.
        let found = places(&schedule, &route(true), 1.0, &[2.0, 5.0, 6.0, 37.0, 38.0, 41.0]);
        assert_eq!(found.iter().map(|(along_m, _)| *along_m).collect::<Vec<_>>(), [1.0, 1.0, 1.5, 1.0, 1.0, 1.5]);
    }

    #[test]
    fn on_an_open_route_that_returns_it_goes_there_and_back_and_pauses_both_ways() {
        let pauses = vec![Pause { at_m: 3.0, for_s: 1.0 }, Pause { at_m: 4.0, for_s: 2.0 }];
        let schedule = Schedule { returns: true, pauses, ..plain() };
        // At 3 m from 6 s to 7 s, at the end from 9 s to 11 s, at 3 m from 13 s to 14 s, at the beginning at 20 s.
        let found = places(&schedule, &route(false), 1.0, &[6.5, 8.0, 10.0, 12.0, 13.5, 15.0, 20.0, 21.0]);
        let back = [false, false, true, true, true, true, false, false];
        let along_m = [3.0, 3.5, 4.0, 3.5, 3.0, 2.5, 0.0, 0.5];
        assert_eq!(found, along_m.into_iter().zip(back).collect::<Vec<_>>());
    }

    #[test]
    fn speeds_hold_from_their_place_to_the_next_also_on_the_way_back() {
        let paces = vec![Pace { from_m: 0.0, m_per_s: 1.0 }, Pace { from_m: 3.0, m_per_s: 0.25 }];
        let schedule = Schedule { returns: true, paces, ..plain() };
        // 3 s for 3 m, 4 s for the last one, 4 s for it back, then fast.
        let found = places(&schedule, &route(false), 1.0, &[3.0, 5.0, 7.0, 9.0, 11.0, 12.0]);
        assert_eq!(found.iter().map(|(along_m, _)| *along_m).collect::<Vec<_>>(), [3.0, 3.5, 4.0, 3.5, 3.0, 2.0]);
    }

    #[test]
    fn what_waits_runs_its_route_once_and_waits_again() {
        let schedule = Schedule { starts_within_m: Some(2.0), ..plain() };
        let closed = route(true);
        let mut ride = Ride::begun(&schedule, &closed, 2.0, 0.5);
        ride.drive(&schedule, &closed, 1.0, 100.0);
        assert_eq!((ride.along_m, ride.waits()), (2.0, true));
        ride.set_out(&schedule, &closed);
        ride.drive(&schedule, &closed, 1.0, 30.0);
        assert_eq!((ride.along_m, ride.waits()), (1.0, false));
        ride.drive(&schedule, &closed, 1.0, 30.0);
        assert_eq!((ride.along_m, ride.waits()), (2.0, true));
        let (open, returning) = (route(false), Schedule { returns: true, ..schedule });
        let mut ride = Ride::begun(&returning, &open, 0.0, 0.5);
        ride.set_out(&returning, &open);
        ride.drive(&returning, &open, 1.0, 15.0);
        assert_eq!((ride.along_m, ride.back), (0.5, true));
        ride.drive(&returning, &open, 1.0, 15.0);
        assert_eq!((ride.along_m, ride.back, ride.waits()), (0.0, false, true));
    }

    #[test]
    fn a_setting_that_makes_movers_faster_leaves_pauses_as_long_as_they_are() {
        let schedule = Schedule { pauses: vec![Pause { at_m: 1.0, for_s: 3.0 }], ..plain() };
        assert_eq!(places(&schedule, &route(true), 2.0, &[1.0, 4.0, 5.0]), [(1.0, false), (1.0, false), (2.0, false)]);
    }

    #[test]
    fn an_open_route_without_return_ends() {
        assert_eq!(places(&plain(), &route(false), 1.0, &[8.0, 100.0]), [(4.0, false), (4.0, false)]);
    }
}
