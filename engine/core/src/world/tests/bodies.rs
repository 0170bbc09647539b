//! Several bodies in one world.

use super::*;
use crate::geometry::Vector3;
use crate::world::scene::Shape;
use std::f64::consts::PI;

/// Starts at these places, looking along the x axis.
fn starts(places: &[[f64; 2]]) -> String {
    places.iter().map(|[x, y]| format!("[[start]]\nposition_m = [{x}, {y}]\n")).collect()
}

/// Bodies at these poses of an empty world.
fn at(poses: &[Pose]) -> World {
    let mut world = World::new(layout(START), &vec![EXACT; poses.len()], 0.5, 1);
    for (index, pose) in poses.iter().enumerate() {
        world.place(index, *pose);
    }
    world
}

fn contacts(world: &mut World, linear: &[f64]) -> Vec<bool> {
    let commands: Vec<_> = linear.iter().map(|linear| Twist::new(*linear, 0.0)).collect();
    world.advance(&commands).iter().map(|motion| motion.contact).collect()
}

#[test]
fn two_bodies_that_drive_at_one_another_touch_and_stop() {
    let mut world = at(&[Pose::default(), Pose::new(3.0, 0.0, PI)]);
    for _ in 0..6 {
        assert_eq!(contacts(&mut world, &[0.4, 0.4]), [false, false]);
    }
    // Fronts 3 - 0.497 - 6 * 0.4 = 0.103 m apart: the first body drives the whole of it, the second finds no room.
    for _ in 0..3 {
        assert_eq!(contacts(&mut world, &[0.4, 0.4]), [true, true]);
        let (first, second) = (world.body(0).pose.x_m, world.body(1).pose.x_m);
        assert!((0.0..0.001_25 + 1e-9).contains(&(second - first - 0.497)), "{first} {second}");
        assert!((second - 1.8).abs() < 0.001_25 + 1e-9, "{second}");
    }
    assert_eq!(contacts(&mut world, &[0.0, -0.2]), [false, false]);
    assert!((world.body(1).pose.x_m - 1.9).abs() < 0.002);
}

#[test]
fn a_body_that_stands_feels_another_that_drives_into_it_whichever_comes_first() {
    let ahead = Pose::new(0.6, 0.0, 0.0);
    let mut world = at(&[Pose::default(), ahead]);
    assert_eq!(contacts(&mut world, &[0.4]), [true, true]);
    assert_eq!(world.body(1).pose, ahead);
    let mut world = at(&[ahead, Pose::default()]);
    assert_eq!(contacts(&mut world, &[0.0, 0.4]), [true, true]);
    assert_eq!(world.body(0).pose, ahead);
}

#[test]
fn a_body_meets_those_before_it_in_the_list_where_they_have_arrived_and_those_behind_where_they_stood() {
    let (behind, ahead) = (Pose::default(), Pose::new(0.597, 0.0, 0.0));
    assert_eq!(contacts(&mut at(&[ahead, behind]), &[0.4, 0.4]), [false, false]);
    assert_eq!(contacts(&mut at(&[behind, ahead]), &[0.4, 0.4]), [true, true]);
}

#[test]
fn a_round_body_and_a_long_one_touch_at_the_sum_of_their_reaches() {
    let mut world = World::new(layout(START), &[ROUND, EXACT], 0.5, 1);
    world.place(1, Pose::new(2.0, 0.0, 0.0));
    while contacts(&mut world, &[0.2]) == [false, false] {}
    let gap = world.body(1).pose.x_m - world.body(0).pose.x_m - (0.22 + HALF_LENGTH_M);
    assert!((0.0..0.2 * 0.05 / 16.0 + 1e-9).contains(&gap), "{gap}");
}

#[test]
fn no_body_is_safe_in_another_and_each_is_where_it_stands() {
    let world = at(&[Pose::default(), Pose::new(3.0, 0.0, 0.0)]);
    assert!(world.is_safe(0, Pose::default()) && !world.is_safe(1, Pose::default()));
    assert!(!world.is_safe(1, Pose::new(0.49, 0.0, 0.0)) && world.is_safe(1, Pose::new(0.5, 0.0, 0.0)));
    assert!(!world.is_safe(1, Pose::new(0.0, 0.47, 0.0)) && world.is_safe(1, Pose::new(0.0, 0.48, 0.0)));
    // Across: 0.2485 m and 0.238 m.
    assert!(!world.is_safe(0, Pose::new(3.48, 0.0, FRAC_PI_2)) && world.is_safe(0, Pose::new(3.49, 0.0, FRAC_PI_2)));
}

#[test]
fn bodies_begin_at_the_first_starts_that_are_safe_for_them() {
    let begin = |places: &[[f64; 2]]| {
        let world = World::new(layout(&starts(places)), &[EXACT; 3], 0.5, 1);
        [0, 1, 2].map(|index| world.body(index).pose.x_m)
    };
    assert_eq!(begin(&[[0.0, 0.0], [0.3, 0.0], [1.0, 0.0], [2.0, 0.0]]), [0.0, 1.0, 2.0]);
    assert_eq!(begin(&[[0.0, 0.0], [1.0, 0.0]]), [0.0, 1.0, 0.0]);
}

#[test]
fn bodies_that_overlap_do_not_hold_one_another() {
    let mut world = at(&[Pose::default(), Pose::new(0.3, 0.0, 0.0)]);
    assert_eq!(contacts(&mut world, &[0.0, 0.4]), [true, true]);
    assert!((world.body(1).pose.x_m - 0.5).abs() < 1e-12);
    assert_eq!(contacts(&mut world, &[0.0, 0.4]), [false, false]);
    // Once apart they are solid for one another again: 0.203 m lie between them.
    assert_eq!(contacts(&mut world, &[0.4, 0.0]), [false, false]);
    assert_eq!(contacts(&mut world, &[0.4, 0.0]), [true, true]);
}

#[test]
fn a_body_sees_the_others_as_boxes_and_cylinders_but_not_itself() {
    let mut world = World::new(shipped("object"), &[EXACT, ROUND, EXACT], 0.5, 1);
    world.place(0, Pose::new(1.0, 0.0, 0.0));
    world.place(1, Pose::new(2.0, 0.0, 0.0));
    world.place(2, Pose::new(3.0, 0.0, FRAC_PI_2));
    let movers = world.moving().len();
    assert!(movers > 0);
    let [first, second, third] = [0, 1, 2].map(|index| world.seen_by(index));
    assert!([first, second, third].iter().all(|seen| seen.len() == movers + 2));
    assert_eq!(&first[2..], world.moving());
    assert_eq!(&second[1..=movers], world.moving());
    assert_eq!(&third[..movers], world.moving());
    let (round, long) = (&first[0], &first[1]);
    assert_eq!(round.shape, Shape::Cylinder { radius_m: 0.22, half_height_m: 0.1 });
    assert_eq!(round.centre, Point3::new(2.0, 0.0, 0.1));
    assert_eq!(long.shape, Shape::Box { half_m: Vector3::new(0.2485, 0.238, 0.225) });
    assert_eq!((long.centre, long.yaw_rad), (Point3::new(3.0, 0.0, 0.225), FRAC_PI_2));
    assert_eq!((&second[0], &second[movers + 1].centre.x), (long, &1.0));
    assert_eq!((third[movers].centre.x, &third[movers + 1]), (1.0, round));
    assert_eq!(world.layout().scene.parts().materials[round.material].name, "plain");
    world.advance(&[Twist::default(), Twist::new(0.2, 0.0)]);
    assert!((world.seen_by(0)[0].centre.x - 2.1).abs() < 1e-12);
    assert!((world.seen_by(2)[movers + 1].centre.x - 2.1).abs() < 1e-12);
}

#[test]
fn a_body_alone_sees_the_very_slice_of_the_movers() {
    let world = World::new(shipped("object"), &[EXACT], 0.5, 1);
    assert!(std::ptr::eq(world.seen_by(0), world.moving()) && world.moving().len() == 2);
}

#[test]
fn a_body_drives_as_if_alone_while_the_others_are_far_and_each_has_its_own_noise() {
    let noisy = RobotSettings { lag_s: 0.15, speed_noise: 0.05, slip: 0.1, ..EXACT };
    let mut alone = World::new(layout(START), &[noisy], 0.33, 3);
    let mut world = World::new(layout(START), &[noisy; 3], 0.33, 3);
    world.place(1, Pose::new(20.0, 0.0, 0.0));
    world.place(2, Pose::new(40.0, 0.0, 0.0));
    let command = Twist::new(0.2, 0.4);
    for _ in 0..50 {
        assert_eq!(world.advance(&[command; 3])[0], alone.advance(&[command])[0]);
        assert_eq!(world.body(0), alone.body(0));
    }
    let yaws = [0, 1, 2].map(|index| world.body(index).pose.yaw_rad);
    assert!(yaws[0] != yaws[1] && yaws[1] != yaws[2] && yaws[0] != yaws[2], "{yaws:?}");
}
