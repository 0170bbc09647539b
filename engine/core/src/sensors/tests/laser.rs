//! The laser against exact rays and hand-computed ranges.

use super::oracle::{box_at, entry, is_free, on_the_floor, random_pose, random_solids, scene};
use crate::geometry::{Isometry3, Vector3};
use crate::random::{Random, Stream};
use crate::sensors::Laser;
use crate::sensors::observation::Scan;
use crate::settings::{LaserSettings, Settings};
use crate::world::scene::{Scene, Solid};
use std::f64::consts::PI;
use std::sync::Arc;

fn settings() -> LaserSettings {
    LaserSettings { noise_m: 0.0, forward_m: 0.0, ..Settings::default().laser }
}

fn scan(scene: Scene, settings: &LaserSettings, pose: &Isometry3, moving: &[Solid]) -> Vec<f32> {
    let mut scan = Scan { ranges_m: Vec::new() };
    Laser::new(&Arc::new(scene), settings, 1).scan(pose, moving, &mut scan);
    scan.ranges_m
}

fn is_close(found: f32, expected: f64) -> bool {
    (f64::from(found) - expected).abs() < 1e-5
}

#[test]
fn walls_ahead_and_to_the_right_are_at_their_distances() {
    let walls = vec![box_at([3.1, 0.0, 0.5], [0.1, 9.0, 0.5], 1), box_at([0.0, -2.1, 0.5], [9.0, 0.1, 0.5], 1)];
    let ranges = scan(scene(walls, 2), &settings(), &Isometry3::identity(), &[]);
    assert_eq!(ranges.len(), 181);
    assert!(is_close(ranges[0], 2.0) && is_close(ranges[90], 3.0));
    assert!(is_close(ranges[30], 2.0 / libm::cos(PI / 6.0)));
    // Far to the left the front wall is 3 m / cos(80 degrees) = 17.3 m away: nothing seen is exactly the maximum.
    assert_eq!(ranges[170], 8.192);
}

#[test]
fn tilted_down_by_45_degrees_it_sees_the_flat_floor() {
    let tilted = LaserSettings { tilt_deg: 45.0, ..settings() };
    let ranges = scan(scene(Vec::new(), 1), &tilted, &on_the_floor(2.0, 1.0, 0.7), &[]);
    let front = 0.38 * 2_f64.sqrt();
    assert!(is_close(ranges[90], front));
    for (beam, range) in ranges.iter().enumerate().take(171).skip(10) {
        let angle = (beam as f64 - 90.0).to_radians();
        assert!(is_close(*range, front / libm::cos(angle)), "beam {beam}");
    }
    assert_eq!((ranges[0], ranges[180]), (8.192, 8.192));
}

#[test]
fn near_things_read_the_minimum_and_movers_are_seen() {
    let mover = box_at([0.15, 0.0, 0.5], [0.05, 0.05, 0.5], 1);
    let ranges = scan(scene(Vec::new(), 2), &settings(), &Isometry3::identity(), &[mover]);
    assert_eq!(ranges[90], 0.2);
    assert_eq!(ranges[0], 8.192);
}

#[test]
fn glass_and_paint_are_not_seen() {
    let wall = |material, collides| Solid { collides, ..box_at([2.0, 0.0, 0.5], [0.1, 9.0, 0.5], material) };
    let mut parts = scene(vec![wall(1, true), wall(2, false)], 3).parts().clone();
    parts.materials[1].laser = false;
    let ranges = scan(Scene::new(parts), &settings(), &Isometry3::identity(), &[wall(1, true), wall(2, false)]);
    assert!(ranges.iter().all(|range| *range == 8.192));
}

#[test]
fn ranges_agree_with_exact_rays() {
    let mut random = Random::new(8, Stream::Test);
    let mut seen = 0;
    for round in 0..400 {
        let solids = random_solids(&mut random, 12);
        let pose = random_pose(&mut random);
        let tilt_deg = [0.0, 10.0, 45.0, 90.0, -20.0][round % 5];
        let (beams, field_of_view_deg) =
            [(181, 180.0), (40, 60.0), (271, 270.0), (360, 360.0), (7, 359.0)][round / 5 % 5];
        let settings = LaserSettings { beams, field_of_view_deg, tilt_deg, min_range_m: 0.0, ..settings() };
        let origin = (pose * nalgebra::Point3::new(0.0, 0.0, settings.height_m)).coords;
        if !is_free(&solids, &origin) {
            continue;
        }
        let ranges = scan(scene(solids[..9].to_vec(), 13), &settings, &pose, &solids[9..]);
        let (sin, cos) = libm::sincos(tilt_deg.to_radians());
        let (ahead, left) = (pose * Vector3::new(cos, 0.0, -sin), pose * Vector3::y());
        for (beam, range) in ranges.iter().enumerate() {
            let angle = settings.fan().bearing_rad(beam);
            let ray = ahead * libm::cos(angle) + left * libm::sin(angle);
            let mut exact = if ray.z < 0.0 { -origin.z / ray.z } else { f64::INFINITY };
            for solid in &solids {
                exact = exact.min(entry(solid, &origin, &ray, false).map_or(f64::INFINITY, |hit| hit.0));
            }
            let error = f64::from(*range) - exact.min(8.192);
            assert!(error.abs() < 1e-4, "round {round}, beam {beam}: {range} m instead of {exact} m");
            seen += usize::from(exact < 8.0);
        }
    }
    assert!(seen > 20_000, "{seen}");
}

#[test]
fn a_laser_that_looks_all_round_sees_the_wall_behind() {
    let walls = vec![box_at([-2.1, 0.0, 0.5], [0.1, 9.0, 0.5], 1), box_at([0.0, 3.1, 0.5], [9.0, 0.1, 0.5], 1)];
    let settings = LaserSettings { beams: 360, field_of_view_deg: 360.0, ..settings() };
    let ranges = scan(scene(walls, 2), &settings, &Isometry3::identity(), &[]);
    assert_eq!(ranges.len(), 360);
    assert!(is_close(ranges[0], 2.0) && is_close(ranges[270], 3.0));
    assert!(is_close(ranges[30], 2.0 / libm::cos(PI / 6.0)));
    assert_eq!((ranges[90], ranges[180]), (8.192, 8.192));
}

#[test]
fn noise_has_its_deviation_and_other_scans_have_other_noise() {
    let wall = box_at([3.1, 0.0, 0.5], [0.1, 90.0, 0.5], 1);
    let noisy = LaserSettings { noise_m: 0.01, ..settings() };
    let mut laser = Laser::new(&Arc::new(scene(vec![wall], 2)), &noisy, 1);
    let mut scan = Scan { ranges_m: Vec::new() };
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for _ in 0..500 {
        laser.scan(&Isometry3::identity(), &[], &mut scan);
        for beam in 60..=120 {
            let error = f64::from(scan.ranges_m[beam]) - 3.0 / libm::cos((beam as f64 - 90.0).to_radians());
            (sum, squares, count) = (sum + error, squares + error * error, count + 1.0);
        }
        assert_eq!(scan.ranges_m[0], 8.192);
    }
    assert!((sum / count).abs() < 3e-4 && ((squares / count).sqrt() - 0.01).abs() < 3e-4);
    let before = scan.clone();
    laser.scan(&Isometry3::identity(), &[], &mut scan);
    assert_ne!(before, scan);
    laser.set_scans(499);
    laser.scan(&Isometry3::identity(), &[], &mut scan);
    assert_eq!(before, scan);
}
