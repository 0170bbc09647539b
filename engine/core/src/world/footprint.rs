//! Where the robot's body is, and what it touches: exact tests on the floor plan, heights beside them.
//!
//! The body is the Pioneer 2-AT of Gazebo's model file: 0.497 m long and, with its wheels, 0.476 m wide. Half of that,
//! 0.238 m, is less than the 0.25 m at which the paper's laser rule fires, so the rule can fire for a wall beside the
//! robot before the body touches it. The maker's 0.505 m would touch first.

use super::scene::{Shape, Solid};
use crate::geometry::Pose;

/// Half of the body's length, metres.
pub const HALF_LENGTH_M: f64 = 0.2485;
/// Half of the body's width over the wheels, metres.
pub const HALF_WIDTH_M: f64 = 0.238;
/// Height of the body above its ground, metres.
pub const HEIGHT_M: f64 = 0.45;
/// Highest step that the wheels climb and the belly clears, and deepest that they go down without falling, metres.
pub const STEP_M: f64 = 0.06;
/// Half of the distance between the axles, metres.
pub(super) const WHEEL_X_M: f64 = 0.137;
/// Half of the distance between the left and right wheels, metres.
pub(super) const WHEEL_Y_M: f64 = 0.19;
/// Distance of the footprint's corners from its centre, rounded up, metres.
pub(super) const RADIUS_M: f64 = 0.345;

/// A pose with the plane that the body stands on: z = `z_m` + `slope_x` * x + `slope_y` * y in the body's own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stance {
    pub(super) pose: Pose,
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) z_m: f64,
    pub(super) slope_x: f64,
    pub(super) slope_y: f64,
}

impl Stance {
    /// Level at height `z_m`.
    pub(super) fn level(pose: Pose, z_m: f64) -> Self {
        let (sin, cos) = libm::sincos(pose.yaw_rad);
        Self { pose, sin, cos, z_m, slope_x: 0.0, slope_y: 0.0 }
    }

    /// The same plane carried along to another pose.
    pub(super) fn moved(self, pose: Pose) -> Self {
        Self { z_m: self.z_m, slope_x: self.slope_x, slope_y: self.slope_y, ..Self::level(pose, 0.0) }
    }

    /// A point of the body's axes in the world's.
    pub(super) fn world(&self, x: f64, y: f64) -> (f64, f64) {
        (self.pose.x_m + x * self.cos - y * self.sin, self.pose.y_m + x * self.sin + y * self.cos)
    }

    fn local(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - self.pose.x_m, y - self.pose.y_m);
        (x * self.cos + y * self.sin, y * self.cos - x * self.sin)
    }

    /// Height of the plane at a point of the body's axes.
    pub(super) fn plane_m(&self, x: f64, y: f64) -> f64 {
        self.z_m + self.slope_x * x + self.slope_y * y
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Outline {
    Rectangle { half_x: f64, half_y: f64, ramp: bool },
    Circle { radius: f64 },
}

/// A solid as the body meets it: its outline on the floor plan, its bottom and its top.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Obstacle {
    x: f64,
    y: f64,
    sin: f64,
    cos: f64,
    outline: Outline,
    bottom_m: f64,
    top_m: f64,
}

impl Obstacle {
    pub(super) fn new(solid: &Solid) -> Self {
        let (sin, cos) = libm::sincos(solid.yaw_rad);
        let half = solid.shape.half_extents();
        let outline = match solid.shape {
            Shape::Box { .. } => Outline::Rectangle { half_x: half.x, half_y: half.y, ramp: false },
            Shape::Ramp { .. } => Outline::Rectangle { half_x: half.x, half_y: half.y, ramp: true },
            Shape::Cylinder { radius_m, .. } => Outline::Circle { radius: radius_m },
        };
        let (bottom_m, top_m) = (solid.centre.z - half.z, solid.centre.z + half.z);
        Self { x: solid.centre.x, y: solid.centre.y, sin, cos, outline, bottom_m, top_m }
    }

    pub(super) fn top_m(&self) -> f64 {
        self.top_m
    }

    /// A point of the world in the solid's axes.
    fn local(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - self.x, y - self.y);
        (x * self.cos + y * self.sin, y * self.cos - x * self.sin)
    }

    /// The height of its top over a point of the floor plan, if it is there.
    pub(super) fn top_at(&self, x: f64, y: f64) -> Option<f64> {
        let (x, y) = self.local(x, y);
        match self.outline {
            Outline::Rectangle { half_x, half_y, ramp } => (x.abs() <= half_x && y.abs() <= half_y)
                .then(|| if ramp { self.slope_top(x, half_x) } else { self.top_m }),
            Outline::Circle { radius } => (x * x + y * y <= radius * radius).then_some(self.top_m),
        }
    }

    fn slope_top(&self, x: f64, half_x: f64) -> f64 {
        self.bottom_m + (self.top_m - self.bottom_m) * (0.5 + 0.5 * x / half_x)
    }

    /// Whether the body in this stance overlaps the solid.
    pub(super) fn touches(&self, body: &Stance) -> bool {
        let (x, y) = body.local(self.x, self.y);
        match self.outline {
            Outline::Circle { radius } => {
                let (near_x, near_y) = (x.clamp(-HALF_LENGTH_M, HALF_LENGTH_M), y.clamp(-HALF_WIDTH_M, HALF_WIDTH_M));
                let (x, y) = (x - near_x, y - near_y);
                x * x + y * y < radius * radius && self.stands_in_the_way(body.plane_m(near_x, near_y), self.top_m)
            }
            Outline::Rectangle { half_x, half_y, ramp } => {
                self.rectangles_overlap(body, (x, y), (half_x, half_y))
                    && if ramp {
                        self.ramp_touches(body, half_x, half_y)
                    } else {
                        self.box_touches(body, half_x, half_y)
                    }
            }
        }
    }

    /// The separating-axis test of two rectangles: they are apart if one of their four sides' directions shows a gap.
    fn rectangles_overlap(&self, body: &Stance, (x, y): (f64, f64), (half_x, half_y): (f64, f64)) -> bool {
        let cos = (body.cos * self.cos + body.sin * self.sin).abs();
        let sin = (body.cos * self.sin - body.sin * self.cos).abs();
        if x.abs() >= HALF_LENGTH_M + half_x * cos + half_y * sin
            || y.abs() >= HALF_WIDTH_M + half_x * sin + half_y * cos
        {
            return false;
        }
        let (x, y) = self.local(body.pose.x_m, body.pose.y_m);
        x.abs() < half_x + HALF_LENGTH_M * cos + HALF_WIDTH_M * sin
            && y.abs() < half_y + HALF_LENGTH_M * sin + HALF_WIDTH_M * cos
    }

    fn stands_in_the_way(&self, plane_m: f64, top_m: f64) -> bool {
        top_m > plane_m + STEP_M && self.bottom_m < plane_m + HEIGHT_M
    }

    fn box_touches(&self, body: &Stance, half_x: f64, half_y: f64) -> bool {
        let (x, y) = self.local(body.pose.x_m, body.pose.y_m);
        let (near_x, near_y) = self.nearest_in_body(body, x.clamp(-half_x, half_x), y.clamp(-half_y, half_y));
        self.stands_in_the_way(body.plane_m(near_x, near_y), self.top_m)
    }

    /// A ramp is in the way where its slope stands higher above the body's plane than a step, as it does at its sides
    /// and its high end; on the slope itself plane and ramp agree.
    fn ramp_touches(&self, body: &Stance, half_x: f64, half_y: f64) -> bool {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let mut shared = SharedPolygon { points: [(0.0, 0.0); 8], count: 4 };
        for (point, (x, y)) in shared.points.iter_mut().zip(corners) {
            let (x, y) = body.world(x * HALF_LENGTH_M, y * HALF_WIDTH_M);
            *point = self.local(x, y);
        }
        shared.cut(|(x, _)| half_x - x);
        shared.cut(|(x, _)| half_x + x);
        shared.cut(|(_, y)| half_y - y);
        shared.cut(|(_, y)| half_y + y);
        // Both heights are linear over what body and ramp share, so the highest difference is at one of its corners.
        shared.points[..shared.count].iter().any(|&(x, y)| {
            let (world_x, world_y) = self.world(x, y);
            let (body_x, body_y) = body.local(world_x, world_y);
            self.stands_in_the_way(body.plane_m(body_x, body_y), self.slope_top(x, half_x))
        })
    }

    fn world(&self, x: f64, y: f64) -> (f64, f64) {
        (self.x + x * self.cos - y * self.sin, self.y + x * self.sin + y * self.cos)
    }

    fn nearest_in_body(&self, body: &Stance, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = self.world(x, y);
        let (x, y) = body.local(x, y);
        (x.clamp(-HALF_LENGTH_M, HALF_LENGTH_M), y.clamp(-HALF_WIDTH_M, HALF_WIDTH_M))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Vector3};
    use crate::random::{Random, Stream};
    use parry3d::math::{Pose as ParryPose, Rotation, Vector};
    use parry3d::query;
    use parry3d::shape::{ConvexPolyhedron, Cuboid, Cylinder, Shape as ParryShape};

    /// The same question to another implementation, in single precision, of a solid grown by `skin_m` all round.
    fn oracle(body: Pose, solid: &Solid, skin_m: f64) -> bool {
        let turn = |yaw: f64| Rotation::from_rotation_z(yaw as f32);
        let single = |x: f64, y: f64, z: f64| Vector::new(x as f32, y as f32, z as f32);
        let own = Cuboid::new(single(HALF_LENGTH_M, HALF_WIDTH_M, 0.5 * (HEIGHT_M - STEP_M)));
        let own_centre = single(body.x_m, body.y_m, 0.5 * (STEP_M + HEIGHT_M));
        let half = solid.shape.half_extents().add_scalar(skin_m);
        let (x, y, z) = (half.x as f32, half.y as f32, half.z as f32);
        let (shape, rotation): (Box<dyn ParryShape>, _) = match solid.shape {
            Shape::Box { .. } => (Box::new(Cuboid::new(Vector::new(x, y, z))), turn(solid.yaw_rad)),
            Shape::Cylinder { .. } => {
                (Box::new(Cylinder::new(z, x)), Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2))
            }
            Shape::Ramp { .. } => {
                // Longer at the high end and higher all along: growing every side would change the slope.
                let (skin, slope) = (skin_m as f32, (z - skin_m as f32) / (x - skin_m as f32));
                let low = (skin - x, skin - z);
                let corners = [low, (x, low.1), (low.0, low.1 + skin), (x, low.1 + skin + slope * (x - low.0))];
                let points: Vec<_> =
                    corners.iter().flat_map(|&(x, z)| [Vector::new(x, -y, z), Vector::new(x, y, z)]).collect();
                (Box::new(ConvexPolyhedron::from_convex_hull(&points).unwrap()), turn(solid.yaw_rad))
            }
        };
        let centre = single(solid.centre.x, solid.centre.y, solid.centre.z);
        let (own_pose, pose) =
            (ParryPose::from_parts(own_centre, turn(body.yaw_rad)), ParryPose::from_parts(centre, rotation));
        query::intersection_test(&own_pose, &own, &pose, shape.as_ref()).unwrap().intersecting
    }

    /// How often the two disagree by more than `skin_m`, and how often there is contact.
    fn compare(shape: fn(Vector3) -> Shape, skin_m: f64) -> (usize, usize) {
        let mut random = Random::new(1, Stream::Test);
        let mut draw = |low, high| random.between(low, high);
        let (mut wrong, mut touching) = (0, 0);
        for _ in 0..5_000 {
            let body = Pose::new(draw(-0.8, 0.8), draw(-0.8, 0.8), draw(-3.0, 3.0));
            let centre = Point3::new(0.0, 0.0, draw(-0.2, 0.7));
            let shape = shape(Vector3::new(draw(0.02, 0.6), draw(0.02, 0.6), draw(0.02, 0.4)));
            let solid = Solid { shape, centre, yaw_rad: draw(-3.0, 3.0), material: 0, collides: true };
            let touches = Obstacle::new(&solid).touches(&Stance::level(body, 0.0));
            touching += usize::from(touches);
            let agrees = if touches { oracle(body, &solid, skin_m) } else { !oracle(body, &solid, -skin_m) };
            wrong += usize::from(!agrees);
        }
        (wrong, touching)
    }

    #[test]
    fn contact_with_boxes_agrees_with_a_second_implementation() {
        let (wrong, touching) = compare(|half_m| Shape::Box { half_m }, 1e-4);
        assert!(wrong == 0 && touching > 1_000, "{wrong} {touching}");
    }

    #[test]
    fn contact_with_cylinders_agrees_with_a_second_implementation() {
        let (wrong, touching) = compare(|half| Shape::Cylinder { radius_m: half.x, half_height_m: half.z }, 1e-3);
        assert!(wrong == 0 && touching > 1_000, "{wrong} {touching}");
    }

    #[test]
    fn contact_with_ramps_agrees_with_a_second_implementation() {
        let (wrong, touching) = compare(|half_m| Shape::Ramp { half_m }, 1e-3);
        assert!(wrong == 0 && touching > 1_000, "{wrong} {touching}");
    }
}
