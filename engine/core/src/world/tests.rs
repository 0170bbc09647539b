//! How a body drives, touches, climbs and falls.

mod bodies;
mod movers;

use super::*;
use crate::diagnostic::SourceText;
use crate::geometry::Point3;
use crate::settings::{BodyShape, DriveLimits, Footprint};
use std::f64::consts::FRAC_PI_2;

const PIONEER: BodyShape = BodyShape::pioneer2at();
const HALF_LENGTH_M: f64 = 0.2485;
const DRIVE: DriveLimits = DriveLimits { greatest_m_per_s: 2.0, greatest_rad_per_s: 6.0, bicycle: None };
const EXACT: RobotSettings =
    RobotSettings { body: PIONEER, drive: DRIVE, lag_s: 0.0, speed_noise: 0.0, slip: 0.0, tick_s: 0.05 };

/// A round robot of the size of a TurtleBot3 Waffle.
const ROUND: RobotSettings = RobotSettings {
    body: BodyShape {
        footprint: Footprint::Round { radius_m: 0.22 },
        height_m: 0.2,
        step_m: 0.01,
        steepest: f64::INFINITY,
        wheelbase_m: 0.2,
        track_m: 0.29,
    },
    ..EXACT
};

fn layout(text: &str) -> Arc<Layout> {
    Arc::new(Layout::parse(SourceText::new("test.toml", text), &PIONEER).unwrap_or_else(|error| panic!("{error:?}")))
}

fn world(text: &str) -> World {
    World::new(layout(text), &[EXACT], 0.5, 1)
}

fn shipped(name: &str) -> Arc<Layout> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../worlds/{name}.toml"));
    Arc::new(Layout::load(&path, &PIONEER).unwrap_or_else(|error| panic!("{error:?}")))
}

fn drive(world: &mut World, linear: f64, angular: f64, periods: usize) -> Motion {
    let mut last = Motion::default();
    for _ in 0..periods {
        last = world.advance(&[Twist::new(linear, angular)])[0];
    }
    last
}

const START: &str = "[[start]]\nposition_m = [0, 0]\n";
const WALL_AHEAD: &str = "[[wall]]\npoints_m = [[1.05, -3], [1.05, 3]]\n[[start]]\nposition_m = [0, 0]\n";

#[test]
fn without_lag_and_noise_the_robot_does_just_what_it_is_told() {
    let mut world = world(START);
    let motion = drive(&mut world, 0.4, 0.0, 5);
    assert!((world.body(0).pose.x_m - 1.0).abs() < 1e-12 && world.body(0).pose.y_m == 0.0);
    assert!((motion.odometry.linear_m_per_s - 0.4).abs() < 1e-12 && !motion.contact);
    assert_eq!(world.time_s(), 2.5);
}

#[test]
fn a_wall_ahead_stops_the_body_at_its_front() {
    let mut world = world(WALL_AHEAD);
    let motion = drive(&mut world, 0.4, 0.0, 6);
    assert!(motion.contact);
    let gap = 1.0 - HALF_LENGTH_M - world.body(0).pose.x_m;
    assert!((0.0..0.4 * 0.05 / 16.0 + 1e-9).contains(&gap), "{gap}");
    assert!(motion.odometry.linear_m_per_s.abs() < 0.01);
    let back = drive(&mut world, -0.2, 0.0, 1);
    assert!(!back.contact && world.body(0).pose.x_m < 0.66);
}

#[test]
fn turning_beside_a_wall_brings_a_corner_against_it() {
    let mut world = world("[[wall]]\npoints_m = [[-3, -0.35], [3, -0.35]]\n[[start]]\nposition_m = [0, 0]\n");
    // The inner face is 0.3 m away: the side at 0.238 m is clear, the corner at 0.344 m is not.
    assert!(drive(&mut world, 0.0, 0.8, 2).contact);
    assert!(world.body(0).pose.yaw_rad > 0.1);
}

#[test]
fn a_round_body_turns_beside_a_wall_and_stops_at_its_radius_before_one() {
    let beside = "[[wall]]\npoints_m = [[-3, -0.35], [3, -0.35]]\n[[start]]\nposition_m = [0, 0]\n";
    let mut turning = World::new(layout(beside), &[ROUND], 0.5, 1);
    assert!(!drive(&mut turning, 0.0, 0.8, 20).contact);
    let mut world = World::new(layout(WALL_AHEAD), &[ROUND], 0.5, 1);
    assert!(drive(&mut world, 0.4, 0.0, 6).contact);
    let gap = 1.0 - 0.22 - world.body(0).pose.x_m;
    assert!((0.0..0.4 * 0.05 / 16.0 + 1e-9).contains(&gap), "{gap}");
}

#[test]
fn what_a_body_climbs_and_where_it_is_safe_is_its_own() {
    let kerb = format!("[[box]]\ncentre_m = [2, 0]\nsize_m = [2, 4, 0.05]\n{START}");
    assert!(drive(&mut World::new(layout(&kerb), &[ROUND], 0.5, 1), 0.4, 0.0, 10).contact);
    // The platform's edge is at 0.9 m, the room's wall at 0.
    let platform = World::new(shipped("platform"), &[ROUND], 0.5, 1);
    assert_eq!(platform.body(0).z_m, 0.5);
    assert!(platform.is_safe(0, Pose::new(3.0, 0.67, 0.3)) && !platform.is_safe(0, Pose::new(3.0, 0.69, 0.3)));
    let room = World::new(shipped("room"), &[ROUND], 0.5, 1);
    assert!(room.is_safe(0, Pose::new(3.0, 0.23, 0.3)) && !room.is_safe(0, Pose::new(3.0, 0.21, 0.3)));
}

#[test]
fn a_round_body_tips_on_a_ramp_and_falls_over_an_edge() {
    let ramp = "[[ramp]]\ncentre_m = [2, 0]\nsize_m = [2, 2, 0.4]\n[[start]]\nposition_m = [0, 0]\n";
    let climber = RobotSettings { body: BodyShape { step_m: 0.03, ..ROUND.body }, ..EXACT };
    let mut world = World::new(layout(ramp), &[climber], 0.5, 1);
    assert!(!drive(&mut world, 0.4, 0.0, 10).contact);
    let body = world.body(0);
    assert!((body.z_m - 0.2).abs() < 1e-9 && (body.pitch_rad + libm::atan(0.2)).abs() < 1e-9, "{body:?}");
    let mut world = World::new(shipped("platform"), &[ROUND], 0.5, 1);
    world.place(0, Pose::new(3.0, 0.0, -FRAC_PI_2));
    // The front wheels leave the edge at 0.9 m when the centre is at 0.8 m.
    assert!(!drive(&mut world, 0.2, 0.0, 7).fallen && drive(&mut world, 0.2, 0.0, 2).fallen);
    assert!((world.body(0).pose.y_m + 0.8).abs() < 0.011, "{:?}", world.body(0));
}

#[test]
fn a_low_kerb_is_climbed_and_a_higher_one_is_a_wall() {
    let kerb = |height: f64| format!("[[box]]\ncentre_m = [2, 0]\nsize_m = [2, 4, {height}]\n{START}");
    let mut low = world(&kerb(0.05));
    assert!(!drive(&mut low, 0.4, 0.0, 10).contact);
    assert!((low.body(0).z_m - 0.05).abs() < 1e-12 && low.body(0).pitch_rad == 0.0);
    assert!(drive(&mut world(&kerb(0.08)), 0.4, 0.0, 10).contact);
}

#[test]
fn a_ramp_lifts_the_body_and_its_nose() {
    let ramp = "[[ramp]]\ncentre_m = [2, 0]\nsize_m = [2, 2, 0.4]\n\
                [[platform]]\ncentre_m = [4, 0]\nsize_m = [2, 2, 0.4]\n[[start]]\nposition_m = [0, 0]\n";
    let mut world = world(ramp);
    assert!(!drive(&mut world, 0.4, 0.0, 10).contact);
    let body = world.body(0);
    // Halfway up a slope of 0.2.
    assert!((body.z_m - 0.2).abs() < 1e-9 && (body.pitch_rad + libm::atan(0.2)).abs() < 1e-9, "{body:?}");
    let nose = body.world_from_robot() * Point3::new(1.0, 0.0, 0.0);
    assert!(nose.z > 0.35);
    let up = drive(&mut world, 0.4, 0.0, 10);
    assert!(!up.contact && !up.fallen && (world.body(0).z_m - 0.4).abs() < 1e-12);
    let down = drive(&mut world, -0.4, 0.0, 20);
    assert!(!down.contact && !down.fallen && world.body(0).z_m == 0.0);
    // Placed across the slope it leans to its left, which is downhill: no pitch, negative roll.
    world.place(0, Pose::new(2.0, 0.0, FRAC_PI_2));
    let across = world.body(0);
    assert!((across.z_m - 0.2).abs() < 1e-9 && across.pitch_rad.abs() < 1e-9, "{across:?}");
    assert!((across.roll_rad + libm::atan(0.2)).abs() < 1e-9);
    assert!(world.is_safe(0, across.pose) && !world.is_safe(0, Pose::new(2.0, 0.9, 0.0)));
}

#[test]
fn a_ramp_that_is_steeper_than_the_body_climbs_is_a_wall_from_below_and_can_be_driven_down() {
    let ramp = "[[ramp]]\ncentre_m = [2, 0]\nsize_m = [2, 2, 0.4]\n\
                [[platform]]\ncentre_m = [4, 0]\nsize_m = [2, 2, 0.4]\n[[start]]\nposition_m = [0, 0]\n";
    // A rise of 0.2 for each metre is 11.3 degrees.
    let climbs = |slope_deg: f64| {
        let steepest = libm::tan(slope_deg.to_radians());
        let body = BodyShape { steepest, ..PIONEER };
        World::new(layout(ramp), &[RobotSettings { body, ..EXACT }], 0.5, 1)
    };
    assert!(!drive(&mut climbs(12.0), 0.4, 0.0, 10).contact);
    let mut world = climbs(11.0);
    assert!(drive(&mut world, 0.4, 0.0, 10).contact);
    assert!((world.body(0).pose.x_m - (1.0 - HALF_LENGTH_M)).abs() < 0.011, "{:?}", world.body(0));
    world.place(0, Pose::new(3.5, 0.0, 0.0));
    assert!(!drive(&mut world, -0.4, 0.0, 18).contact && world.body(0).z_m == 0.0);
}

#[test]
fn wheels_stand_about_the_middle_of_the_outline() {
    let ramp = "[[ramp]]\ncentre_m = [2, 0]\nsize_m = [2, 2, 0.4]\n[[start]]\nposition_m = [0, 0]\n";
    let footprint = Footprint::Rectangle { length_m: 0.5, width_m: 0.3, ahead_m: 0.2 };
    let body = BodyShape { footprint, wheelbase_m: 0.4, ..PIONEER };
    let mut world = World::new(layout(ramp), &[RobotSettings { body, ..EXACT }], 0.5, 1);
    // The wheels are 0 and 0.4 m ahead of the origin: at 0.9 m only the front ones stand on the ramp, 0.06 m up, and the
    // origin, over the rear ones, is still on the floor.
    assert!(!drive(&mut world, 0.4, 0.0, 4).contact);
    drive(&mut world, 0.2, 0.0, 1);
    let lifted = world.body(0);
    assert!((lifted.pose.x_m - 0.9).abs() < 1e-9 && lifted.z_m.abs() < 1e-9, "{lifted:?}");
    assert!((lifted.pitch_rad + libm::atan(0.15)).abs() < 1e-9, "{lifted:?}");
}

#[test]
fn the_side_of_a_ramp_is_a_wall() {
    let ramp = "[[ramp]]\ncentre_m = [0, 2]\nsize_m = [2, 2, 0.4]\n[[start]]\nposition_m = [0.5, 0]\nyaw_deg = 90\n";
    let mut world = world(ramp);
    assert!(drive(&mut world, 0.4, 0.0, 8).contact);
    assert!(world.body(0).pose.y_m < 1.0 - HALF_LENGTH_M + 1e-9);
}

#[test]
fn over_the_edge_the_robot_falls_and_lies_still_until_it_is_placed() {
    let mut world = World::new(shipped("platform"), &[EXACT], 0.5, 1);
    assert_eq!(world.body(0).z_m, 0.5);
    let edge = Pose::new(3.0, 0.0, -FRAC_PI_2);
    world.place(0, edge);
    let mut periods = 0;
    while !drive(&mut world, 0.2, 0.0, 1).fallen {
        periods += 1;
    }
    // The front wheels leave the edge at 0.9 m when the centre is at 0.763 m.
    assert_eq!(periods, 7);
    let lying = world.body(0);
    assert!((lying.pose.y_m + 0.77).abs() < 0.011, "{lying:?}");
    assert!(drive(&mut world, -0.2, 0.0, 3).fallen);
    assert_eq!(world.body(0), lying);
    world.place(0, edge);
    assert!(!drive(&mut world, 0.2, 0.0, 1).fallen);
}

#[test]
fn a_place_is_safe_when_nothing_touches_and_all_of_it_is_carried() {
    let platform = World::new(shipped("platform"), &[EXACT], 0.5, 1);
    assert!(platform.is_safe(0, Pose::new(3.0, 0.6, 0.0)));
    assert!(!platform.is_safe(0, Pose::new(3.0, 0.7, 0.0)));
    let room = World::new(shipped("room"), &[EXACT], 0.5, 1);
    assert!(room.is_safe(0, Pose::new(3.0, 0.25, 0.0)));
    assert!(!room.is_safe(0, Pose::new(3.0, 0.22, 0.0)));
}

#[test]
fn the_prey_drives_along_its_route_and_can_be_touched() {
    let mut world = World::new(shipped("object"), &[EXACT], 0.5, 1);
    assert_eq!(world.prey(), Some(Pose::new(4.0, 0.0, 0.0)));
    let motion = drive(&mut world, 0.2, 0.0, 20);
    let gap = world.prey().unwrap().x_m - world.body(0).pose.x_m;
    assert!(!motion.contact && (gap - 1.1).abs() < 1e-9);
    assert!((world.moving()[1].centre.x - 6.0).abs() < 1e-9);
    // It stands 0.6 m ahead of the front after 20 periods and drives away at 0.2 m/s.
    assert!(drive(&mut world, 0.4, 0.0, 10).contact);
    assert!(!drive(&mut world, -0.2, 0.0, 2).contact);
}

#[test]
fn the_same_seed_drives_the_same_way_and_another_does_not() {
    let noisy = RobotSettings { lag_s: 0.15, speed_noise: 0.05, slip: 0.1, ..EXACT };
    let end = |seed| {
        let mut world = World::new(shipped("room"), &[noisy], 0.33, seed);
        drive(&mut world, 0.2, 0.4, 100);
        world.body(0).pose
    };
    assert_eq!(end(3), end(3));
    assert_ne!(end(3), end(4));
}

#[test]
fn whatever_is_commanded_the_body_never_ends_inside_a_solid_or_in_the_air() {
    let noisy = RobotSettings { lag_s: 0.15, speed_noise: 0.2, slip: 0.2, tick_s: 0.1, ..EXACT };
    for name in ["room", "rectangle", "corridor", "platform"] {
        let mut world = World::new(shipped(name), &[noisy], 0.5, 9);
        let mut random = crate::random::Random::new(9, crate::random::Stream::Test);
        let (mut contacts, mut falls) = (0, 0);
        for _ in 0..3_000 {
            let motion = drive(&mut world, random.between(-0.2, 1.0), random.between(-1.0, 1.0), 1);
            (contacts, falls) = (contacts + usize::from(motion.contact), falls + usize::from(motion.fallen));
            let start = world.layout().starts[random.below(4) as usize].pose;
            if motion.fallen {
                world.place(0, start);
            }
            let obstruction = world.layout().obstruction(&PIONEER, world.body(0).pose);
            assert!(!matches!(obstruction, Some(super::layout::Obstruction::Solid(_))), "{name}: {:?}", world.body(0));
            assert!(name != "platform" || (world.body(0).z_m - 0.5).abs() < 1e-12);
        }
        assert!((name == "platform") == (falls > 0) && (name == "platform") == (contacts == 0), "{contacts} {falls}");
    }
}

#[test]
fn the_ground_is_the_highest_top_that_is_not_above_a_limit() {
    // The ramp rises from x = -1 to x = -3.
    let ramp = "[[ramp]]\ncentre_m = [-2, 0]\nsize_m = [2, 2, 1]\nyaw_deg = 180\n";
    let layout = layout(&format!("{ramp}{START}"));
    let ground_m = |below_z_m| layout.terrain().ground_m(&layout.scene, -2.5, 0.0, below_z_m);
    assert!((ground_m(9.0) - 0.75).abs() < 1e-12);
    assert_eq!(ground_m(0.5), 0.0);
}

#[test]
fn movers_go_as_many_times_as_fast_as_they_are_set_to() {
    let after = |speed: f64| {
        let mut world = World::new(shipped("object"), &[EXACT], 0.5, 1).with_mover_speed(speed);
        drive(&mut world, 0.0, 0.0, 20);
        assert!((world.moving()[0].centre.x - world.prey().unwrap().x_m).abs() < 1e-12);
        world.prey().unwrap().x_m
    };
    // 10 s from x = 4 m, at 0.2 m/s by the file.
    assert!((after(1.0) - 6.0).abs() < 1e-9 && (after(1.5) - 7.0).abs() < 1e-9);
    assert_eq!(after(0.0), 4.0);
}
