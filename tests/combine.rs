use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Bench, SCRIPT};

/// Two policies of the short behaviour, each with a filter of its own, and a script that combines them.
fn bench(way: &str) -> Bench {
    let bench = Bench::new();
    bench.write("left.rhai", format!("{SCRIPT}\nfilter(\"sobel\", #{{ threshold: 60 }}); learner(\"ttd\");"));
    bench.write(
        "right.rhai",
        format!("{SCRIPT}\nfilter(\"sobel\", #{{ threshold: 90 }}); grid(#{{ occupied: 0.03 }}); learner(\"ttd\");"),
    );
    bench.engine(&["run", "left.rhai"]);
    bench.engine(&["run", "right.rhai", "--seed", "2"]);
    let policies = "policy(\"left\", \"runs/left/1\"); policy(\"right\", \"runs/right/2/policy.toml\");";
    bench.write("both.rhai", format!("{policies}\n{way}\n{SCRIPT}"));
    bench
}

fn json(bench: &Bench, arguments: &[&str]) -> Value {
    serde_json::from_slice(&bench.engine(arguments).stdout).unwrap()
}

fn combine(call: &str) -> String {
    let bench = Bench::new();
    bench.write("mine.rhai", format!("{SCRIPT}{call}\n"));
    bench.failure(&["run", "mine.rhai"])
}

/// The error of combining after a policy's file was changed.
fn damaged(from: &str, to: &str) -> String {
    let bench = bench("");
    let text = bench.read("runs/left/1/policy.toml");
    assert!(text.contains(from), "{text}");
    bench.write("runs/left/1/policy.toml", text.replacen(from, to, 1));
    bench.failure(&["run", "both.rhai"])
}

#[test]
fn a_combination_is_tested_and_leaves_its_files() {
    let bench = bench("combine(\"priority\", #{ margin: 0.01 });");
    let output = bench.engine(&["run", "both.rhai"]);
    assert!(output.status.code().unwrap() <= 1, "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("combined:  priority, decided by left ") && text.contains("disagree:  "), "{text}");
    let mut names: Vec<String> = std::fs::read_dir(bench.path().join("runs/both/1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let wanted = "disagreements.csv frame.png frame.svg log.bin report.html run.toml summary.json trajectories.png trajectories.svg";
    assert_eq!(names.join(" "), wanted);
}

#[test]
fn the_summary_tells_who_decided_and_where_they_disagree() {
    let bench = bench("combine(\"priority\", #{ margin: 0.01 });");
    let summary = json(&bench, &["run", "both.rhai", "--json"]);
    assert_eq!(summary["learned_at"], Value::Null);
    assert_eq!((&summary["steps"], &summary["test"]["steps"]), (&0.into(), &400.into()));
    let told = &summary["combination"];
    assert_eq!((&told["policies"][0]["name"], &told["policies"][1]["behaviour"]), (&"left".into(), &"right".into()));
    let decided = |policy: usize| told["policies"][policy]["decided"].as_f64().unwrap();
    assert!((decided(0) + decided(1) - 1.0).abs() < 1e-12);
    // Two policies that disagree do so in as many steps as their pairs of states count.
    let table = bench.read("runs/both/1/disagreements.csv");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let steps = |row: &Vec<&str>, column: usize| row[column].parse::<u64>().unwrap();
    let all: u64 = rows.iter().map(|row| steps(row, 10)).sum();
    assert!(all > 0 && (told["disagree"].as_f64().unwrap() * 400.0 - all as f64).abs() < 1e-9);
    assert_eq!(told["disagreements"], rows.len());
    for row in &rows {
        assert!(row[0] == "left" && row[1] == "right" && row[4] != row[7], "{row:?}");
        // By priority of two that both know their states, exactly one of them wins.
        assert_eq!(steps(row, 10), steps(row, 11) + steps(row, 12), "{row:?}");
    }
}

#[test]
fn a_margin_decides_who_decides() {
    let bench = bench("");
    let decided = |margin: &str| {
        let set = format!("combine.margin={margin}");
        let summary = json(&bench, &["run", "both.rhai", "--json", "--set", &set]);
        summary["combination"]["policies"][1]["decided"].as_f64().unwrap()
    };
    assert_eq!(decided("1000"), 1.0);
    assert!(decided("0") < 0.1);
}

#[test]
fn a_sum_has_no_decider() {
    let bench = bench("combine(\"sum\", #{ scaled: true });");
    let summary = json(&bench, &["run", "both.rhai", "--json"]);
    assert_eq!(summary["combination"]["way"], "sum");
    assert_eq!(summary["combination"]["policies"][0]["decided"], Value::Null);
}

#[test]
fn the_last_of_two_decides_as_if_it_were_alone() {
    let bench = bench("combine(\"priority\", #{ margin: 1000 });");
    let summary = json(&bench, &["run", "both.rhai", "--json", "--seed", "2"]);
    let alone = json(&bench, &["test", "runs/right/2", "--json"]);
    assert_eq!(summary["test"]["distance_m"], alone["distance_m"]);
}

#[test]
fn a_combination_is_tested_again_from_its_folder_alone() {
    let bench = bench("");
    let summary = json(&bench, &["run", "both.rhai", "--json", "--out", "kept"]);
    for gone in ["runs", "worlds"] {
        std::fs::remove_dir_all(bench.path().join(gone)).unwrap();
    }
    std::fs::remove_file(bench.path().join("both.rhai")).unwrap();
    crate::support::assert_tested_again(&summary, &bench.engine(&["test", "kept", "--json"]).stdout);
}

#[test]
fn the_same_seed_combines_to_the_same_bytes_on_any_number_of_threads() {
    let bench = bench("combine(\"sum\");");
    bench.engine(&["run", "both.rhai", "--seeds", "2", "--threads", "1", "--out", "a"]);
    bench.engine(&["run", "both.rhai", "--seeds", "2", "--threads", "2", "--out", "b"]);
    for file in ["1/disagreements.csv", "2/disagreements.csv", "2/run.toml", "1/trajectories.svg", "2/frame.png"] {
        let read = |folder: &str| std::fs::read(bench.path().join(folder).join(file)).unwrap();
        assert!(read("a") == read("b"), "{file}");
    }
    bench.engine(&["run", "both.rhai", "--seed", "2", "--out", "alone"]);
    assert_eq!(bench.read("a/2/disagreements.csv"), bench.read("alone/disagreements.csv"));
}

// Mistakes

#[test]
fn one_policy_alone() {
    assert_snapshot!(combine("policy(\"left\", \"runs/left/1\");"));
}

#[test]
fn two_policies_of_one_name() {
    assert_snapshot!(combine("policy(\"left\", \"runs/left/1\");\npolicy(\"left\", \"runs/left/2\");"));
}

#[test]
fn combining_without_policies() {
    assert_snapshot!(combine("combine(\"sum\");"));
}

#[test]
fn a_way_of_combining_that_is_not_there() {
    assert_snapshot!(combine("combine(\"vote\");"));
}

#[test]
fn a_policy_without_a_path() {
    assert_snapshot!(combine("policy(\"left\");"));
}

#[test]
fn a_missing_policy_is_answered_with_the_command_that_makes_it() {
    let bench = Bench::new();
    bench.write("both.rhai", format!("policy(\"a\", \"runs/short/1\");\npolicy(\"b\", \"runs/short/2\");\n{SCRIPT}"));
    assert_snapshot!(bench.failure(&["run", "both.rhai"]));
    bench.engine(&["run", "short.rhai"]);
    assert_snapshot!(bench.failure(&["run", "both.rhai"]));
}

#[test]
fn a_missing_policy_of_nobody_knows_what() {
    assert_snapshot!(combine("policy(\"a\", \"good.toml\");\npolicy(\"b\", \"better.toml\");"));
}

#[test]
fn a_policy_on_another_grid() {
    let bench = bench("grid(#{ rows: 2 });");
    assert_snapshot!(bench.failure(&["run", "both.rhai"]));
}

#[test]
fn a_policy_on_a_grid_with_column_fill() {
    let bench = bench("grid(#{ fill: false });");
    assert_snapshot!(bench.failure(&["run", "both.rhai"]));
}

#[test]
fn a_policy_with_other_actions() {
    let bench = bench("actions([[0.4, 0.2], [0.4, 0.0]]);");
    assert_snapshot!(bench.failure(&["run", "both.rhai"]));
}

#[test]
fn a_policy_with_one_action_that_differs() {
    assert_snapshot!(damaged("[0.4, 0.2]", "[0.4, 0.25]"));
}

#[test]
fn a_policy_with_a_damaged_line() {
    assert_snapshot!(damaged("visits = ", "visits = x"));
}

#[test]
fn a_policy_of_an_older_engine() {
    assert_snapshot!(damaged("format = 2", "format = 1"));
}

#[test]
fn steps_of_learning_for_a_combination() {
    let bench = bench("");
    assert_snapshot!(bench.failure(&["run", "both.rhai", "--steps", "400"]));
}
