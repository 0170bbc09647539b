use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{
    Cycle, Ledger, Overrides, Phase, Plan, Playback, RunLog, Summary, learn_into, run_seed, test,
};
use engine::outcome::Destination;
use engine::robot::Robot;
use engine::script::Behaviour;
use engine::settings::RecoverTo;
use engine::verdict::BaseLines;

use crate::support::root;

/// A plan of a script that stands beside the shipped ones.
fn plan_of(text: &str) -> engine::diagnostic::Result<Plan> {
    let source = SourceText::new(root().join("scripts/own.rhai"), text.to_owned());
    Plan::new(Arc::new(Behaviour::parse("own", source)?), &Overrides::default())
}

fn plan(text: &str) -> Plan {
    plan_of(text).unwrap_or_else(|error| panic!("{error}: {:?}", error.help))
}

/// Where the robot is at the beginning of each of the next attempts, metres along x.
fn beginnings(plan: &Plan, count: usize) -> Vec<f64> {
    let mut cycle = Cycle::new(plan, Phase::Learning.robot(plan, 1).unwrap()).unwrap();
    let x_m = |cycle: &Cycle<_>| Robot::whereabouts(Cycle::robot(cycle)).unwrap().pose.x_m;
    let mut found = vec![x_m(&cycle)];
    while found.len() < count {
        if cycle.step(0).unwrap().then.is_some() {
            cycle.recover().unwrap();
            found.push(x_m(&cycle));
        }
    }
    found
}

const EXACT: &str = "#{ position_m: 0, yaw_deg: 0 }";

#[test]
fn a_rule_says_where_the_next_attempt_begins() {
    let script = |then: &str| {
        format!(
            "world(\"bridge\"); recovery(\"at pillar\", {EXACT}); rule \"late\" when time.attempt_s > 1.0 => 0 {then};"
        )
    };
    assert_eq!(beginnings(&plan(&script("then restart")), 3), [8.6, 8.6, 8.6]);
    assert_eq!(beginnings(&plan(&script("then restart to \"middle\"")), 3), [8.6, 4.5, 4.5]);
    assert!(beginnings(&plan(&script("then fail to \"start\"")), 9).contains(&0.0));
}

#[test]
fn a_function_says_where_the_next_attempt_begins() {
    let script = |to: &str| {
        format!(
            "world(\"bridge\"); recovery(\"end\", {EXACT});\n\
             fn reward(facts) {{ if facts.time.attempt_s > 1.0 {{ #{{ value: 0, then: \"restart\", to: \"{to}\" }} }} else {{ 0 }} }}"
        )
    };
    assert_eq!(beginnings(&plan(&script("first platform")), 3), [6.6, 0.0, 0.0]);
    let plan = plan(&script("first"));
    let mut cycle = Cycle::new(&plan, Phase::Learning.robot(&plan, 1).unwrap()).unwrap();
    let error = (0..5).find_map(|_| cycle.step(0).err()).unwrap();
    assert!(error.code == "E-REWARD-VALUE" && error.message.contains("has no start \"first\""), "{error}");
}

#[test]
fn a_place_that_the_world_does_not_have_is_a_mistake_with_the_nearest_name() {
    let refused = |setup: &str, to: &str| {
        let text = format!("world(\"bridge\"); {setup} rule \"late\" when time.attempt_s > 9.0 => 0 then restart{to};");
        let error = *plan_of(&text).map(|_| ()).unwrap_err();
        let place = error.place.unwrap();
        (error.code, place.source.text[place.span].to_owned(), error.message, error.help.unwrap())
    };
    let start = "recovery(\"start\");";
    let wrong = refused(start, " to \"midle\"");
    assert_eq!((wrong.0, wrong.1.as_str()), ("E-SCRIPT-PLACE", "\"midle\""));
    assert_eq!(wrong.3, "did you mean \"middle\"?");
    let wrong = refused("recovery(\"pillar\");", "");
    assert!(wrong.0 == "E-SCRIPT-PLACE" && wrong.2.contains("has no start \"pillar\""), "{wrong:?}");
    let wrong = refused(start, " to \"behind\"");
    assert!(
        wrong.2.contains("needs a mover") && wrong.3.contains("at pillar, end, middle, first platform"),
        "{wrong:?}"
    );
    let wrong = refused(&format!("{start} starts([\"end\", \"start\"]);"), "");
    assert!(wrong.0 == "E-SCRIPT-PLACE" && wrong.2.contains("\"start\""), "{wrong:?}");
    let wrong = refused("recovery(\"end\"); starts([\"end\", \"middle\"]);", "");
    assert!(
        wrong.2.contains("no attempt begins at one of these") && wrong.3.contains("recovery(\"start\")"),
        "{wrong:?}"
    );
}

/// Attempts of five steps that all go well, from ever more starts.
const WIDENED: &str = "world(\"bridge\"); recovery(\"start\"); run(#{ steps: 400, test_steps: 100 });\n\
    starts([\"at pillar\", \"end\", \"middle\", \"first platform\"], #{ widen: 1.0 });\n\
    actions([[0.0, 0.1], [0.0, -0.1]]); rule \"late\" when time.attempt_s > 2.3 => 0 then restart;";

#[test]
fn starts_join_when_enough_attempts_went_well_and_the_summary_says_when() {
    let plan = plan(WIDENED);
    let found = beginnings(&plan, 80);
    assert!(found[..20].iter().all(|x| (*x - 8.6).abs() < 0.2) && found[20..40].iter().any(|x| *x < 7.0), "{found:?}");
    let learned = learn_into(&plan, 1, &AtomicBool::new(false), &|_| (), &mut Ledger::off()).unwrap();
    // Twenty attempts of five steps for each.
    assert_eq!(learned.joined, [0, 100, 200, 300]);
    let tested = test(&plan, &learned.policy, 1, &AtomicBool::new(false)).unwrap();
    let summary = Summary::new(&plan, 1, Some(&learned), &tested, &BaseLines::of_untrained(tested.figures.clone()));
    assert_eq!(summary.starts[3].name, "first platform");
    assert_eq!(summary.starts[3].joined_at, Some(300));
}

#[test]
fn what_has_been_recorded_with_places_starts_and_movers_is_played_again_bit_for_bit() {
    let crossing = "world(\"crossing\"); run(#{ steps: 600, test_steps: 100 });\n\
        rule \"hit\" when robot.contact || laser.nearest <= 0.25 => -1 then fail to \"start 3\";";
    let tail = "world(\"tail\"); recovery(\"behind\"); run(#{ steps: 600, test_steps: 100 }); filter(\"colour\");\n\
        rule \"hit\" when laser.nearest <= 0.3 => -1 then fail;\n\
        rule \"late\" when time.attempt_s > 20.0 => 0 then restart to \"behind\";";
    for text in [WIDENED, crossing, tail] {
        let plan = plan(text);
        let mut log = RunLog::new(&plan);
        run_seed(&plan, 7, &AtomicBool::new(false), &|_| (), &mut log).unwrap();
        for (phase, ledger) in [(Phase::Learning, &log.learning), (Phase::Test, &log.test)] {
            let mut playback = Playback::new(&plan, 7, phase, ledger).unwrap();
            while let Some(step) = playback.advance().unwrap() {
                assert_eq!(playback.difference(), None, "{text}: {phase:?} {}", step.index);
                assert_eq!(ledger.record(step.index as usize).unwrap().to, step.to);
            }
            assert_eq!(playback.done(), ledger.len());
        }
    }
    let plan = plan(tail);
    let mut ledger = Ledger::new(&plan, 600);
    learn_into(&plan, 7, &AtomicBool::new(false), &|_| (), &mut ledger).unwrap();
    let behind = Some(Destination::Word(RecoverTo::Behind));
    assert!(ledger.records().any(|record| record.to == behind) && ledger.records().any(|record| record.to.is_none()));
}

#[test]
fn visits_and_gates_are_measured_where_a_success_asks_for_them() {
    let script = |world: &str, success: &str| {
        format!(
            "world(\"{world}\"); recovery(\"start\", {EXACT}); run(#{{ test_steps: 200 }}); actions([[0.2, 0.0], [0.2, 0.01]]);\n\
             rule \"late\" when time.attempt_s > 40.0 => 0 then restart; success \"s\" when {success};"
        )
    };
    let refused = |world: &str, success: &str| plan_of(&script(world, success)).map(|_| ()).unwrap_err().message;
    assert!(refused("patrol", "test.visits_per_1000(\"rde\") > 1.0").contains("no place \"rde\""));
    assert!(refused("patrol", "test.gate_errors < 0.1").contains("no gates: 'gate_errors'"));
    let plan = plan(&script("slalom", "test.gates_per_1000 > 1.0 && test.gate_errors < 0.5"));
    let learned = learn_into(&plan, 1, &AtomicBool::new(false), &|_| (), &mut Ledger::off()).unwrap();
    let tested = test(&plan, &learned.policy, 1, &AtomicBool::new(false)).unwrap();
    let [gates, errors] = &tested.figures.asked[..] else { panic!("{:?}", tested.figures.asked) };
    assert_eq!((gates.name.as_str(), errors.name.as_str()), ("gates_per_1000", "gate_errors"));
    assert!(gates.value.unwrap() >= 0.0 && (0.0..=1.0).contains(&errors.value.unwrap()));
}
