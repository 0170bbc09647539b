//! The body that a script names: what it sets, what wins over it, and what it cannot do.

use super::errors::{expect, wrong};
use super::parse;
use crate::diagnostic::SourceText;
use crate::script::{Behaviour, ParamValues};
use crate::settings::{Footprint, Settings};

const RULE: &str = "rule \"a\" when robot.contact => -1 then recover;";

fn settings(set_up: &str) -> Settings {
    parse(&format!("{set_up} {RULE}")).unwrap_or_else(|wrong| panic!("{wrong:?}")).settings().clone()
}

#[test]
fn what_the_script_sets_wins_over_the_body_wherever_it_stands() {
    let of = settings("laser(#{ beams: 90 }); robot(\"turtlebot3\", #{ lag_s: 0.3 }); camera(#{ tilt_deg: 10 });");
    assert_eq!(of.robot.body.footprint, Footprint::Round { radius_m: 0.105 });
    assert_eq!((of.robot.lag_s, of.robot.drive.greatest_m_per_s), (0.3, 0.22));
    assert_eq!((of.laser.beams, of.laser.field_of_view_deg, of.laser.max_range_m), (90, 360.0, 3.5));
    assert_eq!((of.camera.tilt_deg, of.camera.field_of_view_deg, of.camera.width_px), (10.0, 62.0, 160));
    assert_eq!(of.actions.len(), 10);
}

#[test]
fn the_pioneer_by_its_name_is_the_pioneer_without() {
    assert_eq!(settings("robot(\"pioneer2at\");"), Settings::default());
    assert_eq!(settings("robot(#{ slip: 0.2 });").robot.slip, 0.2);
}

#[test]
fn an_action_that_the_robot_cannot_do_is_underlined() {
    let text = format!("robot(\"f1tenth\"); actions([[0.4, 0.5], [0.4, 0.8]]); {RULE}");
    let mistake = wrong(&text);
    assert_eq!(
        mistake.message,
        "action 1 is [0.4, 0.8]: a bicycle with a wheelbase of 0.33 m and 24 degrees of steering turns by 0.54 rad/s at most \
         at 0.4 m/s, found 0.8"
    );
    let place = mistake.place.unwrap();
    assert_eq!(&place.source.text[place.span.clone()], "[0.4, 0.8]");
    expect(&text, "E-SCRIPT-SETTING", "[0.4, 0.8]", "the nearest that it can do is [0.4, 0.53]");
}

#[test]
fn without_actions_a_robot_has_those_of_every_script_that_it_can_do() {
    let body = "footprint = { shape = \"round\", radius_m = 0.2 }\nheight_m = 0.3\nstep_m = 0.01\n\
                drive = { kind = \"bicycle\", wheelbase_m = 0.33, steer_deg = 24 }\n";
    let script = SourceText::new("car.rhai", format!("robot(\"car\"); {RULE}"));
    let files = |name: &str| Ok((name == "car").then(|| SourceText::new("robots/car.toml", body)));
    let car = Behaviour::parse_with("car", script, &files, &ParamValues::new()).unwrap();
    let actions: Vec<_> = car.settings().actions.iter().map(|a| (a.linear_m_per_s, a.angular_rad_per_s)).collect();
    assert_eq!(actions, [(0.4, 0.2), (0.4, 0.0), (0.4, -0.2), (0.2, 0.2), (0.2, 0.0), (0.2, -0.2)]);
    assert_eq!(car.body().unwrap().path.to_str(), Some("robots/car.toml"));
    assert_eq!(car.settings().robot.body.wheelbase_m, 0.33);
}

#[test]
fn a_robot_that_is_not_there_is_told_with_those_that_are() {
    expect(&format!("robot(\"turtlebot\"); {RULE}"), "E-ROBOT-FILE", "robot", "did you mean \"turtlebot3\"?");
    expect(&format!("robot(\"../pioneer2at\"); {RULE}"), "E-ROBOT-FILE", "robot", "without folder");
    expect(&format!("robot(\"\"); {RULE}"), "E-SCRIPT-SETTING", "robot", "robot(\"turtlebot3\"");
    expect(&format!("robot(\"f1tenth\"); robot(\"f1tenth\"); {RULE}"), "E-SCRIPT-SETTING", "robot", "keep one");
}

#[test]
fn every_mistake_of_a_body_file_is_told_at_its_place_there() {
    let told = |body: &'static str| {
        let script = SourceText::new("x.rhai", format!("robot(\"x\"); laser(#{{ beams: 9 }}); {RULE}"));
        let wrong =
            Behaviour::parse_with("x", script, &|_| Ok(Some(SourceText::new("x.toml", body))), &ParamValues::new())
                .unwrap_err();
        let told = |one: &crate::diagnostic::Diagnostic| {
            let place = one.place.as_ref().unwrap();
            assert_eq!(place.source.path.to_str(), Some("x.toml"));
            format!("{} {}", one.code, &place.source.text[place.span.clone()])
        };
        std::iter::once(&*wrong).chain(&wrong.others).map(told).collect::<Vec<_>>()
    };
    let body = "footprint = { shape = \"round\", length_m = 0.2, radius_m = 9 }\nheight_cm = 20\nstep_m = 0.01\n\
                drive = { kind = \"skid\", slip = 0.9 }\nactions = [[2.5, 0]]\n[laser]\nbeams = 2\nrange = 3\n";
    assert_eq!(
        told(body),
        [
            "E-ROBOT-KEY length_m",
            "E-ROBOT-VALUE 9",
            "E-ROBOT-KEY height_cm",
            "E-ROBOT-VALUE 0.9",
            "E-ROBOT-VALUE [2.5, 0]",
            "E-ROBOT-VALUE 2",
            "E-ROBOT-KEY range",
        ]
    );
    assert_eq!(told("footprint = "), ["E-ROBOT-SYNTAX "]);
}
