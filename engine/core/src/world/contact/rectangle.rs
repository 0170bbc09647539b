//! What a body with a rectangular footprint overlaps.

use super::nearest_within;
use crate::settings::BodyShape;
use crate::world::obstacle::{FloorArea, Obstacle};
use crate::world::stance::Stance;

/// A rectangular body in a stance.
pub(super) struct RectangleBody<'a> {
    shape: &'a BodyShape,
    stance: &'a Stance,
    half_x: f64,
    half_y: f64,
    /// How far the middle lies ahead of the origin.
    ahead: f64,
}

impl<'a> RectangleBody<'a> {
    pub(super) fn new(shape: &'a BodyShape, stance: &'a Stance) -> Self {
        let [half_x, half_y] = shape.footprint.half_m();
        Self { shape, stance, half_x, half_y, ahead: shape.footprint.ahead_m() }
    }

    /// Whether it overlaps a solid.
    pub(super) fn overlaps(&self, solid: &Obstacle) -> bool {
        let (x, y) = self.local(solid.x, solid.y);
        match solid.area {
            FloorArea::Circle { radius } => {
                let near = self.nearest(x, y);
                let (x, y) = (x - near.0, y - near.1);
                x * x + y * y < radius * radius && solid.blocks(self.shape, self.plane_m(near), solid.top_m)
            }
            FloorArea::Rectangle { half_x, half_y, ramp } => {
                self.meets_rectangle(solid, (x, y), (half_x, half_y))
                    && if ramp { self.meets_ramp(solid, half_x, half_y) } else { self.meets_box(solid, half_x, half_y) }
            }
        }
    }

    /// A point of the world in axes along the body's from the middle of its rectangle.
    fn local(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = self.stance.local(x, y);
        (x - self.ahead, y)
    }

    /// The middle of the rectangle in the world.
    fn middle(&self) -> (f64, f64) {
        self.stance.world(self.ahead, 0.0)
    }

    /// The point of the rectangle nearest to a point, both from its middle.
    fn nearest(&self, x: f64, y: f64) -> (f64, f64) {
        (nearest_within(x, self.half_x), nearest_within(y, self.half_y))
    }

    /// Height of the body's plane at a point from the middle.
    fn plane_m(&self, (x, y): (f64, f64)) -> f64 {
        self.stance.plane_m(x + self.ahead, y)
    }

    /// The separating-axis test of two rectangles: they are apart if one of their four sides' directions shows a gap.
    fn meets_rectangle(&self, solid: &Obstacle, (x, y): (f64, f64), (half_x, half_y): (f64, f64)) -> bool {
        let stance = self.stance;
        let cos = (stance.cos * solid.cos + stance.sin * solid.sin).abs();
        let sin = (stance.cos * solid.sin - stance.sin * solid.cos).abs();
        if x.abs() >= self.half_x + half_x * cos + half_y * sin || y.abs() >= self.half_y + half_x * sin + half_y * cos
        {
            return false;
        }
        let middle = self.middle();
        let (x, y) = solid.local(middle.0, middle.1);
        x.abs() < half_x + self.half_x * cos + self.half_y * sin
            && y.abs() < half_y + self.half_x * sin + self.half_y * cos
    }

    fn meets_box(&self, solid: &Obstacle, half_x: f64, half_y: f64) -> bool {
        let middle = self.middle();
        let (x, y) = solid.local(middle.0, middle.1);
        let (x, y) = solid.world(nearest_within(x, half_x), nearest_within(y, half_y));
        let (x, y) = self.local(x, y);
        solid.blocks(self.shape, self.plane_m(self.nearest(x, y)), solid.top_m)
    }

    /// A ramp is in the way where its slope stands higher above the body's plane than a step, as it does at its sides
    /// and its high end; on the slope itself plane and ramp agree.
    fn meets_ramp(&self, solid: &Obstacle, half_x: f64, half_y: f64) -> bool {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let mut shared = SharedPolygon { points: [(0.0, 0.0); 8], count: 4 };
        for (point, (x, y)) in shared.points.iter_mut().zip(corners) {
            let (x, y) = self.stance.world(x * self.half_x + self.ahead, y * self.half_y);
            *point = solid.local(x, y);
        }
        shared.cut(|(x, _)| half_x - x);
        shared.cut(|(x, _)| half_x + x);
        shared.cut(|(_, y)| half_y - y);
        shared.cut(|(_, y)| half_y + y);
        // Both heights are linear over what body and ramp share, so the highest difference is at one of its corners.
        shared.points[..shared.count].iter().any(|&(x, y)| {
            let (world_x, world_y) = solid.world(x, y);
            let (body_x, body_y) = self.stance.local(world_x, world_y);
            solid.blocks(self.shape, self.stance.plane_m(body_x, body_y), solid.slope_top(x, half_x))
        })
    }
}

/// A convex polygon of at most eight corners: two rectangles share no more.
struct SharedPolygon {
    points: [(f64, f64); 8],
    count: usize,
}

impl SharedPolygon {
    /// Keeps the part where the linear function `inside` is not negative (Sutherland and Hodgman 1974).
    fn cut(&mut self, inside: impl Fn((f64, f64)) -> f64) {
        let (old, count) = (self.points, self.count);
        self.count = 0;
        for index in 0..count {
            let (from, to) = (old[index], old[(index + 1) % count]);
            let (a, b) = (inside(from), inside(to));
            if a >= 0.0 {
                self.push(from);
            }
            if (a < 0.0) != (b < 0.0) {
                let share = a / (a - b);
                self.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
            }
        }
    }

    fn push(&mut self, point: (f64, f64)) {
        if let Some(place) = self.points.get_mut(self.count) {
            *place = point;
            self.count += 1;
        }
    }
}
