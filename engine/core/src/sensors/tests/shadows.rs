//! Shadows against one exact ray to the sun for each pixel, and lengths that are computed by hand.

use super::oracle::{box_at, entry, is_free, on_the_floor, random_pose, random_solids, scene};
use crate::geometry::{Isometry3, Vector3};
use crate::random::{Random, Stream};
use crate::sensors::Camera;
use crate::sensors::observation::Image;
use crate::settings::{CameraSettings, Settings};
use crate::world::scene::{Light, Scene, SceneParts, Solid, Texture, Tiling};
use filter_api::Format;
use nalgebra::Point3;
use std::sync::Arc;

/// A camera that looks straight down from 2 m, 100 pixels to the metre: x goes up in the image, y to the left.
fn from_above() -> CameraSettings {
    let defaults = Settings::default().camera;
    let field_of_view_deg = 2.0 * libm::atan(0.4).to_degrees();
    CameraSettings { forward_m: 0.0, height_m: 2.0, tilt_deg: 90.0, field_of_view_deg, noise: 0.0, ..defaults }
}

fn sunny(solids: Vec<Solid>, towards: Vector3, softness_deg: f64) -> Arc<Scene> {
    let mut parts = scene(solids, 4).parts().clone();
    parts.light = Light { shadows: true, softness_deg, ..Light::from_direction(towards, 0.25, 1.0) };
    Arc::new(Scene::new(parts))
}

fn shot(scene: &Arc<Scene>, settings: &CameraSettings, pose: &Isometry3, moving: &[Solid]) -> Image {
    let mut image = Image::new(0, 0);
    Camera::new(scene, settings, 1).render(pose, moving, &mut image);
    image
}

/// Red at a place of the floor, seen from above; metres from the middle of the image.
fn red_at(image: &Image, x_m: f64, y_m: f64) -> u8 {
    let (column, row) = (80.0 - 100.0 * y_m, 60.0 - 100.0 * x_m);
    image.pixels[(row as usize * 160 + column as usize) * 3]
}

#[test]
fn a_box_throws_a_shadow_as_long_as_it_is_high_under_a_sun_at_45_degrees() {
    // 0.3 m high, its face at x = -0.3: the shadow ends at x = 0.
    let scene = sunny(vec![box_at([-0.4, 0.0, 0.15], [0.1, 0.2, 0.15], 1)], Vector3::new(-1.0, 0.0, 1.0), 0.0);
    let image = shot(&scene, &from_above(), &on_the_floor(0.0, 0.0, 0.0), &[]);
    // The floor is 60 under full light: a quarter of it comes from everywhere, the rest at 45 degrees.
    let (lit, shaded) = ((60.0 * (0.25 + 0.75 * 0.5_f64.sqrt())).round() as u8, 15);
    for (x_m, y_m, red) in [(-0.03, 0.0, shaded), (0.03, 0.0, lit), (-0.15, 0.17, shaded), (-0.15, 0.23, lit)] {
        assert_eq!(red_at(&image, x_m, y_m), red, "{x_m} {y_m}");
    }
}

#[test]
fn a_wide_sun_makes_an_edge_as_soft_as_its_height_and_a_wall_sharper_at_its_foot() {
    // The edge at the top, 0.3 m up and 0.424 m from the floor along the light; the sun is 10 degrees wide.
    let scene = sunny(vec![box_at([-0.4, 0.0, 0.15], [0.1, 0.4, 0.15], 1)], Vector3::new(-1.0, 0.0, 1.0), 10.0);
    let image = shot(&scene, &from_above(), &on_the_floor(0.0, 0.0, 0.0), &[]);
    let reds: Vec<u8> = (-30..30).map(|step| red_at(&image, f64::from(step) * 0.005, 0.0)).collect();
    assert!(reds.is_sorted(), "{reds:?}");
    // From 0.3 / tan(50) = 0.252 to 0.3 / tan(40) = 0.358 m behind the face: from x = -0.048 to 0.058.
    let between = reds.iter().filter(|red| **red > reds[0] && **red < reds[59]).count() as f64 * 0.005;
    assert!((0.06..0.13).contains(&between), "{between}");
    assert!(reds[0] == 15 && reds[59] > 45, "{reds:?}");
}

#[test]
fn what_drives_takes_its_shadow_along_and_leaves_none() {
    let towards = Vector3::new(-1.0, 0.0, 1.0);
    let mut parts = sunny(Vec::new(), towards, 0.0).parts().clone();
    parts.solids.push(box_at([-3.0, 0.0, 0.1], [0.1, 3.0, 0.1], 1));
    let scene = Arc::new(Scene::new(parts).driven_over([nalgebra::Point2::new(0.0, 0.0)].iter()));
    let mut camera = Camera::new(&scene, &from_above(), 1);
    let (mut image, pose) = (Image::new(0, 0), on_the_floor(0.0, 0.0, 0.0));
    let mover = |x_m: f64| [box_at([x_m, 0.0, 0.15], [0.05, 0.2, 0.15], 2)];
    camera.render(&pose, &mover(-0.3), &mut image);
    let lit = red_at(&image, 0.4, 0.0);
    assert!(red_at(&image, 0.0, 0.0) < lit && red_at(&image, 0.1, 0.0) == lit);
    // A metre further behind it stands out of sight, and its shadow lies out of sight.
    camera.render(&pose, &mover(-1.3), &mut image);
    assert_eq!(red_at(&image, 0.0, 0.0), lit);
    // Out of sight above the upper edge of the image, with its shadow in sight.
    let tall = [box_at([-0.85, 0.0, 0.5], [0.05, 0.2, 0.5], 2)];
    camera.render(&pose, &tall, &mut image);
    assert!(red_at(&image, 0.0, 0.0) < lit && red_at(&image, 0.3, 0.0) == lit);
}

#[test]
fn what_drives_into_a_shadow_is_shaded_as_a_whole() {
    let wall = box_at([-0.6, 0.0, 0.5], [0.05, 3.0, 0.5], 1);
    let scene = sunny(vec![wall], Vector3::new(-1.0, 0.0, 1.0), 0.0);
    let top = |x_m: f64| {
        let image =
            shot(&scene, &from_above(), &on_the_floor(x_m, 0.0, 0.0), &[box_at([x_m, 0.0, 0.05], [0.1, 0.1, 0.05], 2)]);
        red_at(&image, 0.0, 0.0)
    };
    // The wall's shadow ends 1 m behind its face at -0.55.
    let (shaded, lit) = (top(0.0), top(1.5));
    assert_eq!(shaded, (142.0_f64 * 0.25).round() as u8);
    assert_eq!(lit, (142.0 * (0.25 + 0.75 * 0.5_f64.sqrt())).round() as u8);
}

/// The colour that an exact ray sees, with an exact ray from there to the sun.
fn colour(parts: &SceneParts, origin: &Vector3, ray: &Vector3) -> [u8; 3] {
    let mut nearest = if ray.z < 0.0 { (-origin.z / ray.z, Some((parts.floor, Vector3::z()))) } else { (1e30, None) };
    for solid in &parts.solids {
        if let Some((distance, normal)) = entry(solid, origin, ray, true).filter(|hit| hit.0 < nearest.0) {
            nearest = (distance, Some((solid.material, normal)));
        }
    }
    nearest.1.map_or([186, 198, 210], |(material, normal)| {
        let at = origin + ray * nearest.0 + normal * 1e-4;
        let hidden = parts.solids.iter().any(|solid| entry(solid, &at, &parts.light.towards, true).is_some());
        let brightness = parts.light.partly_on(&normal, if hidden { 0.0 } else { 1.0 });
        parts.materials[material].colour.map(|channel| (f64::from(channel) * brightness).round() as u8)
    })
}

#[test]
fn shadows_on_floor_and_faces_are_those_of_exact_rays_but_for_the_cells_at_their_edges() {
    let mut random = Random::new(21, Stream::Test);
    let settings = CameraSettings { width_px: 96, height_px: 72, noise: 0.0, ..Settings::default().camera };
    let (mut wrong, mut all, mut shaded) = (0, 0, 0);
    while all < 30 * 96 * 72 {
        let mut parts = scene(random_solids(&mut random, 10), 11).parts().clone();
        let towards = Vector3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(0.3, 1.0));
        parts.light = Light { shadows: true, ..Light::from_direction(towards, 0.3, 1.0) };
        let pose = random_pose(&mut random);
        let place = (pose * Point3::new(settings.forward_m, 0.0, settings.height_m)).coords;
        if !is_free(&parts.solids, &place) {
            continue;
        }
        let scene = Arc::new(Scene::new(parts.clone()));
        let (image, rays) = (shot(&scene, &settings, &pose, &[]), crate::sensors::CameraRays::new(&settings));
        for at in 0..96 * 72 {
            let ray = pose * rays.ray((at % 96) as f64 + 0.5, (at / 96) as f64 + 0.5);
            let wanted = colour(&parts, &place, &ray);
            all += 1;
            wrong += usize::from(image.pixels[3 * at..3 * at + 3] != wanted);
        }
        parts.light.shadows = false;
        let without = shot(&Arc::new(Scene::new(parts)), &settings, &pose, &[]);
        shaded +=
            image.pixels.chunks(3).zip(without.pixels.chunks(3)).filter(|(with, without)| with != without).count();
    }
    let (wrong, shaded) = (wrong as f64 / all as f64, shaded as f64 / all as f64);
    assert!(wrong < 0.012 && shaded > 0.08, "{wrong} wrong, {shaded} shaded");
}

#[test]
fn a_grey_image_under_shadows_is_the_luma_of_the_image_in_colour() {
    let mut random = Random::new(8, Stream::Test);
    let (joint_m, joint) = (0.03, 24.5);
    for round in 0..20 {
        let mut parts = scene(random_solids(&mut random, 8), 9).parts().clone();
        let (amplitude, scale_m) = (7.5, 0.2);
        let tiling = Tiling { amplitude, scale_m, joint_m, joint };
        let textures = [Texture::Plain, Texture::Tiles(tiling), Texture::Checker { amplitude, scale_m }];
        for (index, material) in parts.materials.iter_mut().enumerate() {
            material.texture = textures[(index + round) % 3];
            material.colour = [[140, 120, 90], [30, 250, 90]][round % 2];
        }
        parts.light.shadows = true;
        parts.light.softness_deg = [0.0, 4.0][round / 2 % 2];
        let mut settings = CameraSettings { width_px: 97, height_px: 71, ..Settings::default().camera };
        settings.exposure_drift = [0.0, 0.0, 0.2][round % 3];
        let (pose, movers) = (random_pose(&mut random), random_solids(&mut random, 2));
        let mut camera = Camera::new(&Arc::new(Scene::new(parts)), &settings, 3);
        let (mut colour, mut grey) = (Image::new(0, 0), Image::of(Format::Grey, 0, 0));
        camera.render(&pose, &movers, &mut colour);
        camera.set_frames(0);
        camera.render(&pose, &movers, &mut grey);
        let mut luma = vec![0; 97 * 71];
        colour.frame().unwrap().write_luma(&mut luma).unwrap();
        assert!(grey.pixels == luma, "round {round}");
    }
}
