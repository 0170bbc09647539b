//! Learned policies that a script uses: `use "dock" when ...;`

use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Bench, SCRIPT, assert_tested_again};

/// A policy with a view, stages, bins and actions of its own, whose step is twice as long.
pub(crate) const SLOW: &str = r#"world("small"); run(#{ steps: 800, test_steps: 400, period_s: 1.0 });
actions([[0.1, 0.0], [0.1, 0.5], [0.1, -0.5]]);
view("edges", filter("sobel", #{ threshold: 60 }), grid(#{ rows: 1, columns: 3 }));
state("edges", bins(laser.front, [1.0])); stages(["calm", "near"]);
rule "gets near" in "calm" when laser.nearest < 0.6 => 0 then stage "near";
rule "gets away" in "near" when laser.nearest > 0.7 => 0 then stage "calm";
rule "too close" when laser.nearest <= 0.25 => -1 then recover;
"#;
const NAMED: &str = "policy(\"slow\", \"runs/slow/1\");";

fn bench(uses: &str) -> Bench {
    let bench = Bench::new();
    bench.write("slow.rhai", SLOW);
    bench.engine(&["run", "slow.rhai"]);
    bench.write("mine.rhai", format!("{NAMED}\n{uses}\n{SCRIPT}"));
    bench
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn wrong(script: &str) -> String {
    let bench = bench("");
    bench.write("mine.rhai", script);
    bench.failure(&["run", "mine.rhai"])
}

#[test]
fn a_used_policy_drives_while_its_condition_holds_and_the_script_learns_the_rest() {
    let bench = bench("use \"slow\" when laser.front < 1.5;");
    let output = bench.engine(&["run", "mine.rhai"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("used:      slow drove "), "{text}");
    let summary = json(&bench.read("runs/mine/1/summary.json"));
    let used = &summary["uses"][0];
    assert_eq!((&used["name"], &used["behaviour"]), (&"slow".into(), &"slow".into()));
    let drove = used["drove"].as_f64().unwrap();
    assert!(drove > 0.02 && drove < 0.98 && used["takeovers_per_1000"].as_f64().unwrap() > 0.0, "{used}");
    // Every step is chosen by whom the condition says, with actions of the one that chose.
    let listed = json(&bench.ok(&["replay", "runs/mine/1", "--from", "0", "--to", "799", "--json"]));
    let steps = listed["listed"].as_array().unwrap();
    let slow = |step: &Value| step["used"] == "slow";
    assert!(steps.iter().all(|step| slow(step) == (step["motion"][0] == 0.1)), "each has actions of its own");
    let by_slow = steps.iter().filter(|step| slow(step)).count();
    assert!(by_slow > 10 && by_slow < 790, "{by_slow}");
    // Its step is twice as long: where it drives for two steps from the beginning of one, it does the same twice.
    let table: toml::Table = bench.read("runs/mine/1/policy.toml").parse().unwrap();
    let visits = table["state"].as_array().unwrap().iter().map(|state| state["visits"].as_integer().unwrap());
    assert_eq!(visits.sum::<i64>() as usize, steps.len() - by_slow);
}

#[test]
fn a_run_with_a_used_policy_comes_out_again_bit_for_bit_without_the_files_that_it_named() {
    let bench = bench("use \"slow\" when laser.front < 1.5;");
    bench.engine(&["run", "mine.rhai"]);
    std::fs::remove_dir_all(bench.path().join("runs/slow")).unwrap();
    assert!(bench.ok(&["replay", "runs/mine/1", "--verify"]).contains("bit for bit"));
    let summary = json(&bench.read("runs/mine/1/summary.json"));
    assert_tested_again(&summary, &bench.engine(&["test", "runs/mine/1", "--json"]).stdout);
    let run = bench.read("runs/mine/1/run.toml");
    assert!(run.contains("[[used]]") || run.contains("[used.policy]"), "the policy and its run are kept");
}

#[test]
fn a_step_of_a_used_policy_says_who_drove_and_why() {
    let bench = bench("use \"slow\" when laser.front < 1.5;");
    bench.engine(&["run", "mine.rhai"]);
    let listed = json(&bench.ok(&["replay", "runs/mine/1", "--from", "0", "--to", "799", "--json"]));
    let steps = listed["listed"].as_array().unwrap();
    let at = steps.iter().find(|step| step["motion"][0] == 0.1).unwrap()["step"].to_string();
    let told = bench.ok(&["explain", "runs/mine/1", "--step", &at]);
    assert!(told.contains("use:       \"slow\" (line 2) drives, since laser.front = "), "{told}");
    assert!(told.contains("stage \"calm\"") || told.contains("stage \"near\""), "{told}");
    let page = bench.read("runs/mine/1/report.html");
    assert!(page.contains("\"uses\":[{\"name\":\"slow\",\"line\":2}]"), "the page knows who may drive");
}

#[test]
fn a_script_whose_policy_always_drives_learns_nothing() {
    let bench = bench("use \"slow\";");
    let summary = json(&String::from_utf8(bench.engine(&["run", "mine.rhai", "--json"]).stdout).unwrap());
    assert_eq!((&summary["steps"], &summary["learned_at"]), (&0.into(), &Value::Null));
    assert_eq!(summary["uses"][0]["drove"], 1.0);
    assert!(!bench.path().join("runs/mine/1/policy.toml").exists());
    assert!(bench.ok(&["replay", "runs/mine/1", "--verify"]).contains("bit for bit"));
}

#[test]
fn a_used_policy_drives_in_a_stage() {
    let stages = "stages([\"far\", \"near\"]);\nuse \"slow\" in \"near\";\n\
                  rule \"gets near\" in \"far\" when laser.nearest < 0.6 => 0 then stage \"near\";\n\
                  rule \"gets far\" in \"near\" when laser.nearest > 0.65 => 0 then stage \"far\";";
    let bench = bench(stages);
    bench.engine(&["run", "mine.rhai"]);
    let summary = json(&bench.read("runs/mine/1/summary.json"));
    let drove = summary["uses"][0]["drove"].as_f64().unwrap();
    assert!(drove > 0.0 && drove < 1.0, "{drove}");
}

#[test]
fn a_use_of_an_unknown_policy() {
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slwo\" when robot.contact;\n{SCRIPT}")));
}

#[test]
fn a_policy_that_is_never_used() {
    let named = format!("{NAMED} policy(\"other\", \"runs/slow/1\");");
    assert_snapshot!(wrong(&format!("{named}\nuse \"slow\" when robot.contact;\n{SCRIPT}")));
}

#[test]
fn a_use_whose_condition_is_a_number() {
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" when laser.front;\n{SCRIPT}")));
}

#[test]
fn a_use_below_one_that_always_holds() {
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\";\nuse \"slow\" when robot.contact;\n{SCRIPT}")));
}

#[test]
fn a_use_in_a_stage_that_is_not_there() {
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" in \"near\";\n{SCRIPT}")));
}

#[test]
fn a_use_that_is_written_like_a_rule() {
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" when robot.contact => 1;\n{SCRIPT}")));
}

#[test]
fn a_used_policy_of_another_camera_and_another_laser() {
    let here = "camera(#{ tilt_deg: 30 }); laser(#{ beams: 91 });";
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" when robot.contact;\n{here}\n{SCRIPT}")));
}

#[test]
fn a_used_policy_of_another_body() {
    let here = "robot(\"turtlebot3\"); ";
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" when robot.contact;\n{here}\n{SCRIPT}")));
}

#[test]
fn a_used_policy_whose_step_is_no_whole_number_of_steps() {
    let script = SCRIPT.replace("test_steps: 400", "test_steps: 400, period_s: 0.4");
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" when robot.contact;\n{script}")));
}

#[test]
fn a_used_policy_without_its_run() {
    let bench = bench("use \"slow\" when robot.contact;");
    std::fs::remove_file(bench.path().join("runs/slow/1/run.toml")).unwrap();
    assert_snapshot!(bench.failure(&["run", "mine.rhai"]));
}

#[test]
fn a_script_that_uses_and_combines() {
    let call = "combine(\"sum\");";
    assert_snapshot!(wrong(&format!("{NAMED}\nuse \"slow\" when robot.contact;\n{call}\n{SCRIPT}")));
}

#[test]
fn a_policy_that_uses_policies_itself() {
    let bench = bench("use \"slow\" when laser.front < 1.5;");
    bench.engine(&["run", "mine.rhai"]);
    let named = "policy(\"mine\", \"runs/mine/1\");";
    bench.write("more.rhai", format!("{named}\nuse \"mine\" when robot.contact;\n{SCRIPT}"));
    assert_snapshot!(bench.failure(&["run", "more.rhai"]));
}

#[test]
fn a_run_that_used_a_policy_can_be_rescored() {
    let bench = bench("use \"slow\" when laser.front < 1.5;");
    bench.engine(&["run", "mine.rhai"]);
    let same = json(&bench.ok(&["rescore", "runs/mine/1", "mine.rhai", "--json"]));
    assert_eq!((&same["steps_changed"], &same["other_hands"]), (&0.into(), &0.into()));
    assert_eq!((&same["states_changed"], &same["reward_before"]), (&Value::Array(vec![]), &same["reward_after"]));
    // Another condition: whoever drove drives on, and it is told how often that is not what the script says.
    let other = format!("{NAMED}\nuse \"slow\" when laser.front < 0.3;\n{SCRIPT}");
    bench.write("other.rhai", other);
    let told = bench.ok(&["rescore", "runs/mine/1", "other.rhai"]);
    assert!(told.contains("another policy would have driven, or none; the recorded one drove on"), "{told}");
    // Without any use the steps of the other policy say nothing.
    bench.write("none.rhai", SCRIPT);
    assert!(bench.failure(&["rescore", "runs/mine/1", "none.rhai"]).contains("E-RESCORE"));
}
