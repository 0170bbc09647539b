use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{Learning, Ledger, Overrides, Plan, learn, test};
use engine::learner::Carry;
use engine::script::Behaviour;
use insight::store::{policy_from_toml, policy_to_toml};
use serde_json::Value;

use crate::support::{Bench, SCRIPT, root};

/// Two grids, 64 x 3,125 states.
const VIEWS: &str = r#"world("room");
run(#{ steps: 600, test_steps: 400 });
view("coarse", filter("sobel"), grid(#{ rows: 3, columns: 3, occupied: 0.015 }));
view("fine", filter("sobel"), grid(#{ rows: 4, columns: 5, occupied: 0.015 }));
state("coarse", "fine");
learner(#{ kind: "memory" });
rule "too close" when laser.nearest <= 0.25 => -1 then recover;
rule "lost" when laser.nearest > 0.9 for 3 seconds => -1 then recover;
"#;

fn plan(script: &str) -> Plan {
    let source = SourceText::new(root().join("scripts/own.rhai"), script);
    Plan::new(Arc::new(Behaviour::parse("own", source).unwrap()), &Overrides::default()).unwrap()
}

fn remembering() -> Bench {
    let bench = Bench::new();
    let output = bench.engine(&["run", "short.rhai", "--out", "a"]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&output.stderr));
    bench
}

fn json(bench: &Bench, arguments: &[&str]) -> Value {
    let output = bench.engine(&[arguments, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn a_run_that_remembers_is_replayed_and_tested_again_bit_for_bit() {
    let bench = remembering();
    assert_eq!(json(&bench, &["replay", "a", "--verify"])["reproduced"], true);
    let policy = bench.read("a/policy.toml");
    assert!(policy.starts_with("format = 4\n") && policy.contains("\ntemperature = "));
    // Every one of 64 states can answer, met or not.
    assert_eq!(policy.matches("[[state]]").count(), 64);
    assert!(policy.contains("visits = 0"));
    let summary: Value = serde_json::from_str(&bench.read("a/summary.json")).unwrap();
    assert_eq!(json(&bench, &["test", "a"])["failures"], summary["test"]["failures"]);
}

#[test]
fn the_value_of_an_action_is_explained_down_to_the_steps_behind_it() {
    let bench = remembering();
    let report = json(&bench, &["explain", "a", "--step", "500"]);
    let (value, state) = (&report["value"], &report["state"]["index"]);
    let links: Vec<&str> =
        value["links"].as_array().unwrap().iter().map(|link| link["name"].as_str().unwrap()).collect();
    assert_eq!(links, ["first value", "columns 1 2", "columns 1 3", "columns 2 3", "similar actions", "own tries"]);
    assert_eq!(value["links"][5]["value"], value["value"]);
    // The steps that it names are steps of this state and action, before this one.
    let tries = value["tries"].as_array().unwrap();
    for past in tries.iter().take(2) {
        let step = past["step"].as_u64().unwrap();
        assert!(step < 500);
        let earlier = json(&bench, &["explain", "a", "--step", &step.to_string()]);
        assert_eq!((&earlier["state"]["index"], &earlier["action"]), (state, &report["action"]));
    }
    let text = String::from_utf8(bench.engine(&["explain", "a", "--step", "500"]).stdout).unwrap();
    assert!(text.contains("why this action was worth") && text.contains("similar actions"), "{text}");
    // A table has no such chain.
    bench.write("table.rhai", format!("learner(\"ttd\");\n{SCRIPT}"));
    bench.engine(&["run", "table.rhai", "--out", "b"]);
    assert!(json(&bench, &["explain", "b", "--step", "500"])["value"].is_null());
}

#[test]
fn over_many_states_the_file_answers_for_those_never_met_as_the_learned_policy_does() {
    let (plan, never) = (plan(VIEWS), AtomicBool::new(false));
    let learned = learn(&plan, 3, &never, &|_| ()).unwrap();
    let text = policy_to_toml(&plan, &learned.policy, None).unwrap();
    let read = policy_from_toml(&SourceText::new("policy.toml", text.clone()), &plan).unwrap();
    assert_eq!(read, learned.policy);
    let tested = |policy| test(&plan, policy, 3, &never).unwrap();
    let (one, other) = (tested(&read), tested(&learned.policy));
    assert_eq!(one.state_hash, other.state_hash);
    let damaged = text.replacen("tries = [", "tries = [1.0, ", 1);
    let error = policy_from_toml(&SourceText::new("policy.toml", damaged), &plan).unwrap_err();
    assert!(error.message.contains("damaged sums"), "{}", error.message);
}

#[test]
fn a_reward_is_swapped_in_a_robot_that_remembers() {
    let (plan, never) = (plan(VIEWS), AtomicBool::new(false));
    for (carry, met) in [(Carry::Keep, true), (Carry::Decay, false), (Carry::Reset, false)] {
        let mut learning = Learning::new(&plan, 3).unwrap();
        learning.run(300, &never, &|_| (), &mut Ledger::off()).unwrap();
        learning.swap(&plan, carry, &mut Ledger::off()).unwrap();
        assert_eq!(learning.snapshot().policy.states_met() > 0, met, "{carry:?}");
        learning.run(300, &never, &|_| (), &mut Ledger::off()).unwrap();
        assert!(learning.finish().policy.states_met() > 0);
    }
}

#[test]
fn only_what_is_met_has_rows_where_no_table_could_hold_all_states() {
    // Two grids of 3,125 states each: 9,765,625 together.
    let fine = VIEWS.replace("rows: 3, columns: 3", "rows: 4, columns: 5");
    let (plan, never) = (plan(&fine), AtomicBool::new(false));
    let learned = learn(&plan, 3, &never, &|_| ()).unwrap();
    assert_eq!(learned.policy.states(), 9_765_625);
    assert!(learned.policy.rows().count() < 600);
    let text = policy_to_toml(&plan, &learned.policy, None).unwrap();
    assert_eq!(policy_from_toml(&SourceText::new("policy.toml", text), &plan).unwrap(), learned.policy);
    let table = fine.replace("memory", "ttd");
    let source = SourceText::new(root().join("scripts/own.rhai"), table);
    let error = Plan::new(Arc::new(Behaviour::parse("own", source).unwrap()), &Overrides::default()).err().unwrap();
    assert!(error.message.contains("make more than 524288 states"), "{}", error.message);
    assert!(error.help.unwrap().contains("learner(#{ kind: \"memory\" })"));
}

/// The wall's script with rewards of another size, learned for 2,000 steps: the failures of each window, and every value.
fn learned_at_size(size: f64, seed: u64) -> (Vec<u64>, Vec<f64>) {
    let script = std::fs::read_to_string(root().join("scripts/wall.rhai")).unwrap();
    let sized = script.replace("=> -1 then", &format!("=> {:?} then", -size));
    assert_eq!(sized.matches(&format!("=> {:?} then", -size)).count(), 3);
    let mut plan = plan(&sized);
    plan.settings.run.steps = 2_000;
    let learned = learn(&plan, seed, &AtomicBool::new(false), &|_| ()).unwrap();
    let values = learned.policy.rows().flat_map(|(_, row)| row.values.clone()).collect();
    (learned.tally.windows.iter().map(|window| window.endings.failures).collect(), values)
}

#[test]
fn rewards_times_128_or_a_64th_teach_the_same_to_the_bit() {
    for size in [128.0, 1.0 / 64.0] {
        let ((failures, values), (sized_failures, sized_values)) = (learned_at_size(1.0, 7), learned_at_size(size, 7));
        assert_eq!(failures, sized_failures, "rewards times {size}");
        assert!(values.iter().zip(&sized_values).all(|(value, sized)| value * size == *sized), "values times {size}");
    }
}

#[test]
fn rewards_times_100_or_a_50th_cost_the_same_punishments_within_one() {
    let mean = |size: f64| {
        let seeds = 1..=6;
        let punished: u64 = seeds.map(|seed| learned_at_size(size, seed).0.iter().sum::<u64>()).sum();
        punished as f64 / 6.0
    };
    let usual = mean(1.0);
    for size in [100.0, 0.02] {
        let sized = mean(size);
        assert!((sized - usual).abs() <= 1.0, "{sized} punishments with rewards times {size}, {usual} as they are");
    }
}
