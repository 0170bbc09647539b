//! A solid as a body meets it: an outline on the floor plan with a bottom and a top.

use super::scene::{Shape, Solid};

/// The outline of an obstacle on the floor plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FloorArea {
    Rectangle { half_x: f64, half_y: f64, ramp: bool },
    Circle { radius: f64 },
}

/// A solid prepared for contact and for standing on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Obstacle {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) area: FloorArea,
    pub(super) bottom_m: f64,
    pub(super) top_m: f64,
    /// Of a ramp: metres of height for each metre of way; 0 of others, which are level.
    pub(super) rise: f64,
}

impl Obstacle {
    pub(super) fn new(solid: &Solid) -> Self {
        let (sin, cos) = libm::sincos(solid.yaw_rad);
        let half = solid.shape.half_extents();
        let area = match solid.shape {
            Shape::Box { .. } => FloorArea::Rectangle { half_x: half.x, half_y: half.y, ramp: false },
            Shape::Ramp { .. } => FloorArea::Rectangle { half_x: half.x, half_y: half.y, ramp: true },
            Shape::Cylinder { radius_m, .. } => FloorArea::Circle { radius: radius_m },
        };
        let (bottom_m, top_m) = (solid.centre.z - half.z, solid.centre.z + half.z);
        let rise = if matches!(solid.shape, Shape::Ramp { .. }) { half.z / half.x } else { 0.0 };
        Self { x: solid.centre.x, y: solid.centre.y, sin, cos, area, bottom_m, top_m, rise }
    }

    /// Whether a circle around its middle that holds it comes within `reach_m` of a place.
    pub(super) fn is_within(&self, x: f64, y: f64, reach_m: f64) -> bool {
        let radius = match self.area {
            FloorArea::Rectangle { half_x, half_y, .. } => (half_x * half_x + half_y * half_y).sqrt(),
            FloorArea::Circle { radius } => radius,
        };
        let (x, y, reach_m) = (x - self.x, y - self.y, reach_m + radius);
        x * x + y * y <= reach_m * reach_m
    }

    /// A point of the world in the solid's axes.
    pub(super) fn local(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - self.x, y - self.y);
        (x * self.cos + y * self.sin, y * self.cos - x * self.sin)
    }

    /// A point of the solid's axes in the world's.
    pub(super) fn world(&self, x: f64, y: f64) -> (f64, f64) {
        (self.x + x * self.cos - y * self.sin, self.y + x * self.sin + y * self.cos)
    }

    /// The height of its top over a point of the floor plan, if it is there.
    pub(super) fn top_at(&self, x: f64, y: f64) -> Option<f64> {
        let (x, y) = self.local(x, y);
        match self.area {
            FloorArea::Rectangle { half_x, half_y, ramp } => (x.abs() <= half_x && y.abs() <= half_y)
                .then(|| if ramp { self.slope_top(x, half_x) } else { self.top_m }),
            FloorArea::Circle { radius } => (x * x + y * y <= radius * radius).then_some(self.top_m),
        }
    }

    /// The height of a ramp's top `x` along its slope from its middle.
    pub(super) fn slope_top(&self, x: f64, half_x: f64) -> f64 {
        self.bottom_m + (self.top_m - self.bottom_m) * (0.5 + 0.5 * x / half_x)
    }
}
