//! Movers that stop and go, wait, and begin anew.

use super::*;

const WAY: &str = "[[route]]\nname = \"way\"\npoints_m = [[0, 3], [8, 3]]\n";

/// A world with a mover on an open route of 8 m, 3 m to the left of the robot's start.
fn with_mover(lines: &str, seed: u64) -> World {
    let mover = "[[mover]]\nname = \"a\"\nroute = \"way\"\n";
    let body = "boxes = [{ centre_m = [0, 0, 0.2], size_m = [0.2, 0.2, 0.4] }]\n";
    World::new(layout(&format!("{START}{WAY}{mover}{lines}\n{body}")), &[EXACT], 0.5, seed)
}

fn x_m(world: &World) -> f64 {
    world.prey().unwrap().x_m
}

#[test]
fn a_mover_waits_until_the_robot_is_near_and_runs_once() {
    let mut world = with_mover("speed_m_per_s = 0.5\nreturns = true\nstarts_within_m = 2", 1);
    drive(&mut world, 0.0, 0.0, 10);
    assert_eq!(x_m(&world), 0.0);
    world.place(0, Pose::new(0.0, 1.0, 0.0));
    drive(&mut world, 0.0, 0.0, 1);
    world.place(0, Pose::new(0.0, -9.0, 0.0));
    // 20 s: 8 m there, 2 m back.
    drive(&mut world, 0.0, 0.0, 39);
    assert!((x_m(&world) - 6.0).abs() < 1e-9 && world.prey().unwrap().yaw_rad > 3.0, "{:?}", world.prey());
    drive(&mut world, 0.0, 0.0, 100);
    assert_eq!(x_m(&world), 0.0);
}

#[test]
fn an_attempt_begins_with_a_speed_of_its_own_and_with_movers_where_they_begin() {
    let mut stays = with_mover("speed_m_per_s = [0.1, 0.3]", 7);
    let mut begins = with_mover("speed_m_per_s = [0.1, 0.3]\nat_recovery = \"begins\"", 7);
    let mut ways = Vec::new();
    for world in [&mut stays, &mut begins] {
        drive(world, 0.0, 0.0, 4);
        let first = x_m(world) / 2.0;
        world.begin_attempt();
        let from = x_m(world);
        drive(world, 0.0, 0.0, 4);
        ways.push((first, from, (x_m(world) - from) / 2.0));
    }
    let [(first, from, second), (again, begun, other)] = ways[..] else { panic!() };
    assert!((0.1..0.3).contains(&first) && (0.1..0.3).contains(&second) && first != second, "{ways:?}");
    assert!((from - 2.0 * first).abs() < 1e-9 && begun == 0.0, "{ways:?}");
    assert!((first - again).abs() < 1e-9 && (second - other).abs() < 1e-9, "{ways:?}");
}

#[test]
fn a_new_attempt_changes_nothing_where_the_clock_alone_drives() {
    let mut world = with_mover("speed_m_per_s = 0.2", 1);
    drive(&mut world, 0.0, 0.0, 7);
    world.begin_attempt();
    drive(&mut world, 0.0, 0.0, 1);
    assert_eq!(x_m(&world), 0.2 * 4.0);
}

#[test]
fn movers_followed_along_a_record_are_where_they_were() {
    let mut world = with_mover("speed_m_per_s = [0.1, 0.3]\npauses = [{ at_m = 1, for_s = 2 }]\nreturns = true", 3);
    let mut movements = Movements::new(Arc::clone(&world.layout), 3, 1.0);
    for period in 1..400 {
        drive(&mut world, 0.0, 0.0, 1);
        movements.advance(f64::from(period) * 0.5, std::iter::empty());
        assert_eq!(Some(movements.pose(0)), world.prey());
        if period % 60 == 0 {
            world.begin_attempt();
            movements.begin();
        }
    }
}
