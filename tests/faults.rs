//! One operation of the disk after the other fails, in commands that write: one error, and what stood there stays.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{Bench, SCRIPT};

/// Operations of each kind that fail in turn.
const FAULTS: usize = 3;
const CALLS: [&str; 5] = ["fsync", "renameat2", "rename", "mkdir", "write"];

type Files = BTreeMap<PathBuf, Vec<u8>>;

/// All files, but those that a process leaves for the next one to sweep.
fn files(folder: &Path) -> Files {
    let mut files = Files::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        match path.is_dir() {
            true if name.ends_with(".part") => {}
            true => files.extend(self::files(&path)),
            false if name.ends_with(".part") || name.ends_with(".lock") => {}
            false => drop(files.insert(path.clone(), std::fs::read(&path).unwrap())),
        }
    }
    files
}

fn restore(bench: &Bench, before: &Files) {
    for path in files(bench.path()).into_keys().filter(|path| !before.contains_key(path)) {
        std::fs::remove_file(path).unwrap();
    }
    before.iter().for_each(|(path, bytes)| std::fs::write(path, bytes).unwrap());
}

/// Fails operations of a command; how many of them it could not do without.
fn failed(bench: &Bench, arguments: &[&str]) -> usize {
    let before = files(bench.path());
    let mut failed = 0;
    for call in CALLS {
        for when in 1..=FAULTS {
            let error = if when % 2 == 0 { "ENOSPC" } else { "EIO" };
            let engine = bench.command(arguments);
            let mut command = Command::new("strace");
            command.args(["-f", "-o", "/dev/null", "-e", &format!("trace={call}")]);
            command.args(["-e", &format!("inject={call}:error={error}:when={when}")]);
            command.arg(engine.get_program()).args(arguments).current_dir(bench.path());
            command.envs(engine.get_envs().filter_map(|(name, value)| Some((name, value?))));
            let output = command.output().unwrap();
            let told = String::from_utf8_lossy(&output.stderr);
            let which = format!("{arguments:?}: {call} {when}: {told}");
            assert!(!told.contains("panicked"), "{which}");
            if output.status.code() == Some(6) {
                failed += 1;
                assert_eq!(told.matches("error[E-").count(), 1, "{which}");
                // Of one file, the last thing that can fail is to make its new name last: then the new one stands there, whole.
                // So it does where only what was done cannot be told.
                let is_done = call == "fsync" && arguments[0] == "pack" || told.contains("standard output");
                assert!(is_done || files(bench.path()) == before, "{which}");
                assert!(before.keys().all(|path| path.exists()), "{which}");
            } else {
                assert_eq!(output.status.code(), Some(0), "{which}");
            }
            restore(bench, &before);
        }
    }
    failed
}

#[test]
fn an_operation_that_fails_in_any_command_that_writes_is_one_error_and_leaves_what_stood_there() {
    if Command::new("strace").arg("-V").output().is_err() {
        println!("skipped: strace is not here");
        return;
    }
    let bench = Bench::new();
    bench.write("other.rhai", SCRIPT.replace("<= 0.25", "<= 0.4"));
    let explain = &["explain", "one", "--step", "7"][..];
    let rescore = &["rescore", "one", "other.rhai", "--out", "scored"];
    let compare = &["compare", "one", "two", "--out", "compared"];
    bench.engine(&["run", "short.rhai", "--out", "one"]);
    bench.engine(&["run", "short.rhai", "--seed", "2", "--out", "two"]);
    for again in 0..2 {
        // Into folders that are new, then into those that hold what was written before.
        for command in [explain, rescore, compare] {
            let failed = failed(&bench, command);
            assert!(failed > 2, "{command:?}: {failed}");
            if again == 0 {
                bench.ok(command);
            }
        }
    }
    let file = crate::pack::flow::signed_pack(&bench, "ada/short");
    bench.ok(&["pack", "keygen", "bob", "--no-password"]);
    for command in [
        &["pack", "sign", &file, "--key", "bob.key"][..],
        &["pack", "trust", "bob", "--key", "bob.pub"],
        &["pack", "install", &file],
    ] {
        let failed = failed(&bench, command);
        assert!(failed > 1, "{command:?}: {failed}");
    }
}
