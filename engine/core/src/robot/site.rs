//! One world with the robot and its sensors in it.

use std::sync::Arc;

use super::recovery::Recovery;
use super::variation::Touched;
use crate::saved::{Passed, Passing};
use crate::sensors::{Camera, GroundSensors, Laser};
use crate::settings::{CameraSettings, GroundSettings, Settings};
use crate::world::scene::{Scene, Solid};
use crate::world::{Layout, World};

/// Between the seeds of two worlds of a run: their noise is not the same. The home world has the run's own seed.
const SEED_APART: u64 = 0x9e37_79b9_7f4a_7c15;

/// The robot's body as its own camera sees it.
#[derive(Debug, Clone)]
pub(super) struct OwnBody {
    height_m: f64,
    /// What moves, and room for the body.
    solids: Vec<Solid>,
}

/// A world, and what the robot has there.
pub(super) struct Site {
    pub(super) world: World,
    /// What the camera sees that stands still: the world's scene, perhaps in other colours.
    scene: Arc<Scene>,
    pub(super) camera: Camera,
    pub(super) laser: Laser,
    ground_at: GroundSettings,
    /// Made when somebody first asks for the ground.
    ground: Option<GroundSensors>,
    pub(super) recovery: Recovery,
    /// Where the camera sees the robot's own body.
    pub(super) own: Option<OwnBody>,
    seed: u64,
}

impl Site {
    /// The world with this number in a run under `seed`, with a robot that is not placed yet.
    pub(super) fn new(layout: &Arc<Layout>, settings: &Settings, seed: u64, number: usize) -> Self {
        let seed = seed_of_world(seed, number);
        let world = World::new(Arc::clone(layout), &[settings.robot], settings.run.period_s, seed)
            .with_mover_speed(settings.movers.speed);
        let room = world.seen_by(0).len() + 1;
        let own = settings.camera.own_body.then(|| OwnBody {
            height_m: settings.camera.deck_m.min(settings.robot.body.height_m),
            solids: Vec::with_capacity(room),
        });
        Self {
            world,
            scene: Arc::clone(&layout.scene),
            camera: Camera::new(&layout.scene, &settings.camera, seed),
            laser: Laser::new(&layout.scene, &settings.laser, seed),
            ground_at: settings.ground.clone(),
            ground: None,
            recovery: Recovery::new(settings, layout, seed),
            own,
            seed,
        }
    }

    /// A camera whose images noise does not hide.
    pub(super) fn quiet_camera(&self, settings: &CameraSettings) -> Camera {
        Camera::new(&self.scene, &CameraSettings { noise: 0.0, ..settings.clone() }, self.seed)
    }

    pub(super) fn ground(&mut self) -> &GroundSensors {
        self.ground.get_or_insert_with(|| GroundSensors::new(&self.scene, &self.ground_at))
    }

    /// What settings do not say.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        self.world.pass(by)?;
        let (mut frames, mut scans) = (self.camera.frames(), self.laser.scans());
        by.whole(&mut frames)?;
        by.whole(&mut scans)?;
        self.camera.set_frames(frames);
        self.laser.set_scans(scans);
        self.recovery.pass(by)
    }

    /// Becomes as these settings say, in the rooms that are touched. What depends on a drawn value is made anew: a camera or
    /// a laser of some ten kilobytes.
    pub(super) fn change(&mut self, settings: &Settings, touched: &Touched) {
        if touched.drive {
            self.world.change_drive(0, &settings.robot);
        }
        if touched.movers {
            for index in 0..self.world.layout().movers.len() {
                let speed = touched.speed_of(&self.world.layout().movers[index].name);
                self.world.set_mover_speed(index, settings.movers.speed * speed);
            }
        }
        if touched.colours {
            let scene = &self.world.layout().scene;
            let materials = scene.parts().materials.iter();
            let changes =
                materials.map(|material| (touched.levels_of(&material.name), touched.texture_of(&material.name)));
            self.scene = Arc::new(scene.repainted(changes));
            self.ground = None;
        }
        if touched.camera || touched.colours {
            let frames = self.camera.frames();
            self.camera = Camera::new(&self.scene, &settings.camera, self.seed);
            self.camera.set_frames(frames);
        }
        if touched.laser {
            let scans = self.laser.scans();
            self.laser = Laser::new(&self.scene, &settings.laser, self.seed);
            self.laser.set_scans(scans);
        }
        if touched.recovery {
            self.recovery.change(settings, touched.start_shift_m, touched.start_yaw_deg);
        }
    }
}

/// The seed of the world with this number.
pub(crate) fn seed_of_world(seed: u64, number: usize) -> u64 {
    seed.wrapping_add(SEED_APART.wrapping_mul(number as u64))
}

/// What the camera sees that does not belong to the scene: what moves, and the robot's own body if `own` has room for it.
pub(super) fn in_view<'a>(world: &'a World, own: &'a mut Option<OwnBody>) -> &'a [Solid] {
    let Some(OwnBody { height_m, solids }) = own else { return world.seen_by(0) };
    solids.clear();
    solids.extend_from_slice(world.seen_by(0));
    solids.push(world.solid_of(0, *height_m));
    solids
}
