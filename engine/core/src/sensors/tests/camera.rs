//! The camera against one exact ray for each pixel.

use super::oracle::{box_at, entry, is_free, on_the_floor, random_pose, random_solids, scene};
use crate::geometry::{Isometry3, Vector3};
use crate::random::{Random, Stream};
use crate::sensors::observation::Image;
use crate::sensors::{Camera, self_test};
use crate::settings::{CameraSettings, Lens, Settings};
use crate::world::scene::{Scene, SceneParts, Solid, Texture};
use filter_api::Format;
use std::sync::Arc;

fn settings(width_px: u64, height_px: u64, field_of_view_deg: f64, tilt_deg: f64) -> CameraSettings {
    let defaults = Settings::default().camera;
    CameraSettings { width_px, height_px, field_of_view_deg, tilt_deg, noise: 0.0, ..defaults }
}

fn shot(scene: &Arc<Scene>, settings: &CameraSettings, pose: &Isometry3, moving: &[Solid]) -> Image {
    let mut image = Image::new(0, 0);
    Camera::new(scene, settings, 1).render(pose, moving, &mut image);
    image
}

fn pixel(image: &Image, column: usize, row: usize) -> [u8; 3] {
    let at = (row * image.width_px + column) * 3;
    [image.pixels[at], image.pixels[at + 1], image.pixels[at + 2]]
}

/// Unit vectors of the camera: place, right, down, forward.
fn axes(settings: &CameraSettings, pose: &Isometry3) -> [Vector3; 4] {
    let (sin, cos) = libm::sincos(settings.tilt_deg.to_radians());
    let place = pose * nalgebra::Point3::new(settings.forward_m, 0.0, settings.height_m);
    let [right, down, forward] =
        [[0.0, -1.0, 0.0], [-sin, 0.0, -cos], [cos, 0.0, -sin]].map(|axis| pose * Vector3::from(axis));
    [place.coords, right, down, forward]
}

/// The colour that an exact ray sees.
fn colour(parts: &SceneParts, solids: &[Solid], origin: &Vector3, ray: &Vector3) -> [u8; 3] {
    let mut nearest = if ray.z < 0.0 { (-origin.z / ray.z, Some((parts.floor, Vector3::z()))) } else { (1e30, None) };
    for solid in solids {
        if let Some((distance, normal)) = entry(solid, origin, ray, true).filter(|hit| hit.0 < nearest.0) {
            nearest = (distance, Some((solid.material, normal)));
        }
    }
    nearest.1.map_or([186, 198, 210], |(material, normal)| {
        let lit = |channel: u8| (f64::from(channel) * parts.light.on(&normal)).round().clamp(0.0, 255.0) as u8;
        parts.materials[material].colour.map(lit)
    })
}

/// Share of wrong pixels; what a wrong one shows must be seen within half a pixel.
fn wrong_share(
    random: &mut Random,
    settings: &CameraSettings,
    ray: impl Fn(&[Vector3; 4], f64, f64) -> Vector3,
) -> f64 {
    let (mut wrong, mut all) = (0, 0);
    while all < 40 * 96 * 72 {
        let mut standing = random_solids(random, 14);
        let pose = random_pose(random);
        let axes = axes(settings, &pose);
        if !is_free(&standing, &axes[0]) || axes[0].z < 0.1 {
            continue;
        }
        let solids = standing.clone();
        let moving = standing.split_off(11);
        let scene = Arc::new(scene(standing, 15));
        let image = shot(&scene, settings, &pose, &moving);
        let mut exact = Image::new(96, 72);
        for place in 0..96 * 72 {
            let ray = ray(&axes, (place % 96) as f64 + 0.5 - 48.0, (place / 96) as f64 + 0.5 - 36.0);
            exact.pixels[place * 3..place * 3 + 3].copy_from_slice(&colour(scene.parts(), &solids, &axes[0], &ray));
        }
        for place in 0..96 * 72 {
            let (column, row) = (place % 96, place / 96);
            let seen = pixel(&image, column, row);
            all += 1;
            if seen != pixel(&exact, column, row) {
                wrong += 1;
                let (x, y) = (column as f64 + 0.5 - 48.0, row as f64 + 0.5 - 36.0);
                let shown = |x: f64, y: f64| colour(scene.parts(), &solids, &axes[0], &ray(&axes, x, y)) == seen;
                // The fine search is for slivers.
                let beside = [0.1, 0.004].into_iter().any(|spacing: f64| {
                    let steps = (0.5 / spacing) as i32;
                    let offsets = move || (-steps..=steps).map(move |step| f64::from(step) * spacing);
                    offsets().any(|across| offsets().any(|down| shown(x + across, y + down)))
                });
                assert!(beside, "pixel {column}, {row} shows {seen:?}, which is nowhere within it");
            }
        }
    }
    f64::from(wrong) / f64::from(all)
}

#[test]
fn a_pinhole_image_is_that_of_one_exact_ray_per_pixel() {
    let settings = settings(96, 72, 80.0, 25.0);
    let focal = 48.0 / libm::tan(40_f64.to_radians());
    let ray = |axes: &[Vector3; 4], x: f64, y: f64| axes[3] + axes[1] * (x / focal) + axes[2] * (y / focal);
    let wrong = wrong_share(&mut Random::new(3, Stream::Test), &settings, ray);
    assert!(wrong < 2e-4, "{wrong}");
}

#[test]
fn a_fisheye_image_is_that_of_one_exact_ray_per_pixel_but_for_edges() {
    let settings = CameraSettings { lens: Lens::Fisheye, ..settings(96, 72, 110.0, 25.0) };
    let focal = 96.0 / 110_f64.to_radians();
    let ray = |axes: &[Vector3; 4], x: f64, y: f64| {
        let radius = (x * x + y * y).sqrt();
        let (sin, cos) = libm::sincos(radius / focal);
        axes[3] * cos + (axes[1] * x + axes[2] * y) * (sin / radius)
    };
    let wrong = wrong_share(&mut Random::new(4, Stream::Test), &settings, ray);
    assert!(wrong < 0.03, "{wrong}");
}

#[test]
fn a_box_ahead_covers_the_hand_computed_pixels() {
    // Level, 90 degrees: focal length 50 pixels. The box's front is 2 m before the lens and 0.4 m wide: 10 pixels.
    let settings = CameraSettings { forward_m: 0.0, height_m: 1.0, ..settings(100, 80, 90.0, 0.0) };
    let scene = Arc::new(scene(vec![box_at([2.5, 0.0, 1.0], [0.5, 0.2, 0.2], 1)], 2));
    let image = shot(&scene, &settings, &Isometry3::identity(), &[]);
    let front = pixel(&image, 50, 40);
    for column in 0..100 {
        assert_eq!(pixel(&image, column, 40) == front, (45..55).contains(&column), "column {column}");
    }
    for row in 0..80 {
        assert_eq!(pixel(&image, 50, row) == front, (35..45).contains(&row), "row {row}");
    }
}

#[test]
fn a_mover_hides_the_wall_behind_it_and_leaves_no_trace() {
    let settings = CameraSettings { forward_m: 0.0, height_m: 1.0, ..settings(100, 80, 90.0, 0.0) };
    let scene = Arc::new(scene(vec![box_at([4.0, 0.0, 1.0], [0.1, 3.0, 1.0], 1)], 3));
    let mut camera = Camera::new(&scene, &settings, 1);
    let (mut before, mut with, mut after) = (Image::new(0, 0), Image::new(0, 0), Image::new(0, 0));
    let mover = box_at([2.5, 0.0, 1.0], [0.5, 0.2, 0.2], 2);
    camera.render(&Isometry3::identity(), &[], &mut before);
    camera.render(&Isometry3::identity(), &[mover], &mut with);
    camera.render(&Isometry3::identity(), &[], &mut after);
    let changed = (0..8000).filter(|at| pixel(&before, at % 100, at / 100) != pixel(&with, at % 100, at / 100));
    assert_eq!(changed.count(), 100);
    assert_eq!(before, after);
}

#[test]
fn paint_on_the_floor_is_seen_and_later_paint_lies_on_top() {
    let settings = CameraSettings { forward_m: 0.0, height_m: 1.0, ..settings(100, 80, 90.0, 90.0) };
    let paint = |material| Solid { collides: false, ..box_at([0.0, 0.0, 0.0], [0.3, 0.1, 1e-4], material) };
    let scene = Arc::new(scene(vec![paint(1), paint(2)], 3));
    let image = shot(&scene, &settings, &Isometry3::identity(), &[]);
    let lit = |material: usize| scene.parts().materials[material].colour[0];
    let brightness = scene.parts().light.on(&Vector3::z());
    // Straight down from 1 m: 50 pixels to the metre, so the paint is 10 wide and 30 high.
    assert_eq!(pixel(&image, 50, 40)[0], (f64::from(lit(2)) * brightness).round() as u8);
    assert_eq!((0..8000).filter(|at| pixel(&image, at % 100, at / 100) == pixel(&image, 50, 40)).count(), 300);
}

#[test]
fn a_checkered_floor_changes_colour_at_whole_squares() {
    let mut parts = scene(Vec::new(), 1).parts().clone();
    parts.materials[0].texture = Texture::Checker { amplitude: 20.0, scale_m: 0.2 };
    let settings = CameraSettings { forward_m: 0.0, height_m: 1.0, ..settings(100, 80, 90.0, 90.0) };
    let image = shot(&Arc::new(Scene::new(parts)), &settings, &on_the_floor(0.1, 0.1, 0.0), &[]);
    // 50 pixels to the metre: squares of 10 pixels; the middle of the image is the middle of the square at the origin.
    for column in 0..100 {
        let lighter = ((column + 5) / 10) % 2 == 1;
        assert_eq!(pixel(&image, column, 40) == pixel(&image, 50, 40), lighter, "column {column}");
    }
}

#[test]
fn one_seed_gives_one_image_and_another_seed_other_noise_alone() {
    let scene = Arc::new(scene(vec![box_at([2.5, 0.0, 1.0], [0.5, 0.2, 0.2], 1)], 2));
    let noisy = CameraSettings { noise: 2.0, ..settings(160, 120, 80.0, 42.0) };
    let shot = |seed| {
        let mut image = Image::new(0, 0);
        Camera::new(&scene, &noisy, seed).render(&Isometry3::identity(), &[], &mut image);
        image
    };
    assert_eq!(shot(5), shot(5));
    let (one, other) = (shot(5), shot(6));
    let differences = one.pixels.iter().zip(&other.pixels).map(|(a, b)| f64::from(*a) - f64::from(*b));
    let variance = differences.map(|difference| difference * difference).sum::<f64>() / one.pixels.len() as f64;
    // Two draws of deviation 2, each rounded: 2 * (4 + 1/12).
    assert!((variance - 8.17).abs() < 0.4, "{variance}");
}

#[test]
fn a_grey_image_is_the_luma_of_the_image_in_colour() {
    let mut random = Random::new(6, Stream::Test);
    for round in 0..60 {
        let mut parts = scene(random_solids(&mut random, 8), 9).parts().clone();
        for (index, material) in parts.materials.iter_mut().enumerate() {
            let (amplitude, scale_m) = (10.0, 0.2);
            material.texture = [
                Texture::Plain,
                Texture::Noise { amplitude, scale_m },
                Texture::Checker { amplitude, scale_m },
                Texture::Stripes { amplitude, scale_m },
            ][(index + round) % 4];
            // In some rounds colours are so dark or so light that noise is cut off.
            material.colour = [[40, 120, 90], [3, 120, 90], [60, 255, 90]][round % 3]
                .map(|byte: u8| byte.wrapping_add(index as u8 % 3));
        }
        parts.light.ambient = 1.0;
        let scene = Arc::new(Scene::new(parts));
        let mut settings = settings(97, 71, 120.0, 25.0);
        settings.noise = [0.0, 2.0, 90.0][round / 3 % 3];
        settings.lens = if round % 2 == 0 { Lens::Pinhole } else { Lens::Fisheye };
        let (pose, movers) = (random_pose(&mut random), random_solids(&mut random, 2));
        let mut camera = Camera::new(&scene, &settings, 3);
        let (mut colour, mut grey) = (Image::new(0, 0), Image::of(Format::Grey, 0, 0));
        camera.render(&pose, &movers, &mut colour);
        camera.set_frames(0);
        camera.render(&pose, &movers, &mut grey);
        let mut luma = vec![0; 97 * 71];
        colour.frame().unwrap().write_luma(&mut luma).unwrap();
        assert!(grey.pixels == luma, "round {round}");
    }
}

#[test]
fn the_self_test_refuses_an_empty_plain_world_and_takes_one_with_a_box() {
    let test = |solids: Vec<Solid>| {
        let scene = Arc::new(scene(solids, 2));
        self_test(&mut Camera::new(&scene, &settings(160, 120, 80.0, 42.0), 1), &Isometry3::identity(), &[])
    };
    assert_eq!(test(Vec::new()).unwrap_err().code, "E-CAMERA-BLANK");
    assert!(test(vec![box_at([-1.5, 0.0, 0.5], [0.2, 0.2, 0.5], 1)]).is_ok());
}
