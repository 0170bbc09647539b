use std::sync::Arc;

use engine::experiment::{Overrides, Plan};
use engine::script::Behaviour;
use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Bench, WORLD, root};

/// Mistakes that are found while the script is read, while it is tried, in its filters, and in its world.
const SCRIPT: &str = r#"world("small");
filter("sobell");
camera(#{ tilt: 42 });
rule "lost" when laser.rigth > 1.0 => -1;
rule "lost" when laser[200] > 1.0 for 0 steps => -1;
"#;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("mine.rhai", SCRIPT);
    bench.write(
        "worlds/small.toml",
        WORLD.replace("height_m = 1.0", "height_cm = 100").replace("[120, 120, 120]", "[120]"),
    );
    bench
}

/// Line and code of each mistake in what was said as JSON.
fn told(error: &Value) -> Vec<(u64, String)> {
    let others = error["others"].as_array().unwrap().iter();
    let each = std::iter::once(error).chain(others);
    each.map(|one| (one["line"].as_u64().unwrap(), one["code"].as_str().unwrap().to_owned())).collect()
}

#[test]
fn all_mistakes_of_a_script_and_its_world_are_shown_at_once() {
    assert_snapshot!(bench().failure(&["run", "mine.rhai"]));
}

#[test]
fn running_and_checking_tell_the_same() {
    let bench = bench();
    let shown = bench.failure(&["run", "mine.rhai"]);
    assert_eq!(bench.failure(&["check", "mine.rhai"]), shown);
    let output = bench.engine(&["check", "mine.rhai", "--json"]);
    assert_eq!((output.status.code(), output.stderr.is_empty()), (Some(3), true));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let findings = told["findings"].as_array().unwrap();
    let each = findings.iter().map(|one| (one["line"].as_u64().unwrap(), one["code"].as_str().unwrap().to_owned()));
    let codes = [
        (2, "E-FILTER-SETTING"),
        (3, "E-SCRIPT-SETTING"),
        (4, "E-SCRIPT-FACT"),
        (5, "E-SCRIPT-RULE"),
        (5, "E-SCRIPT-FACT"),
        (5, "E-SCRIPT-RULE"),
        (8, "E-WORLD-VALUE"),
        (17, "E-WORLD-KEY"),
    ];
    assert_eq!(each.collect::<Vec<_>>(), codes.map(|(line, code)| (line, code.to_owned())));
    assert!(findings[6]["file"].as_str().unwrap().ends_with("small.toml"));
    assert_eq!(told["left_out"], 0);
}

#[test]
fn beyond_twenty_mistakes_are_only_counted() {
    let bench = Bench::new();
    let rule = |number: u32| format!("rule \"{number}\" when laser.rigth > 1.0 => -1;\n");
    let rules: String = (0..25).map(rule).collect();
    bench.write("mine.rhai", format!("world(\"small\");\n{rules}"));
    let shown = bench.failure(&["run", "mine.rhai"]);
    assert_eq!(shown.matches("error[").count(), 20);
    assert!(shown.ends_with("\n25 mistakes in 'mine.rhai': 20 are shown, and 5 more\n"), "{shown}");
    let error: Value = serde_json::from_slice(&bench.engine(&["run", "mine.rhai", "--json"]).stderr).unwrap();
    assert_eq!((error["others"].as_array().unwrap().len(), &error["left_out"]), (19, &5.into()));
}

#[test]
fn settings_that_do_not_fit_one_another_are_all_told() {
    let bench = Bench::new();
    let script = "world(\"smal\");\ngrid(#{ rows: 16, columns: 16 });\nfilter(\"sobel\", #{ threshold: -3, tresh: 1 });
actions([[0.2, 0.5]]);\nlearner(\"ttd\", #{ mirror: true });\npolicy(\"a\", \"runs/a/1\");
rule \"close\" when laser.nearest < 0.25 => -1;\n";
    bench.write("mine.rhai", script);
    let error: Value = serde_json::from_slice(&bench.engine(&["run", "mine.rhai", "--json"]).stderr).unwrap();
    let lines: Vec<u64> = told(&error).iter().map(|(line, _)| *line).collect();
    // The mirror needs the grid.
    assert_eq!(lines, [1, 2, 3, 3, 6], "{error}");
    bench.write("mine.rhai", script.replace("grid(#{ rows: 16, columns: 16 });", ""));
    let error: Value = serde_json::from_slice(&bench.engine(&["run", "mine.rhai", "--json"]).stderr).unwrap();
    let lines: Vec<u64> = told(&error).iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [1, 3, 3, 5, 6], "{error}");
}

/// Each script of the corpus with its name.
fn seeded() -> Vec<(String, String)> {
    let corpus = std::fs::read_to_string(root().join("tests/fixtures/mistakes.rhai")).unwrap();
    let each = corpus.split("\n//// ").skip(1).map(|one| one.split_once('\n').unwrap());
    each.map(|(name, text)| (name.to_owned(), text.to_owned())).collect()
}

#[test]
fn every_seeded_mistake_is_told_at_load_in_its_line_with_the_way_out() {
    let bench = Bench::new();
    bench.write("worlds/object.toml", std::fs::read(root().join("worlds/object.toml")).unwrap());
    let seeded = seeded();
    assert!(seeded.len() >= 60, "{}", seeded.len());
    let mut said = String::new();
    for (name, text) in seeded {
        bench.write("mine.rhai", &text);
        let error = Behaviour::load(&bench.path().join("mine.rhai"))
            .and_then(|behaviour| Plan::new(Arc::new(behaviour), &Overrides::default()).map(drop))
            .expect_err(&name);
        let place = error.place.as_ref().unwrap();
        let (line, _) = place.source.position(place.span.start);
        let marked = 1 + text.lines().position(|line| line.ends_with("// <-")).unwrap();
        assert_eq!((line, error.others.len()), (marked, 0), "{name}: {error:?}");
        let help = error.help.as_deref().unwrap_or_default();
        said += &format!("{name}: {} {} | {help}\n", error.code, error.message);
    }
    assert_snapshot!("seeded_mistakes", said);
}
