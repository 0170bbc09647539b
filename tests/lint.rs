use std::path::PathBuf;
use std::sync::Arc;

use engine::diagnostic::Result;
use engine::experiment::{Overrides, Plan};
use engine::script::Behaviour;
use insight::lint::{self, Severity};

use crate::support::{Bench, root};

fn scripts(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|ending| ending == "rhai")).collect();
    files.sort();
    files
}

fn plan(path: &std::path::Path) -> Result<Plan> {
    Plan::new(Arc::new(Behaviour::load(path)?), &Overrides::default())
}

/// Code and line of everything that is wrong with a script.
fn found(path: &std::path::Path) -> Vec<(String, usize)> {
    let plan = match plan(path) {
        Ok(plan) => plan,
        Err(error) => {
            let place = error.place.as_ref().unwrap();
            return vec![(error.code.to_owned(), place.source.position(place.span.start).0)];
        }
    };
    let findings = lint::check_behaviour(&plan).unwrap().findings;
    findings.iter().map(|finding| (finding.code.to_owned(), finding.line)).collect()
}

#[test]
fn every_seeded_mistake_is_found_in_its_line() {
    let corpus = scripts("tests/fixtures/lint");
    assert!(corpus.len() >= 40, "{}", corpus.len());
    let mut missed = Vec::new();
    for path in corpus {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.lines().next().unwrap().trim_start_matches("// ").split(':').next().unwrap().to_owned();
        let line = 1 + text.lines().position(|line| line.ends_with("// <- here")).unwrap();
        let found = found(&path);
        if !found.contains(&(code.clone(), line)) {
            missed.push(format!("{}: {code} in line {line}, found {found:?}", path.display()));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn nothing_is_found_in_scripts_that_ship() {
    for path in scripts("scripts") {
        assert_eq!(found(&path), Vec::new(), "{}", path.display());
    }
}

#[test]
fn the_same_script_gives_the_same_report() {
    let plan = plan(&root().join("scripts/corridor.rhai")).unwrap();
    let report = || serde_json::to_string(&lint::check_behaviour(&plan).unwrap()).unwrap();
    assert_eq!(report(), report());
}

#[test]
fn a_check_that_is_stopped_finds_nothing() {
    let plan = plan(&root().join("scripts/corridor.rhai")).unwrap();
    assert!(lint::check_behaviour_until(&plan, 0, &true.into()).unwrap().is_none());
    assert!(lint::check_behaviour_until(&plan, 1, &false.into()).unwrap().is_some());
}

#[test]
fn spinning_is_shown_to_get_nowhere_and_driving_to_get_along() {
    let plan = plan(&root().join("scripts/corridor.rhai")).unwrap();
    let exploits = lint::check_behaviour(&plan).unwrap().exploits.unwrap();
    let of = |name: &str| exploits.behaviours.iter().find(|exploit| exploit.behaviour.starts_with(name)).unwrap();
    let (best, spin) = (of("best"), of("spin in place, left"));
    assert!(!best.nowhere && best.net_m_per_s.unwrap().abs() > 0.1, "{best:?}");
    assert!(spin.nowhere && spin.spinning > 0.9 && spin.reward_per_400 == 0.0, "{spin:?}");
    assert!(exploits.coverage.states_seen > 10 && exploits.coverage.pairs_untried > 0);
}

#[test]
fn the_program_says_how_it_went_by_its_exit_status() {
    let bench = Bench::new();
    let clean = "world(\"small\");\nrule \"too close\" when laser.nearest <= 0.25 => -1 then recover;\n";
    bench.write("clean.rhai", clean);
    bench.write("unit.rhai", clean.replace("0.25", "25"));
    bench.write("broken.rhai", clean.replace("nearest", "neerest"));
    let status = |script: &str| bench.engine(&["check", script, "--json"]);
    let [clean, unit, broken] = ["clean.rhai", "unit.rhai", "broken.rhai"].map(status);
    assert_eq!([&clean, &unit, &broken].map(|output| output.status.code().unwrap()), [0, 1, 3]);
    let report: serde_json::Value = serde_json::from_slice(&unit.stdout).unwrap();
    assert_eq!(report["findings"][0]["code"], "W-UNIT");
    assert_eq!((&report["findings"][0]["line"], &report["findings"][0]["severity"]), (&2.into(), &"warning".into()));
    assert!(report["findings"][0]["help"].as_str().unwrap().contains("25 cm are 0.25 m"));
    assert_eq!((&report["findings"][0]["file"], &report["findings"][0]["end_line"]), (&"unit.rhai".into(), &2.into()));
    let shown = bench.engine(&["check", "unit.rhai"]);
    let shown = String::from_utf8(shown.stdout).unwrap();
    assert!(shown.contains("warning[W-UNIT]") && shown.contains("^^^^"), "{shown}");
}

#[test]
fn findings_and_errors_have_one_shape_in_every_format() {
    let bench = Bench::new();
    let clean = "world(\"small\");\nrule \"too close\" when laser.nearest <= 0.25 => -1 then recover;\n";
    bench.write("unit.rhai", clean.replace("0.25", "25"));
    bench.write("broken.rhai", clean.replace("nearest", "neerest").replace("recover", "recovver"));
    let told = |script: &str, format: &str| {
        let output = bench.engine(&["check", script, "--format", format]);
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap(), output.stderr)
    };
    let (status, short, _) = told("unit.rhai", "short");
    assert_eq!(status, 1);
    assert!(short.starts_with("unit.rhai:2:23: W-UNIT "), "{short}");
    let (status, short, errors) = told("broken.rhai", "short");
    assert_eq!((status, errors.as_slice()), (3, &b""[..]));
    assert!(short.lines().all(|line| line.starts_with("broken.rhai:2:") && line.contains(": E-SCRIPT-")), "{short}");
    // Every finding has the fields of an error, and a line of the log for code hosts.
    let broken: serde_json::Value = serde_json::from_str(&told("broken.rhai", "json").1).unwrap();
    let error = &broken["findings"][0];
    let found: serde_json::Value = serde_json::from_str(&told("unit.rhai", "json").1).unwrap();
    for key in found["findings"][0].as_object().unwrap().keys() {
        assert!(error.get(key).is_some(), "{key}");
    }
    for (script, level) in [("unit.rhai", "warning"), ("broken.rhai", "error")] {
        let log: serde_json::Value = serde_json::from_str(&told(script, "sarif").1).unwrap();
        let (run, rules) = (&log["runs"][0], &log["runs"][0]["tool"]["driver"]["rules"]);
        let result = &run["results"][0];
        assert_eq!((&log["version"], &result["level"]), (&"2.1.0".into(), &level.into()));
        let place = &result["locations"][0]["physicalLocation"];
        assert_eq!((&place["artifactLocation"]["uri"], &place["region"]["startLine"]), (&script.into(), &2.into()));
        assert!(rules.as_array().unwrap().iter().any(|rule| rule["id"] == result["ruleId"]), "{rules}");
    }
}

#[test]
fn a_script_that_fails_in_a_step_is_an_error_in_its_line() {
    let bench = Bench::new();
    let text = "world(\"small\");\nfn reward(facts) {\n    let list = [1.0];\n    list[facts.time.step]\n}\n";
    bench.write("fails.rhai", text);
    let report = lint::check_behaviour(&plan(&bench.path().join("fails.rhai")).unwrap()).unwrap();
    let first = report.findings.iter().find(|finding| finding.severity == Severity::Error).unwrap();
    assert_eq!((first.code, first.line), ("E-SCRIPT-RUN", 4));
    assert!(report.exploits.is_none());
}

#[test]
fn a_script_that_fails_in_the_first_step_is_told_so_and_nothing_that_only_follows_from_it() {
    let bench = Bench::new();
    bench.write("modulo.rhai", "world(\"small\"); rule \"a\" when time.step % 0 == 0 => -0.1;");
    let told = bench.engine(&["check", "modulo.rhai"]);
    let text = [told.stdout, told.stderr].concat();
    let text = String::from_utf8_lossy(&text).into_owned();
    assert!(text.contains("E-SCRIPT-RUN") && text.contains("1 error, 0 warnings"), "{text}");
    assert!(!text.lines().any(|line| line.trim() == "= help:"), "{text}");
}
