//! Runs that are killed, stopped, doubled or refused by the disk: nothing is lost, and nothing lies.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use engine::experiment::{Learning, Ledger, Overrides, Plan};
use engine::script::Behaviour;

use crate::support::{Bench, root};

/// Learns for a while, with checkpoints on the way.
const LONG: &[&str] = &["run", "short.rhai", "--steps", "6000", "--checkpoint", "400", "--out", "it"];
/// How often the kill loop kills.
const KILLS: u64 = 12;
/// How many operations of each kind fail in turn.
const FAULTS: usize = 4;

fn spawn(bench: &Bench, arguments: &[&str]) -> Child {
    bench.command(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until a run says that it has come to a step.
fn wait_for_progress(child: &mut Child) -> std::io::BufReader<std::process::ChildStderr> {
    let mut progress = std::io::BufReader::new(child.stderr.take().unwrap());
    for _ in 0..3 {
        std::io::BufRead::read_line(&mut progress, &mut String::new()).unwrap();
    }
    progress
}

fn hashes(bench: &Bench, run: &str) -> [String; 2] {
    let summary: serde_json::Value = serde_json::from_str(&bench.read(&format!("{run}/summary.json"))).unwrap();
    ["state_hash", "log_sha256"].map(|key| summary[key].as_str().unwrap().to_owned())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Whether a killed run has left something to go on with.
fn left(bench: &Bench) -> bool {
    names(bench.path())
        .iter()
        .any(|name| name.starts_with(".it.") && bench.path().join(name).join("resume.json").exists())
}

#[test]
fn what_is_saved_in_the_middle_learns_on_bit_for_bit_in_every_shipped_behaviour() {
    let mut scripts: Vec<_> =
        std::fs::read_dir(root().join("scripts")).unwrap().map(|file| file.unwrap().path()).collect();
    scripts.retain(|path| path.extension().is_some_and(|ending| ending == "rhai"));
    scripts.sort();
    let mut kept = 0;
    for path in scripts {
        for learner in [None, Some("learner.kind=ttd".to_owned())] {
            let overrides = Overrides { set: learner.into_iter().collect(), ..Overrides::default() };
            let Ok(plan) = Plan::new(Behaviour::load(&path).unwrap().into(), &overrides) else { continue };
            if !plan.learns() {
                continue;
            }
            let learn = |learning: &mut Learning, steps| {
                learning.run(steps, &AtomicBool::new(false), &|_| (), &mut Ledger::off()).unwrap();
            };
            let mut whole = Learning::new(&plan, 3).unwrap();
            // In the middle of a window.
            learn(&mut whole, 530);
            let saved = whole.save().unwrap();
            learn(&mut whole, 470);
            let mut other = Learning::new(&plan, 3).unwrap();
            learn(&mut other, 40);
            other.load(&saved).unwrap();
            assert!(other.save().unwrap() == saved, "{}", path.display());
            learn(&mut other, 470);
            assert_eq!(whole.finish().state_hash, other.finish().state_hash, "{}", path.display());
            kept += 1;
        }
    }
    assert!(kept > 40, "{kept}");
}

#[test]
fn a_run_that_is_killed_again_and_again_ends_as_one_that_never_was() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--steps", "6000", "--out", "whole"]);
    let whole = hashes(&bench, "whole");
    let (mut milliseconds, mut kills) = (30, 0);
    while kills < KILLS && !bench.path().join("it").exists() {
        let mut child = spawn(&bench, if left(&bench) { &["run", "--resume", "it"] } else { LONG });
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
        (milliseconds, kills) = (milliseconds * 7 / 5, kills + 1);
        if !bench.path().join("it").exists() {
            // Nothing stands there that any command could take for a run.
            for command in [&["test", "it"][..], &["replay", "it"], &["explain", "it", "--step", "10"]] {
                assert_eq!(bench.engine(command).status.code(), Some(7), "{command:?}");
            }
        }
    }
    if left(&bench) {
        let refused = bench.failure(LONG);
        assert!(refused.starts_with("exit status 6\nerror[E-RUN-UNFINISHED]"), "{refused}");
        bench.engine(&["run", "--resume", "it"]);
    } else if !bench.path().join("it").exists() {
        bench.engine(LONG);
    }
    assert_eq!(hashes(&bench, "it"), whole);
    assert_eq!(bench.engine(&["replay", "it", "--verify"]).status.code(), Some(0));
    assert!(names(bench.path()).iter().all(|name| !name.starts_with(".it")), "{:?}", names(bench.path()));
}

#[test]
fn a_run_that_is_stopped_keeps_what_it_learned_and_goes_on_from_there() {
    for (signal, status) in [("-TERM", 143), ("-HUP", 129), ("-INT", 130)] {
        let bench = Bench::new();
        let mut child = spawn(&bench, &["run", "short.rhai", "--steps", "60000", "--out", "it"]);
        let mut progress = wait_for_progress(&mut child);
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let mut told = String::new();
        std::io::Read::read_to_string(&mut progress, &mut told).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(status), "{told}");
        assert!(told.contains("engine run --resume it"), "{told}");
        assert_eq!(bench.engine(&["replay", "it", "--verify"]).status.code(), Some(0));
        bench.engine(&["run", "--resume", "it"]);
        bench.engine(&["run", "short.rhai", "--steps", "60000", "--out", "whole"]);
        assert_eq!(hashes(&bench, "it"), hashes(&bench, "whole"));
        let done = bench.failure(&["run", "--resume", "it"]);
        assert!(done.starts_with("exit status 7\nerror[E-CHECKPOINT]") && done.contains("is done"), "{done}");
    }
}

#[test]
fn a_killed_run_leaves_the_run_that_stood_there_as_it_was() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "it"]);
    bench.write("it/notes.md", "mine");
    let before = hashes(&bench, "it");
    let mut child = spawn(&bench, &["run", "short.rhai", "--steps", "100000000", "--out", "it", "--force"]);
    drop(wait_for_progress(&mut child));
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(hashes(&bench, "it"), before);
    assert_eq!(bench.engine(&["replay", "it", "--verify"]).status.code(), Some(0));
    // The next command sweeps, and what somebody put there moves to the run that replaces it.
    bench.engine(&["run", "short.rhai", "--seed", "2", "--out", "it", "--force"]);
    assert_eq!(bench.read("it/notes.md"), "mine");
    assert!(hashes(&bench, "it") != before && names(bench.path()).iter().all(|name| !name.starts_with(".it")));
}

#[test]
fn of_two_runs_into_one_folder_one_is_told_who_writes_there() {
    let bench = Bench::new();
    let mut child = spawn(&bench, &["run", "short.rhai", "--steps", "100000000", "--out", "it"]);
    drop(wait_for_progress(&mut child));
    for command in [&["run", "short.rhai", "--out", "it"][..], &["run", "--resume", "it"]] {
        let refused = bench.failure(command);
        assert!(refused.starts_with("exit status 6\nerror[E-LOCKED]"), "{refused}");
        assert!(
            refused.contains(&format!("process {} (", child.id())) && refused.contains("run short.rhai"),
            "{refused}"
        );
    }
    child.kill().unwrap();
    child.wait().unwrap();
    bench.engine(&["run", "short.rhai", "--out", "it"]);
    assert_eq!(bench.engine(&["replay", "it"]).status.code(), Some(0));
}

#[test]
fn an_operation_of_the_disk_that_fails_is_one_error_and_leaves_the_old_run() {
    if Command::new("strace").arg("-V").output().is_err() {
        println!("skipped: strace is not here");
        return;
    }
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "it"]);
    let before = hashes(&bench, "it");
    let engine = bench.command(&[]).get_program().to_owned();
    let mut failed = 0;
    for call in ["fsync", "renameat2", "rename", "mkdir", "write"] {
        for when in 1..=FAULTS {
            // What is written first are the lock, run.toml and progress.
            let mut command = Command::new("strace");
            command.args(["-f", "-o", "/dev/null", "-e", &format!("trace={call}")]);
            command.args(["-e", &format!("inject={call}:error=EIO:when={when}")]).arg(&engine);
            command.args(["run", "short.rhai", "--seed", "2", "--force", "--out", "it"]);
            let output = command.current_dir(bench.path()).output().unwrap();
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(!told.contains("panicked"), "{call} {when}: {told}");
            if output.status.code() == Some(6) {
                failed += 1;
                assert_eq!(told.matches("error[E-").count(), 1, "{call} {when}: {told}");
                assert_eq!(hashes(&bench, "it"), before, "{call} {when}");
            } else {
                // It was not so often called, or for something that need not be told.
                assert!(bench.engine(&["replay", "it"]).status.success(), "{call} {when}");
                std::fs::remove_dir_all(bench.path().join("it")).unwrap();
                bench.engine(&["run", "short.rhai", "--out", "it"]);
            }
        }
    }
    assert!(failed > 4, "{failed}");
}

#[cfg(unix)]
#[test]
fn planted_links_pipes_and_devices_are_not_followed_and_hang_nothing() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "it"]);
    bench.write("precious", "mine");
    std::fs::remove_file(bench.path().join("it/summary.json")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", bench.path().join("it/summary.json")).unwrap();
    let refused = bench.failure(&["replay", "it"]);
    assert!(refused.starts_with("exit status 7\nerror[E-RUN-FILE]"), "{refused}");
    std::fs::remove_file(bench.path().join("it/policy.toml")).unwrap();
    assert!(Command::new("mkfifo").arg(bench.path().join("it/policy.toml")).status().unwrap().success());
    assert!(bench.failure(&["test", "it"]).starts_with("exit status 7\n"));
    for planted in [".next.lock", "next"] {
        std::os::unix::fs::symlink("precious", bench.path().join(planted)).unwrap();
        let refused = bench.failure(&["run", "short.rhai", "--out", "next"]);
        assert!(refused.starts_with("exit status 6\nerror[E-IO]"), "{refused}");
        std::fs::remove_file(bench.path().join(planted)).unwrap();
    }
    assert_eq!(bench.read("precious"), "mine");
}

#[test]
fn a_branch_goes_on_from_a_step_under_other_rules_and_names_the_first_that_differs() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "it"]);
    bench.write("other.rhai", crate::support::SCRIPT.replace("<= 0.25 => -1", "<= 0.6 => -1"));
    let text = |script, from: &str, out| {
        let output = bench.engine(&["run", script, "--branch", from, "--out", out]);
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
    };
    let other = text("other.rhai", "it@300", "branched");
    let step = other.split("the first step that differs from the recorded one is ").nth(1).unwrap();
    assert!(step.split(':').next().unwrap().parse::<u64>().unwrap() >= 300, "{other}");
    assert_eq!(bench.engine(&["replay", "branched", "--verify"]).status.code(), Some(0));
    for from in ["it@801", "it@0", "it", "it@-1"] {
        assert!(text("other.rhai", from, "no").contains("error[E-BRANCH]"), "{from}");
    }
}

#[test]
fn runs_that_are_not_done_are_listed_with_how_to_go_on() {
    let bench = Bench::new();
    let long = &["run", "short.rhai", "--steps", "100000000", "--checkpoint", "400", "--out", "runs/it"];
    let listed = || bench.ok(&["runs"]);
    let mut child = spawn(&bench, long);
    drop(wait_for_progress(&mut child));
    let running = listed();
    assert!(running.contains(&format!("is running: process {} (", child.id())), "{running}");
    child.kill().unwrap();
    child.wait().unwrap();
    let killed = listed();
    assert!(killed.contains("runs/it ") && killed.contains("was killed: engine run --resume runs/it"), "{killed}");
    assert!(bench.ok(&["runs", "prune", "--yes"]).contains("removed 0 runs"));
    let mut child = spawn(&bench, &["run", "--resume", "runs/it"]);
    let mut progress = wait_for_progress(&mut child);
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    std::io::Read::read_to_string(&mut progress, &mut String::new()).unwrap();
    child.wait().unwrap();
    let stopped = listed();
    assert!(
        stopped.contains("short in small: ") && stopped.contains("was stopped: engine run --resume runs/it"),
        "{stopped}"
    );
    assert_eq!(stopped.lines().count(), 1, "{stopped}");
}
