//! What a body with a round footprint overlaps.

use super::nearest_within;
use crate::settings::BodyShape;
use crate::world::obstacle::{FloorArea, Obstacle};
use crate::world::stance::Stance;

/// A round body in a stance.
pub(super) struct RoundBody<'a> {
    pub(super) shape: &'a BodyShape,
    pub(super) stance: &'a Stance,
    pub(super) radius_m: f64,
}

impl RoundBody<'_> {
    /// Whether it overlaps a solid.
    pub(super) fn overlaps(&self, solid: &Obstacle) -> bool {
        match solid.area {
            FloorArea::Circle { radius } => self.meets_cylinder(solid, radius),
            FloorArea::Rectangle { half_x, half_y, ramp } => {
                let centre = solid.local(self.stance.pose.x_m, self.stance.pose.y_m);
                let near = (nearest_within(centre.0, half_x), nearest_within(centre.1, half_y));
                self.covers(centre, near)
                    && if ramp {
                        self.meets_ramp(solid, centre, near, (half_x, half_y))
                    } else {
                        solid.blocks(self.shape, self.plane_under(solid, near), solid.top_m)
                    }
            }
        }
    }

    fn meets_cylinder(&self, solid: &Obstacle, radius: f64) -> bool {
        let (x, y) = self.stance.local(solid.x, solid.y);
        let (square, reach) = (x * x + y * y, radius + self.radius_m);
        if square >= reach * reach {
            return false;
        }
        // The point of the body nearest to the cylinder's axis.
        let share = (self.radius_m / square.sqrt()).min(1.0);
        solid.blocks(self.shape, self.stance.plane_m(x * share, y * share), solid.top_m)
    }

    /// Whether a point lies within the body whose centre is at `centre`, in the same axes.
    fn covers(&self, centre: (f64, f64), (x, y): (f64, f64)) -> bool {
        let (x, y) = (x - centre.0, y - centre.1);
        x * x + y * y < self.radius_m * self.radius_m
    }

    /// Height of the body's plane at a point of the solid's axes.
    fn plane_under(&self, solid: &Obstacle, (x, y): (f64, f64)) -> f64 {
        let (x, y) = solid.world(x, y);
        let (x, y) = self.stance.local(x, y);
        self.stance.plane_m(x, y)
    }

    /// A ramp is in the way where its slope stands higher above the body's plane than a step.
    ///
    /// Both heights are linear over what circle and rectangle share. So the highest difference is at a corner of the
    /// rectangle, where the two outlines cross, or where the circle lies farthest up the difference's own slope; `near`
    /// stands for all where there is none. Points are in the solid's axes.
    fn meets_ramp(&self, solid: &Obstacle, centre: (f64, f64), near: (f64, f64), half: (f64, f64)) -> bool {
        let (half_x, half_y) = half;
        let is_higher = |point: (f64, f64)| {
            solid.blocks(self.shape, self.plane_under(solid, point), solid.slope_top(point.0, half_x))
        };
        let is_inside = |(x, y): (f64, f64)| x.abs() <= half_x && y.abs() <= half_y;
        let corners = [(half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)];
        is_higher(near)
            || corners.into_iter().any(|corner| self.covers(centre, corner) && is_higher(corner))
            || [-1.0, 1.0].into_iter().any(|side| {
                let (x, y) = (side * half_x, side * half_y);
                let on_x = self.half_chord(x - centre.0).map(|half| [(x, centre.1 - half), (x, centre.1 + half)]);
                let on_y = self.half_chord(y - centre.1).map(|half| [(centre.0 - half, y), (centre.0 + half, y)]);
                on_x.into_iter().chain(on_y).flatten().any(|point| is_inside(point) && is_higher(point))
            })
            || self.farthest_up(solid, centre, half_x).is_some_and(|point| is_inside(point) && is_higher(point))
    }

    /// Half of what the circle cuts from a line at some distance from its centre; none if it does not reach the line.
    fn half_chord(&self, distance: f64) -> Option<f64> {
        let square = self.radius_m * self.radius_m - distance * distance;
        (square >= 0.0).then(|| square.sqrt())
    }

    /// The point of the circle over which a ramp stands highest above the body's plane, in the ramp's axes; none if the
    /// two are parallel.
    fn farthest_up(&self, solid: &Obstacle, centre: (f64, f64), half_x: f64) -> Option<(f64, f64)> {
        let body = self.stance;
        let (cos, sin) = (body.cos * solid.cos + body.sin * solid.sin, body.sin * solid.cos - body.cos * solid.sin);
        let rise = (solid.top_m - solid.bottom_m) * 0.5 / half_x;
        let (x, y) = (rise - body.slope_x * cos + body.slope_y * sin, -(body.slope_x * sin + body.slope_y * cos));
        let length = (x * x + y * y).sqrt();
        (length > 0.0).then(|| (centre.0 + self.radius_m * x / length, centre.1 + self.radius_m * y / length))
    }
}
