//! Words of other languages and of other simulators, answered with what is written here.

use super::parse;
use crate::judge::fact_table::{call, value};
use crate::judge::withheld::{MEASURED, WITHHELD};
use crate::verdict::FIGURES;

/// One cause, one error: its code, what is marked, and its help.
fn expect(text: &str, code: &str, marked: &str, help: &str) {
    let wrong = *parse(text).map(|_| ()).expect_err(text);
    let place = wrong.place.as_ref().unwrap();
    let found = &place.source.text[place.span.clone()];
    let given = wrong.help.clone().unwrap_or_default();
    assert!(wrong.others.is_empty(), "{text}: {:?}", wrong.others);
    assert_eq!((wrong.code, found), (code, marked), "{text}: {given}");
    assert!(given.contains(help), "{text}: {given}");
}

#[test]
fn words_for_operators_are_answered_with_the_operator() {
    let word = |text: &str, marked: &str, help: &str| expect(text, "E-SCRIPT-WORD", marked, help);
    word("rule \"a\" when robot.contact and laser.front < 1.0 => -1;", "and", "write &&");
    word("rule \"a\" when robot.contact OR laser.front < 1.0 => -1;", "OR", "write ||");
    word("rule \"a\" when not robot.contact => -1;", "not", "write !");
    word("fn reward(facts) { if facts.robot.contact and facts.laser.front < 1.0 { 1 } else { 0 } }", "and", "write &&");
    word("fn reward(facts) { if not facts.robot.contact { 1 } else { 0 } }", "not", "write !");
}

#[test]
fn numbers_with_a_unit_are_answered_with_the_number_in_ours() {
    let word = |text: &str, marked: &str, help: &str| expect(text, "E-SCRIPT-WORD", marked, help);
    word("rule \"a\" when laser.front < 25cm => -1;", "cm", "write 0.25 (metres)");
    word("rule \"a\" when laser.front < 12.5 cm => -1;", "cm", "write 0.125 (metres)");
    word("rule \"a\" when laser.front < 1m => -1;", "m", "write 1.0 (metres)");
    word("fn reward(facts) { let limit = 250mm; limit }", "mm", "write 0.25 (metres)");
    word("rule \"a\" when laser.front > 1.0 for 10 s => -1;", "s", "write for 10 seconds");
}

#[test]
fn an_end_in_the_place_of_a_rule_is_answered_with_the_rule() {
    let word = |text: &str, marked: &str, help: &str| expect(text, "E-SCRIPT-WORD", marked, help);
    let rule = "write rule \"x\" when CONDITION => 1 then goal;";
    word("goal \"x\" when laser.front < 1.0 => 1;", "goal", rule);
    word("goal \"x\" when laser.front < 1.0;", "goal", rule);
    word("fail \"x\" when robot.contact;", "fail", "=> -1 then fail;");
    word("rule \"a\" when robot.contact => -1 then recover(\"start\");", "(", "recovery(\"start\");");
}

#[test]
fn what_only_the_simulator_knows_is_answered_with_the_test_and_a_sensor() {
    let truth = |condition: &str, marked: &str, help: &str| {
        expect(&format!("rule \"a\" when {condition} > 1.0 => 1;"), "E-SCRIPT-TRUTH", marked, help);
    };
    truth("robot.x", "x", "test.laps > 3; the robot measures odometry.away_m");
    truth("robot.heading", "heading", "judged by the test");
    truth("progress", "progress", "success \"name\" when test.laps > 3");
    truth("goal.distance", "goal", "test.goal_rate > 0.9; the robot measures laser.front");
    truth("distance_from_center", "distance_from_center", "test.route_offset_m");
    let function = |body: &str| format!("fn reward(params) {{ if params.{body} {{ 1 }} else {{ 0 }} }}");
    expect(&function("all_wheels_on_track"), "E-SCRIPT-TRUTH", "all_wheels_on_track", "test.off_route < 0.05");
    expect(&function("track_width > 1.0"), "E-SCRIPT-TRUTH", "track_width", "laser.left and laser.right");
    expect(&function("waypoints[0] > 1.0"), "E-SCRIPT-TRUTH", "waypoints", "test.laps > 3");
    let pasted = "fn reward(params) { if params[\"track_width\"] > 1.0 { 1 } else { 0 } }";
    expect(pasted, "E-SCRIPT-TRUTH", "\"", "laser.left and laser.right");
    // What is measured has only another name.
    expect(&function("speed > 1.0"), "E-SCRIPT-FACT", "speed", "did you mean 'robot.linear'?");
    expect(&function("steps > 10"), "E-SCRIPT-FACT", "steps", "did you mean 'time.since_recovery'?");
    expect("rule \"a\" when steering_angle > 0.1 => -1;", "E-SCRIPT-NAME", "steering_angle", "'action.angular'");
    expect("rule \"a\" when robot.contact && True => -1;", "E-SCRIPT-NAME", "True", "did you mean 'true'?");
    // A script's own names stay its own.
    parse("let progress = 1.0; rule \"a\" when laser.front > progress => 1;").unwrap();
}

#[test]
fn a_setting_in_a_rule_is_answered_with_its_value() {
    let fact = |condition: &str, marked: &str, help: &str| {
        expect(&format!("rule \"a\" when {condition} => 1;"), "E-SCRIPT-FACT", marked, help);
    };
    fact("laser.front < laser.max", "max", "did you mean 'farthest' or 'max_range_m'?");
    fact("laser.height_m > 0.3", "height_m", "unless laser(#{ height_m: ... })");
    fact("camera.tilt_deg > 40", "tilt_deg", "write its value: 42");
}

#[test]
fn every_advice_names_facts_and_figures_that_exist() {
    let is_fact = |name: &str| {
        let (group, key) = name.split_once('.').unwrap();
        value(group, key).is_some() || call(group, key).is_some()
    };
    assert!(MEASURED.iter().all(|(_, fact)| is_fact(fact)));
    for row in WITHHELD {
        let figure = row.success.split([' ', '.']).nth(1).unwrap();
        assert!(FIGURES.iter().any(|known| known.name == figure), "{figure}");
        let mut named = row.fact.split([' ', ',', '(']).filter(|word| word.contains('.')).peekable();
        assert!(named.peek().is_some() && named.all(is_fact), "{}", row.fact);
    }
}
