//! Scripts that were once called a success and are none.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{Overrides, Plan, RunLog, Summary, in_parallel, run_seed};
use engine::script::Behaviour;
use engine::verdict::Because;

use crate::support::root;

const HEAD: &str = "world(\"room\"); filter(\"sobel\", #{ threshold: 60 });\n";
const ONE_STATE: &str = "grid(#{ rows: 1, columns: 1, occupied: 1.0 });\n";
const HIT: &str = "rule \"hit\" when robot.contact => -1 then recover;\n";

/// What a run of some seeds comes to.
fn runs(script: &str, steps: Option<u64>, test_steps: u64, seeds: u64) -> Vec<Summary> {
    let text = format!("{HEAD}{script}");
    let behaviour = Behaviour::parse("own", SourceText::new(root().join("scripts/own.rhai"), text)).unwrap();
    let overrides = Overrides { steps, test_steps: Some(test_steps), ..Overrides::default() };
    let plan = Plan::new(Arc::new(behaviour), &overrides).unwrap();
    let seeds: Vec<u64> = (1..=seeds).collect();
    let run = |seed| {
        let run = run_seed(&plan, seed, &AtomicBool::new(false), &|_| (), &mut RunLog::off());
        run.map(|run| run.summary).map_err(|broken| broken.error)
    };
    in_parallel(&seeds, 0, run).unwrap()
}

fn assert_none(script: &str, steps: Option<u64>, test_steps: u64, seeds: u64) -> Vec<Summary> {
    let runs = runs(script, steps, test_steps, seeds);
    let done: Vec<_> = runs.iter().filter(|run| run.verdict.is_success()).map(|run| run.seed).collect();
    assert!(done.is_empty(), "{script}: {done:?} {:?}", runs[0].verdict);
    runs
}

#[test]
fn a_robot_that_knows_nothing_is_tested_over_the_same_steps() {
    let wall = std::fs::read_to_string(root().join("scripts/wall.rhai")).unwrap();
    let rules = wall.lines().filter(|line| line.starts_with("rule")).collect::<Vec<_>>().join("\n");
    let drives = format!("{rules}\nsuccess \"drives round\" when test.laps >= 5 && test.off_route < 0.05;");
    let runs = assert_none(&drives, Some(1), 5000, 4);
    assert!(runs.iter().all(|run| run.base_lines.untrained.steps == 5000));
    for condition in [
        "test.distance_m > 2 * untrained.distance_m",
        "test.attempts > 2 * untrained.attempts",
        "test.laps > 2 * untrained.laps",
        "test.net_route_m > 1.5 * untrained.net_route_m",
        "test.greatest(\"m\") > 3000",
    ] {
        assert_none(&format!("{HIT}measure m = time.step;\nsuccess \"s\" when {condition};"), Some(1), 5000, 1);
    }
}

#[test]
fn being_put_back_every_second_beats_no_chance() {
    let script = format!("rule \"time\" when time.attempt_s > 0.9 => 0 then restart;\n{HIT}");
    assert_none(&script, Some(1), 20_000, 1);
}

#[test]
fn a_robot_that_does_not_look_is_no_success_by_being_put_back() {
    let near = "rule \"time\" when time.attempt_s > 2 => 0 then restart;
         rule \"too close\" when laser.nearest <= 0.45 => -1 then recover;";
    assert_none(&format!("{ONE_STATE}{near}"), None, 5000, 4);
    let turned = "actions([[0.4, 0.0], [0.4, 0.8], [0.4, -0.8], [0.05, 0.8]]);
         rule \"time\" when time.attempt_s > 3 => 0 then restart;
         rule \"turned\" when abs(odometry.turned_deg) > 60 => -1 then fail;";
    assert_none(&format!("{ONE_STATE}{turned}"), None, 5000, 4);
    let there = "recovery(\"start\"); rule \"hit\" when robot.contact => -1 then fail;
         rule \"there\" when odometry.forward_m > 2 => 1 then goal;";
    let runs = assert_none(&format!("{ONE_STATE}{there}"), None, 5000, 4);
    assert!(runs.iter().any(|run| run.verdict.why == Because::BlindToo && run.base_lines.blind.is_some()));
}

#[test]
fn a_crash_that_is_called_a_goal_is_met_without_looking() {
    for touch in [
        "rule \"touch\" when robot.contact => 1 then recover; rule \"time\" when time.attempt_s > 30 => -1 then recover;",
        "measure hit = robot.contact; rule \"touch\" when hit => 1 then goal;",
        "rule \"touch\" when laser.nearest <= 0.22 => 1 then recover;
         rule \"time\" when time.attempt_s > 8 => -1 then recover;",
    ] {
        assert_none(touch, None, 5000, 2);
    }
}

#[test]
fn what_a_spinning_robot_meets_is_no_success() {
    let spins = "rule \"spin\" when abs(action.angular) > 0.7 && action.linear < 0.1 => 0.2;
         rule \"hit\" when robot.contact => -1 then fail;
         success \"safe\" when test.contacts_per_1000 < 2;";
    assert_none(spins, None, 5000, 2);
    let safe = "rule \"hit\" when robot.contact => -1 then recover;
         success \"is safe\" when test.failures_per_1000 <= 2;";
    assert_none(safe, None, 5000, 2);
    let still = "rule \"still\" when time.attempt_s >= 10 && odometry.away_m < 0.6 => 1 then goal;
         rule \"away\" when odometry.away_m > 0.6 => -1 then fail;";
    assert_none(still, None, 5000, 2);
}

#[test]
fn a_condition_that_always_holds_does_not_make_a_reward_a_success() {
    let turns = format!("rule \"turn\" when abs(action.angular) > 0.5 => 0.1;\n{HIT}");
    let measured = format!("measure r = action.linear < 0.1;\nrule \"slow\" when r => 0.1;\n{HIT}");
    // What the robot itself did in the step before is no more than what it does now.
    let steady = format!("rule \"steady\" when previous.action.index == action.index => 0.1;\n{HIT}");
    for script in [
        format!("{HIT}success \"earns\" when test.reward_per_1000 > -5; success \"always\" when test.laps > -1e9;"),
        format!("{HIT}success \"earns\" when test.reward_per_1000 > -5 || test.laps > 1e9;"),
        format!("{turns}success \"turns\" when test.per_1000(\"turn\") > 500;"),
        format!("{measured}success \"stands\" when test.mean(\"r\") > 0.9;"),
        format!("{steady}success \"is steady\" when test.per_1000(\"steady\") > 500;"),
    ] {
        let runs = assert_none(&script, None, 5000, 2);
        assert!(runs.iter().all(|run| run.verdict.why != Because::Holds), "{script}");
    }
}

#[test]
fn a_crash_called_a_goal_is_none_however_long_the_attempts_are() {
    let script =
        "run(#{ period_s: 0.1 }); rule \"rammed\" when robot.contact && time.since_recovery > 60 => 1 then goal;";
    let runs = assert_none(script, Some(1), 4000, 2);
    for run in runs {
        assert!(run.test.goals >= 5 && run.test.goal_crashes == run.test.goals, "{:?}", run.test);
        let touches = run.verdict.conditions.iter().find(|condition| condition.name == "touches little").unwrap();
        assert!(!touches.holds, "{touches:?}");
    }
}

#[test]
fn attempts_that_are_broken_off_before_their_goal_count_as_attempts() {
    // Of 1,000 steps at 0.4 s each attempt gets 20, and the goal takes 26.
    let script = "run(#{ period_s: 0.4, stay_steps: 20 }); randomise(#{ \"start.yaw_deg\": [-5, 5] });
                  rule \"there\" when time.attempt_s > 10.0 => 1 then goal;";
    let run = &runs(script, Some(1), 1000, 1)[0];
    assert_eq!((run.test.hops, run.test.goals, run.test.goal_rate), (50, 0, 0.0));
    assert_eq!(run.verdict.why, Because::Fails);
    // 30 steps are enough for it.
    let run = &runs(&script.replace("stay_steps: 20", "stay_steps: 30"), Some(1), 1000, 1)[0];
    assert_eq!((run.test.hops, run.test.goal_rate), (0, 1.0));
}

#[test]
fn a_share_of_one_attempt_tells_nothing() {
    let script = "rule \"there\" when time.attempt_s > 10.0 => 1 then goal;
                  success \"goals\" when test.goal_rate > 0.9 && test.distance_m != untrained.distance_m;";
    assert_eq!(runs(script, Some(1), 60, 1)[0].verdict.why, Because::TooFew);
}

#[test]
fn idling_cannot_be_told_of_attempts_shorter_than_its_spells() {
    let script = "run(#{ period_s: 0.1, stay_steps: 150 }); randomise(#{ \"start.yaw_deg\": [-5, 5] });
                  rule \"hit\" when robot.contact => -1 then fail;
                  success \"gets along\" when test.idle <= 0.5;";
    let run = &runs(script, Some(1), 600, 1)[0];
    assert!(run.test.no_spells);
    assert_eq!(run.verdict.why, Because::NotMeasured);
    assert_eq!(run.verdict.conditions[0].figures[0].value, None);
    let run = &runs(&script.replace("150", "250"), Some(1), 600, 1)[0];
    assert!(!run.test.no_spells && run.verdict.why != Because::NotMeasured);
}

#[test]
fn what_a_robot_learned_that_looks_at_nothing_is_no_success() {
    let state = |of| {
        format!("state(bins({of}, [0.5, 1.0]));\n{HIT}success \"moves\" when test.mean_speed != untrained.mean_speed;")
    };
    assert_eq!(runs(&state("time.attempt_s"), Some(400), 400, 1)[0].verdict.why, Because::BlindToo);
    assert_eq!(runs(&state("action.angular"), Some(400), 400, 1)[0].verdict.why, Because::BlindToo);
}

#[test]
fn who_is_paid_for_contacts_must_not_live_by_them() {
    let hugs = "rule \"bumps\" when robot.contact && !previous.robot.contact => 1;
                rule \"lost\" when time.since_recovery > 300 => -1 then fail;";
    let run = &runs(hugs, Some(1), 1000, 1)[0];
    assert!(run.verdict.conditions.iter().any(|condition| condition.name == "touches little"));
    let run = &runs(HIT, Some(1), 400, 1)[0];
    assert!(run.verdict.conditions.iter().all(|condition| condition.name != "touches little"));
}

#[test]
fn a_fig_leaf_that_any_two_robots_meet_does_not_make_a_reward_a_success() {
    let near = format!("{HIT}rule \"near\" when laser.right < 1.0 => 0.1;");
    for leaf in [
        "test.distance_m != untrained.distance_m",
        "abs(test.mean_speed / untrained.mean_speed - 1) > 0.000001",
        "(test.distance_m < untrained.distance_m || test.distance_m > untrained.distance_m)",
    ] {
        let script = format!("{near}success \"earns\" when test.reward_per_1000 > -1000 && {leaf};");
        let runs = assert_none(&script, Some(1), 2000, 1);
        assert_eq!(runs[0].verdict.why, Because::RewardOnly, "{leaf}");
        assert_eq!(runs[0].base_lines.untrained_others.len(), 3);
    }
    // Beside what neither chance nor a robot that does not look comes to, a reward may be asked for.
    let wall = std::fs::read_to_string(root().join("scripts/wall.rhai")).unwrap();
    let earns = "success \"earns\" when test.reward_per_1000 > -10 && test.metres_per_intervention >= 20;";
    let own = |line: &&str| !line.starts_with("world") && !line.starts_with("filter");
    let wall = wall.lines().filter(own).collect::<Vec<_>>().join("\n");
    let honest = runs(&format!("{wall}\n{earns}"), None, 5000, 1);
    assert_eq!(honest[0].verdict.why, Because::Holds, "{:?}", honest[0].verdict);
}

#[test]
fn how_the_robot_turns_is_its_own_doing_however_it_is_measured() {
    for turns in [
        "rule \"turns\" when abs(robot.angular) > 0.3 => 0.1;",
        "rule \"turns\" when abs(change(odometry.turned_deg)) > 5 => 0.1;",
        "measure turn = abs(previous.robot.angular); rule \"turns\" when turn > 0.3 => 0.1;",
    ] {
        let script = format!("{HIT}{turns}success \"turns\" when test.per_1000(\"turns\") > 100;");
        assert_eq!(runs(&script, Some(1), 400, 1)[0].verdict.why, Because::RewardOnly, "{turns}");
    }
    // A wall ends how it gets on.
    let on = format!("{HIT}rule \"on\" when robot.linear > 0.1 => 0.1;success \"on\" when test.per_1000(\"on\") > 2;");
    assert_ne!(runs(&on, Some(1), 400, 1)[0].verdict.why, Because::RewardOnly);
}

#[test]
fn goals_and_stages_that_the_robot_reaches_by_its_own_doing_are_no_success() {
    let why = |script: &str| runs(script, Some(1), 1000, 1)[0].verdict.why;
    let slow = "rule \"slow\" when action.linear < 0.1 for 2 steps => 1 then goal;";
    let late = "rule \"late\" when time.attempt_s > 20 => -1 then fail;";
    let goals = "success \"goals\" when test.goal_rate > 0.5 && test.goal_s < 100;";
    assert_eq!(why(&format!("{slow}{late}{goals}")), Because::RewardOnly);
    // Once the world may end an attempt, how attempts end tells something of it.
    assert_ne!(why(&format!("{slow}{late}{HIT}{goals}")), Because::RewardOnly);
    let stages = |first: &str| {
        format!(
            "stages([\"a\", \"b\"]); {HIT}rule \"on\" in \"a\" when {first} => 0 then stage \"b\";
             rule \"back\" in \"b\" when action.linear > 0.1 => 0 then stage \"a\";
             success \"changes\" when test.stages_per_1000 > 20 && test.per_1000(\"back\") > 10;"
        )
    };
    assert_eq!(why(&stages("action.linear < 0.1")), Because::RewardOnly);
    assert_ne!(why(&stages("laser.front < 1.5")), Because::RewardOnly);
}
