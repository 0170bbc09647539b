use serde_json::Value;

use crate::support::Bench;

/// A bench with a run of three seeds, and one of three under another rule and another tilt.
fn runs() -> Bench {
    let bench = Bench::new();
    bench.write("other.rhai", bench.read("short.rhai").replace("0.25", "0.35"));
    bench.engine(&["run", "short.rhai", "--seeds", "3", "--out", "a"]);
    bench.engine(&["run", "other.rhai", "--seeds", "3", "--out", "b", "--set", "camera.tilt_deg=36"]);
    bench
}

#[test]
fn a_comparison_tells_figures_changes_and_states() {
    let bench = runs();
    let output = bench.engine(&["compare", "a", "b", "--json", "--out", "c"]);
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), &told["runs"][1]), (Some(0), &"b".into()));
    assert_eq!((&told["success"][0]["seeds"], &told["success"][0]["chance"]), (&3.into(), &Value::Null));
    assert!(told["success"][1]["chance"].as_f64().unwrap() <= 1.0);
    let failures = told["figures"].as_array().unwrap().iter().find(|one| one["name"] == "failures per 1000").unwrap();
    let summary: Value = serde_json::from_str(&bench.read("a/summary.json")).unwrap();
    assert_eq!(failures["sides"][0]["median"], summary["median"]["failures_per_1000"]);
    let settings = told["changes"][0]["settings"].as_array().unwrap();
    let tilt = settings.iter().find(|one| one["name"] == "camera.tilt_deg").unwrap();
    assert_eq!(tilt["after"], "36");
    let lines = told["changes"][0]["lines"].as_array().unwrap();
    assert!(
        lines.iter().any(|line| line["added"] == true && line["text"].as_str().unwrap().contains("0.35")),
        "{lines:?}"
    );
    assert!(told["states"][0]["both_met"].as_u64().unwrap() > 0);
    let page = bench.read("c/compare.html");
    for words in ["<td>1 to 3</td>", "half of the seeds lie in it", "may be those of different seeds"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("The runs have different seeds"));
    assert!(page.contains("<svg") && page.contains("camera.tilt_deg") && page.contains("0.35"));
    let again = bench.engine(&["compare", "a", "b", "--json", "--out", "d"]);
    assert_eq!((again.stdout, bench.read("d/compare.html")), (output.stdout, page), "the same runs, the same page");
}

#[test]
fn a_run_beside_itself_differs_in_nothing() {
    let bench = runs();
    let told: Value = serde_json::from_slice(&bench.engine(&["compare", "a", "a", "--json"]).stdout).unwrap();
    assert_eq!(told["changes"][0], serde_json::json!({ "settings": [], "lines": [] }));
    assert_eq!(told["states"][0]["differ"], 0);
    for figure in told["figures"].as_array().unwrap() {
        assert_eq!(figure["sides"][1]["chance"], 1.0, "{figure}");
    }
}

#[test]
fn many_runs_fold_their_changes_and_runs_of_other_seeds_are_told() {
    let bench = runs();
    bench.engine(&["run", "short.rhai", "--seed", "7", "--out", "d"]);
    bench.engine(&["compare", "a", "b", "a", "b", "d", "--out", "c"]);
    let page = bench.read("c/compare.html");
    assert_eq!(page.matches("<details>").count(), 8);
    for words in
        ["The runs have different seeds", "the bands of the quartiles are left out", "Compared: a and 4 others"]
    {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn what_cannot_be_compared_is_told_with_what_can() {
    let bench = runs();
    let one = bench.failure(&["compare", "a"]);
    assert!(one.starts_with("exit status 3\n") && one.contains("E-COMPARE"), "{one}");
    bench.write("shelf/readme", "");
    for run in ["shelf/2", "shelf/10"] {
        bench.engine(&["run", "short.rhai", "--out", run]);
    }
    let above = bench.failure(&["compare", "shelf", "a"]);
    assert!(
        above.starts_with("exit status 7\n") && above.contains("it holds the runs 2, 10: write shelf/2"),
        "{above}"
    );
}

#[test]
fn runs_are_listed_tagged_and_pruned() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    bench.engine(&["run", "short.rhai", "--seed", "2"]);
    let list =
        |bench: &Bench| -> Vec<Value> { serde_json::from_slice(&bench.engine(&["runs", "--json"]).stdout).unwrap() };
    assert_eq!(list(&bench).len(), 2);
    bench.engine(&["runs", "tag", "runs/short/2", "best"]);
    let tags: Vec<Value> = list(&bench).iter().map(|run| run["tag"].clone()).collect();
    assert_eq!(tags, [Value::Null, "best".into()]);
    bench.engine(&["runs", "prune"]);
    assert_eq!(list(&bench).len(), 2, "nothing goes without --yes");
    bench.engine(&["runs", "prune", "--older", "1", "--yes"]);
    assert_eq!(list(&bench).len(), 2, "nothing is a day old");
    bench.engine(&["runs", "prune", "--yes"]);
    assert_eq!(list(&bench)[0]["tag"], "best");
    assert_eq!(list(&bench).len(), 1);
}

#[test]
fn many_seeds_are_told_in_their_order_and_as_many_must_succeed_as_are_asked_for() {
    let bench = Bench::new();
    let output = bench.engine(&["run", "short.rhai", "--seeds", "5", "--threads", "2"]);
    let told = String::from_utf8(output.stderr).unwrap();
    let seeds: Vec<&str> = told.lines().filter_map(|line| line.strip_prefix("seed ")?.split(':').next()).collect();
    assert_eq!(seeds, ["1", "2", "3", "4", "5"]);
    let summary: Value = serde_json::from_str(&bench.read("runs/short/1-5/summary.json")).unwrap();
    let share = summary["successes"].as_f64().unwrap() / 5.0;
    let status = |enough: f64| {
        let enough = enough.to_string();
        bench.engine(&["run", "short.rhai", "--seeds", "5", "--enough", &enough]).status.code()
    };
    assert_eq!(status(share), Some(0));
    if share < 1.0 {
        assert_eq!(status(share + 0.1), Some(1));
    }
    assert!(bench.failure(&["run", "short.rhai", "--enough", "1.5"]).starts_with("exit status 2\n"));
}
