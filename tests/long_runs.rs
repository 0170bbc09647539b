//! A run that is longer than a ledger has room for: its log goes on in segments, and is killed, resumed, read and damaged as any.

use std::process::Stdio;

use crate::support::Bench;

/// A segment, and some chunks more: 1,048,576 + 71,424.
const STEPS: &str = "1120000";

/// The quickest behaviour there is: nothing is seen, and the laser has few beams.
const QUICK: &str = "world(\"small\");\nrun(#{ steps: 800, test_steps: 400 });\nlaser(#{ beams: 3 });\n\
                     state(bins(laser.front, [0.5, 1.0]));\nlearner(\"q\");\n\
                     rule \"too close\" when laser.nearest <= 0.25 => -1 then recover;\n";

fn summary(bench: &Bench, run: &str) -> serde_json::Value {
    serde_json::from_str(&bench.read(&format!("{run}/summary.json"))).unwrap()
}

fn long(bench: &Bench, out: &str, more: &[&str]) {
    bench.engine(&[&["run", "quick.rhai", "--steps", STEPS, "--out", out], more].concat());
}

#[test]
fn a_long_run_is_kept_in_segments_that_are_resumed_read_and_verified_as_one_log() {
    let bench = Bench::new();
    bench.write("quick.rhai", QUICK);
    long(&bench, "it", &[]);
    let whole = summary(&bench, "it");
    assert!(bench.path().join("it/log-2.bin").exists() && !bench.path().join("it/log-3.bin").exists());
    // Killed in the second segment and gone on with, it leaves the same bytes.
    let arguments = ["run", "quick.rhai", "--steps", STEPS, "--checkpoint", "50000", "--out", "killed"];
    let mut child = bench.command(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let told = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().unwrap()));
    let comes_to = |line: &str| line.strip_prefix("step ")?.split(':').next()?.parse::<u64>().ok();
    for line in told {
        if comes_to(&line.unwrap()).is_some_and(|step| step > 1_110_000) {
            break;
        }
    }
    child.kill().unwrap();
    child.wait().unwrap();
    bench.engine(&["run", "--resume", "killed"]);
    let again = summary(&bench, "killed");
    assert_eq!((&again["log_sha256"], &again["state_hash"]), (&whole["log_sha256"], &whole["state_hash"]));
    for file in ["log.bin", "log-2.bin"] {
        let bytes = |run: &str| std::fs::read(bench.path().join(run).join(file)).unwrap();
        assert!(bytes("it") == bytes("killed"), "{file}");
    }
    let verified = bench.ok(&["replay", "killed", "--verify"]);
    assert!(verified.contains("bit for bit: 1120000 steps of learning"), "{verified}");
    let replayed = bench.ok(&["replay", "it", "--from", "1119999"]);
    assert!(replayed.contains("played:    1120000 steps of learning"), "{replayed}");
    assert!(bench.ok(&["explain", "it", "--step", "1100000"]).contains("1100000"));

    // A byte of the second segment that is another one, one that is missing, one of another run.
    let path = bench.path().join("it/log-2.bin");
    let bytes = std::fs::read(&path).unwrap();
    let mut changed = bytes.clone();
    changed[3_000_000] ^= 1;
    for (damage, told) in [(Some(changed), "do not match their checksum"), (None, "no such file")] {
        match damage {
            Some(bytes) => std::fs::write(&path, bytes).unwrap(),
            None => std::fs::remove_file(&path).unwrap(),
        }
        let refused = bench.failure(&["replay", "it"]);
        assert!(refused.starts_with("exit status 7\nerror[E-LOG-FILE]") && refused.contains(told), "{refused}");
        assert!(refused.contains("log-2.bin"), "{refused}");
    }
}

#[test]
fn segments_that_are_not_kept_are_in_the_digest_all_the_same() {
    let bench = Bench::new();
    bench.write("quick.rhai", QUICK);
    long(&bench, "first", &["--log-segments", "1"]);
    long(&bench, "all", &[]);
    assert_eq!(summary(&bench, "first")["log_sha256"], summary(&bench, "all")["log_sha256"]);
    assert!(!bench.path().join("first/log-2.bin").exists());
    let replayed = bench.ok(&["replay", "first"]);
    assert!(replayed.contains("played:    1048576 of 1120000 steps of learning"), "{replayed}");
    let verified = bench.ok(&["replay", "first", "--verify"]);
    assert!(verified.contains("bit for bit: 1120000 steps of learning"), "{verified}");
    let beyond = bench.failure(&["explain", "first", "--step", "1100000"]);
    assert!(beyond.contains("E-LOG-STEP"), "{beyond}");
}
