use std::path::Path;
use std::sync::Arc;

use engine::experiment::{Overrides, Plan};
use engine::filter::Catalogue;
use insight::store::{StoredRun, run_to_toml};

use crate::support::Bench;

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
    assert_eq!(short.settings.filters, long.settings.filters);
    let with_constant = load(&bench, "const LEAST = 100;\nfilter(\"where\", `brightness > ${LEAST}`);", &[]).unwrap();
    assert_eq!(short.settings.filters, with_constant.settings.filters);
    let other = load(&bench, "filter(\"where\", \"brightness > 100\");", &["filter.where.is=r > 9"]).unwrap();
    assert_eq!(other.settings.filters[0].condition.as_deref(), Some("r > 9"));
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
    bench.engine(&["run", "own.rhai", "--seed", "3", "--out", "runs"]);
    let folder = bench.path().join("runs/3");
    let folder = if folder.exists() { folder } else { bench.path().join("runs") };
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
