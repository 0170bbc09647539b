//! What the robot can touch and stand on: the scene as the body meets it.

use super::footprint::{HALF_LENGTH_M, HALF_WIDTH_M, Obstacle, RADIUS_M, STEP_M, Stance, WHEEL_X_M, WHEEL_Y_M};
use super::scene::{Scene, Shape};
use crate::geometry::Pose;

/// The wheels in the body's axes: front left, front right, rear left, rear right.
const WHEELS: [(f64, f64); 4] =
    [(WHEEL_X_M, WHEEL_Y_M), (WHEEL_X_M, -WHEEL_Y_M), (-WHEEL_X_M, WHEEL_Y_M), (-WHEEL_X_M, -WHEEL_Y_M)];
/// A placed robot finds its wheels' ground at most this much above its centre's: a slope of 1 at a wheel's distance.
const PLACING_M: f64 = 0.24;

/// The solids of a scene, prepared for contact and for standing on.
#[derive(Debug, Clone)]
pub(super) struct Terrain {
    obstacles: Vec<Obstacle>,
    /// For each solid, whether a robot that is put there stands on top of it.
    carries: Vec<bool>,
    /// Nothing but the floor can be stood on.
    pub(super) flat: bool,
    /// How far the robot can stand above the floor while it stands level, metres; infinite where it can tip.
    pub(super) level_height_m: f64,
}

/// How a stance is supported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Support {
    /// The stance on its new ground.
    pub(super) stance: Stance,
    /// How many of the wheels have no ground within a step.
    pub(super) hanging: usize,
    /// Whether the centre has none.
    pub(super) centre_hangs: bool,
}

impl Terrain {
    /// `carries` tells for each solid whether robots are put on top of it: platforms and ramps, not walls.
    pub(super) fn new(scene: &Scene, carries: Vec<bool>) -> Self {
        let solids = &scene.parts().solids;
        let obstacles: Vec<_> = solids.iter().map(Obstacle::new).collect();
        let can_be_stood_on = |index: usize| {
            let solid = &solids[index];
            let climbed = obstacles[index].top_m() <= STEP_M || matches!(solid.shape, Shape::Ramp { .. });
            solid.collides && (climbed || carries.get(index).is_some_and(|carries| *carries))
        };
        let flat = !(0..solids.len()).any(can_be_stood_on);
        let height_m = |index: usize| {
            let top_m = obstacles[index].top_m();
            let tips = top_m <= STEP_M || matches!(solids[index].shape, Shape::Ramp { .. });
            if tips { f64::INFINITY } else { top_m }
        };
        let level_height_m =
            (0..solids.len()).filter(|index| can_be_stood_on(*index)).map(height_m).fold(0.0, f64::max);
        Self { obstacles, carries, flat, level_height_m }
    }

    pub(super) fn obstacle(&self, index: u32) -> &Obstacle {
        &self.obstacles[index as usize]
    }

    /// Calls `each` with the colliding solids whose surrounding boxes come within `reach_m` of a place.
    pub(super) fn visit_near(scene: &Scene, pose: Pose, reach_m: f64, mut each: impl FnMut(u32)) {
        let single = |value: f64| value as f32;
        let (min_x, max_x) = (single(pose.x_m - reach_m), single(pose.x_m + reach_m));
        let (min_y, max_y) = (single(pose.y_m - reach_m), single(pose.y_m + reach_m));
        scene.visit(
            |min, max| min[0] <= max_x && max[0] >= min_x && min[1] <= max_y && max[1] >= min_y,
            |index| {
                if scene.parts().solids[index].collides {
                    each(index as u32);
                }
            },
        );
    }

    /// The first solid that the body overlaps.
    pub(super) fn overlapped(&self, scene: &Scene, body: &Stance) -> Option<usize> {
        let mut first: Option<u32> = None;
        Self::visit_near(scene, body.pose, RADIUS_M, |index| {
            if first.is_none_or(|first| index < first) && self.obstacle(index).touches(body) {
                first = Some(index);
            }
        });
        first.map(|index| index as usize)
    }

    /// The stance of a robot that is put at `pose`: on the highest platform or ramp there, or on the floor.
    pub(super) fn put(&self, scene: &Scene, pose: Pose) -> Support {
        let level = Stance::level(pose, 0.0);
        if self.flat {
            return Support { stance: level, hanging: 0, centre_hangs: false };
        }
        let mut z_m = 0.0_f64;
        let carries = |index: u32| self.carries.get(index as usize).is_some_and(|carries| *carries);
        Self::visit_near(scene, pose, RADIUS_M, |index| {
            if let Some(top) = self.obstacle(index).top_at(pose.x_m, pose.y_m).filter(|_| carries(index)) {
                z_m = z_m.max(top);
            }
        });
        let stance = Stance { z_m, ..level };
        let mut grounds = Grounds::below(&stance, PLACING_M);
        Self::visit_near(scene, pose, RADIUS_M, |index| grounds.add(self.obstacle(index)));
        grounds.centre = z_m;
        // A slope shows first at the uphill wheels; a second look with that slope finds the downhill ones.
        let first = grounds.settle(&stance, PLACING_M);
        let mut grounds = Grounds::below(&first.stance, STEP_M);
        Self::visit_near(scene, pose, RADIUS_M, |index| grounds.add(self.obstacle(index)));
        grounds.settle(&first.stance, STEP_M)
    }

    /// The support of a moved body on the solids `near` it.
    pub(super) fn support(&self, near: &[u32], body: &Stance) -> Support {
        let mut grounds = Grounds::below(body, STEP_M);
        near.iter().for_each(|&index| grounds.add(self.obstacle(index)));
        grounds.settle(body, STEP_M)
    }

    /// Whether there is ground within a step under all corners of the footprint.
    pub(super) fn carries_corners(&self, scene: &Scene, body: &Stance) -> bool {
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].iter().all(|(x, y)| {
            let (x, y) = (x * HALF_LENGTH_M, y * HALF_WIDTH_M);
            let (world_x, world_y) = body.world(x, y);
            let plane = body.plane_m(x, y);
            plane - self.ground_m(scene, world_x, world_y, plane + STEP_M) <= STEP_M
        })
    }

    /// The highest ground at a place of the floor plan that is not above `below_z_m`; the floor, 0, where there is none.
    pub(super) fn ground_m(&self, scene: &Scene, x_m: f64, y_m: f64, below_z_m: f64) -> f64 {
        let mut ground = 0.0_f64;
        Self::visit_near(scene, Pose::new(x_m, y_m, 0.0), 0.0, |index| {
            if let Some(top) = self.obstacle(index).top_at(x_m, y_m).filter(|top| *top <= below_z_m) {
                ground = ground.max(top);
            }
        });
        ground
    }
}

/// The highest grounds, not above a limit, under the four wheels and the centre.
struct Grounds {
    points: [(f64, f64, f64); 5],
    wheels: [f64; 4],
    centre: f64,
}

impl Grounds {
    /// The floor, until solids are added. Nothing more than `above_m` over the body's plane counts.
    fn below(body: &Stance, above_m: f64) -> Self {
        let point = |(x, y): (f64, f64)| {
            let (world_x, world_y) = body.world(x, y);
            (world_x, world_y, body.plane_m(x, y) + above_m)
        };
        let [a, b, c, d] = WHEELS.map(point);
        Self { points: [a, b, c, d, point((0.0, 0.0))], wheels: [0.0; 4], centre: 0.0 }
    }

    fn add(&mut self, obstacle: &Obstacle) {
        let grounds = self.wheels.iter_mut().chain(std::iter::once(&mut self.centre));
        for ((x, y, limit), ground) in self.points.iter().zip(grounds) {
            if let Some(top) = obstacle.top_at(*x, *y).filter(|top| top <= limit) {
                *ground = ground.max(top);
            }
        }
    }

    fn settle(&self, body: &Stance, drop_m: f64) -> Support {
        let hangs = |wheel: usize| body.plane_m(WHEELS[wheel].0, WHEELS[wheel].1) - self.wheels[wheel] > drop_m;
        let hanging = (0..4).filter(|&wheel| hangs(wheel)).count();
        let centre_hangs = body.z_m - self.centre > drop_m;
        let mut heights = self.wheels;
        if hanging == 1 {
            // The other three wheels carry the body; the fourth hangs in their plane.
            for wheel in (0..4).filter(|&wheel| hangs(wheel)) {
                heights[wheel] = self.wheels[wheel ^ 1] + self.wheels[wheel ^ 2] - self.wheels[wheel ^ 3];
            }
        }
        if hanging > 1 || centre_hangs {
            return Support { stance: *body, hanging, centre_hangs };
        }
        let [front_left, front_right, rear_left, rear_right] = heights;
        let stance = Stance {
            z_m: 0.25 * (front_left + front_right + rear_left + rear_right),
            slope_x: (front_left + front_right - rear_left - rear_right) / (4.0 * WHEEL_X_M),
            slope_y: (front_left + rear_left - front_right - rear_right) / (4.0 * WHEEL_Y_M),
            ..*body
        };
        Support { stance, hanging, centre_hangs }
    }
}
