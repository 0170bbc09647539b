use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use dispatch::Processor;
use engine::experiment::{Overrides, Plan, learn};
use engine::script::Behaviour;

use crate::support::{Bench, root};

fn hash(text: &str) -> String {
    let summary: serde_json::Value = serde_json::from_str(text).unwrap();
    summary["state_hash"].as_str().unwrap().to_owned()
}

fn run(bench: &Bench, arguments: &[&str]) -> serde_json::Value {
    let mut all = vec!["run", "short.rhai", "--json"];
    all.extend(arguments);
    serde_json::from_slice(&bench.engine(&all).stdout).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let bench = Bench::new();
    run(&bench, &["--out", "a"]);
    run(&bench, &["--out", "b"]);
    for file in ["policy.toml", "curve.csv", "run.toml", "learning-curve.svg", "trajectories.png", "frame.png"] {
        let read = |folder: &str| std::fs::read(bench.path().join(folder).join(file)).unwrap();
        assert!(read("a") == read("b"), "{file}");
    }
    assert_eq!(hash(&bench.read("a/summary.json")), hash(&bench.read("b/summary.json")));
}

#[test]
fn another_seed_gives_another_run() {
    let bench = Bench::new();
    run(&bench, &["--out", "a"]);
    run(&bench, &["--seed", "2", "--out", "b"]);
    assert_ne!(hash(&bench.read("a/summary.json")), hash(&bench.read("b/summary.json")));
}

#[test]
fn one_thread_and_two_learn_the_same() {
    let bench = Bench::new();
    let hashes = |threads: &str| -> Vec<String> {
        let spread = run(&bench, &["--seeds", "4", "--threads", threads, "--out", threads]);
        spread["seeds"].as_array().unwrap().iter().map(|seed| seed["state_hash"].to_string()).collect()
    };
    let one = hashes("1");
    assert_eq!(one.len(), 4);
    assert_eq!(one, hashes("2"));
}

#[test]
fn a_seed_whose_base_lines_a_second_thread_measures_leaves_the_same_figures() {
    let bench = Bench::new();
    let figures = |threads: &str| {
        let mut figures = run(&bench, &["--threads", threads, "--out", threads]);
        figures["steps_per_second"].take();
        figures
    };
    let one = figures("1");
    assert!(one["untrained"]["distance_m"].as_f64().unwrap() > 0.0);
    assert_eq!(one, figures("2"));
    let spread = run(&bench, &["--seeds", "2", "--threads", "2", "--out", "many"]);
    for line in ["untrained", "blind"] {
        assert_eq!(spread["seeds"][0][line], one[line]);
    }
}

#[test]
fn every_compilation_of_the_vector_code_learns_the_same_behaviours() {
    let scripts = ["wall", "wall-left", "corridor", "platform", "object", "line", "avoid", "dock"];
    let learned = |processor: Processor, script: &str, set: &[&str]| {
        Processor::limit_best(processor);
        let behaviour = Behaviour::load(&root().join(format!("scripts/{script}.rhai"))).unwrap();
        let set = set.iter().map(|pair| (*pair).to_owned()).collect();
        let overrides = Overrides { steps: Some(400), set, ..Overrides::default() };
        let plan = Plan::new(Arc::new(behaviour), &overrides).unwrap();
        learn(&plan, 1, &AtomicBool::new(false), &|_| ()).unwrap().state_hash
    };
    for processor in Processor::all() {
        for script in scripts {
            let portable = learned(Processor::PORTABLE, script, &[]);
            assert_eq!(learned(processor, script, &[]), portable, "{script}, {}", processor.name());
        }
        for set in [&["camera.lens=fisheye"][..], &["camera.noise=0"], &["camera.width_px=97", "camera.noise=60"]] {
            let portable = learned(Processor::PORTABLE, "wall", set);
            assert_eq!(learned(processor, "wall", set), portable, "{set:?}, {}", processor.name());
        }
    }
}

#[test]
fn a_seed_is_the_same_alone_and_among_others() {
    let bench = Bench::new();
    run(&bench, &["--seeds", "3", "--out", "many"]);
    run(&bench, &["--seed", "3", "--out", "alone"]);
    assert_eq!(bench.read("many/3/policy.toml"), bench.read("alone/policy.toml"));
    assert_eq!(hash(&bench.read("many/3/summary.json")), hash(&bench.read("alone/summary.json")));
}

#[test]
fn a_stored_policy_tested_again_gives_the_figures_of_its_run() {
    let bench = Bench::new();
    let summary = run(&bench, &["--out", "a"]);
    crate::support::assert_tested_again(&summary, &bench.engine(&["test", "a", "--json"]).stdout);
}

#[test]
fn a_run_needs_neither_its_script_nor_its_world_to_be_tested_again() {
    let bench = Bench::new();
    let summary = run(&bench, &["--out", "a"]);
    std::fs::remove_file(bench.path().join("short.rhai")).unwrap();
    std::fs::remove_dir_all(bench.path().join("worlds")).unwrap();
    crate::support::assert_tested_again(&summary, &bench.engine(&["test", "a", "--json"]).stdout);
}
