//! A robot's body as data: the ground that it covers, its height, its wheels.

use serde::{Deserialize, Serialize};

/// Radii are rounded up to this many to the metre, so that rounding never makes one smaller than its body.
const PER_METRE: f64 = 1000.0;

/// The body of a robot, as far as a world must know it: what it touches with and what it stands on.
///
/// Its axes: x forward, y left, the origin on the ground at the point about which it turns. Lengths are in metres,
/// positive and finite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyShape {
    /// Its outline on the floor plan, the same at every height.
    pub footprint: Footprint,
    /// Height above its ground, metres.
    pub height_m: f64,
    /// Highest step that the wheels climb and the belly clears, and deepest that they go down without falling, metres.
    pub step_m: f64,
    /// Steepest ramp that it climbs, metres of height for each metre of way; infinite for any. Steeper ones are walls.
    #[serde(default = "any_slope")]
    pub steepest: f64,
    /// Distance between the axles, half of it ahead of the footprint's middle, metres.
    pub wheelbase_m: f64,
    /// Distance between the left and the right wheels, half of it on each side of the origin, metres.
    pub track_m: f64,
}

/// The outline of a body on the floor plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case", deny_unknown_fields)]
pub enum Footprint {
    /// A rectangle along the body's axes.
    Rectangle {
        /// Length, metres.
        length_m: f64,
        /// Width, metres.
        width_m: f64,
        /// How far its middle lies ahead of the origin, metres; negative behind it.
        #[serde(default)]
        ahead_m: f64,
    },
    /// A circle around the origin.
    Round {
        /// Radius, metres.
        radius_m: f64,
    },
}

impl BodyShape {
    /// The Pioneer 2-AT of the paper.
    ///
    /// Length, wheelbase and track are those of `pioneer2at.model` in Gazebo 0.8; the width is its track and the 0.096 m of
    /// a wheel. Half of that, 0.238 m, is less than the 0.25 m at which the paper's laser rule fires, so the rule can fire
    /// for a wall beside the robot before the body touches it; with the maker's 0.505 m the body would touch first. No
    /// model file has the other two: the height is about that of a laser on the deck, the step half the radius of a wheel.
    #[must_use]
    pub const fn pioneer2at() -> Self {
        Self {
            footprint: Footprint::Rectangle { length_m: 0.497, width_m: 0.476, ahead_m: 0.0 },
            height_m: 0.45,
            step_m: 0.06,
            steepest: f64::INFINITY,
            wheelbase_m: 0.274,
            track_m: 0.38,
        }
    }

    /// Radius of a circle around the origin that holds the whole footprint, rounded up to a millimetre, metres.
    #[must_use]
    pub(crate) fn radius_m(&self) -> f64 {
        let radius_m = match self.footprint {
            Footprint::Rectangle { length_m, width_m, ahead_m } => {
                let (x, y) = (0.5 * length_m + ahead_m.abs(), 0.5 * width_m);
                (x * x + y * y).sqrt()
            }
            Footprint::Round { radius_m } => radius_m,
        };
        (radius_m * PER_METRE).ceil() / PER_METRE
    }
}

const fn any_slope() -> f64 {
    f64::INFINITY
}

impl Footprint {
    /// Length and width of the greatest rectangle within it, as far apart as its wheels can be, metres.
    #[must_use]
    pub(super) fn wheels_m(&self) -> [f64; 2] {
        match *self {
            Self::Rectangle { length_m, width_m, .. } => [length_m, width_m],
            Self::Round { radius_m } => [radius_m * std::f64::consts::SQRT_2; 2],
        }
    }

    /// Its corners, or 24 points of its circle, from the front left on anticlockwise; in the body's axes, metres.
    #[must_use]
    pub fn outline_m(&self) -> Vec<[f64; 2]> {
        match *self {
            Self::Rectangle { ahead_m, .. } => {
                let [x, y] = self.half_m();
                vec![[ahead_m + x, y], [ahead_m - x, y], [ahead_m - x, -y], [ahead_m + x, -y]]
            }
            Self::Round { radius_m } => (0..24)
                .map(|point| libm::sincos(std::f64::consts::TAU * f64::from(point) / 24.0))
                .map(|(sin, cos)| [radius_m * cos, radius_m * sin])
                .collect(),
        }
    }

    /// How far a place lies outside of the outline, metres; negative within it.
    #[must_use]
    pub fn outside_m(&self, x_m: f64, y_m: f64) -> f64 {
        match *self {
            Self::Rectangle { ahead_m, .. } => {
                let [x, y] = self.half_m();
                ((x_m - ahead_m).abs() - x).max(y_m.abs() - y)
            }
            Self::Round { radius_m } => (x_m * x_m + y_m * y_m).sqrt() - radius_m,
        }
    }

    /// Half of its length and half of its width, metres.
    #[must_use]
    pub fn half_m(&self) -> [f64; 2] {
        match *self {
            Self::Rectangle { length_m, width_m, .. } => [0.5 * length_m, 0.5 * width_m],
            Self::Round { radius_m } => [radius_m; 2],
        }
    }

    /// How far its middle lies ahead of the origin, metres.
    #[must_use]
    pub fn ahead_m(&self) -> f64 {
        match *self {
            Self::Rectangle { ahead_m, .. } => ahead_m,
            Self::Round { .. } => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_radius_reaches_the_farthest_corner_and_is_rounded_up() {
        // The square root of 0.2485^2 + 0.238^2 is 0.34409.
        assert_eq!(BodyShape::pioneer2at().radius_m(), 0.345);
        let footprint = Footprint::Rectangle { length_m: 0.4, width_m: 0.6, ahead_m: -0.2 };
        assert_eq!(BodyShape { footprint, ..BodyShape::pioneer2at() }.radius_m(), 0.5);
        let footprint = Footprint::Round { radius_m: 0.22 };
        assert_eq!(BodyShape { footprint, ..BodyShape::pioneer2at() }.radius_m(), 0.22);
    }

    #[test]
    fn the_outline_goes_round_the_middle_that_lies_ahead() {
        let footprint = Footprint::Rectangle { length_m: 0.6, width_m: 0.4, ahead_m: 0.2 };
        assert_eq!(footprint.outline_m()[0], [0.5, 0.2]);
        assert_eq!(footprint.outline_m()[2], [-0.09999999999999998, -0.2]);
        assert!((footprint.outside_m(0.6, 0.0) - 0.1).abs() < 1e-12 && footprint.outside_m(0.2, 0.0) < -0.19);
        let round = Footprint::Round { radius_m: 0.2 };
        assert_eq!((round.outline_m().len(), round.outline_m()[0]), (24, [0.2, 0.0]));
        assert!((round.outside_m(0.0, 0.25) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn a_body_is_read_from_a_table_of_lengths() {
        let text = "footprint = { shape = \"round\", radius_m = 0.22 }\nheight_m = 0.2\nstep_m = 0.01\n\
                    wheelbase_m = 0.2\ntrack_m = 0.29\n";
        let body: BodyShape = toml::from_str(text).unwrap();
        assert_eq!((body.footprint, body.track_m), (Footprint::Round { radius_m: 0.22 }, 0.29));
        assert!(toml::from_str::<BodyShape>(&text.replace("track_m", "track_cm")).is_err());
        let pioneer = BodyShape::pioneer2at();
        assert_eq!(toml::from_str::<BodyShape>(&toml::to_string(&pioneer).unwrap()).unwrap(), pioneer);
    }
}
