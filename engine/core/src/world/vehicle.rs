//! One body in motion: it drives, stops at what it touches, climbs, and falls.

use super::body::Motion;
use super::drivetrain::Drivetrain;
use super::layout::Layout;
use super::scene::{Shape, Solid};
use super::stance::Stance;
use super::terrain::Terrain;
use super::traffic::Traffic;
use crate::geometry::{Point3, Pose, Twist, Vector3};
use crate::saved::{Passed, Passing};
use crate::settings::{BodyShape, Footprint, RobotSettings};

/// A body and its drive.
#[derive(Debug, Clone)]
pub(super) struct Vehicle {
    shape: BodyShape,
    drive: Drivetrain,
    stance: Stance,
    fallen: bool,
    /// Solids that can be reached in the present period.
    near: Vec<u32>,
    /// Those of them that the body does not overlap already.
    blocking: Vec<u32>,
    /// Other bodies that can be reached and are not overlapped already.
    others: Vec<usize>,
    /// Other bodies that were touched in the last period.
    struck: Vec<usize>,
}

/// All that can stop the body in one period.
struct Obstacles<'a> {
    shape: &'a BodyShape,
    terrain: &'a Terrain,
    blocking: &'a [u32],
    traffic: &'a Traffic,
    others: &'a [usize],
    /// False if there are no movers, or the body overlaps one already.
    movers: bool,
}

impl Obstacles<'_> {
    fn is_empty(&self) -> bool {
        self.blocking.is_empty() && self.others.is_empty() && !self.movers
    }

    fn block(&self, body: &Stance) -> bool {
        self.blocking.iter().any(|&index| self.terrain.obstacle(index).touches(self.shape, body))
            || (self.movers && self.traffic.touches(self.shape, body))
            || self.met(body).next().is_some()
    }

    /// The other bodies that stand in the way.
    fn met(&self, body: &Stance) -> impl Iterator<Item = usize> {
        self.others.iter().copied().filter(|&other| self.traffic.body(other).touches(self.shape, body))
    }

    /// The last free stance on the way of a blocked tick, to a sixteenth of it, and the share of the tick until there.
    fn last_free(&self, from: &Stance, twist: Twist, tick_s: f64) -> (Stance, f64) {
        let (mut free, mut done, mut part) = (*from, 0.0, 0.5);
        for _ in 0..4 {
            let stance = from.moved(from.pose.moved(twist, tick_s * (done + part)));
            if !self.block(&stance) {
                (free, done) = (stance, done + part);
            }
            part *= 0.5;
        }
        (free, done)
    }
}

impl Vehicle {
    /// A body at rest at `pose`, with room for meeting `others` bodies.
    pub(super) fn new(shape: BodyShape, drive: Drivetrain, layout: &Layout, pose: Pose, others: usize) -> Self {
        Self {
            shape,
            drive,
            stance: layout.terrain().put(&layout.scene, &shape, pose).stance,
            fallen: false,
            near: Vec::with_capacity(64),
            blocking: Vec::with_capacity(64),
            others: Vec::with_capacity(others),
            struck: Vec::with_capacity(others),
        }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        self.stance.pass(by)?;
        by.flag(&mut self.fallen)?;
        self.drive.pass(by)
    }

    /// Drives on as other settings say, with the same random numbers.
    pub(super) fn change_drive(&mut self, robot: &RobotSettings, period_s: f64) {
        self.drive.change(robot, period_s);
    }

    pub(super) fn shape(&self) -> &BodyShape {
        &self.shape
    }

    pub(super) fn stance(&self) -> &Stance {
        &self.stance
    }

    /// The other bodies that it touched in the last period.
    pub(super) fn struck(&self) -> &[usize] {
        &self.struck
    }

    /// The body as others meet and see it: upright, whatever slope it stands on.
    pub(super) fn solid(&self, material: usize) -> Solid {
        self.solid_up_to(self.shape.height_m, material)
    }

    /// The body up to a height.
    pub(super) fn solid_up_to(&self, height_m: f64, material: usize) -> Solid {
        let (ahead_m, half_z) = (self.shape.footprint.ahead_m(), 0.5 * height_m);
        let [half_x, half_y] = self.shape.footprint.half_m();
        let shape = match self.shape.footprint {
            Footprint::Rectangle { .. } => Shape::Box { half_m: Vector3::new(half_x, half_y, half_z) },
            Footprint::Round { radius_m } => Shape::Cylinder { radius_m, half_height_m: half_z },
        };
        let (x, y) = self.stance.world(ahead_m, 0.0);
        let centre = Point3::new(x, y, self.stance.plane_m(ahead_m, 0.0) + half_z);
        Solid { shape, centre, yaw_rad: self.stance.pose.yaw_rad, material, collides: true }
    }

    /// At rest at `pose`.
    pub(super) fn place(&mut self, layout: &Layout, pose: Pose) {
        self.stance = layout.terrain().put(&layout.scene, &self.shape, pose).stance;
        self.fallen = false;
        self.drive.stop();
    }

    /// One control period of the body with this index.
    pub(super) fn advance(&mut self, layout: &Layout, traffic: &Traffic, index: usize, command: Twist) -> Motion {
        self.drive.begin();
        self.struck.clear();
        let mut motion = Motion { fallen: self.fallen, ..Motion::default() };
        if self.fallen {
            return motion;
        }
        let terrain = layout.terrain();
        let reach_m = self.drive.reach_m(command) + self.shape.radius_m();
        motion.contact = self.gather(layout, reach_m);
        motion.contact |= self.gather_others(traffic, index, reach_m);
        let held = traffic.touches(&self.shape, &self.stance);
        motion.contact |= held;
        let movers = !held && traffic.has_movers();
        let (shape, flat) = (&self.shape, terrain.is_flat(&self.shape));
        let obstacles = Obstacles { shape, terrain, blocking: &self.blocking, traffic, others: &self.others, movers };
        if flat && obstacles.is_empty() {
            let mut pose = self.stance.pose;
            motion.odometry = drive_through(&mut self.drive, command, |twist, tick_s| {
                pose = pose.moved(twist, tick_s);
                Some(1.0)
            });
            self.stance = self.stance.moved(pose);
            return motion;
        }
        let (stance, fallen, near, struck) = (&mut self.stance, &mut self.fallen, &self.near, &mut self.struck);
        motion.odometry = drive_through(&mut self.drive, command, |twist, tick_s| {
            let mut next = stance.moved(stance.pose.moved(twist, tick_s));
            let mut done = 1.0;
            if obstacles.block(&next) {
                for other in obstacles.met(&next) {
                    if !struck.contains(&other) {
                        struck.push(other);
                    }
                }
                (next, done) = obstacles.last_free(stance, twist, tick_s);
                motion.contact = true;
            }
            *stance = next;
            if !flat {
                let support = terrain.support(near, shape, stance);
                *stance = support.stance;
                *fallen = support.hanging > 1 || support.centre_hangs;
            }
            (!*fallen).then_some(done)
        });
        motion.fallen = self.fallen;
        motion
    }

    /// Collects the solids that can be reached, and returns whether the body overlaps any of them already.
    fn gather(&mut self, layout: &Layout, reach_m: f64) -> bool {
        let (terrain, shape, stance) = (layout.terrain(), &self.shape, &self.stance);
        let (near, blocking) = (&mut self.near, &mut self.blocking);
        near.clear();
        blocking.clear();
        Terrain::visit_near(&layout.scene, stance.pose, reach_m, |index| {
            near.push(index);
            if !terrain.obstacle(index).touches(shape, stance) {
                blocking.push(index);
            }
        });
        blocking.len() < near.len()
    }

    /// Collects the other bodies that can be reached, and returns whether the body overlaps any of them already.
    fn gather_others(&mut self, traffic: &Traffic, index: usize, reach_m: f64) -> bool {
        self.others.clear();
        for (other, obstacle) in traffic.others(index, self.stance.pose, reach_m) {
            let list = if obstacle.touches(&self.shape, &self.stance) { &mut self.struck } else { &mut self.others };
            list.push(other);
        }
        !self.struck.is_empty()
    }
}

/// Gives every tick's twist to `go`, which returns the share of the tick that was driven, or nothing to end the period
/// there. A tick cut short stops the wheels. Returns the wheels' mean speed.
fn drive_through(drive: &mut Drivetrain, command: Twist, mut go: impl FnMut(Twist, f64) -> Option<f64>) -> Twist {
    let (tick_s, share) = (drive.tick_s, 1.0 / f64::from(drive.ticks));
    let mut mean = Twist::default();
    for _ in 0..drive.ticks {
        let wheels = drive.tick(command);
        let done = go(drive.on_ground(wheels), tick_s);
        let weight = share * done.unwrap_or(1.0);
        mean.linear_m_per_s += wheels.linear_m_per_s * weight;
        mean.angular_rad_per_s += wheels.angular_rad_per_s * weight;
        match done {
            None => break,
            Some(done) if done < 1.0 => drive.stop(),
            Some(_) => {}
        }
    }
    mean
}
