use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{Learning, Ledger, Leg, Overrides, Plan, learn_into, rejudge};
use engine::learner::Carry;
use engine::script::Behaviour;
use serde_json::Value;

use crate::support::{Bench, SCRIPT, root};

const MEMORY: &str = "learner(#{ kind: \"memory\" });\n";
const SEED: u64 = 3;

/// A folder with a run of `short.rhai`, whose learner remembers its steps, and with another world.
fn remembered() -> Bench {
    let bench = Bench::new();
    bench.write("short.rhai", format!("{MEMORY}{SCRIPT}"));
    let wider = bench.read("worlds/small.toml").replace("description = \"", "description = \"Another: ");
    bench.write("worlds/other.toml", wider);
    run(&bench, &["short.rhai", "--out", "a"]);
    bench
}

fn run(bench: &Bench, arguments: &[&str]) {
    let output = bench.engine(&[&["run"], arguments].concat());
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&output.stderr));
}

fn refused(bench: &Bench, arguments: &[&str]) -> String {
    let output = bench.engine(&[&["run"], arguments].concat());
    assert_eq!(output.status.code(), Some(7));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn from(bench: &Bench, folder: &str) -> Value {
    serde_json::from_str::<Value>(&bench.read(&format!("{folder}/summary.json"))).unwrap()["from"].clone()
}

fn is_verified(bench: &Bench, folder: &str) -> bool {
    let output = bench.engine(&["replay", folder, "--verify", "--json"]);
    serde_json::from_slice::<Value>(&output.stdout).is_ok_and(|verified| verified["reproduced"] == true)
}

#[test]
fn a_run_goes_on_from_another_in_another_world_and_is_verified_from_its_own_folder_alone() {
    let bench = remembered();
    run(&bench, &["short.rhai", "--world", "worlds/other.toml", "--from", "a", "--out", "b"]);
    std::fs::remove_dir_all(bench.path().join("a")).unwrap();
    assert!(is_verified(&bench, "b"));
    let from = from(&bench, "b");
    assert_eq!(from["carried"], "kept the memory of 800 steps, forgot how often (another world)");
    assert_eq!((&from["steps"], from["run"].as_str().unwrap().contains("small, seed 1")), (&800.into(), true));
    assert!(bench.read("b/run.toml").starts_with("format = 5\n"));
    assert!(bench.read("b/report.html").contains("forgot how often (another world)"));
    // The first value of an action comes from steps of the run before.
    let told = bench.engine(&["explain", "b", "--step", "5", "--json"]);
    let told: Value = serde_json::from_slice(&told.stdout).unwrap();
    assert!(told["value"]["links"][1]["tries"].as_f64().unwrap() > 1.0);
    // ... and a run may go on from that again.
    run(&bench, &["short.rhai", "--from", "b", "--out", "c"]);
    assert!(is_verified(&bench, "c"));
    assert_eq!(self::from(&bench, "c")["steps"], 1600);
}

#[test]
fn what_its_filters_kept_goes_on_with_the_policy_and_is_there_in_every_step_again() {
    let bench = remembered();
    let filter = "filter(\"floor\", #{ memory: true });\ngrid(#{ occupied: 0.2 });\n";
    bench.write("floor.rhai", SCRIPT.replacen('\n', &format!("\n{filter}"), 1));
    let darker = bench.read("worlds/small.toml").replace("[120, 120, 120]", "[60, 60, 60]");
    bench.write("worlds/other.toml", darker);
    run(&bench, &["floor.rhai", "--out", "f"]);
    run(&bench, &["floor.rhai", "--from", "f", "--world", "worlds/other.toml", "--out", "g"]);
    run(&bench, &["floor.rhai", "--world", "worlds/other.toml", "--out", "h"]);
    let kept = |folder: &str, step: &str| {
        let told = bench.engine(&["explain", folder, "--step", step, "--json"]);
        let told: Value = serde_json::from_slice(&told.stdout).unwrap();
        told["kept"][0]["words"].as_str().unwrap().to_owned()
    };
    // What was driven over before is known at the first step, and not to who begins with nothing.
    assert!(kept("g", "0") != kept("h", "0"), "{}", kept("g", "0"));
    bench.engine(&["explain", "g", "--step", "799", "--json"]);
    assert!(is_verified(&bench, "g"));
}

#[test]
fn rules_of_another_form_judge_the_steps_anew_and_other_numbers_keep_all() {
    let bench = remembered();
    bench.write("nearer.rhai", format!("{MEMORY}{}", SCRIPT.replace("0.25", "0.3")));
    run(&bench, &["nearer.rhai", "--from", "a", "--out", "b"]);
    assert_eq!(from(&bench, "b")["carried"], "kept the memory of 800 steps, and how often");
    let lost = "rule \"lost\" when laser.nearest > 0.9 for 2 seconds => -1 then recover;\n";
    bench.write("lost.rhai", format!("{MEMORY}{SCRIPT}{lost}"));
    run(&bench, &["lost.rhai", "--from", "a", "--out", "c"]);
    assert_eq!(from(&bench, "c")["carried"], "judged the memory of 800 steps by the new rules, forgot how often");
    assert!(is_verified(&bench, "b") && is_verified(&bench, "c"));
}

#[test]
fn a_table_is_carried_on_as_it_is_and_each_seed_goes_on_from_its_own() {
    let bench = Bench::new();
    run(&bench, &["short.rhai", "--set", "learner.kind=ttd", "--seeds", "2", "--out", "a"]);
    run(&bench, &["short.rhai", "--set", "learner.kind=ttd", "--seeds", "2", "--from", "a", "--out", "b"]);
    let spread: Value = serde_json::from_str(&bench.read("b/summary.json")).unwrap();
    for seed in [1, 2] {
        let from = &spread["seeds"][seed - 1]["from"];
        assert_eq!(from["carried"], "kept the table and its visits");
        assert!(from["run"].as_str().unwrap().ends_with(&format!("seed {seed})")), "{from}");
        assert!(is_verified(&bench, &format!("b/{seed}")));
    }
    assert!(
        refused(
            &bench,
            &["short.rhai", "--set", "learner.kind=ttd", "--seed", "2", "--seeds", "2", "--from", "a", "--out", "c"]
        )
        .contains("'a' has no seed 3 to go on from")
    );
}

#[test]
fn what_does_not_fit_is_one_error() {
    let bench = remembered();
    let errors = [
        ("grid(#{ rows: 2, columns: 3 });\n", "has other states"),
        ("actions([[0.2, 0.0], [0.1, 0.4], [0.1, -0.4]]);\n", "has other actions"),
        ("filter(\"threshold\");\n", "has other filters"),
    ];
    for (call, wanted) in errors {
        bench.write("other.rhai", format!("{MEMORY}{call}{SCRIPT}"));
        let error = refused(&bench, &["other.rhai", "--from", "a", "--out", "b"]);
        assert!(error.starts_with("error[E-FROM]") && error.contains(wanted), "{error}");
        assert_eq!(error.matches("error[").count(), 1);
    }
    let error = refused(&bench, &["short.rhai", "--set", "learner.kind=q", "--from", "a", "--out", "b"]);
    assert!(error.contains("has other ways of learning: memory, here q"), "{error}");
    assert!(!bench.path().join("b").exists());
}

#[test]
fn a_run_that_does_not_come_out_as_it_was_recorded_is_not_gone_on_from() {
    let bench = remembered();
    run(&bench, &["short.rhai", "--from", "a", "--out", "b"]);
    let text = bench.read("b/run.toml");
    let hash = text.lines().find(|line| line.starts_with("state_hash = ")).unwrap().to_owned();
    bench.write("b/run.toml", text.replace(&hash, &format!("state_hash = \"{}\"", "0".repeat(64))));
    for file in ["log.bin", "summary.json"] {
        std::fs::remove_file(bench.path().join("b").join(file)).unwrap();
    }
    assert!(!is_verified(&bench, "b"));
}

/// `short.rhai` in the room, with more rules.
fn plan(rules: &str, steps: u64) -> Plan {
    let script = format!("{MEMORY}{}{rules}", SCRIPT.replace("small", "room"));
    let source = SourceText::new(root().join("scripts/own.rhai"), script);
    let overrides = Overrides { steps: Some(steps), ..Overrides::default() };
    Plan::new(Arc::new(Behaviour::parse("own", source).unwrap()), &overrides).unwrap()
}

const LOST: &str = "rule \"lost\" when laser.nearest > 0.9 for 2 seconds => -1 then recover;\n";

#[test]
fn the_same_rules_say_of_every_step_what_they_said() {
    let (plan, never) = (plan(LOST, 600), AtomicBool::new(false));
    let mut ledger = Ledger::new(&plan, 600);
    learn_into(&plan, SEED, &never, &|_| (), &mut ledger).unwrap();
    let said = rejudge(&plan, SEED, &ledger, &plan).unwrap();
    assert_eq!(said.len(), 600);
    for (record, one) in ledger.records().zip(&said) {
        let wanted = (record.state as usize, usize::from(record.action), record.reward, record.then.is_some());
        let transition = one.transition;
        assert_eq!((transition.state, transition.action, transition.reward, transition.ending.is_some()), wanted);
        assert_eq!(one.moved, record.then.is_some());
    }
    assert!(said.iter().any(|one| one.transition.next_potential < 0.0));
}

#[test]
fn a_swap_that_judges_the_steps_anew_is_the_same_live_as_from_the_plan_of_its_legs() {
    let (first, second, never) = (plan("", 600), plan(LOST, 300), AtomicBool::new(false));
    assert_eq!(first.carries_to(&second), Carry::Rescore);
    let mut ledger = Ledger::new(&first, 600);
    let mut learning = Learning::new(&first, SEED).unwrap();
    learning.run(600, &never, &|_| (), &mut ledger).unwrap();
    let said = rejudge(&first, SEED, &ledger, &second).unwrap();
    learning.swap_rejudged(&second, Carry::Rescore, &said, &mut ledger).unwrap();
    learning.run(300, &never, &|_| (), &mut ledger).unwrap();
    let leg = Leg { plan: first, steps: 600, then: Carry::Rescore };
    let legs = second.after(vec![leg]);
    let learned = learn_into(&legs, SEED, &never, &|_| (), &mut Ledger::off()).unwrap();
    assert_eq!(learned.state_hash, learning.finish().state_hash);
}
