//! What a reward cannot see: where the robot really is, and whether it gets anywhere.

use super::{Cycle, Observer, Step};
use crate::geometry::{Point2, Pose, wrap_angle};
use crate::robot::Robot;
use crate::world::{RouteProgress, WorldSet};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Seconds over which spinning, standing and circling are judged.
const SPELL_S: f64 = 20.0;
/// Turning tighter than this radius on average is spinning, metres.
const SPIN_RADIUS_M: f64 = 0.3;
/// A spell with less path than this is standing, metres.
const STANDING_M: f64 = 0.2;

/// Follows the true pose through a test.
#[derive(Debug, Clone)]
pub(super) struct Truth {
    worlds: WorldSet,
    /// The world in which the robot is.
    at: usize,
    /// Along the lap route of each world; none unless all have one.
    alongs: Vec<Along>,
    last: Pose,
    /// Length of the path, metres.
    pub(super) distance_m: f64,
    spell: Spell,
    spell_steps: u64,
    /// Whole spells, and of these spinning, standing, circling, and going backwards along the route.
    pub(super) spells: Spells,
    /// Distance to the prey after each step, metres; empty without a prey.
    pub(super) prey_m: Vec<f32>,
}

/// Where a robot was beside the lap route.
#[derive(Debug, Clone, Copy)]
struct Along {
    progress: RouteProgress,
    /// Length of the route, metres.
    lap_m: f64,
    /// Steps that ended farther from it than its half width.
    off_steps: u64,
    /// Sum of the distances from it after each step, metres.
    offsets_m: f64,
}

/// Counts of spells of 20 s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Spells {
    /// All whole spells.
    pub(super) all: u64,
    /// Full turn or more on a radius below 0.3 m.
    pub(super) spinning: u64,
    /// Less than 0.2 m of path and no full turn.
    pub(super) standing: u64,
    /// Full turn or more on a wider radius, ending within a quarter of the path of where it began.
    pub(super) circling: u64,
    /// None of these, but ending within a quarter of the path of where it began: to and fro.
    pub(super) returning: u64,
    /// Net progress along the route below zero.
    pub(super) backwards: u64,
}

#[derive(Debug, Clone, Copy)]
struct Spell {
    steps: u64,
    path_m: f64,
    turn_rad: f64,
    from: Pose,
    net_from_m: f64,
}

impl Truth {
    /// Begins at the robot's present pose; `None` for a robot that does not know where it is.
    #[must_use]
    pub(super) fn new(robot: &impl Robot, worlds: &WorldSet, period_s: f64, steps: u64) -> Option<Self> {
        let pose = robot.whereabouts()?.pose;
        let laps = worlds.layouts().iter().filter_map(|layout| layout.lap.map(|lap| &layout.routes[lap]));
        let along = |route| {
            let progress = RouteProgress::new(route, Point2::new(pose.x_m, pose.y_m));
            Along { progress, lap_m: route.length_m(), off_steps: 0, offsets_m: 0.0 }
        };
        let alongs = laps.filter(|_| worlds.have_laps()).map(along).collect();
        let prey_m = Vec::with_capacity(if robot.prey().is_some() { steps as usize } else { 0 });
        let spell_steps = (SPELL_S / period_s).round().max(1.0) as u64;
        Some(Self {
            worlds: worlds.clone(),
            at: robot.world_index(),
            alongs,
            last: pose,
            distance_m: 0.0,
            spell: Spell::new(pose, 0.0),
            spell_steps,
            spells: Spells::default(),
            prey_m,
        })
    }

    fn follow(&mut self, pose: Pose, prey: Option<Pose>) {
        let moved = pose.distance_m(self.last);
        self.distance_m += moved;
        self.spell.path_m += moved;
        self.spell.turn_rad += wrap_angle(pose.yaw_rad - self.last.yaw_rad);
        self.spell.steps += 1;
        self.last = pose;
        let layout = &self.worlds.layouts()[self.at];
        if let (Some(along), Some(lap)) = (self.alongs.get_mut(self.at), layout.lap) {
            along.progress.update(&layout.routes[lap], Point2::new(pose.x_m, pose.y_m));
            along.off_steps += u64::from(!along.progress.is_on());
            along.offsets_m += along.progress.offset_m();
        }
        if let Some(prey) = prey {
            self.prey_m.push(pose.distance_m(prey) as f32);
        }
        if self.spell.steps == self.spell_steps {
            self.end_spell();
        }
    }

    /// The robot was put elsewhere, perhaps into another world: no progress is counted for that, and the spell begins anew.
    fn jump(&mut self, world: usize, pose: Pose) {
        self.at = world;
        let layout = &self.worlds.layouts()[world];
        if let (Some(Along { progress, .. }), Some(lap)) = (self.alongs.get_mut(world), layout.lap) {
            progress.jump(&layout.routes[lap], Point2::new(pose.x_m, pose.y_m));
        }
        self.last = pose;
        self.spell = Spell::new(pose, self.net_m().unwrap_or(0.0));
    }

    /// Signed progress along the lap route of every world, metres; `None` unless all have one.
    #[must_use]
    pub(super) fn net_m(&self) -> Option<f64> {
        self.sum(|along| along.progress.net_m())
    }

    /// Laps of every world's route.
    pub(super) fn laps(&self) -> Option<f64> {
        self.sum(|along| along.progress.net_m() / along.lap_m)
    }

    /// Steps that ended farther from the route than its half width.
    pub(super) fn off_steps(&self) -> Option<f64> {
        self.sum(|along| along.off_steps as f64)
    }

    /// Sum of the distances from the route after each step, metres.
    pub(super) fn offsets_m(&self) -> Option<f64> {
        self.sum(|along| along.offsets_m)
    }

    fn sum(&self, of: impl Fn(&Along) -> f64) -> Option<f64> {
        // The sum of one is that one, to the last bit.
        self.alongs.iter().map(of).reduce(|sum, one| sum + one)
    }

    fn end_spell(&mut self) {
        let net_m = self.net_m();
        let Spell { path_m, turn_rad, from, net_from_m, .. } = self.spell;
        let (turned, away_m) = (turn_rad.abs() >= TAU, self.last.distance_m(from));
        self.spells.all += 1;
        if turned && path_m < SPIN_RADIUS_M * turn_rad.abs() {
            self.spells.spinning += 1;
        } else if turned && away_m < 0.25 * path_m {
            self.spells.circling += 1;
        } else if path_m < STANDING_M {
            self.spells.standing += 1;
        } else if away_m < 0.25 * path_m {
            self.spells.returning += 1;
        }
        self.spells.backwards += u64::from(net_m.is_some_and(|net_m| net_m < net_from_m));
        self.spell = Spell::new(self.last, net_m.unwrap_or(0.0));
    }
}

impl<R: Robot> Observer<R> for Truth {
    fn stepped(&mut self, cycle: &Cycle<R>, _: &Step) -> ControlFlow<()> {
        if let Some(here) = cycle.robot().whereabouts() {
            self.follow(here.pose, cycle.robot().prey());
        }
        ControlFlow::Continue(())
    }

    fn recovered(&mut self, cycle: &Cycle<R>) {
        if let Some(here) = cycle.robot().whereabouts() {
            self.jump(cycle.robot().world_index(), here.pose);
        }
    }
}

impl Spell {
    fn new(from: Pose, net_from_m: f64) -> Self {
        Self { steps: 0, path_m: 0.0, turn_rad: 0.0, from, net_from_m }
    }
}
