//! What a reward cannot see: where the robot really is, and whether it gets anywhere.

use super::spells::{SPELL_S, Spell, Spells};
use super::{Cycle, Observer, Step};
use crate::geometry::{Point2, Pose};
use crate::robot::Robot;
use crate::world::{RouteProgress, WorldSet};
use std::ops::ControlFlow;

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
    /// Whole spells, and of these spinning, standing, circling, and so on, and going backwards along the route.
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
        self.distance_m += pose.distance_m(self.last);
        self.spell.follow(pose);
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
        self.spell.count(net_m, &mut self.spells);
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
