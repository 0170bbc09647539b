//! Where everything is that drives by itself: by the clock alone, or by what its world file says beside its speed.

use super::layout::Layout;
use super::mover::Mover;
use super::route::Route;
use super::schedule::{Ride, Schedule};
use crate::geometry::{Point2, Pose};
use crate::random::{Random, Stream};
use crate::saved::{Passed, Passing};
use std::sync::Arc;

/// All movers of a world at one time.
///
/// They depend on nothing but the seed, the time, where attempts began, and, of those that wait for a robot, where the
/// robots were: so they can be followed along a record too.
#[derive(Debug, Clone)]
pub struct Movements {
    layout: Arc<Layout>,
    /// For each mover that does more than follow its route at one speed.
    rides: Vec<Option<Ride>>,
    random: Random,
    /// For each mover, how many times as fast as its file says it is.
    scales: Vec<f64>,
    time_s: f64,
}

impl Movements {
    /// As they are at time 0, under a run's seed; `scale` times as fast as the world file says.
    #[must_use]
    pub fn new(layout: Arc<Layout>, seed: u64, scale: f64) -> Self {
        let rides = vec![None; layout.movers.len()];
        let (random, scales) = (Random::new(seed, Stream::Movers), vec![scale; layout.movers.len()]);
        let mut movements = Self { layout, rides, random, scales, time_s: 0.0 };
        movements.begin_all(true);
        movements
    }

    pub(super) fn scaled(self, scale: f64) -> Self {
        Self { scales: vec![scale; self.scales.len()], ..self }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        // Those of one world file are the same ones in every run.
        by.all(&mut self.rides, |by, ride| ride.as_mut().map_or(Ok(()), |ride| ride.pass(by)))?;
        by.random(&mut self.random)?;
        by.all(&mut self.scales, Passing::number)?;
        by.number(&mut self.time_s)
    }

    /// From here on one mover is so many times as fast as its file says.
    pub fn set_scale(&mut self, mover: usize, scale: f64) {
        if let Some(own) = self.scales.get_mut(mover) {
            *own = scale;
        }
    }

    /// Whether the clock alone does not say where they are.
    #[must_use]
    pub fn live(&self) -> bool {
        self.rides.iter().any(Option::is_some)
    }

    /// Goes on to a time; `robots` are the middles of all bodies.
    pub fn advance(&mut self, time_s: f64, robots: impl Iterator<Item = Point2> + Clone) {
        let period_s = time_s - self.time_s;
        self.time_s = time_s;
        for ((mover, ride), scale) in self.layout.movers.iter().zip(&mut self.rides).zip(&self.scales) {
            let (Some(ride), Some((schedule, route))) = (ride, scheduled(mover, &self.layout.routes)) else { continue };
            if let Some(within_m) = schedule.starts_within_m.filter(|_| ride.waits()) {
                let here = place(route, ride);
                let is_near = |robot: Point2| here.distance_m(Pose::new(robot.x, robot.y, 0.0)) <= within_m;
                if robots.clone().any(is_near) {
                    ride.set_out(schedule, route);
                }
            }
            ride.drive(schedule, route, *scale, period_s);
        }
    }

    /// An attempt begins: speeds are drawn, and those begin anew whose file says so.
    pub fn begin(&mut self) {
        self.begin_all(false);
    }

    fn begin_all(&mut self, first: bool) {
        let Self { layout, rides, random, .. } = self;
        for (mover, ride) in layout.movers.iter().zip(rides) {
            let Some((schedule, route)) = scheduled(mover, &layout.routes) else { continue };
            let [low, high] = schedule.speed_m_per_s;
            let speed_m_per_s = if low < high { random.between(low, high) } else { low };
            match ride {
                Some(ride) if !first && !schedule.begins => ride.speed_m_per_s = speed_m_per_s,
                _ => *ride = Some(Ride::begun(schedule, route, mover.offset_m, speed_m_per_s)),
            }
        }
    }

    /// Where a mover is; at the origin if there is none with this index.
    #[must_use]
    pub fn pose(&self, index: usize) -> Pose {
        let Some(mover) = self.layout.movers.get(index) else { return Pose::default() };
        match (self.rides[index], mover.way(&self.layout.routes)) {
            (Some(ride), Some(route)) => place(route, &ride),
            _ => mover.pose_at(&self.layout.routes, self.clock_s(index)),
        }
    }

    /// Where all of them are, in the order of the world file.
    pub fn poses(&self) -> impl Iterator<Item = Pose> + '_ {
        (0..self.rides.len()).map(|index| self.pose(index))
    }

    /// The route of the first mover, how far along it the mover is, metres, and whether it comes back along it.
    pub(super) fn first_on_route(&self) -> Option<(&Route, f64, bool)> {
        let mover = self.layout.movers.first()?;
        let route = mover.way(&self.layout.routes)?;
        match self.rides.first()? {
            Some(ride) => Some((route, ride.along_m, ride.back)),
            None => Some((route, mover.along_m(route, self.clock_s(0)), false)),
        }
    }

    /// The time by which a mover goes that knows nothing but its speed.
    fn clock_s(&self, mover: usize) -> f64 {
        self.time_s * self.scales[mover]
    }
}

fn scheduled<'a>(mover: &'a Mover, routes: &'a [Route]) -> Option<(&'a Schedule, &'a Route)> {
    mover.schedule.as_ref().zip(mover.way(routes))
}

fn place(route: &Route, ride: &Ride) -> Pose {
    let pose = route.pose_at(ride.along_m);
    if ride.back { Pose::new(pose.x_m, pose.y_m, pose.yaw_rad + std::f64::consts::PI) } else { pose }
}
