//! Editions through the program: upgraded, stored, packed; the language as data.

use serde_json::Value;

use crate::support::{Bench, SCRIPT};

#[test]
fn an_upgrade_is_shown_first_and_written_on_demand() {
    let bench = Bench::new();
    let shown = bench.ok(&["upgrade", "short.rhai"]);
    for line in ["+edition(2);", "+learner(#{ kind: \"ttd\" });", "=> -1 then fail;", "nothing is written yet"] {
        assert!(shown.contains(line), "{line}: {shown}");
    }
    assert_eq!(bench.read("short.rhai"), SCRIPT);
    assert!(bench.ok(&["upgrade", "short.rhai", "--write"]).contains("written to short.rhai"));
    assert!(bench.read("short.rhai").starts_with("edition(2);\nlearner(#{ kind: \"ttd\" });\nworld(\"small\");"));
    assert!(bench.ok(&["upgrade", "short.rhai", "--write"]).contains("nothing to change"));
}

#[test]
fn a_script_of_the_first_edition_learns_the_same_table_when_it_is_upgraded() {
    let bench = Bench::new();
    bench.write("short.rhai", format!("edition(1);\n{SCRIPT}"));
    let learned = |bench: &Bench| {
        bench.engine(&["run", "short.rhai", "--force"]);
        let text = bench.read("runs/short/1/policy.toml");
        text.lines().filter(|line| !line.starts_with("run_sha256")).collect::<Vec<_>>().join("\n")
    };
    let before = learned(&bench);
    assert!(before.starts_with("format = 2\n"), "{before}");
    bench.ok(&["upgrade", "short.rhai", "--write"]);
    assert_eq!(learned(&bench), before);
}

#[test]
fn the_second_edition_learns_by_memory_and_the_first_by_ttd() {
    let bench = Bench::new();
    for (edition, format) in [("", 4), ("edition(2);", 4), ("edition(1);", 2)] {
        bench.write("short.rhai", format!("{edition}\n{SCRIPT}"));
        bench.engine(&["run", "short.rhai", "--force"]);
        assert!(bench.read("runs/short/1/policy.toml").starts_with(&format!("format = {format}\n")), "{edition}");
    }
}

#[test]
fn a_setting_of_another_learner_is_refused_where_nothing_would_read_it() {
    let bench = Bench::new();
    let told = bench.failure(&["run", "short.rhai", "--set", "learner.window=10"]);
    assert!(told.starts_with("exit status 2") && told.contains("E-SET") && told.contains("learner.kind=ttd"), "{told}");
    let told = bench.failure(&["run", "short.rhai", "--set", "learner.memory_steps=900", "--set", "learner.kind=q"]);
    assert!(told.contains("learner \"q\" remembers no steps") && told.contains("learner.kind=memory"), "{told}");
    bench.engine(&["run", "short.rhai", "--set", "learner.window=10", "--set", "learner.kind=ttd"]);
    assert!(bench.read("runs/short/1/run.toml").contains("window = 10.0"));
}

#[cfg(unix)]
#[test]
fn an_upgrade_goes_through_a_link_and_keeps_the_rights_of_the_file() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    let (file, link) = (bench.path().join("short.rhai"), bench.path().join("link.rhai"));
    std::fs::set_permissions(&file, PermissionsExt::from_mode(0o640)).unwrap();
    symlink(&file, &link).unwrap();
    bench.ok(&["upgrade", "link.rhai", "--write"]);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(bench.read("short.rhai").starts_with("edition(2);"));
    assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    std::fs::write(&file, SCRIPT).unwrap();
    std::fs::set_permissions(&file, PermissionsExt::from_mode(0o444)).unwrap();
    assert!(bench.failure(&["upgrade", "short.rhai", "--write"]).starts_with("exit status 6"));
    assert_eq!(bench.read("short.rhai"), SCRIPT);
}

#[test]
fn a_run_says_its_edition_and_one_that_says_none_is_of_the_first() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let text = bench.read("runs/short/1/run.toml");
    assert!(text.contains("\nedition = 2\n"), "{text}");
    bench.write("runs/short/1/run.toml", text.replace("\nedition = 2\n", "\nedition = 9\n"));
    assert!(bench.failure(&["replay", "runs/short/1"]).contains("is of edition 9, which this engine does not know"));
}

#[test]
fn a_script_that_cannot_be_read_is_not_upgraded() {
    let bench = Bench::new();
    bench.write("mine.rhai", "rule \"a\" when");
    assert!(bench.failure(&["upgrade", "mine.rhai", "--write"]).starts_with("exit status 3"));
    assert_eq!(bench.read("mine.rhai"), "rule \"a\" when");
}

#[test]
fn the_language_comes_as_data() {
    let data: Value = serde_json::from_str(&Bench::new().ok(&["reference", "--json"])).unwrap();
    assert_eq!(data["format"], 1);
    assert!(data["facts"].as_array().unwrap().len() > 40 && data["codes"].as_array().unwrap().len() > 60);
}
