//! What bodies can touch and stand on: the scene as they meet it.

use super::obstacle::Obstacle;
use super::scene::{Scene, Shape};
use super::stance::Stance;
use crate::geometry::Pose;
use crate::settings::{BodyShape, Footprint};
use std::f64::consts::TAU;

/// Points of a round footprint's rim under which ground is looked for.
const RIM_POINTS: usize = 16;
/// Solids that are no farther apart meet: the numbers of a world file are rounded.
const MEETING_M: f64 = 0.005;

/// The solids of a scene, prepared for contact and for standing on.
#[derive(Debug, Clone)]
pub(super) struct Terrain {
    obstacles: Vec<Obstacle>,
    /// For each solid, whether a body that is put there stands on top of it.
    carries: Vec<bool>,
    /// Whether there are ramps that can be driven on.
    has_ramps: bool,
    /// The lowest top of a solid that can be touched, metres; infinite without any.
    lowest_top_m: f64,
    /// The highest top of a solid that carries, metres; none without any.
    highest_carrying_m: Option<f64>,
}

/// How a stance is supported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Support {
    /// The stance on its new ground.
    pub(super) stance: Stance,
    /// How many of the wheels have no ground within a step.
    pub(super) hanging: usize,
    /// Whether the origin of the body has none.
    pub(super) centre_hangs: bool,
}

impl Terrain {
    /// `carries` holds for each solid whether bodies are put on top of it: platforms and ramps, not walls.
    pub(super) fn new(scene: &Scene, carries: Vec<bool>) -> Self {
        let solids = &scene.parts().solids;
        let obstacles: Vec<_> = solids.iter().map(Obstacle::new).collect();
        let touchable = || solids.iter().zip(&obstacles).zip(&carries).filter(|((solid, _), _)| solid.collides);
        let tops = || touchable().map(|((_, obstacle), _)| obstacle.top_m);
        let has_ramps = touchable().any(|((solid, _), _)| matches!(solid.shape, Shape::Ramp { .. }));
        let carrying = touchable().filter(|(_, carries)| **carries).map(|((_, obstacle), _)| obstacle.top_m);
        let (lowest_top_m, highest_carrying_m) = (tops().fold(f64::INFINITY, f64::min), carrying.reduce(f64::max));
        Self { has_ramps, lowest_top_m, highest_carrying_m, obstacles, carries }
    }

    /// Whether a body finds nothing but the floor to stand on.
    pub(super) fn is_flat(&self, shape: &BodyShape) -> bool {
        !self.has_ramps && self.highest_carrying_m.is_none() && self.lowest_top_m > shape.step_m
    }

    /// How far a body can stand above the floor while it stands level, metres; infinite where it can tip.
    pub(super) fn level_height_m(&self, shape: &BodyShape) -> f64 {
        if self.has_ramps || self.lowest_top_m <= shape.step_m {
            return f64::INFINITY;
        }
        self.highest_carrying_m.map_or(0.0, |top_m| top_m.max(0.0))
    }

    /// For each solid, whether a body drives on it: it carries, or its top is within a step of the floor or of a solid
    /// beside it that is driven on.
    pub(super) fn driven_on(&self, scene: &Scene, step_m: f64) -> Vec<bool> {
        let solids = &scene.parts().solids;
        let near = |a: usize, b: usize| {
            let ((a_min, a_max), (b_min, b_max)) = (solids[a].bounds(), solids[b].bounds());
            let meet = |a: (f64, f64), b: (f64, f64)| a.0 <= b.1 + MEETING_M && b.0 <= a.1 + MEETING_M;
            meet((a_min.x, a_max.x), (b_min.x, b_max.x)) && meet((a_min.y, a_max.y), (b_min.y, b_max.y))
        };
        let top_m = |index: usize| self.obstacles[index].top_m;
        let mut driven: Vec<bool> = (0..solids.len())
            .map(|index| solids[index].collides && (self.carries[index] || top_m(index) <= step_m))
            .collect();
        let mut reached: Vec<usize> = (0..solids.len()).filter(|index| driven[*index]).collect();
        while let Some(from) = reached.pop() {
            for to in 0..solids.len() {
                let steps = solids[to].collides && !driven[to] && (top_m(to) - top_m(from)).abs() <= step_m;
                if steps && near(from, to) {
                    driven[to] = true;
                    reached.push(to);
                }
            }
        }
        driven
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
    pub(super) fn overlapped(&self, scene: &Scene, shape: &BodyShape, stance: &Stance) -> Option<usize> {
        let mut first: Option<u32> = None;
        Self::visit_near(scene, stance.pose, shape.radius_m(), |index| {
            if first.is_none_or(|first| index < first) && self.obstacle(index).touches(shape, stance) {
                first = Some(index);
            }
        });
        first.map(|index| index as usize)
    }

    /// The stance of a body that is put at `pose`: on the highest platform or ramp there, or on the floor.
    pub(super) fn put(&self, scene: &Scene, shape: &BodyShape, pose: Pose) -> Support {
        let level = Stance::level(pose, 0.0);
        if self.is_flat(shape) {
            return Support { stance: level, hanging: 0, centre_hangs: false };
        }
        let (wheels, reach_m) = (Wheels::of(shape), shape.radius_m());
        let mut z_m = 0.0_f64;
        let carries = |index: u32| self.carries.get(index as usize).is_some_and(|carries| *carries);
        Self::visit_near(scene, pose, reach_m, |index| {
            if let Some(top) = self.obstacle(index).top_at(pose.x_m, pose.y_m).filter(|_| carries(index)) {
                z_m = z_m.max(top);
            }
        });
        let stance = Stance { z_m, ..level };
        let placing_m = wheels.placing_m();
        let mut grounds = Grounds::below(&stance, wheels, placing_m);
        Self::visit_near(scene, pose, reach_m, |index| grounds.add(self.obstacle(index)));
        grounds.centre = z_m;
        // A slope shows first at the uphill wheels; a second look with that slope finds the downhill ones.
        let first = grounds.settle(&stance, placing_m);
        let mut grounds = Grounds::below(&first.stance, wheels, shape.step_m);
        Self::visit_near(scene, pose, reach_m, |index| grounds.add(self.obstacle(index)));
        grounds.settle(&first.stance, shape.step_m)
    }

    /// The support of a moved body on the solids `near` it.
    pub(super) fn support(&self, near: &[u32], shape: &BodyShape, stance: &Stance) -> Support {
        let mut grounds = Grounds::below(stance, Wheels::of(shape), shape.step_m);
        near.iter().for_each(|&index| grounds.add(self.obstacle(index)));
        grounds.settle(stance, shape.step_m)
    }

    /// Whether there is ground within a step under the edge of the footprint: at a rectangle's corners, or at sixteen
    /// points of a circle.
    pub(super) fn carries_edge(&self, scene: &Scene, shape: &BodyShape, stance: &Stance) -> bool {
        let is_carried = |x: f64, y: f64| {
            let (world_x, world_y) = stance.world(x, y);
            let plane = stance.plane_m(x, y);
            plane - self.ground_m(scene, world_x, world_y, plane + shape.step_m) <= shape.step_m
        };
        match shape.footprint {
            Footprint::Rectangle { ahead_m, .. } => {
                let [half_x, half_y] = shape.footprint.half_m();
                [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
                    .iter()
                    .all(|(x, y)| is_carried(x * half_x + ahead_m, y * half_y))
            }
            Footprint::Round { radius_m } => (0..RIM_POINTS).all(|point| {
                let (sin, cos) = libm::sincos(TAU * point as f64 / RIM_POINTS as f64);
                is_carried(radius_m * cos, radius_m * sin)
            }),
        }
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

/// The four wheels of a body in its axes: front left, front right, rear left, rear right.
#[derive(Debug, Clone, Copy)]
struct Wheels {
    half_base: f64,
    half_track: f64,
    /// How far their middle lies ahead of the body's origin, metres.
    middle: f64,
    places: [(f64, f64); 4],
}

impl Wheels {
    fn of(shape: &BodyShape) -> Self {
        let (x, y, middle) = (0.5 * shape.wheelbase_m, 0.5 * shape.track_m, shape.footprint.ahead_m());
        let places = [(middle + x, y), (middle + x, -y), (middle - x, y), (middle - x, -y)];
        Self { half_base: x, half_track: y, middle, places }
    }

    /// How far above the ground of its origin a placed body looks for that of its wheels, metres: a slope of 1 at their
    /// distance, rounded up to a centimetre.
    fn placing_m(&self) -> f64 {
        let (x, y) = (self.half_base + self.middle.abs(), self.half_track);
        ((x * x + y * y).sqrt() * 100.0).ceil() / 100.0
    }
}

/// The highest grounds, not above a limit, under the four wheels and the centre.
struct Grounds {
    at: Wheels,
    points: [(f64, f64, f64); 5],
    wheels: [f64; 4],
    centre: f64,
}

impl Grounds {
    /// The floor, until solids are added. Nothing more than `above_m` over the body's plane counts.
    fn below(body: &Stance, at: Wheels, above_m: f64) -> Self {
        let point = |(x, y): (f64, f64)| {
            let (world_x, world_y) = body.world(x, y);
            (world_x, world_y, body.plane_m(x, y) + above_m)
        };
        let [a, b, c, d] = at.places.map(point);
        Self { at, points: [a, b, c, d, point((0.0, 0.0))], wheels: [0.0; 4], centre: 0.0 }
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
        let Wheels { half_base, half_track, middle, places } = self.at;
        let hangs = |wheel: usize| body.plane_m(places[wheel].0, places[wheel].1) - self.wheels[wheel] > drop_m;
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
        let slope_x = (front_left + front_right - rear_left - rear_right) / (4.0 * half_base);
        let stance = Stance {
            z_m: 0.25 * (front_left + front_right + rear_left + rear_right) - slope_x * middle,
            slope_x,
            slope_y: (front_left + rear_left - front_right - rear_right) / (4.0 * half_track),
            ..*body
        };
        Support { stance, hanging, centre_hangs }
    }
}
