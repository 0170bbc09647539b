//! Nothing that a folder holds is written over, tagged away or forged without a word.

use crate::support::Bench;

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
