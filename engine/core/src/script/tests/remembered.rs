//! What rules remember: windows, counters, timers, stages; each with numbers worked out by hand.

use super::errors::expect;
use super::{fan, judge, parse};
use crate::judge::{Judge, ViewFacts};
use crate::outcome::Then;

/// The rewards of steps in which the beam ahead has these ranges; the period is half a second.
pub(super) fn ahead(judge: &mut Judge, ranges_m: &[f32]) -> Vec<f64> {
    let rewards = ranges_m.iter().map(|range_m| {
        judge.facts_mut().ranges_m.fill(*range_m);
        judge.judge().unwrap().reward
    });
    rewards.collect()
}

#[test]
fn a_change_is_the_newest_value_less_that_of_the_step_before() {
    let mut judge = judge("rule \"d\" when true => change(laser.front);");
    assert_eq!(ahead(&mut judge, &[2.0, 1.5, 1.5, 4.0]), [0.0, -0.5, 0.0, 2.5]);
    judge.recovered();
    assert_eq!(ahead(&mut judge, &[1.0, 3.0]), [0.0, 2.0]);
}

#[test]
fn a_change_over_a_time_begins_with_the_first_sample() {
    // 1 s is two steps of 0.5 s.
    let mut judge = judge("rule \"d\" when true => change(laser.front, 1);");
    assert_eq!(ahead(&mut judge, &[1.0, 2.0, 4.0, 8.0]), [0.0, 1.0, 3.0, 6.0]);
}

#[test]
fn an_average_is_of_the_last_steps_and_counts_truth_as_one() {
    let mut mean = judge("rule \"m\" when true => average(laser.front, 1);");
    assert_eq!(ahead(&mut mean, &[1.0, 2.0, 4.0]), [1.0, 1.5, 3.0]);
    let mut share = judge("measure near = laser.front < 1.0; rule \"s\" when average(near, 2) >= 0.5 => 1;");
    assert_eq!(ahead(&mut share, &[2.0, 0.5, 2.0, 2.0, 2.0, 2.0]), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn the_step_before_is_read_as_it_was() {
    let mut judge = judge("rule \"nearer\" when laser.front < previous.laser.front => 1;");
    assert_eq!(ahead(&mut judge, &[2.0, 1.0, 1.0, 0.5]), [0.0, 1.0, 0.0, 1.0]);
}

#[test]
fn rules_are_counted_and_timed() {
    let mut judge = judge(
        "rule \"seen\" when laser.front < 1.0 => 0;
         rule \"count\" when true => fired(\"seen\");
         rule \"ago\" when since(\"seen\") < 100 => 10 * since(\"seen\");",
    );
    // What fired above in the same step counts: twice at once, then 0.5 s and 1 s ago.
    assert_eq!(ahead(&mut judge, &[2.0, 0.5, 2.0, 2.0, 0.5]), [0.0, 1.0, 6.0, 11.0, 2.0]);
    judge.recovered();
    assert_eq!(ahead(&mut judge, &[2.0]), [0.0]);
}

#[test]
fn once_waits_until_the_condition_has_been_false() {
    let mut door = judge("rule \"door\" when laser.front > 1.0 once => 1;");
    assert_eq!(ahead(&mut door, &[2.0, 2.0, 0.5, 2.0, 2.0]), [1.0, 0.0, 0.0, 1.0, 0.0]);
    let mut held = judge("rule \"door\" when laser.front > 1.0 for 2 steps once => 1;");
    assert_eq!(ahead(&mut held, &[2.0, 2.0, 2.0, 2.0, 0.5, 2.0, 2.0]), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn a_value_per_second_is_multiplied_by_the_period() {
    let mut judge = judge("rule \"time\" when true => -0.2 per second;");
    assert_eq!(ahead(&mut judge, &[1.0, 1.0]), [-0.1, -0.1]);
}

#[test]
fn measures_are_read_by_rules_and_by_functions() {
    let mut judge = judge(
        "measure gap = laser.front - 0.5; measure wide = gap > 1.0; measure both = gap * 2.0;
         rule \"wide\" when wide => both;
         fn reward(facts) { if facts.wide { 100.0 + facts.gap } else { 0.0 } }",
    );
    assert_eq!(ahead(&mut judge, &[1.0, 2.0]), [0.0, 3.0 + 101.5]);
}

#[test]
fn stages_are_entered_at_the_end_of_a_step_and_forgotten_at_recovery() {
    let mut judge = judge(
        "stages([\"out\", \"back\"]);
         rule \"there\" in \"out\"  when laser.front < 1.0 => 1 then stage \"back\";
         rule \"again\" in \"out\"  when laser.front < 1.0 => 10;
         rule \"home\"  in \"back\" when laser.front > 3.0 => 2 then goal;
         rule \"time\"  when stage.at(\"back\") && stage.steps == 2 => 100;",
    );
    assert_eq!(ahead(&mut judge, &[2.0]), [0.0]);
    assert_eq!((ahead(&mut judge, &[0.5]), judge.stage()), (vec![11.0], 1));
    assert_eq!(ahead(&mut judge, &[0.5, 0.5, 2.0]), [0.0, 100.0, 0.0]);
    judge.facts_mut().ranges_m.fill(4.0);
    let last = judge.judge().unwrap();
    assert_eq!((last.reward, last.then), (2.0, Some(Then::Goal)));
    judge.recovered();
    assert_eq!((judge.stage(), judge.digits()), (0, &[0][..]));
}

#[test]
fn the_wheels_count_from_the_start_of_the_attempt_and_of_the_stage() {
    let mut judge = judge(
        "stages([\"a\", \"b\"]); measure way = odometry.forward_m; rule \"far\" in \"a\" when way >= 1.0 => 0 then stage \"b\";
         rule \"r\" when true => way + 100.0 * stage.distance_m;",
    );
    judge.facts_mut().linear_m_per_s = 1.0;
    // Half a metre in each step; the second stage begins after the second step.
    assert_eq!(ahead(&mut judge, &[1.0; 4]), [0.5 + 50.0, 1.0 + 100.0, 1.5 + 50.0, 2.0 + 100.0]);
}

#[test]
fn bearings_name_beams_and_hits_tell_a_wall_from_nothing() {
    let mut judge = judge("rule \"r\" when laser.hit_at(0) => laser.at(0) + 100 * laser.between(-10, 10).hits;");
    let facts = judge.facts_mut();
    (facts.laser_view_deg, facts.laser_range_m) = (180.0, (0.2, 8.0));
    facts.ranges_m.fill(8.0);
    for beam in 89..=92 {
        facts.ranges_m[beam] = 2.0;
    }
    assert_eq!(judge.judge().unwrap().reward, 402.0);
    judge.facts_mut().ranges_m[90] = 8.0;
    assert_eq!(judge.judge().unwrap().reward, 0.0);
}

#[test]
fn a_word_that_a_script_defines_is_its_own() {
    for script in [
        "let stage = 2; rule \"a\" when true => stage;",
        "fn change(x) { x + 1 } rule \"a\" when true => change(1.0);",
        "const previous = 2.0; rule \"a\" when true => previous;",
        "let measure = 2; rule \"a\" when measure == 2 => 2;",
        "fn odometry(x) { x } rule \"a\" when true => odometry(2.0);",
    ] {
        let mut judge =
            parse(script).unwrap_or_else(|wrong| panic!("{script}: {wrong:?}")).judge(0.5, fan(181)).unwrap();
        judge.facts_mut().views = vec![ViewFacts { grid: (3, 3), ..ViewFacts::default() }];
        judge.calibrate().unwrap();
        assert_eq!(judge.judge().unwrap().reward, 2.0, "{script}");
    }
}

#[test]
fn what_cannot_be_remembered_is_told_with_the_way_out() {
    let rule = "rule \"a\" when true => 1;";
    let told = |text: &str, code: &str, marked: &str, help: &str| expect(&format!("{text} {rule}"), code, marked, help);
    told("rule \"b\" in \"x\" when true => 1;", "E-SCRIPT-STAGE", "\"", "stages([\"x\"");
    told("stages([\"out\", \"back\"]); rule \"b\" in \"bck\" when true => 1;", "E-SCRIPT-STAGE", "\"", "\"back\"");
    told("stages([\"one\"]);", "E-SCRIPT-SETTING", "stages", "stages([\"search\"");
    told("rule \"b\" when fired(\"door\") > 1 => 1;", "E-SCRIPT-WINDOW", "\"", "there are: b, a");
    told("rule \"b\" when change(laser.front, 700) > 1 => 1;", "E-SCRIPT-WINDOW", "700", "change(x, 10)");
    told("fn f(x) { x } rule \"b\" when change(f(1.0)) > 0.0 => 1;", "E-SCRIPT-WINDOW", "change", "measure m = ...");
    told("fn f(x) { change(x) }", "E-SCRIPT-WINDOW", "change", "facts.m");
    told("fn f(x) { x } measure m = f(laser.front);", "E-SCRIPT-WINDOW", "f", "functions of the table");
    told("measure laser = 1.0;", "E-SCRIPT-NAME", "laser", "another name");
    told("measure m = laser.frnt;", "E-SCRIPT-FACT", "frnt", "'front'");
    told("rule \"b\" when previous.laser.frnt > 1.0 => 1;", "E-SCRIPT-FACT", "frnt", "'front'");
    told("rule \"b\" when previous.stage.index > 1 => 1;", "E-SCRIPT-FACT", "stage", "change(m)");
    told("rule \"b\" once when true => 1;", "E-SCRIPT-RULE", "once", "");
    told("rule \"b\" when true => 1 per hour;", "E-SCRIPT-RULE", "hour", "");
}
