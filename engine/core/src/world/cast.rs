//! Exact queries over a scene: what a ray meets first, and where the ground is.
//!
//! Slow and simple, by other code than the camera and the laser use, so that it can judge them.

use super::footprint::Obstacle;
use super::scene::{Scene, Shape, Solid};
use crate::geometry::{Point3, Vector3};
use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::query::{Ray, RayCast, RayIntersection};
use parry3d::shape::{ConvexPolyhedron, Cuboid, Cylinder};

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Distance from the ray's origin, metres.
    pub distance_m: f64,
    /// Unit normal of the surface.
    pub normal: Vector3,
    /// Index of the solid; none is the floor.
    pub solid: Option<usize>,
}

impl Scene {
    /// The first thing that a ray meets within `max_m` metres; `direction` is a unit vector.
    ///
    /// Solids that cannot be touched are seen too. From inside a solid the ray meets its far side. Distances are good to
    /// about 1e-5 of the solid's size and distance: the shapes compute in single precision.
    #[must_use]
    pub fn cast_ray(&self, origin: Point3, direction: Vector3, max_m: f64) -> Option<RayHit> {
        let mut best: Option<RayHit> = None;
        if origin.z > 0.0 && direction.z < 0.0 {
            let distance_m = -origin.z / direction.z;
            if distance_m <= max_m {
                best = Some(RayHit { distance_m, normal: Vector3::z(), solid: None });
            }
        }
        let reaches = |min: [f32; 3], max: [f32; 3]| {
            let (mut from, mut to) = (0.0_f64, max_m);
            for axis in 0..3 {
                let (low, high) = (f64::from(min[axis]) - origin[axis], f64::from(max[axis]) - origin[axis]);
                if direction[axis] == 0.0 {
                    if low > 0.0 || high < 0.0 {
                        return false;
                    }
                } else {
                    let (a, b) = (low / direction[axis], high / direction[axis]);
                    (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
                }
            }
            from <= to
        };
        self.visit(reaches, |index| {
            let Some((distance_m, normal)) = meet(&self.parts().solids[index], origin, direction, max_m) else {
                return;
            };
            let nearer = best.is_none_or(|best| {
                distance_m < best.distance_m
                    || (distance_m == best.distance_m && best.solid.is_some_and(|old| index < old))
            });
            if nearer {
                best = Some(RayHit { distance_m, normal, solid: Some(index) });
            }
        });
        best
    }

    /// The highest ground at a place of the floor plan that is not above `below_z_m`; the floor, 0, where there is none.
    #[must_use]
    pub fn ground_m(&self, x_m: f64, y_m: f64, below_z_m: f64) -> f64 {
        let (x, y) = (x_m as f32, y_m as f32);
        let mut ground = 0.0_f64;
        self.visit(
            |min, max| min[0] <= x && max[0] >= x && min[1] <= y && max[1] >= y,
            |index| {
                let solid = &self.parts().solids[index];
                if solid.collides
                    && let Some(top) = Obstacle::new(solid).top_at(x_m, y_m).filter(|top| *top <= below_z_m)
                {
                    ground = ground.max(top);
                }
            },
        );
        ground
    }
}

/// Distance and normal at which a ray meets one solid.
fn meet(solid: &Solid, origin: Point3, direction: Vector3, max_m: f64) -> Option<(f64, Vector3)> {
    // Into the solid's own axes in double precision, so that single precision starts from small numbers.
    let (sin, cos) = libm::sincos(solid.yaw_rad);
    let turn = |v: Vector3| Vector3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z);
    let single = |v: Vector3| Vector::new(v.x as f32, v.y as f32, v.z as f32);
    let ray = Ray::new(single(turn(origin - solid.centre)), single(turn(direction)));
    let hit = meet_local(&solid.shape, &ray, max_m as f32)?;
    let normal = Vector3::new(f64::from(hit.normal.x), f64::from(hit.normal.y), f64::from(hit.normal.z));
    let world = Vector3::new(normal.x * cos - normal.y * sin, normal.x * sin + normal.y * cos, normal.z);
    Some((f64::from(hit.time_of_impact), world))
}

fn meet_local(shape: &Shape, ray: &Ray, max_m: f32) -> Option<RayIntersection> {
    let half = shape.half_extents();
    let (x, y, z) = (half.x as f32, half.y as f32, half.z as f32);
    match shape {
        Shape::Box { .. } => Cuboid::new(Vector::new(x, y, z)).cast_local_ray_and_get_normal(ray, max_m, false),
        Shape::Cylinder { .. } => {
            // The library's cylinders stand along y.
            let upright = ParryPose::from_rotation(Rotation::from_xyzw(
                std::f32::consts::FRAC_1_SQRT_2,
                0.0,
                0.0,
                std::f32::consts::FRAC_1_SQRT_2,
            ));
            Cylinder::new(z, x).cast_ray_and_get_normal(&upright, ray, max_m, false)
        }
        Shape::Ramp { .. } => {
            let corners = [(-x, -z), (x, -z), (x, z)];
            let points: Vec<_> =
                corners.iter().flat_map(|&(x, z)| [Vector::new(x, -y, z), Vector::new(x, y, z)]).collect();
            ConvexPolyhedron::from_convex_hull(&points)?.cast_local_ray_and_get_normal(ray, max_m, false)
        }
    }
}
