use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::allowed::Allowed;
use engine::experiment::{
    Choice, Chooser, Cycle, Each, Ledger, Overrides, Phase, Plan, Playback, Step, learn_into, test, test_choices,
};
use engine::filter::Catalogue;
use insight::store::{StoredRun, run_to_toml};

use crate::support::{Bench, SCRIPT};

/// A short behaviour with statements before its rules.
fn script(statements: &str) -> String {
    format!(
        "world(\"small\");\nrun(#{{ steps: 300, test_steps: 100 }});\n{statements}\nrule \"contact\" when robot.contact => -1 then recover;\n"
    )
}

fn load(bench: &Bench, statements: &str, set: &[&str]) -> engine::diagnostic::Result<Plan> {
    bench.write("own.rhai", script(statements));
    let set = set.iter().map(|pair| (*pair).to_owned()).collect();
    let overrides = Overrides { set, ..Overrides::default() };
    Plan::load(&bench.path().join("own.rhai"), &overrides, || Ok(Arc::new(Catalogue::linked_in())))
}

/// A mistake as it is shown, without the folder.
fn mistake(bench: &Bench, statements: &str) -> String {
    let error = load(bench, statements, &[]).err().unwrap();
    error.render(false).replace(&format!("{}{}", bench.path().display(), std::path::MAIN_SEPARATOR), "")
}

#[test]
fn a_condition_of_pixels_is_a_filter_in_both_of_its_forms() {
    let bench = Bench::new();
    let short = load(&bench, "filter(\"where\", \"brightness > 100\");", &[]).unwrap();
    let long = load(&bench, "filter(\"where\", #{ is: \"brightness > 100\" });", &[]).unwrap();
    assert_eq!(short.settings.view.filters, long.settings.view.filters);
    let with_constant = load(&bench, "const LEAST = 100;\nfilter(\"where\", `brightness > ${LEAST}`);", &[]).unwrap();
    assert_eq!(short.settings.view.filters, with_constant.settings.view.filters);
    let other = load(&bench, "filter(\"where\", \"brightness > 100\");", &["filter.where.is=r > 9"]).unwrap();
    assert_eq!(other.settings.view.filters[0].condition.as_deref(), Some("r > 9"));
}

#[test]
fn a_mistake_in_a_condition_is_told_at_its_place_in_the_text() {
    let bench = Bench::new();
    let told = [
        "filter(\"where\", \"r > 60 and g < 90\");",
        "filter(\"where\", #{ is: \"60 < r < 90\" });",
        "const LEAST = 150;\nfilter(\"where\", `gren > ${LEAST}`);",
        "filter(\"where\");",
        "filter(\"where\", #{ hue_deg: 3 });",
        "filter(\"sobel\", \"r > 3\");",
        "filter(\"where\", \"r > 3\"); filter(\"colour\");",
        "filter(\"where\", \"r > 300\");",
    ];
    insta::assert_snapshot!(told.map(|statements| mistake(&bench, statements)).join("\n"));
}

#[test]
fn a_run_keeps_its_condition_and_is_tested_again_with_it() {
    let bench = Bench::new();
    bench.write("own.rhai", script("filter(\"where\", \"brightness > 100 && !(r > g)\");"));
    bench.engine(&["run", "own.rhai"]);
    let folder = bench.path().join("runs/own/1");
    let run = std::fs::read_to_string(folder.join("run.toml")).unwrap();
    let policy = std::fs::read_to_string(folder.join("policy.toml")).unwrap();
    let line = "is = \"brightness > 100 && !(r > g)\"";
    assert!(run.contains(line) && policy.contains(line), "{run}");
    assert_same_plan(&folder);
    bench.success(&["replay", folder.to_str().unwrap(), "--verify"]);
}

/// What is stored of a run is read back and stored as the same text.
fn assert_same_plan(folder: &Path) {
    let stored = StoredRun::load(folder).unwrap();
    let text = std::fs::read_to_string(folder.join("run.toml")).unwrap();
    assert_eq!(run_to_toml(&stored.plan, stored.seed).unwrap(), text);
}

#[test]
fn the_filter_of_conditions_is_listed_and_explained() {
    let bench = Bench::new();
    assert!(bench.ok(&["plugins"]).contains("\nwhere "));
    let manual = bench.ok(&["plugins", "show", "where"]);
    assert!(manual.contains("filter(\"where\", \"r > 1.5 * g && r > 60\");") && manual.contains("hue_deg"), "{manual}");
}

const NEAR: &str = "const near = param(0.25, #{ low: 0.15, high: 0.5, unit: \"m\" });\nrule \"close\" when laser.nearest < near => -1 then recover;";

#[test]
fn a_parameter_is_set_from_the_command_line_and_kept_by_the_run() {
    let bench = Bench::new();
    bench.write("own.rhai", script(NEAR));
    bench.engine(&["run", "own.rhai", "--set", "near=0.4"]);
    let folder = bench.path().join("runs/own/1");
    let text = bench.read("runs/own/1/run.toml");
    assert!(text.contains("[params]\nnear = 0.4\n"), "{text}");
    assert_same_plan(&folder);
    bench.success(&["replay", "runs/own/1", "--verify"]);
    assert!(
        bench
            .ok(&["explain", "runs/own/1", "--step", "3"])
            .contains("parameter: near = 0.4 m (0.15 to 0.5; the script says 0.25)")
    );
    assert!(bench.read("runs/own/1/report.html").contains("\"name\":\"near\""));
    // The rules of the script itself, with the value of the run: nothing differs.
    let rescored = bench.engine(&["rescore", "runs/own/1", "own.rhai", "--json"]);
    let rescored: serde_json::Value = serde_json::from_slice(&rescored.stdout).unwrap();
    assert_eq!(rescored["reward_before"], rescored["reward_after"], "{rescored}");
    let plain = bench.engine(&["run", "own.rhai", "--out", "plain"]);
    assert!(plain.status.code().unwrap() < 2);
    let hash = |path: &str| serde_json::from_str::<serde_json::Value>(&bench.read(path)).unwrap()["state_hash"].clone();
    assert_ne!(hash("runs/own/1/summary.json"), hash("plain/summary.json"));
}

#[test]
fn a_wrong_parameter_on_the_command_line_lists_those_that_there_are() {
    let bench = Bench::new();
    let wrong = |pair: &str| load(&bench, NEAR, &[pair]).err().unwrap();
    assert_eq!(wrong("far=0.3").help.as_deref(), Some("there are: near"));
    assert_eq!(wrong("near=3").message, "'near' must be 0.15 to 0.5 m, not 3");
    assert_eq!(wrong("near=wide").code, "E-SET");
    assert_eq!(wrong("tilt_deg=3").help.as_deref(), Some("did you mean 'camera.tilt_deg'?"));
}

#[test]
fn a_stored_plan_follows_a_parameter_into_its_settings() {
    let bench = Bench::new();
    let statements = "const least = param(0.25, #{ low: 0.1, high: 0.5 });\nlaser(#{ min_range_m: least });";
    let plan = load(&bench, statements, &["camera.tilt_deg=30"]).unwrap();
    let changed = plan.with_changes(&Overrides { set: vec!["least=0.2".to_owned()], ..Overrides::default() }).unwrap();
    assert_eq!((changed.settings.laser.min_range_m, changed.settings.camera.tilt_deg), (0.2, 30.0));
    assert_eq!(changed.behaviour.params()[0].value, 0.2);
}

const GUARD: &str = "forbid \"ahead\" when laser.front < 0.9 => action.linear > 0.1;";

/// Drives by one action, whatever guards say.
struct Always(usize);

impl Chooser for Always {
    fn choose(&mut self, _: &[usize], _: Allowed) -> engine::diagnostic::Result<Choice> {
        Ok(Choice { action: self.0, explored: false })
    }
}

#[test]
fn no_step_of_learning_or_test_does_what_a_guard_forbids() {
    let bench = Bench::new();
    for kind in ["ttd", "q", "sarsa-lambda", "ttd-cichosz"] {
        let plan = load(&bench, GUARD, &[&format!("learner.kind={kind}")]).unwrap();
        let (mut ledger, stop) = (Ledger::new(&plan, 300), AtomicBool::new(false));
        let learned = learn_into(&plan, 1, &stop, &|_| (), &mut ledger).unwrap();
        let (mut near, mut playback) = (0, Playback::new(&plan, 1, Phase::Learning, &ledger).unwrap());
        for step in 0..300 {
            playback.seek(step).unwrap();
            let cycle = playback.cycle();
            let guarded = cycle.observation().scan.ranges_m[90] < 0.9;
            assert_eq!(!cycle.allowed().is_all(), guarded, "{kind}: step {step}");
            let done = playback.advance().unwrap().unwrap();
            near += u64::from(guarded);
            let linear = plan.settings.actions[done.action].linear_m_per_s;
            assert!(done.guarded == guarded && !(guarded && linear > 0.1), "{kind}: step {step}: {linear}");
        }
        assert!(near > 5, "{kind}: the guard held in {near} steps");
        let figures = test(&plan, &learned.policy, 1, &stop).unwrap().figures;
        assert!(figures.forbidden_per_1000.unwrap() > 0.0);
    }
}

#[test]
fn whoever_chooses_what_is_forbidden_gets_the_slowest_that_is_not() {
    let bench = Bench::new();
    let plan = load(&bench, GUARD, &[]).unwrap();
    let (stop, mut guarded) = (AtomicBool::new(false), 0);
    let mut watch = Each(|_: &Cycle<_>, step: &Step| {
        guarded += u64::from(step.guarded);
        // Of the default actions the slowest are those at 0.05 m/s; the first of them is number 12.
        assert_eq!(step.action, if step.guarded { 12 } else { 1 });
    });
    test_choices(&plan, 1, &stop, &mut Always(1), &mut watch).unwrap();
    assert!(guarded > 0);
}

#[test]
fn a_guard_is_explained_counted_and_replayed() {
    let bench = Bench::new();
    bench.write("own.rhai", script(GUARD));
    bench.engine(&["run", "own.rhai"]);
    bench.success(&["replay", "runs/own/1", "--verify"]);
    let summary: serde_json::Value = serde_json::from_str(&bench.read("runs/own/1/summary.json")).unwrap();
    assert!(summary["test"]["forbidden_per_1000"].as_f64().unwrap() > 0.0);
    assert!(summary["untrained"]["forbidden_per_1000"].as_f64().unwrap() > 0.0);
    let told = (0..300).map(|step| bench.ok(&["explain", "runs/own/1", "--step", &step.to_string()]));
    let told = told.into_iter().find(|told| told.contains("guard:")).unwrap();
    assert!(told.contains("guard:     \"ahead\" (line 3) forbade 12 of 14 actions: [0.4, 0.2]"), "{told}");
    assert!(told.contains("since laser.front"), "{told}");
    let again = bench.engine(&["rescore", "runs/own/1", "own.rhai", "--json"]);
    let again: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["states_changed"], serde_json::json!([]), "{again}");
}

#[test]
fn without_guards_a_summary_says_nothing_of_them() {
    let bench = Bench::new();
    bench.write("own.rhai", script(""));
    bench.engine(&["run", "own.rhai"]);
    assert!(!bench.read("runs/own/1/summary.json").contains("forbidden"));
}

#[test]
fn a_grid_that_remembers_is_learned_stored_and_verified() {
    let bench = Bench::new();
    bench.write(
        "mine.rhai",
        format!("{SCRIPT}filter(\"sobel\", #{{ threshold: 200 }}); grid(#{{ remember_s: 2.0 }});\n"),
    );
    bench.engine(&["run", "mine.rhai"]);
    let policy = bench.read("runs/mine/1/policy.toml");
    assert!(policy.contains("\nremember_s = 2.0\n") && policy.contains("\nstates = 125\n"), "{policy}");
    assert!(bench.ok(&["replay", "runs/mine/1", "--verify"]).contains("bit for bit"));
    bench.write("mine.rhai", format!("{SCRIPT}grid(#{{ remember_s: 2.0, fill: false }});\n"));
    let told = bench.failure(&["run", "mine.rhai"]);
    assert!(told.contains("E-GRID") && told.contains("remember_s needs fill"), "{told}");
}

#[test]
fn views_that_begin_alike_leave_the_same_bytes_as_views_that_do_not() {
    let bench = Bench::new();
    let run = |second: &str| {
        let views = format!(
            "view(\"a\", filter(\"blur\"), filter(\"sobel\", #{{ threshold: 60 }}));\nview(\"b\", {second}, filter(\"sobel\", #{{ threshold: 90 }}));\n"
        );
        bench.write("mine.rhai", format!("{SCRIPT}{views}"));
        let output = bench.engine(&["run", "mine.rhai", "--json", "--force"]);
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (summary["state_hash"].clone(), summary["log_sha256"].clone())
    };
    // The default written out is the same filter to a camera, and not the same text.
    assert_eq!(run("filter(\"blur\")"), run("filter(\"blur\", #{ radius_px: 1 })"));
}
