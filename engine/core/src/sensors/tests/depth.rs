//! The depth image against one exact ray for each pixel.

use super::oracle::{entry, is_free, random_pose, random_solids, scene};
use crate::geometry::{Isometry3, Vector3};
use crate::random::{Random, Stream};
use crate::sensors::Camera;
use crate::sensors::observation::Image;
use crate::settings::{CameraSettings, Settings};
use filter_api::Format;
use std::sync::Arc;

fn settings() -> CameraSettings {
    let defaults = Settings::default().camera;
    CameraSettings { width_px: 96, height_px: 72, depth: true, depth_noise: 0.0, noise: 0.0, ..defaults }
}

fn measured(camera: &mut Camera, pose: &Isometry3) -> Vec<u16> {
    let mut depth = Image::of(Format::Depth, 0, 0);
    camera.render_both(pose, &[], None, Some(&mut depth));
    depth.frame().unwrap().nearness().collect()
}

#[test]
fn nearness_is_one_over_the_distance_ahead_of_what_each_ray_meets() {
    let mut random = Random::new(5, Stream::Test);
    let (settings, mut wrong, mut all) = (settings(), 0, 0);
    let focal_px = 48.0 / libm::tan(settings.field_of_view_deg.to_radians() * 0.5);
    let (sin, cos) = libm::sincos(settings.tilt_deg.to_radians());
    while all < 20 * 96 * 72 {
        let solids = random_solids(&mut random, 14);
        let pose = random_pose(&mut random);
        let place = pose * nalgebra::Point3::new(settings.forward_m, 0.0, settings.height_m);
        if !is_free(&solids, &place.coords) {
            continue;
        }
        let nearness = measured(&mut Camera::new(&Arc::new(scene(solids.clone(), 15)), &settings, 1), &pose);
        let [right, down, ahead] =
            [[0.0, -1.0, 0.0], [-sin, 0.0, -cos], [cos, 0.0, -sin]].map(|axis| pose * Vector3::from(axis));
        for (index, found) in nearness.into_iter().enumerate() {
            let (x, y) = ((index % 96) as f64 + 0.5 - 48.0, (index / 96) as f64 + 0.5 - 36.0);
            let ray = ahead + (right * x + down * y) / focal_px;
            let floor = if ray.z < 0.0 { -place.z / ray.z } else { f64::INFINITY };
            let hits = solids.iter().filter_map(|solid| entry(solid, &place.coords, &ray, true)).map(|hit| hit.0);
            let wanted = (8192.0 / hits.fold(floor, f64::min)).min(65_535.0);
            wrong += usize::from((f64::from(found) - wanted).abs() > 1.5 + wanted * 1e-3);
            all += 1;
        }
    }
    // Pixels through which an edge runs show one side or the other.
    assert!(wrong * 200 < all, "{wrong} of {all}");
}

#[test]
fn noise_has_its_deviation_in_nearness_and_leaves_the_sky_empty() {
    let level = CameraSettings { tilt_deg: 0.0, ..settings() };
    let noisy = CameraSettings { depth_noise: 0.01, ..level.clone() };
    let of = |settings: &CameraSettings| {
        measured(&mut Camera::new(&Arc::new(scene(Vec::new(), 1)), settings, 1), &Isometry3::identity())
    };
    let (exact, found) = (of(&level), of(&noisy));
    assert!(exact[..36 * 96].iter().chain(&found[..36 * 96]).all(|nearness| *nearness == 0));
    // 0.01 1/m are 82 of 8192; from the row 10 on the floor is further from nothing than that.
    let off = exact.iter().zip(&found).skip(46 * 96).map(|(exact, found)| f64::from(*found) - f64::from(*exact));
    let squares: Vec<f64> = off.map(|off| off * off).collect();
    let deviation = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((deviation - 81.9).abs() < 4.0, "{deviation}");
}

#[test]
fn holes_take_their_share_of_a_plain_floor() {
    let pierced = CameraSettings { tilt_deg: 90.0, depth_holes: 0.2, ..settings() };
    let found = measured(&mut Camera::new(&Arc::new(scene(Vec::new(), 1)), &pierced, 1), &Isometry3::identity());
    let share = found.iter().filter(|nearness| **nearness == 0).count() as f64 / found.len() as f64;
    assert!((share - 0.2).abs() < 0.02, "{share}");
}

#[test]
fn asking_for_depth_changes_no_colour() {
    let noisy = CameraSettings { noise: 2.0, ..settings() };
    let mut random = Random::new(6, Stream::Test);
    let scene = Arc::new(scene(random_solids(&mut random, 14), 15));
    let [mut alone, mut both] = [0, 1].map(|_| Camera::new(&scene, &noisy, 3));
    let (mut image, mut same, mut depth) = (Image::new(0, 0), Image::new(0, 0), Image::of(Format::Depth, 0, 0));
    for _ in 0..2 {
        alone.render(&Isometry3::identity(), &[], &mut image);
        both.render_both(&Isometry3::identity(), &[], Some(&mut same), Some(&mut depth));
        assert_eq!(image, same);
    }
}
