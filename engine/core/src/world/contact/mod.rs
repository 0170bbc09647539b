//! Whether a body overlaps a solid: exact tests on the floor plan, heights beside them.

mod gap;
mod rectangle;
mod round;
#[cfg(test)]
mod tests;

use super::obstacle::Obstacle;
use super::stance::Stance;
use crate::settings::{BodyShape, Footprint};

/// A ramp that is too steep to climb is in the way from this height on, metres: more than rounding makes of the floor.
const STEEP_M: f64 = 0.001;

impl Obstacle {
    /// Whether a body in this stance overlaps the solid.
    pub(super) fn touches(&self, shape: &BodyShape, stance: &Stance) -> bool {
        match shape.footprint {
            Footprint::Rectangle { .. } => rectangle::RectangleBody::new(shape, stance).overlaps(self),
            Footprint::Round { radius_m } => round::RoundBody { shape, stance, radius_m }.overlaps(self),
        }
    }

    /// Whether the solid, `top_m` high at some place, is in the way of a body whose plane is `plane_m` high there:
    /// neither low enough to be climbed nor high enough to pass under.
    fn blocks(&self, shape: &BodyShape, plane_m: f64, top_m: f64) -> bool {
        let step_m = if self.rise > shape.steepest { shape.step_m.min(STEEP_M) } else { shape.step_m };
        top_m > plane_m + step_m && self.bottom_m < plane_m + shape.height_m
    }
}

/// The point of -`half` to `half` that is nearest to `x`.
fn nearest_within(x: f64, half: f64) -> f64 {
    x.max(-half).min(half)
}
