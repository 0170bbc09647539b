//! What a script does when it runs.

mod budget;
mod editions;
mod errors;
mod guards;
mod memory;
mod mistakes;
mod pages;
mod params;
mod remembered;
mod robots;
mod running;
mod same;
mod success;
mod traps;
mod types;
mod views;
mod words;

use super::*;
use crate::diagnostic::{Diagnostic, SourceText};
use crate::judge::{Judge, Judgement, ViewFacts};
use crate::outcome::Then;
use crate::settings::ScanFan;

pub(super) fn parse(text: &str) -> Result<Behaviour, Box<Diagnostic>> {
    Behaviour::parse("test", SourceText::new("test.rhai", text))
}

/// So many beams over half a circle.
pub(super) const fn fan(beams: usize) -> ScanFan {
    ScanFan { beams, view_deg: 180.0 }
}

/// A judge of a script over 181 beams at 2 m, two steps a second.
pub(super) fn judge(text: &str) -> Judge {
    let behaviour = parse(text).unwrap_or_else(|wrong| panic!("{wrong:?}"));
    let mut judge = behaviour.judge(0.5, fan(181)).unwrap();
    let facts = judge.facts_mut();
    facts.ranges_m.fill(2.0);
    facts.views = vec![ViewFacts { grid: (3, 3), cells: vec![0.0; 9], ..ViewFacts::default() }];
    judge.calibrate().unwrap();
    judge
}

fn rewards(judge: &mut Judge, steps: usize) -> Vec<f64> {
    (0..steps).map(|_| judge.judge().unwrap().reward).collect()
}

#[test]
fn a_rule_fires_when_its_condition_holds() {
    let mut judge = judge("rule \"close\" when laser.nearest <= 0.25 => -1 then recover;");
    assert_eq!(judge.judge().unwrap(), Judgement::default());
    assert_eq!(judge.fired(), [None]);
    judge.facts_mut().ranges_m[40] = 0.25;
    assert_eq!(judge.judge().unwrap(), Judgement { reward: -1.0, then: Some(Then::Recover), ..Judgement::default() });
    assert_eq!(judge.fired(), [Some(-1.0)]);
}

#[test]
fn a_rule_for_three_steps_fires_in_every_third_step() {
    let mut judge = judge("rule \"far\" when laser.right > 1.0 for 3 steps => -1;");
    assert_eq!(rewards(&mut judge, 7), [0.0, 0.0, -1.0, 0.0, 0.0, -1.0, 0.0]);
}

#[test]
fn a_break_starts_the_count_again() {
    let mut judge = judge("rule \"far\" when laser.right > 1.0 for 3 steps => -1;");
    assert_eq!(rewards(&mut judge, 2), [0.0, 0.0]);
    judge.facts_mut().ranges_m[0] = 0.5;
    assert_eq!(rewards(&mut judge, 1), [0.0]);
    judge.facts_mut().ranges_m[0] = 2.0;
    assert_eq!(rewards(&mut judge, 3), [0.0, 0.0, -1.0]);
}

#[test]
fn recovery_starts_the_count_again() {
    let mut judge = judge("rule \"far\" when laser.right > 1.0 for 3 steps => -1;");
    assert_eq!(rewards(&mut judge, 2), [0.0, 0.0]);
    judge.recovered();
    assert_eq!(rewards(&mut judge, 3), [0.0, 0.0, -1.0]);
}

#[test]
fn seconds_are_rounded_up_to_steps() {
    let far = |time: &str, period_s: f64| {
        let script = format!("rule \"far\" when laser.right > 1.0 for {time} => -1;");
        let mut judge = parse(&script).unwrap().judge(period_s, fan(181)).unwrap();
        judge.facts_mut().ranges_m.fill(2.0);
        judge.facts_mut().views = vec![ViewFacts { grid: (3, 3), ..ViewFacts::default() }];
        1 + rewards(&mut judge, 100).iter().position(|&reward| reward != 0.0).unwrap()
    };
    assert_eq!(far("7 seconds", 0.5), 14);
    assert_eq!(far("7 seconds", 0.33), 22);
    assert_eq!(far("0.9 seconds", 0.3), 3);
    assert_eq!(far("0.1 seconds", 0.5), 1);
}

#[test]
fn rules_add_up_until_one_recovers() {
    let mut judge = judge(
        "rule \"a\" when true => 1; rule \"b\" when true => -3 then recover; rule \"c\" when true => 10;
         fn reward(facts) { 100 }",
    );
    assert_eq!(judge.judge().unwrap(), Judgement { reward: -2.0, then: Some(Then::Recover), ..Judgement::default() });
    assert_eq!(judge.fired(), [Some(1.0), Some(-3.0), None, None]);
}

#[test]
fn the_reward_function_adds_to_the_rules() {
    let mut judge = judge("rule \"a\" when true => 1; fn reward(facts) { facts.laser.right * 2 }");
    assert_eq!(judge.judge().unwrap(), Judgement { reward: 5.0, then: None, ..Judgement::default() });
    assert_eq!(judge.fired(), [Some(1.0), Some(4.0)]);
}

#[test]
fn the_reward_function_may_ask_for_recovery() {
    let mut judge = judge("fn reward(facts) { #{ value: -1, recover: facts.robot.contact } }");
    judge.facts_mut().contact = true;
    assert_eq!(judge.judge().unwrap(), Judgement { reward: -1.0, then: Some(Then::Recover), ..Judgement::default() });
}

#[test]
fn constants_are_seen_in_rules_and_in_functions() {
    let mut judge = judge(
        "const LIMIT = 1.5; let weight = 2;
         fn weighted(x) { x * weight }
         rule \"far\" when laser.right > LIMIT => weighted(weight);
         fn reward(facts) { weighted(LIMIT) }",
    );
    assert_eq!(judge.judge().unwrap().reward, 4.0 + 3.0);
}

#[test]
fn variables_that_stand_before_and_after_a_rule_do_not_mix() {
    let mut judge = judge(
        "fn same(x) { x } let a = 1.0; rule \"one\" when same(a) == 1.0 => same(a); let b = 2.0;
         rule \"two\" when same(b) == 2.0 => same(a) + same(b); let c = 4.0;",
    );
    assert_eq!(judge.judge().unwrap().reward, 4.0);
}

#[test]
fn the_laser_and_a_sector_stand_for_their_nearest_range() {
    let mut judge = judge("rule \"a\" when laser < 1 => 1; rule \"b\" when laser.sector(0, 10) < 1.0 => 10;");
    judge.facts_mut().ranges_m[10] = 0.5;
    assert_eq!(judge.judge().unwrap().reward, 11.0);
    judge.facts_mut().ranges_m[10] = 2.0;
    judge.facts_mut().ranges_m[11] = 0.5;
    assert_eq!(judge.judge().unwrap().reward, 1.0);
}

#[test]
fn what_was_calibrated_is_read_in_rules_and_in_the_reward() {
    let mut judge = judge(
        "fn calibrate(facts) { #{ front: facts.laser.front, all: [1, 2] } }
         rule \"a\" when laser.front >= calibrated.front => calibrated.front;
         fn reward(facts) { facts.calibrated.all[1] / 4 }",
    );
    assert_eq!(judge.judge().unwrap().reward, 2.5);
}

#[test]
fn an_uncalibrated_judge_refuses() {
    let behaviour = parse("fn calibrate(facts) { 1 } rule \"a\" when laser.right > calibrated => 1;").unwrap();
    let mut judge = behaviour.judge(0.5, fan(181)).unwrap();
    assert!(judge.judge().is_err());
}

#[test]
fn the_set_up_becomes_settings_with_places() {
    let text = "world(\"hall\");\nfilter(\"blur\"); filter(\"sobel\", #{ threshold: 70 });
        actions([[0.4, 0.2], [0.1, -1]]);
        camera(#{ tilt_deg: 30, lens: \"fisheye\" }); learner(\"q\", #{ window: 5 }); grid(#{ fill: false });
        rule \"a\" when true => 1;";
    let behaviour = parse(text).unwrap();
    let settings = behaviour.settings();
    assert_eq!((settings.world.as_str(), settings.view.filters.len(), settings.actions.len()), ("hall", 2, 2));
    assert_eq!(settings.view.filters[1].parameters, [("threshold".to_owned(), 70.0)]);
    assert_eq!((settings.camera.tilt_deg, settings.camera.lens.word()), (30.0, "fisheye"));
    assert_eq!((settings.learner.kind.word(), settings.learner.window), ("q", 5));
    assert!(!settings.view.grid.fill);
    let at = |name: &str| &text[behaviour.place_of(name).unwrap()];
    assert_eq!((at("world"), at("filter:1"), at("filter:1.threshold")), ("world", "filter", "70"));
    assert_eq!((at("camera.tilt_deg"), at("learner.kind"), at("actions")), ("30", "learner", "actions"));
    assert_eq!(behaviour.place_of("run.steps"), None);
}

#[test]
fn rules_are_listed_with_their_lines_and_texts() {
    let behaviour = parse("// one\nrule \"a;b\" when true // why\n  => 1;\nfn reward(facts) { 0 }\n").unwrap();
    let lines: Vec<_> = behaviour.rules().iter().map(|rule| (rule.name.as_str(), rule.line)).collect();
    assert_eq!(lines, [("a;b", 2), ("reward", 4)]);
    assert_eq!(behaviour.rules()[0].text, "rule \"a;b\" when true // why\n  => 1");
    assert_eq!(behaviour.rules()[1].text, "fn reward(facts) { 0 }");
}

#[test]
fn a_byte_order_mark_a_program_line_and_carriage_returns_are_accepted() {
    assert!(parse("\u{feff}rule \"a\" when true => 1;").is_ok());
    assert!(parse("#!/usr/bin/env engine\r\nworld(\"room\");\r\nrule \"a\" when true => 1;\r\n").is_ok());
}
