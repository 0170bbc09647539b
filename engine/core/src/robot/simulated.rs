//! The robot in the simulator: world, camera and laser behind the door.

use std::sync::Arc;

use super::{Ended, Recovery, Robot, Whereabouts};
use crate::diagnostic::Result;
use crate::geometry::{Pose, Twist};
use crate::sensors::observation::{Image, Observation};
use crate::sensors::{Camera, CameraWatch, Laser, self_test};
use crate::settings::{CameraSettings, Settings};
use crate::world::{Layout, Motion, World};

/// A Pioneer 2-AT with a camera and a laser, in a world.
pub struct SimulatedRobot {
    world: World,
    camera: Camera,
    laser: Laser,
    watch: CameraWatch,
    recovery: Recovery,
    motion: Motion,
    moved: bool,
    /// The start at which it was put last, if it was one.
    start: Option<usize>,
}

impl SimulatedRobot {
    /// A robot at a safe pose of the world, its camera tested.
    ///
    /// # Errors
    /// If no pose is safe, or the camera shows nothing from there.
    pub fn new(layout: &Arc<Layout>, settings: &Settings, seed: u64) -> Result<Self> {
        let mut world = World::new(Arc::clone(layout), &[settings.robot], settings.run.period_s, seed)
            .with_mover_speed(settings.movers.speed);
        let camera = Camera::new(&layout.scene, &settings.camera, seed);
        let laser = Laser::new(&layout.scene, &settings.laser, seed);
        let mut recovery = Recovery::new(settings, layout, seed);
        let put = recovery.pose(&world, None)?;
        world.place(0, put.pose);
        // Noise would hide a blank image from the test.
        let mut quiet = Camera::new(&layout.scene, &CameraSettings { noise: 0.0, ..settings.camera.clone() }, seed);
        self_test(&mut quiet, &world.body(0).world_from_robot(), world.seen_by(0))?;
        let (watch, motion) = (CameraWatch::new(), Motion::default());
        Ok(Self { world, camera, laser, watch, recovery, motion, moved: false, start: put.start })
    }

    /// The truth, for tests and reports only.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }
}

impl Robot for SimulatedRobot {
    fn observe(&mut self, observation: &mut Observation) -> Result<()> {
        let world_from_robot = self.world.body(0).world_from_robot();
        self.camera.render(&world_from_robot, self.world.seen_by(0), &mut observation.image);
        self.watch.check(&observation.image, self.moved)?;
        self.laser.scan(&world_from_robot, self.world.seen_by(0), &mut observation.scan);
        observation.contact = self.motion.contact;
        observation.fallen = self.motion.fallen;
        observation.odometry = self.motion.odometry;
        Ok(())
    }

    fn act(&mut self, twist: Twist) -> Result<()> {
        let before = self.world.body(0).pose;
        self.motion = self.world.advance(&[twist]).first().copied().unwrap_or_default();
        self.moved = self.world.body(0).pose != before;
        Ok(())
    }

    fn recover(&mut self) -> Result<()> {
        self.recover_after(Ended::default())
    }

    fn recover_after(&mut self, ended: Ended) -> Result<()> {
        self.recovery.count(self.start, ended.good);
        self.world.begin_attempt();
        let put = self.recovery.pose(&self.world, ended.to)?;
        self.world.place(0, put.pose);
        self.start = put.start;
        self.motion = Motion::default();
        self.moved = true;
        Ok(())
    }

    fn whereabouts(&self) -> Option<Whereabouts> {
        let body = self.world.body(0);
        Some(Whereabouts { pose: body.pose, z_m: body.z_m })
    }

    fn starts_in_use(&self) -> usize {
        self.recovery.starts_in_use()
    }

    fn start(&self) -> Option<usize> {
        self.start
    }

    fn mover(&self, index: usize) -> Option<Pose> {
        self.world.mover(index)
    }

    fn gap_m(&self, mover: usize) -> Option<f64> {
        self.world.gap_m(0, mover)
    }

    /// Call it before anything moves: the frame is drawn a second time.
    fn photograph(&self) -> Option<Image> {
        let mut camera = self.camera.clone();
        camera.set_frames(camera.frames().saturating_sub(1));
        let mut image = Image::new(0, 0);
        camera.render(&self.world.body(0).world_from_robot(), self.world.seen_by(0), &mut image);
        Some(image)
    }
}
