//! The robot in the simulator: world, camera and laser behind the door.

use std::sync::Arc;

use super::{Ended, Recovery, Robot, Whereabouts};
use crate::diagnostic::Result;
use crate::geometry::{Pose, Twist};
use crate::sensors::observation::{Image, Observation};
use crate::sensors::{Camera, CameraWatch, GroundSensors, Laser, self_test};
use crate::settings::{CameraSettings, GroundSettings, Settings};
use crate::world::scene::Solid;
use crate::world::{Layout, Motion, World};

/// A robot with a body, a camera and a laser, in a world.
pub struct SimulatedRobot {
    world: World,
    camera: Camera,
    laser: Laser,
    ground_at: GroundSettings,
    /// Made when somebody first asks for the ground.
    ground: Option<GroundSensors>,
    watch: CameraWatch,
    recovery: Recovery,
    motion: Motion,
    moved: bool,
    /// Where the camera sees the robot's own body: what it sees that moves, and room for it.
    own: Option<Vec<Solid>>,
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
        let mut own = settings.camera.own_body.then(|| Vec::with_capacity(world.seen_by(0).len() + 1));
        self_test(&mut quiet, &world.body(0).world_from_robot(), in_view(&world, &mut own))?;
        let (watch, motion) = (CameraWatch::new(), Motion::default());
        let (start, ground_at, ground) = (put.start, settings.ground.clone(), None);
        Ok(Self { world, camera, laser, ground_at, ground, watch, recovery, motion, moved: false, own, start })
    }

    /// The truth, for tests and reports only.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }
}

/// What the camera sees that does not belong to the scene: what moves, and the robot's own body if `own` has room for it.
fn in_view<'a>(world: &'a World, own: &'a mut Option<Vec<Solid>>) -> &'a [Solid] {
    let Some(solids) = own else { return world.seen_by(0) };
    solids.clear();
    solids.extend_from_slice(world.seen_by(0));
    solids.push(world.solid_of(0));
    solids
}

impl Robot for SimulatedRobot {
    fn observe(&mut self, observation: &mut Observation) -> Result<()> {
        let world_from_robot = self.world.body(0).world_from_robot();
        let moving = in_view(&self.world, &mut self.own);
        self.camera.render(&world_from_robot, moving, &mut observation.image);
        self.watch.check(&observation.image, self.moved)?;
        self.laser.scan(&world_from_robot, self.world.seen_by(0), &mut observation.scan);
        if let Some(colours) = &mut observation.ground {
            let scene = &self.world.layout().scene;
            let ground = self.ground.get_or_insert_with(|| GroundSensors::new(scene, &self.ground_at));
            *colours = ground.read(&world_from_robot);
        }
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
        let mut own = self.own.clone();
        camera.render(&self.world.body(0).world_from_robot(), in_view(&self.world, &mut own), &mut image);
        Some(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::settings::RecoverTo;
    use filter_api::Format;

    #[test]
    fn a_camera_sees_the_body_below_it_only_where_it_is_told_to() {
        let text = "[[material]]\nname = \"red\"\ncolour = [200, 0, 0]\n[floor]\nmaterial = \"red\"\n\
                    [[wall]]\npoints_m = [[-9, 0.5], [9, 0.5]]\n[[start]]\nposition_m = [0, 0]\n";
        let look = |own_body: bool| {
            let mut settings = Settings::default();
            settings.recovery.to = RecoverTo::Start;
            settings.camera = CameraSettings { own_body, tilt_deg: 90.0, noise: 0.0, ..settings.camera };
            let layout = Layout::parse(SourceText::new("w.toml", text), &settings.robot.body).unwrap();
            let mut robot = SimulatedRobot::new(&Arc::new(layout), &settings, 1).unwrap();
            let mut observation = Observation::asking_for(Format::Rgb, 160, 120, 181);
            robot.observe(&mut observation).unwrap();
            let pixel = (60 * 160 + 80) * 3;
            let middle = observation.image.pixels[pixel..pixel + 3].to_vec();
            (middle, observation.scan.ranges_m)
        };
        let ((floor, without), (body, with)) = (look(false), look(true));
        assert!(floor[0] > 2 * floor[1].max(1), "{floor:?}");
        assert!(body[1] > 40 && body[1] == body[2], "{body:?}");
        assert_eq!(without, with);
    }
}
