use std::sync::Arc;

use engine::experiment::{Overrides, Plan};
use engine::filter::Catalogue;
use engine::geometry::Pose;
use engine::sensors::observation::Image;
use engine::sensors::{Camera, load_photograph};
use engine::settings::CameraSettings;
use engine::world::World;
use filter_api::Format;

use crate::support::root;

const FRAMES: [&str; 10] = [
    "room-300-60-0",
    "room-690-90-30",
    "room-1130-500-75",
    "room-800-820-200",
    "room-360-750-250",
    "corridor-200-30-10",
    "corridor-920-200-95",
    "corridor-1460-1060-130",
    "corridor-40-760-215",
    "corridor-550-1120-170",
];

/// The plan of `wall.rhai` in a world.
fn plan(world: &str) -> Plan {
    let world = root().join(format!("worlds/{world}.toml")).display().to_string();
    let there = Overrides { world: Some(world), ..Overrides::default() };
    Plan::load(&root().join("scripts/wall.rhai"), &there, || Ok(Arc::new(Catalogue::linked_in()))).unwrap()
}

/// What this engine's camera sees from a pose, without noise.
fn drawn(plan: &Plan, pose: Pose) -> Image {
    let mut world = World::new(Arc::clone(&plan.layout), &[plan.settings.robot], 0.5, 1);
    world.place(0, pose);
    let settings = CameraSettings { noise: 0.0, ..plan.settings.camera.clone() };
    let mut image = Image::of(Format::Rgb, settings.width_px as usize, settings.height_px as usize);
    Camera::new(&plan.layout.scene, &settings, 1).render(&world.body(0).world_from_robot(), &[], &mut image);
    image
}

/// Mask and state.
fn seen(plan: &Plan, image: &Image) -> (Vec<u8>, usize) {
    let (mut chain, mut grid) = (plan.chain().unwrap(), plan.grid().unwrap());
    let state = grid.encode(chain.apply(image).unwrap());
    (chain.mask().to_vec(), state)
}

/// Edges of one mask that have one of the other within a pixel, as a share.
fn near(one: &[u8], other: &[u8], width: usize) -> f64 {
    let there = |x: usize, y: usize| other.get(y * width + x).is_some_and(|pixel| *pixel > 0);
    let has = |at: usize| {
        let (x, y) = (at % width, at / width);
        (y.saturating_sub(1)..=y + 1).any(|y| (x.saturating_sub(1)..=(x + 1).min(width - 1)).any(|x| there(x, y)))
    };
    let edges: Vec<usize> = (0..one.len()).filter(|at| one[*at] > 0).collect();
    edges.iter().filter(|at| has(**at)).count() as f64 / edges.len().max(1) as f64
}

#[test]
fn another_renderer_sees_the_same_worlds_from_the_same_poses() {
    for name in FRAMES {
        let parts: Vec<&str> = name.split('-').collect();
        let number = |at: usize| parts[at].parse::<f64>().unwrap();
        let plan = plan(parts[0]);
        let own = drawn(&plan, Pose::new(number(1) / 100.0, number(2) / 100.0, number(3).to_radians()));
        let file = root().join(format!("tests/fixtures/rendered/{name}.png"));
        let other = load_photograph(&file, own.width_px, own.height_px).unwrap();
        let within = |(one, other): (&u8, &u8)| one.abs_diff(*other) <= 1;
        let same = own.pixels.iter().zip(&other.pixels).filter(|pair| within(*pair)).count();
        let share = same as f64 / own.pixels.len() as f64;
        let ((mask, state), (others, other_state)) = (seen(&plan, &own), seen(&plan, &other));
        let (ours, theirs) = (near(&mask, &others, own.width_px), near(&others, &mask, own.width_px));
        println!(
            "{name}: {:.2} % of pixels, edges {ours:.4} and {theirs:.4}, states {state} and {other_state}",
            100.0 * share
        );
        assert!(share >= 0.99, "{name}: {share}");
        assert!(ours >= 0.92 && theirs >= 0.92, "{name}: {ours} {theirs}");
        assert_eq!(state, other_state, "{name}");
    }
}
