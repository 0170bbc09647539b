//! Contact, held against another implementation and against hand-computed distances.

use super::*;
use crate::geometry::{Point3, Pose, Vector3};
use crate::random::{Random, Stream};
use crate::world::scene::{Shape, Solid};
use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::query;
use parry3d::shape::{ConvexPolyhedron, Cuboid, Cylinder, Shape as ParryShape};
use std::f64::consts::FRAC_PI_2;

const PIONEER: BodyShape = BodyShape::pioneer2at();
const ROUND: BodyShape = BodyShape { footprint: Footprint::Round { radius_m: 0.22 }, ..PIONEER };
/// Turns about a point in its rear.
const LONG: BodyShape =
    BodyShape { footprint: Footprint::Rectangle { length_m: 0.5, width_m: 0.2, ahead_m: 0.15 }, ..PIONEER };

fn single(x: f64, y: f64, z: f64) -> Vector {
    Vector::new(x as f32, y as f32, z as f32)
}

fn turn(yaw_rad: f64) -> Rotation {
    Rotation::from_rotation_z(yaw_rad as f32)
}

/// The other implementation's cylinders stand along y.
fn upright() -> Rotation {
    Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2)
}

/// What of a body can touch: all above the height of a step.
fn parry_body(shape: &BodyShape, at: Pose) -> (Box<dyn ParryShape>, ParryPose) {
    let half_z = 0.5 * (shape.height_m - shape.step_m);
    let [x, y] = shape.footprint.half_m();
    let (sin, cos) = libm::sincos(at.yaw_rad);
    let ahead = shape.footprint.ahead_m();
    let centre = single(at.x_m + ahead * cos, at.y_m + ahead * sin, 0.5 * (shape.step_m + shape.height_m));
    match shape.footprint {
        Footprint::Rectangle { .. } => {
            (Box::new(Cuboid::new(single(x, y, half_z))), ParryPose::from_parts(centre, turn(at.yaw_rad)))
        }
        Footprint::Round { radius_m } => {
            (Box::new(Cylinder::new(half_z as f32, radius_m as f32)), ParryPose::from_parts(centre, upright()))
        }
    }
}

/// Contact as parry3d finds it, in single precision, with a solid grown by `skin_m` all round.
fn oracle(shape: &BodyShape, at: Pose, solid: &Solid, skin_m: f64) -> bool {
    let (own, own_pose) = parry_body(shape, at);
    let half = solid.shape.half_extents().add_scalar(skin_m);
    let (x, y, z) = (half.x as f32, half.y as f32, half.z as f32);
    let (other, rotation): (Box<dyn ParryShape>, _) = match solid.shape {
        Shape::Box { .. } => (Box::new(Cuboid::new(Vector::new(x, y, z))), turn(solid.yaw_rad)),
        Shape::Cylinder { .. } => (Box::new(Cylinder::new(z, x)), upright()),
        Shape::Ramp { .. } => {
            // Longer at the high end and higher all along, or shorter and lower: growing every side would change the
            // slope. What would come to lie below the bottom is cut off.
            let (skin, slope) = (skin_m as f32, (z - skin_m as f32) / (x - skin_m as f32));
            let low = (skin - x, skin - z);
            let begin = low.0 + (-skin).max(0.0) / slope;
            let top = low.1 + skin + slope * (x - low.0);
            let corners = [(begin, low.1), (x, low.1), (begin, low.1 + skin.max(0.0)), (x, top)];
            let points: Vec<_> =
                corners.iter().flat_map(|&(x, z)| [Vector::new(x, -y, z), Vector::new(x, y, z)]).collect();
            (Box::new(ConvexPolyhedron::from_convex_hull(&points).unwrap()), turn(solid.yaw_rad))
        }
    };
    let centre = single(solid.centre.x, solid.centre.y, solid.centre.z);
    let pose = ParryPose::from_parts(centre, rotation);
    query::intersection_test(&own_pose, own.as_ref(), &pose, other.as_ref()).unwrap().intersecting
}

/// Holds 5,000 random meetings of each body with solids of one shape against the oracle, which may differ by `skin_m`.
fn hold_against_the_oracle(solid: fn(Vector3) -> Shape, skin_m: f64) {
    for body in [PIONEER, ROUND, LONG] {
        let mut random = Random::new(1, Stream::Test);
        let mut draw = |low, high| random.between(low, high);
        let (mut wrong, mut touching) = (0, 0);
        for _ in 0..5_000 {
            let at = Pose::new(draw(-0.8, 0.8), draw(-0.8, 0.8), draw(-3.0, 3.0));
            let centre = Point3::new(0.0, 0.0, draw(-0.2, 0.7));
            let shape = solid(Vector3::new(draw(0.02, 0.6), draw(0.02, 0.6), draw(0.02, 0.4)));
            let solid = Solid { shape, centre, yaw_rad: draw(-3.0, 3.0), material: 0, collides: true };
            let touches = Obstacle::new(&solid).touches(&body, &Stance::level(at, 0.0));
            touching += usize::from(touches);
            let agrees = if touches { oracle(&body, at, &solid, skin_m) } else { !oracle(&body, at, &solid, -skin_m) };
            wrong += usize::from(!agrees);
        }
        assert!(wrong == 0 && touching > 800, "{body:?}: {wrong} {touching}");
    }
}

#[test]
fn contact_with_boxes_agrees_with_a_second_implementation() {
    hold_against_the_oracle(|half_m| Shape::Box { half_m }, 1e-4);
}

#[test]
fn contact_with_cylinders_agrees_with_a_second_implementation() {
    hold_against_the_oracle(|half| Shape::Cylinder { radius_m: half.x, half_height_m: half.z }, 1e-3);
}

#[test]
fn contact_with_ramps_agrees_with_a_second_implementation() {
    hold_against_the_oracle(|half_m| Shape::Ramp { half_m }, 1e-3);
}

fn solid(shape: Shape, x: f64, y: f64) -> Obstacle {
    let centre = Point3::new(x, y, shape.half_extents().z);
    Obstacle::new(&Solid { shape, centre, yaw_rad: 0.0, material: 0, collides: true })
}

fn touches(obstacle: &Obstacle, body: &BodyShape, yaw_rad: f64) -> bool {
    obstacle.touches(body, &Stance::level(Pose::new(0.0, 0.0, yaw_rad), 0.0))
}

#[test]
fn a_round_body_touches_at_its_radius_whichever_way_it_looks() {
    let block = |x: f64, y: f64| solid(Shape::Box { half_m: Vector3::new(0.1, 0.1, 0.5) }, x, y);
    for yaw_rad in [0.0, 0.4, FRAC_PI_2, 3.0] {
        assert!(touches(&block(0.3199, 0.0), &ROUND, yaw_rad) && !touches(&block(0.3201, 0.0), &ROUND, yaw_rad));
        // The corner at (0.16, 0.16) is 0.2263 m away, that at (0.155, 0.155) 0.2192 m.
        assert!(!touches(&block(0.26, 0.26), &ROUND, yaw_rad) && touches(&block(0.255, 0.255), &ROUND, yaw_rad));
    }
    let post = |x: f64, y: f64| solid(Shape::Cylinder { radius_m: 0.05, half_height_m: 0.5 }, x, y);
    // 0.22 + 0.05 m from centre to centre, here along (3, 4) / 5.
    assert!(touches(&post(0.161, 0.215), &ROUND, 1.0) && !touches(&post(0.163, 0.217), &ROUND, 1.0));
}

#[test]
fn a_round_body_passes_over_what_is_low_and_under_what_is_high() {
    let slab = |bottom_m: f64, top_m: f64| {
        let shape = Shape::Box { half_m: Vector3::new(0.1, 0.1, 0.5 * (top_m - bottom_m)) };
        let centre = Point3::new(0.2, 0.0, 0.5 * (top_m + bottom_m));
        Obstacle::new(&Solid { shape, centre, yaw_rad: 0.0, material: 0, collides: true })
    };
    assert!(!touches(&slab(0.0, 0.05), &ROUND, 0.0) && touches(&slab(0.0, 0.07), &ROUND, 0.0));
    assert!(!touches(&slab(0.46, 0.6), &ROUND, 0.0) && touches(&slab(0.44, 0.6), &ROUND, 0.0));
}

#[test]
fn a_round_body_rides_up_a_ramp_and_meets_its_side_and_its_high_end() {
    // From the floor at x = -1 to 0.4 m at x = 1, two metres wide: a slope of 0.2.
    let ramp = solid(Shape::Ramp { half_m: Vector3::new(1.0, 1.0, 0.2) }, 0.0, 0.0);
    let on_it = Stance { z_m: 0.2, slope_x: 0.2, ..Stance::level(Pose::default(), 0.0) };
    assert!(!ramp.touches(&ROUND, &on_it));
    let across = Stance { z_m: 0.2, slope_y: -0.2, ..Stance::level(Pose::new(0.0, 0.0, FRAC_PI_2), 0.0) };
    assert!(!ramp.touches(&ROUND, &across));
    let at = |x: f64, y: f64| ramp.touches(&ROUND, &Stance::level(Pose::new(x, y, 0.0), 0.0));
    assert!(at(1.21, 0.0) && !at(1.23, 0.0) && at(0.5, 1.21) && !at(0.5, 1.23));
    // Level before its low end it reaches over the slope as far as that is not above a step of 0.06 m, at x = -0.7.
    assert!(!at(-0.93, 0.0) && at(-0.91, 0.0));
}

#[test]
fn a_rectangle_ahead_of_its_origin_reaches_farther_before_than_behind() {
    let post = |x: f64, y: f64| solid(Shape::Cylinder { radius_m: 0.1, half_height_m: 0.5 }, x, y);
    // From 0.1 m behind the origin to 0.4 m ahead of it.
    assert!(touches(&post(0.49, 0.0), &LONG, 0.0) && !touches(&post(0.51, 0.0), &LONG, 0.0));
    assert!(touches(&post(-0.19, 0.0), &LONG, 0.0) && !touches(&post(-0.21, 0.0), &LONG, 0.0));
    assert!(touches(&post(0.0, 0.49), &LONG, FRAC_PI_2) && !touches(&post(0.0, 0.51), &LONG, FRAC_PI_2));
}
