//! Exact rays against solids as cuts of half spaces, and random scenes to shoot them at.

use crate::geometry::{Isometry3, Point3, Vector3, rotation};
use crate::random::Random;
use crate::sensors::surface::CYLINDER_SIDES;
use crate::world::scene::{Light, Material, Scene, SceneParts, Shape, Solid, Texture};
use nalgebra::{Translation3, UnitQuaternion};
use std::f64::consts::TAU;

/// Unit normals and offsets of the planes around a solid, in its own axes; a cylinder's side is left out or a prism.
fn planes(shape: &Shape, prism: bool) -> Vec<(Vector3, f64)> {
    let half = shape.half_extents();
    let mut planes = vec![(Vector3::z(), half.z), (-Vector3::z(), half.z)];
    match *shape {
        Shape::Box { .. } => {
            planes.extend([(Vector3::x(), half.x), (-Vector3::x(), half.x), (Vector3::y(), half.y)]);
            planes.push((-Vector3::y(), half.y));
        }
        Shape::Ramp { .. } => {
            planes[0] = (Vector3::new(-half.z, 0.0, half.x).normalize(), 0.0);
            planes.extend([(Vector3::x(), half.x), (Vector3::y(), half.y), (-Vector3::y(), half.y)]);
        }
        Shape::Cylinder { radius_m, .. } if prism => {
            let step = TAU / CYLINDER_SIDES as f64;
            planes.extend((0..CYLINDER_SIDES).map(|side| {
                let (sin, cos) = libm::sincos((side as f64 + 0.5) * step);
                (Vector3::new(cos, sin, 0.0), radius_m * libm::cos(step * 0.5))
            }));
        }
        Shape::Cylinder { .. } => {}
    }
    planes
}

/// Where a ray enters a solid, in ray lengths, and the normal there.
pub(super) fn entry(solid: &Solid, origin: &Vector3, ray: &Vector3, prism: bool) -> Option<(f64, Vector3)> {
    let turn = rotation(solid.yaw_rad, 0.0, 0.0);
    let (from, ray) = (turn.inverse() * (origin - solid.centre.coords), turn.inverse() * ray);
    let (mut enter, mut leave, mut normal) = (f64::NEG_INFINITY, f64::INFINITY, Vector3::z());
    for (out, offset) in planes(&solid.shape, prism) {
        let (height, fall) = (out.dot(&from) - offset, -out.dot(&ray));
        if fall > 0.0 && height / fall > enter {
            (enter, normal) = (height / fall, out);
        } else if fall < 0.0 {
            leave = leave.min(height / fall);
        } else if fall == 0.0 && height > 0.0 {
            return None;
        }
    }
    if let (Shape::Cylinder { radius_m, .. }, false) = (solid.shape, prism) {
        let (a, b) = (ray.x * ray.x + ray.y * ray.y, ray.x * from.x + ray.y * from.y);
        let root = b * b - a * (from.x * from.x + from.y * from.y - radius_m * radius_m);
        if root < 0.0 {
            return None;
        }
        enter = enter.max((-b - root.sqrt()) / a);
        leave = leave.min((-b + root.sqrt()) / a);
    }
    (enter > 0.0 && enter < leave).then(|| (enter, turn * normal))
}

/// Every solid has its own colour, and each of its sides its own brightness.
pub(super) fn scene(solids: Vec<Solid>, materials: usize) -> Scene {
    let material = |index: usize| Material {
        name: format!("material {index}"),
        colour: [60 + (index * 41 % 190) as u8, 60 + (index * 83 % 190) as u8, 60 + (index * 131 % 190) as u8],
        texture: Texture::Plain,
        laser: true,
    };
    let light = Light::from_direction(Vector3::new(0.48, 0.36, 0.8), 0.5, 0.9);
    Scene::new(SceneParts { solids, materials: (0..materials).map(material).collect(), floor: 0, light })
}

/// Solids of all shapes, some sunk, some afloat, some through each other, each of its own material from 1 on.
pub(super) fn random_solids(random: &mut Random, count: usize) -> Vec<Solid> {
    (1..=count)
        .map(|material| {
            let half_m = Vector3::new(random.between(0.05, 0.8), random.between(0.05, 0.8), random.between(0.05, 0.6));
            let shape = match random.below(3) {
                0 => Shape::Box { half_m },
                1 => Shape::Ramp { half_m },
                _ => Shape::Cylinder { radius_m: half_m.x, half_height_m: half_m.z },
            };
            let centre = Point3::new(random.between(-4.0, 4.0), random.between(-4.0, 4.0), random.between(-0.2, 1.2));
            Solid { shape, centre, yaw_rad: random.between(-3.0, 3.0), material, collides: true }
        })
        .collect()
}

/// A robot near the origin that pitches and rolls.
pub(super) fn random_pose(random: &mut Random) -> Isometry3 {
    let turn = rotation(random.between(-3.1, 3.1), random.between(-0.2, 0.2), random.between(-0.2, 0.2));
    let place = Translation3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(0.0, 0.2));
    Isometry3::from_parts(place, UnitQuaternion::from_rotation_matrix(&turn))
}

/// The transform from the axes of a robot that stands level on the floor, metres and radians.
pub(super) fn on_the_floor(x_m: f64, y_m: f64, yaw_rad: f64) -> Isometry3 {
    let turn = UnitQuaternion::from_rotation_matrix(&rotation(yaw_rad, 0.0, 0.0));
    Isometry3::from_parts(Translation3::new(x_m, y_m, 0.0), turn)
}

/// Whether a point keeps some distance from every solid.
pub(super) fn is_free(solids: &[Solid], point: &Vector3) -> bool {
    solids.iter().all(|solid| {
        let (min, max) = solid.bounds();
        (0..3).any(|axis| point[axis] < min[axis] - 0.1 || point[axis] > max[axis] + 0.1)
    })
}

/// The solid turned about nothing: a box with sides along the world's axes.
pub(super) fn box_at(centre: [f64; 3], half: [f64; 3], material: usize) -> Solid {
    let shape = Shape::Box { half_m: Vector3::from(half) };
    Solid { shape, centre: Point3::from(centre), yaw_rad: 0.0, material, collides: true }
}
