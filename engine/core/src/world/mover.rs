//! Things that drive along a route by themselves: the prey of a following behaviour.

use super::route::Route;
use super::scene::Solid;
use super::schedule::Schedule;
use crate::geometry::{Point3, Pose};

/// A body of boxes that follows a route; at the end of an open one it stops.
#[derive(Debug, Clone, PartialEq)]
pub struct Mover {
    /// The name in the world file.
    pub name: String,
    /// Index of its route among the layout's.
    pub(super) route: usize,
    /// Speed along the route, m/s.
    pub(super) speed_m_per_s: f64,
    /// Where on the route it is at time 0, metres from the route's beginning.
    pub(super) offset_m: f64,
    /// What else it does; nothing if the time alone says where it is.
    pub(super) schedule: Option<Schedule>,
    /// Its solids in its own axes: x forward, the origin on the floor at the place on the route.
    pub solids: Vec<Solid>,
}

impl Mover {
    /// Its way, of the layout's routes.
    #[must_use]
    pub fn way<'a>(&self, routes: &'a [Route]) -> Option<&'a Route> {
        routes.get(self.route)
    }

    /// Where it is at a time, if it does nothing but follow its route at one speed; else see [`super::Movements`].
    #[must_use]
    pub fn pose_at(&self, routes: &[Route], time_s: f64) -> Pose {
        routes.get(self.route).map_or(Pose::default(), |route| route.pose_at(self.along_m(route, time_s)))
    }

    /// How far along its route it is at a time, metres; more than the length after the first lap.
    #[must_use]
    pub(super) fn along_m(&self, route: &Route, time_s: f64) -> f64 {
        let along_m = self.offset_m + self.speed_m_per_s * time_s;
        if route.closed { along_m } else { along_m.min(route.length_m()) }
    }

    /// Writes its solids in world coordinates into the first of `places` and returns the rest.
    pub(super) fn arrange<'a>(&self, at: Pose, places: &'a mut [Solid]) -> &'a mut [Solid] {
        let (sin, cos) = libm::sincos(at.yaw_rad);
        let (mine, rest) = places.split_at_mut(self.solids.len().min(places.len()));
        for (solid, place) in self.solids.iter().zip(mine) {
            let (x, y) = (solid.centre.x, solid.centre.y);
            place.centre = Point3::new(at.x_m + x * cos - y * sin, at.y_m + x * sin + y * cos, solid.centre.z);
            place.yaw_rad = at.yaw_rad + solid.yaw_rad;
        }
        rest
    }
}
