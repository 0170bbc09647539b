//! Learned policies that a script uses: in its own pack, and from another's.

use crate::support::Bench;

const SCRIPT: &str = "world(\"small\"); run(#{ steps: 400, test_steps: 400 });\n\
                      rule \"contact\" when robot.contact => -1 then fail;\n";

#[test]
fn a_behaviour_that_uses_a_policy_is_a_pack_with_the_run_of_it() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let uses = "policy(\"other\", \"runs/short/1\");\nuse \"other\" when laser.front < 1.5;\n";
    bench.write("mine.rhai", format!("{uses}{SCRIPT}"));
    bench.ok(&["pack", "new", "ada/mine", "--from", "mine.rhai"]);
    assert!(bench.read("mine/pack.toml").contains("\nedition = 2\n"));
    bench.ok(&["pack", "build", "mine", "--out", "mine.pack"]);
    std::fs::remove_dir_all(bench.path().join("runs/short")).unwrap();
    assert!(bench.ok(&["pack", "verify", "mine.pack", "--allow-unsigned", "--replay"]).contains("bit for bit"));
}

#[test]
fn a_policy_comes_from_a_pack_too() {
    let bench = Bench::new();
    bench.ok(&["pack", "new", "ada/short", "--from", "short.rhai"]);
    bench.ok(&["pack", "build", "short", "--out", "short.pack"]);
    let uses = "policy(\"other\", \"short.pack\");\nuse \"other\" when laser.front < 1.5;\n";
    bench.write("mine.rhai", format!("{uses}{SCRIPT}"));
    let refused = bench.failure(&["run", "mine.rhai"]);
    assert!(refused.contains("E-TRUST"), "{refused}");
    let output = bench.engine(&["run", "mine.rhai", "--allow-unsigned"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("used:      other drove "), "{text} {}", String::from_utf8_lossy(&output.stderr));
    std::fs::remove_file(bench.path().join("short.pack")).unwrap();
    assert!(bench.ok(&["replay", "runs/mine/1", "--verify"]).contains("bit for bit"));
}
