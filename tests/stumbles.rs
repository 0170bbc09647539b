//! What people stumbled over: each is told where it stands, with what to type next.

use serde_json::Value;

use crate::support::{Bench, SCRIPT, WORLD};

/// What `engine check` says of a script.
fn checked(script: &str, further: &[&str]) -> String {
    let bench = Bench::new();
    bench.write("mine.rhai", script);
    let output = bench.engine(&[&["check", "mine.rhai"], further].concat());
    String::from_utf8_lossy(&output.stdout).into_owned() + &*String::from_utf8_lossy(&output.stderr)
}

/// Asserts that a script is told these texts, all of them.
fn assert_told(script: &str, texts: &[&str]) {
    let told = checked(script, &[]);
    for text in texts {
        assert!(told.contains(text), "{text}\n{told}");
    }
}

#[test]
fn every_world_that_is_not_there_is_marked_at_its_own_name() {
    let script = format!("worlds([\"small\", \"smal\", \"bigg\"]);\n{}", without_world());
    assert_told(&script, &["'smal'", "^^^^^^ not found", "'bigg'", "2 mistakes", ":1:18", ":1:26"]);
    let weights = format!("worlds(#{{ \"small\": 2, \"smal\": 1 }});\n{}", without_world());
    assert_told(&weights, &["'smal'", ":1:23", "did you mean \"small\"?"]);
}

#[test]
fn what_is_no_name_of_a_world_is_told_as_that() {
    let script = format!("worlds([\"small\", 3]);\n{}", without_world());
    assert_told(&script, &["the name of a world must be a text in quotes", ":1:18"]);
    let twice = format!("worlds([\"small\", \"small\"]);\n{}", without_world());
    assert_told(&twice, &["listed twice", ":1:18"]);
}

#[test]
fn every_policy_that_is_not_there_is_told() {
    let policies = "policy(\"a\", \"runs/none/1\");\npolicy(\"b\", \"runs/nope/1\");\n";
    for uses in ["", "use \"a\" when laser.front < 1.0;\nuse \"b\" when laser.front > 2.0;\n"] {
        let bench = Bench::new();
        bench.write("mine.rhai", format!("{policies}{uses}{SCRIPT}"));
        let told = bench.failure(&["run", "mine.rhai"]);
        for text in ["policy \"a\" is not there", "policy \"b\" is not there", ":1:1", ":2:1", "2 mistakes"] {
            assert!(told.contains(text), "{text}\n{told}");
        }
    }
}

#[test]
fn what_every_world_lacks_is_told_at_once() {
    let bench = Bench::new();
    bench.write("worlds/other.toml", WORLD);
    let success =
        "success \"a\" when test.visits_per_1000(\"red\") > 1;\nsuccess \"b\" when test.gates_per_1000 > 1;\n";
    bench.write("mine.rhai", format!("worlds([\"small\", \"other\"]);\n{success}{}", without_world()));
    let told = bench.failure(&["check", "mine.rhai"]);
    assert!(told.contains("no place \"red\"") && told.contains("no gates") && told.contains("2 mistakes"), "{told}");
}

#[test]
fn a_guard_and_a_use_that_can_never_hold_are_told_as_rules_are() {
    let guard = format!("{SCRIPT}forbid \"ahead\" when laser.nearest < 0.1 => action.linear > 0.3;\n");
    assert_told(&guard, &["E-SCRIPT-GUARD", "guard \"ahead\" can never hold", "this is always between 0.2 and "]);
    let used = format!("policy(\"a\", \"runs/a/1\");\nuse \"a\" when laser.front > 99.0;\n{SCRIPT}");
    assert_told(&used, &["E-SCRIPT-USE", "this use of \"a\" can never hold", ":2:14"]);
}

#[test]
fn a_constant_that_is_not_finite_is_told_where_it_is_written() {
    assert_told(
        &format!("const n = 1.0 / 0.0;\n{SCRIPT}"),
        &["this gives no finite number", ":1:11", "always infinite"],
    );
    assert_told(&format!("const n = 1e308 * 10.0;\n{SCRIPT}"), &["this gives no finite number", ":1:11"]);
    assert_told(&format!("const n = 0.0 / 0.0;\n{SCRIPT}"), &["this gives no number", "always NaN"]);
}

#[test]
fn what_is_drawn_and_has_no_effect_is_found() {
    let script =
        format!("randomise(#{{ \"recovery.distance_m\": [1.0, 2.0], \"movers.speed\": [1.0, 2.0] }});\n{SCRIPT}");
    let texts = ["recovery.distance_m is drawn for each attempt", "movers.speed is drawn for each attempt", "W-UNUSED"];
    assert_told(&script, &texts);
}

#[test]
fn a_goal_of_which_nothing_came_into_sight_is_found() {
    let goal = "rule \"there\" when ground.saturation > 0.5 && laser.front < 1.0 => 1 then goal;\n";
    assert_told(
        &format!("{SCRIPT}{goal}"),
        &["W-RULE-NEVER", "the goal of rule \"there\" was never met", "ground.saturation was 0.00 to 0.00"],
    );
}

#[test]
fn a_condition_of_the_filter_where_stands_alone() {
    let script = format!("world(\"small\");\nfilter(\"where\", #{{ condition: \"r > 5\" }});\n{}", without_world());
    assert_told(
        &script,
        &["'condition' is no parameter of filter \"where\"", "write filter(\"where\", \"r > 5\");", ":2:20"],
    );
    let number = format!("world(\"small\");\nfilter(\"where\", 3);\n{}", without_world());
    assert_told(&number, &["write filter(\"where\", \"r > 1.5 * g && r > 60\");"]);
}

#[test]
fn a_truth_value_of_another_language_is_answered_in_a_world() {
    let bench = Bench::new();
    bench.write("worlds/small.toml", WORLD.replacen("closed = true", "closed = yes", 1));
    let told = bench.failure(&["check", "short.rhai"]);
    assert!(told.contains("closed = yes") && told.contains("help: write true"), "{told}");
}

#[test]
fn a_key_that_is_set_twice_is_refused() {
    let bench = Bench::new();
    let told = bench.failure(&["run", "short.rhai", "--set", "run.steps=400", "--set", "run.steps=800"]);
    assert!(told.contains("'run.steps' is set twice") && told.contains("keep one of the two"), "{told}");
}

#[test]
fn settings_of_a_view_are_found_under_its_name() {
    let told = checked(&format!("view(\"red\", filter(\"colour\"));\n{SCRIPT}"), &["--set", "view.red.rows=2"]);
    assert!(told.contains("write --set red.rows=2"), "{told}");
    let told = checked(SCRIPT, &["--set", "view.red.rows=2"]);
    assert!(told.contains("--set grid.rows=3"), "{told}");
}

#[test]
fn a_cheat_that_pays_is_marked_at_the_rule_that_pays_it() {
    let bench = Bench::new();
    let pays = "rule \"turns\" when action.angular > 0.3 => 1;\n";
    bench.write("mine.rhai", format!("{SCRIPT}{pays}"));
    let report: Value = serde_json::from_slice(&bench.engine(&["check", "mine.rhai", "--json"]).stdout).unwrap();
    let found = report["findings"].as_array().unwrap().iter().find(|one| one["code"] == "W-EXPLOIT").unwrap();
    let line = 1 + SCRIPT.lines().count();
    assert_eq!(found["line"], line, "{found}");
}

#[test]
fn what_somebody_put_into_a_run_stays_when_it_is_pruned() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    bench.write("runs/short/1/notes.md", "mine");
    let told = bench.ok(&["runs", "prune", "--yes"]);
    assert!(told.contains("kept:      runs/short/1/notes.md"), "{told}");
    assert!(bench.read("runs/short/1/notes.md") == "mine" && !bench.path().join("runs/short/1/run.toml").exists());
}

#[test]
fn a_step_that_once_keeps_silent_says_so() {
    let bench = Bench::new();
    bench.write("mine.rhai", format!("{SCRIPT}rule \"moves\" when laser.nearest > 0.2 once => 0.1;\n"));
    bench.engine(&["run", "mine.rhai"]);
    let told = bench.ok(&["explain", "runs/mine/1", "--step", "1", "--test"]);
    assert!(told.contains("'once': it has fired, and its condition has held ever since"), "{told}");
}

#[test]
fn a_test_in_several_worlds_has_figures_of_each() {
    let bench = Bench::new();
    bench.write("worlds/other.toml", WORLD);
    bench.write(
        "mine.rhai",
        format!("worlds([\"small\", \"other\"]);\nrun(#{{ stay_steps: 40 }});\n{}", without_world()),
    );
    let told = bench.engine(&["run", "mine.rhai"]);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("worlds:    "), "{told}");
    let summary: Value = serde_json::from_str(&bench.read("runs/mine/1/summary.json")).unwrap();
    let worlds = summary["worlds"].as_array().unwrap();
    let sum = |key: &str| worlds.iter().map(|world| world[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!((worlds[0]["world"].as_str(), worlds[1]["world"].as_str()), (Some("small"), Some("other")));
    assert_eq!(
        (sum("steps"), sum("failures")),
        (summary["test"]["steps"].as_u64().unwrap(), summary["test"]["failures"].as_u64().unwrap())
    );
    assert!(worlds.iter().all(|world| world["steps"].as_u64().unwrap() >= 40));
    bench.ok(&["replay", "runs/mine/1", "--verify"]);
}

/// The short script without the name of its world.
fn without_world() -> String {
    SCRIPT.replacen("world(\"small\");", "", 1)
}
