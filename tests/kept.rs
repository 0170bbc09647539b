//! Nothing that a folder holds is written over, tagged away or forged without a word.

use crate::support::{Bench, SCRIPT};

#[test]
fn one_seed_and_many_do_not_replace_one_another() {
    let bench = Bench::new();
    let run = |more: &[&str]| bench.failure(&[&["run", "short.rhai", "--out", "q"], more].concat());
    run(&[]);
    let told = run(&["--seeds", "3"]);
    assert!(told.starts_with("exit status 6\n") && told.contains("E-RUN-TAKEN"), "{told}");
    run(&["--seeds", "3", "--force"]);
    assert!(!bench.path().join("q/log.bin").exists() && bench.path().join("q/3/log.bin").exists());
    for other in [&["--seeds", "2"][..], &[]] {
        assert!(run(other).contains("E-RUN-TAKEN"), "{other:?}");
    }
    run(&["--seeds", "2", "--force"]);
    assert!(!bench.path().join("q/3").exists() && bench.path().join("q/2/log.bin").exists());
}

#[test]
fn a_test_writes_over_no_run_and_over_no_other_test() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "q"]);
    let test = |more: &[&str]| bench.failure(&[&["test", "q", "--out"], more].concat());
    assert!(test(&["q"]).contains("holds a run"), "{}", test(&["q"]));
    test(&["x"]);
    let first = bench.read("x/test.json");
    assert!(test(&["x", "--steps", "100"]).contains("E-RUN-TAKEN"));
    assert_eq!(bench.read("x/test.json"), first);
    test(&["x", "--steps", "100", "--force"]);
    assert_ne!(bench.read("x/test.json"), first);
}

#[test]
fn a_table_of_other_values_is_no_policy_of_the_run_whatever_its_digest_line_says() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "a"]);
    bench.engine(&["run", "short.rhai", "--seed", "2", "--out", "b"]);
    let own = bench.read("a/policy.toml");
    let line = |text: &str| text.lines().find(|line| line.starts_with("run_sha256")).unwrap().to_owned();
    let other = bench.read("b/policy.toml");
    bench.write("a/policy.toml", other.replace(&line(&other), &line(&own)));
    let both = format!("policy(\"one\", \"a\");\npolicy(\"two\", \"b\");\n{SCRIPT}");
    bench.write("both.rhai", both.replace("steps: 800, ", ""));
    for command in [
        &["test", "a"][..],
        &["compare", "a", "b"],
        &["replay", "a"],
        &["explain", "a", "--step", "3"],
        &["rescore", "a", "short.rhai"],
        &["run", "short.rhai", "--from", "a", "--out", "c"],
        &["run", "short.rhai", "--branch", "a@10", "--out", "c"],
        &["run", "both.rhai", "--out", "c"],
    ] {
        let told = bench.failure(command);
        assert!(told.starts_with("exit status 7\n") && told.contains("E-LOG-RUN"), "{command:?}: {told}");
        assert!(told.contains("does not hold what"), "{command:?}: {told}");
    }
    // One changed value is enough.
    let visits = own.lines().find(|line| line.starts_with("visits")).unwrap();
    bench.write("a/policy.toml", own.replacen(visits, "visits = 77777", 1));
    assert!(bench.failure(&["test", "a"]).contains("E-LOG-RUN"));
    // What was written before digests were kept is read, and what stands alone belongs to nobody.
    let summary = bench.read("a/summary.json");
    let older: Vec<&str> = summary.lines().filter(|line| !line.contains("policy_sha256")).collect();
    bench.write("a/summary.json", older.join("\n"));
    assert!(!bench.failure(&["test", "a"]).contains("E-LOG-RUN"));
    bench.write("a/policy.toml", &own);
    assert!(bench.ok(&["replay", "a", "--verify"]).contains("reproduced bit for bit"));
    for file in ["summary.json", "log.bin"] {
        std::fs::remove_file(bench.path().join("a").join(file)).unwrap();
    }
    bench.write("a/policy.toml", own.replacen(visits, "visits = 77777", 1));
    assert!(!bench.failure(&["test", "a"]).contains("E-LOG-RUN"));
}

#[test]
fn a_tagged_run_makes_room_for_another_one_and_keeps_what_was_said_of_it() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "q"]);
    bench.ok(&["runs", "tag", "q", "best"]);
    bench.engine(&["rescore", "q", "short.rhai"]);
    bench.engine(&["run", "short.rhai", "--out", "q"]);
    assert_eq!((bench.read("q/tag.txt").as_str(), bench.path().join("q.2").exists()), ("best\n", false));
    let told = bench.engine(&["run", "short.rhai", "--seed", "2", "--out", "q", "--force"]);
    assert!(String::from_utf8_lossy(&told.stderr).contains("has a tag: it is kept, in q.2"), "{told:?}");
    assert!(bench.read("q.2/run.toml").contains("seed = 1\n") && bench.read("q/run.toml").contains("seed = 2\n"));
    assert_eq!(bench.read("q.2/tag.txt"), "best\n");
    assert!(bench.path().join("q.2/rescore-short/rescore.json").exists());
    assert!(!bench.path().join("q/tag.txt").exists() && !bench.path().join("q/rescore-short").exists());
}

#[test]
fn photographs_are_not_drawn_into_the_folder_of_a_run_or_a_test() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "q"]);
    bench.engine(&["test", "q", "--out", "x"]);
    for out in ["q", "x"] {
        let told = bench.failure(&["filter", "short.rhai", "q/frame.png", "--out", out]);
        assert!(told.starts_with("exit status 6\n") && told.contains("E-RUN-TAKEN"), "{told}");
    }
}

#[test]
fn a_policy_is_not_tested_with_states_that_mean_something_else() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "q"]);
    let told = bench.failure(&["test", "q", "--set", "grid.rows=4"]);
    assert!(told.starts_with("exit status 7\n") && told.contains("E-POLICY-FILE"), "{told}");
    let told = bench.failure(&["test", "q", "--set", "learner.kind=q"]);
    assert!(told.contains("E-SET") && told.contains("nothing is learned in a test"), "{told}");
    assert!(!bench.failure(&["test", "q", "--set", "camera.noise=2"]).contains("error"));
}

#[test]
fn every_seed_and_the_figures_above_them_are_verified() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--seeds", "2", "--out", "q"]);
    assert!(bench.ok(&["replay", "q", "--verify"]).contains("2 seeds, and every figure above them"));
    let summary = bench.read("q/summary.json");
    bench.write("q/summary.json", summary.replacen("\"successes\": ", "\"successes\": 1", 1));
    assert!(bench.failure(&["replay", "q", "--verify"]).contains("successes is 1"));
    bench.write("q/summary.json", &summary);
    let one = bench.read("q/1/summary.json");
    bench.write("q/1/summary.json", one.replacen('{', "{ \"extra\": 1,", 1));
    assert!(bench.failure(&["replay", "q/1", "--verify"]).contains("extra is 1 there"));
    bench.write("q/1/summary.json", &one);
    std::fs::remove_file(bench.path().join("q/1/curve.csv")).unwrap();
    assert!(bench.failure(&["replay", "q/1", "--verify"]).contains("curve.csv"));
}

#[test]
fn a_script_whose_name_is_dots_goes_to_no_folder_above() {
    let bench = Bench::new();
    bench.write("...rhai", bench.read("short.rhai"));
    let told = bench.failure(&["run", "...rhai"]);
    assert!(told.starts_with("exit status 3\n") && told.contains("no name but dots"), "{told}");
}

#[test]
fn what_does_not_load_is_told_as_json_where_findings_are() {
    let bench = Bench::new();
    bench.write("bad.rhai", "world(\"small\"); rule \"a\" when laser.rigth < 1 => -1;");
    let output = bench.engine(&["check", "bad.rhai", "--format", "json"]);
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((told["findings"][0]["code"].as_str(), output.status.code()), (Some("E-SCRIPT-FACT"), Some(3)));
    assert!(output.stderr.is_empty());
}

#[test]
fn seeds_do_not_begin_anew_after_the_last() {
    let bench = Bench::new();
    let told = bench.failure(&["run", "short.rhai", "--seed", "18446744073709551615", "--seeds", "2"]);
    assert!(told.starts_with("exit status ") && told.contains("choose a lesser --seed"), "{told}");
}
