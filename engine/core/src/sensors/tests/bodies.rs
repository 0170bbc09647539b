//! What the sensors of one body see of another.

use crate::diagnostic::SourceText;
use crate::geometry::Pose;
use crate::sensors::observation::{Image, Scan};
use crate::sensors::{Camera, Laser};
use crate::settings::{CameraSettings, LaserSettings, Settings};
use crate::world::scene::Solid;
use crate::world::{Layout, World};
use std::f64::consts::PI;
use std::sync::Arc;

/// Two of the default body, 2 m apart and face to face on an empty floor.
fn face_to_face() -> (Settings, World) {
    let settings = Settings::default();
    let text = SourceText::new("test.toml", "[[start]]\nposition_m = [0, 0]\n");
    let layout = Arc::new(Layout::parse(text, &settings.robot.body).unwrap());
    let mut world = World::new(layout, &[settings.robot; 2], settings.run.period_s, 1);
    world.place(1, Pose::new(2.0, 0.0, PI));
    (settings, world)
}

#[test]
fn the_laser_of_each_body_measures_the_way_to_the_other() {
    let (settings, world) = face_to_face();
    let settings = LaserSettings { noise_m: 0.0, ..settings.laser };
    let mut laser = Laser::new(&world.layout().scene, &settings, 1);
    for body in [0, 1] {
        let mut scan = Scan { ranges_m: Vec::new() };
        laser.scan(&world.body(body).world_from_robot(), world.seen_by(body), &mut scan);
        // From a laser 0.18 m ahead of one origin to a front 0.2485 m ahead of the other.
        assert!((f64::from(scan.ranges_m[90]) - (2.0 - 0.18 - 0.2485)).abs() < 1e-5, "{body}: {}", scan.ranges_m[90]);
        assert_eq!((scan.ranges_m[0], scan.ranges_m[180]), (8.192, 8.192));
    }
}

#[test]
fn the_camera_of_each_body_draws_the_other_and_not_its_own() {
    let (settings, world) = face_to_face();
    let mut camera = Camera::new(&world.layout().scene, &CameraSettings { noise: 0.0, ..settings.camera }, 1);
    let mut pixels = |body: usize, moving: &[Solid]| {
        let mut image = Image::new(0, 0);
        camera.render(&world.body(body).world_from_robot(), moving, &mut image);
        image.pixels
    };
    for body in [0, 1] {
        let (floor, seen) = (pixels(body, &[]), pixels(body, world.seen_by(body)));
        let differing = seen.chunks_exact(3).zip(floor.chunks_exact(3)).filter(|(seen, floor)| seen != floor).count();
        assert!(differing > 500 && differing < 160 * 120 / 2, "{differing}");
    }
}
