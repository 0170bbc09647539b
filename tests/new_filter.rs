use std::process::Command;

use crate::support::{Bench, root};

/// Runs cargo in the new filter's folder.
fn cargo(bench: &Bench, arguments: &[&str]) {
    let folder = bench.path().join("ink");
    let mut command = Command::new(env!("CARGO"));
    // The outer cargo's settings are for the engine, not for a crate of its own.
    command.args(arguments).current_dir(&folder).env_remove("CARGO_TARGET_DIR").env_remove("RUSTFLAGS");
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn digest(plugins: &str) -> String {
    let start = plugins.find("--allow-native=sha256:").unwrap();
    plugins[start..].split_whitespace().next().unwrap().to_owned()
}

#[test]
fn a_new_filter_builds_is_listed_keeps_the_law_and_learns() {
    let bench = Bench::new();
    bench.success(&["new", "filter", "ink"]);
    cargo(&bench, &["test", "--quiet", "--offline"]);
    cargo(&bench, &["build", "--release", "--quiet", "--offline"]);
    let folder = "--filter-dir=ink/target/release".to_owned();
    let listed = bench.success(&["plugins", &folder]);
    let allow = digest(&listed);
    let show = bench.success(&["plugins", "show", "ink", &folder, &allow]);
    assert!(show.contains("level: 1 to 255 (grey levels, whole), default 15"), "{show}");
    let check = bench.success(&["plugins", "check", "ink", &folder, &allow]);
    assert!(check.contains("keeps the law of filters: 400 frames"), "{check}");
    let script = std::fs::read_to_string(bench.path().join("ink/example.rhai")).unwrap();
    let world = root().join("worlds/room.toml").canonicalize().unwrap();
    bench.write("ink/example.rhai", script.replace("\"room\"", &format!("{:?}", world.to_str().unwrap())));
    let output = bench.command(&["run", "ink/example.rhai", "--steps=400", &folder, &allow]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("behaviour: example in room"), "{text}{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_name_that_cannot_be_used_is_refused_with_a_way_out() {
    let bench = Bench::new();
    bench.write("taken/here", "");
    for name in ["Ink", "9", "", "../ink", "sobel", "taken", "filter_api"] {
        let text = bench.failure(&["new", "filter", name]);
        assert!(text.contains("exit status 2") && text.contains("help: "), "{name}: {text}");
    }
}
