//! The robot in the simulator: world, camera and laser behind the door.

use std::sync::Arc;

use super::journey::Journey;
use super::site::{Site, in_view};
use super::{Ended, Robot, Whereabouts, work};
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::{Pose, Twist};
use crate::saved::{Passed, Passing};
use crate::sensors::observation::{Image, Observation};
use crate::sensors::{CameraWatch, self_test};
use crate::settings::Settings;
use crate::world::{Layout, Motion, World, WorldSet};

/// Most solids of a world with shadows.
const MOST_SHADED_SOLIDS: usize = 1000;

/// A robot with a body, a camera and a laser, in a world; or in one world after another.
pub struct SimulatedRobot {
    here: Site,
    /// The other worlds, and what is drawn; nothing of a robot that stays in one world as it is.
    journey: Option<Box<Journey>>,
    /// Nothing where the state shows no view: then an empty image is no fault.
    watch: Option<CameraWatch>,
    motion: Motion,
    moved: bool,
    /// The start at which it was put last, if it was one.
    start: Option<usize>,
}

impl SimulatedRobot {
    /// A robot at a safe pose of one world, its camera tested; what the settings vary is drawn.
    ///
    /// # Errors
    /// If no pose is safe, or the camera shows nothing from there.
    pub fn new(layout: &Arc<Layout>, settings: &Settings, seed: u64) -> Result<Self> {
        Self::in_worlds(&WorldSet::alone(Arc::clone(layout)), settings, seed)
    }

    /// A robot at a safe pose of the first of several worlds. After each attempt it is put into the next one that is drawn;
    /// all are made here.
    ///
    /// # Errors
    /// As [`SimulatedRobot::new`].
    pub fn in_worlds(worlds: &WorldSet, settings: &Settings, seed: u64) -> Result<Self> {
        for layout in worlds.layouts().iter() {
            check_shadows(layout, settings)?;
            work::survey(layout, settings)?;
        }
        let mut here = Site::new(worlds.home(), settings, seed, 0);
        let varies = !worlds.further().is_empty() || !settings.randomise.is_empty();
        let mut journey = varies.then(|| Box::new(Journey::new(worlds, settings, seed)));
        let mut settings = settings;
        if let Some(journey) = &mut journey {
            settings = journey.set_out(&mut here);
        }
        let put = here.recovery.pose(&here.world, None)?;
        here.world.place(0, put.pose);
        // Noise would hide a blank image from the test.
        if settings.sees() {
            let mut quiet = here.quiet_camera(&settings.camera);
            self_test(&mut quiet, &here.world.body(0).world_from_robot(), in_view(&here.world, &mut here.own))?;
        }
        let (watch, motion) = (settings.sees().then(CameraWatch::new), Motion::default());
        Ok(Self { here, journey, watch, motion, moved: false, start: put.start })
    }

    /// Tries the ends of all that these settings draw in one world.
    ///
    /// # Errors
    /// For the first with which no pose is safe, or the camera shows nothing.
    pub(crate) fn try_extremes(layout: &Arc<Layout>, settings: &Settings) -> Result<()> {
        super::variation::extremes(settings).try_for_each(|extreme| Self::new(layout, &extreme, 0).map(drop))
    }

    /// The truth, for tests and reports only.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.here.world
    }
}

/// The baking of shadows is bounded by the number of solids.
fn check_shadows(layout: &Layout, settings: &Settings) -> Result<()> {
    let parts = layout.scene.parts();
    let drawn = settings.randomise.iter().any(|varied| varied.key == "light.shadows");
    let asked = parts.light.shadows || settings.camera.light.shadows || drawn;
    if !asked || parts.solids.len() <= MOST_SHADED_SOLIDS {
        return Ok(());
    }
    let message = format!(
        "the world '{}' has {} solids: shadows are for worlds of at most {MOST_SHADED_SOLIDS}",
        layout.name,
        parts.solids.len()
    );
    Diagnostic::new("E-WORLD-SHADOWS", message).help("join solids, take some out, or leave light.shadows off").fail()
}

impl Robot for SimulatedRobot {
    fn observe(&mut self, observation: &mut Observation) -> Result<()> {
        let here = &mut self.here;
        let world_from_robot = here.world.body(0).world_from_robot();
        let moving = in_view(&here.world, &mut here.own);
        let image = Some(&mut observation.image).filter(|image| image.width_px > 0);
        here.camera.render_both(&world_from_robot, moving, image, observation.depth.as_mut());
        // Who does not look asks for no image.
        if let Some(watch) = self.watch.as_mut().filter(|_| !observation.sight().pixels.is_empty()) {
            watch.check(observation.sight(), self.moved)?;
        }
        here.laser.scan(&world_from_robot, here.world.seen_by(0), &mut observation.scan);
        work::check(here)?;
        if let Some(colours) = &mut observation.ground {
            *colours = here.ground().read(&world_from_robot);
        }
        observation.contact = self.motion.contact;
        observation.fallen = self.motion.fallen;
        observation.odometry = self.motion.odometry;
        Ok(())
    }

    fn act(&mut self, twist: Twist) -> Result<()> {
        let world = &mut self.here.world;
        let before = world.body(0).pose;
        self.motion = world.advance(&[twist]).first().copied().unwrap_or_default();
        self.moved = world.body(0).pose != before;
        Ok(())
    }

    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        if let Some(journey) = &mut self.journey {
            journey.pass(&mut self.here, by)?;
        }
        self.here.pass(by)?;
        if let Some(watch) = &mut self.watch {
            watch.pass(by)?;
        }
        let Motion { contact, fallen, odometry } = &mut self.motion;
        by.flag(contact)?;
        by.flag(fallen)?;
        by.twist(odometry)?;
        by.flag(&mut self.moved)?;
        by.option(&mut self.start, Passing::size)
    }

    fn recover(&mut self) -> Result<()> {
        self.recover_after(Ended::default())
    }

    fn recover_after(&mut self, ended: Ended) -> Result<()> {
        if let Some(good) = ended.good {
            self.here.recovery.count(self.start, good);
        }
        let to = match &mut self.journey {
            Some(journey) => journey.go_on(&mut self.here, ended.to),
            None => ended.to,
        };
        self.here.world.begin_attempt();
        let put = self.here.recovery.pose(&self.here.world, to)?;
        self.here.world.place(0, put.pose);
        self.start = put.start;
        self.motion = Motion::default();
        self.moved = true;
        Ok(())
    }

    fn whereabouts(&self) -> Option<Whereabouts> {
        let body = self.here.world.body(0);
        Some(Whereabouts { pose: body.pose, z_m: body.z_m })
    }

    fn world_index(&self) -> usize {
        self.journey.as_ref().map_or(0, |journey| journey.at())
    }

    fn drawn(&self) -> &[f64] {
        self.journey.as_ref().map_or(&[], |journey| journey.drawn())
    }

    fn laser_max_range_m(&self) -> Option<f64> {
        self.journey.as_ref().and_then(|journey| journey.max_range_m())
    }

    fn starts_in_use(&self) -> usize {
        self.here.recovery.starts_in_use()
    }

    fn start(&self) -> Option<usize> {
        self.start
    }

    fn mover(&self, index: usize) -> Option<Pose> {
        self.here.world.mover(index)
    }

    fn gap_m(&self, mover: usize) -> Option<f64> {
        self.here.world.gap_m(0, mover)
    }

    /// Call it before anything moves: the frame is drawn a second time.
    fn photograph(&self) -> Option<Image> {
        let mut camera = self.here.camera.clone();
        camera.set_frames(camera.frames().saturating_sub(1));
        let mut image = Image::new(0, 0);
        let mut own = self.here.own.clone();
        camera.render(&self.here.world.body(0).world_from_robot(), in_view(&self.here.world, &mut own), &mut image);
        Some(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::settings::{CameraSettings, DrawnFrom, RecoverTo, Value, Varied};
    use filter_api::Format;

    #[test]
    fn a_texture_is_drawn_anew_for_each_attempt_and_is_seen() {
        let text = "[[material]]\nname = \"grey\"\ncolour = [120, 120, 120]\n[floor]\nmaterial = \"grey\"\n\
                    [[wall]]\npoints_m = [[-9, 3], [9, 3]]\n[[start]]\nposition_m = [0, 0]\n";
        let kinds = ["plain", "checker", "tiles"].map(|kind| Value::Text(kind.to_owned()));
        let varied = Varied { key: "texture.grey".to_owned(), from: DrawnFrom::OneOf(kinds.to_vec()) };
        let mut settings = Settings { randomise: vec![varied], ..Settings::default() };
        settings.recovery.to = RecoverTo::Start;
        settings.camera.noise = 0.0;
        let layout = Layout::parse(SourceText::new("w.toml", text), &settings.robot.body).unwrap();
        let mut robot = SimulatedRobot::new(&Arc::new(layout), &settings, 1).unwrap();
        let mut observation = Observation::asking_for(Format::Grey, 160, 120, 181);
        let mut met = [false; 3];
        for _ in 0..20 {
            let kind = robot.drawn()[0] as usize;
            robot.observe(&mut observation).unwrap();
            let below = &observation.image.pixels[160 * 100..];
            let same = below.iter().all(|grey| *grey == below[0]);
            assert_eq!(same, kind == 0, "{kind}");
            met[kind] = true;
            robot.recover().unwrap();
        }
        assert_eq!(met, [true; 3]);
    }

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
