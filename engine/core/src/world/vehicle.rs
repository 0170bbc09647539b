//! The robot's body: it drives, stops at what it touches, climbs, and falls.

use super::Motion;
use super::drivetrain::Drivetrain;
use super::layout::Layout;
use super::mover::Traffic;
use super::stance::Stance;
use super::terrain::Terrain;
use crate::geometry::{Pose, Twist};
use crate::settings::BodyShape;

/// The body and its drive.
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
}

/// All that can stop the body in one period.
struct Obstacles<'a> {
    shape: &'a BodyShape,
    terrain: &'a Terrain,
    blocking: &'a [u32],
    /// None if nothing moves, or the body overlaps a mover already.
    traffic: Option<&'a Traffic>,
}

impl Obstacles<'_> {
    fn block(&self, body: &Stance) -> bool {
        self.blocking.iter().any(|&index| self.terrain.obstacle(index).touches(self.shape, body))
            || self.traffic.is_some_and(|traffic| traffic.touches(self.shape, body))
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
    pub(super) fn new(shape: BodyShape, drive: Drivetrain, layout: &Layout, pose: Pose) -> Self {
        let stance = layout.terrain().put(&layout.scene, &shape, pose).stance;
        Self { shape, drive, stance, fallen: false, near: Vec::with_capacity(64), blocking: Vec::with_capacity(64) }
    }

    pub(super) fn shape(&self) -> &BodyShape {
        &self.shape
    }

    pub(super) fn stance(&self) -> &Stance {
        &self.stance
    }

    /// At rest at `pose`.
    pub(super) fn place(&mut self, layout: &Layout, pose: Pose) {
        self.stance = layout.terrain().put(&layout.scene, &self.shape, pose).stance;
        self.fallen = false;
        self.drive.stop();
    }

    /// One control period.
    pub(super) fn advance(&mut self, layout: &Layout, traffic: &Traffic, command: Twist) -> Motion {
        self.drive.begin();
        let mut motion = Motion { fallen: self.fallen, ..Motion::default() };
        if self.fallen {
            return motion;
        }
        let terrain = layout.terrain();
        motion.contact = self.gather(layout, command);
        let held = traffic.touches(&self.shape, &self.stance);
        motion.contact |= held;
        let traffic = Some(traffic).filter(|traffic| !held && !traffic.is_empty());
        let (shape, flat) = (&self.shape, terrain.is_flat(&self.shape));
        let obstacles = Obstacles { shape, terrain, blocking: &self.blocking, traffic };
        if flat && obstacles.blocking.is_empty() && traffic.is_none() {
            let mut pose = self.stance.pose;
            motion.odometry = drive_through(&mut self.drive, command, |twist, tick_s| {
                pose = pose.moved(twist, tick_s);
                Some(1.0)
            });
            self.stance = self.stance.moved(pose);
            return motion;
        }
        let (stance, fallen, near) = (&mut self.stance, &mut self.fallen, &self.near);
        motion.odometry = drive_through(&mut self.drive, command, |twist, tick_s| {
            let mut next = stance.moved(stance.pose.moved(twist, tick_s));
            let mut done = 1.0;
            if obstacles.block(&next) {
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

    /// Collects what can be reached, and tells whether the body overlaps any of it already.
    fn gather(&mut self, layout: &Layout, command: Twist) -> bool {
        let (terrain, shape, stance) = (layout.terrain(), &self.shape, &self.stance);
        let (near, blocking) = (&mut self.near, &mut self.blocking);
        near.clear();
        blocking.clear();
        Terrain::visit_near(&layout.scene, stance.pose, self.drive.reach_m(command) + shape.radius_m(), |index| {
            near.push(index);
            if !terrain.obstacle(index).touches(shape, stance) {
                blocking.push(index);
            }
        });
        blocking.len() < near.len()
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
