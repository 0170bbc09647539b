//! Frames and scans that must come out alike on every machine and in every build.

use super::oracle::{random_pose, random_solids, scene};
use crate::random::{Random, Stream};
use crate::sensors::observation::{Image, Scan};
use crate::sensors::{Camera, Laser};
use crate::settings::{Lens, Settings};
use crate::world::scene::{Scene, Texture};
use std::sync::Arc;

/// FNV-1a (Fowler, Noll and Vo).
fn fingerprint(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Fingerprints of an image and of a scan after twenty poses.
fn sensed(lens: Lens) -> (u64, u64) {
    let mut random = Random::new(11, Stream::Test);
    let mut parts = scene(random_solids(&mut random, 12), 13).parts().clone();
    for (index, material) in parts.materials.iter_mut().enumerate() {
        let (amplitude, scale_m) = (25.0, 0.15);
        material.texture = match index % 4 {
            0 => Texture::Noise { amplitude, scale_m },
            1 => Texture::Checker { amplitude, scale_m },
            2 => Texture::Stripes { amplitude, scale_m },
            _ => Texture::Plain,
        };
    }
    let scene = Arc::new(Scene::new(parts));
    let mut settings = Settings::default();
    (settings.camera.lens, settings.camera.tilt_deg) = (lens, 20.0);
    settings.laser.tilt_deg = 15.0;
    let (mut camera, mut laser) = (Camera::new(&scene, &settings.camera, 3), Laser::new(&scene, &settings.laser, 3));
    let (mut image, mut scan) = (Image::new(0, 0), Scan { ranges_m: Vec::new() });
    let (mut pixels, mut ranges) = (Vec::new(), Vec::new());
    for _ in 0..20 {
        let (pose, movers) = (random_pose(&mut random), random_solids(&mut random, 2));
        camera.render(&pose, &movers, &mut image);
        laser.scan(&pose, &movers, &mut scan);
        pixels.extend_from_slice(&image.pixels);
        ranges.extend(scan.ranges_m.iter().flat_map(|range| range.to_le_bytes()));
    }
    (fingerprint(pixels), fingerprint(ranges))
}

#[test]
fn both_sensors_give_the_recorded_bytes() {
    assert_eq!(sensed(Lens::Pinhole), (5_096_316_319_905_851_907, 7_882_391_037_906_771_012));
    assert_eq!(sensed(Lens::Fisheye), (14_970_386_428_204_561_522, 7_882_391_037_906_771_012));
}
