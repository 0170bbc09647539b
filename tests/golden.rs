//! The recorded bytes of the shipped behaviours. What a declared behaviour change alters is recorded anew:
//!
//! ```text
//! cargo test --release record_the_golden_values -- --ignored
//! git diff tests/golden.toml
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::support::{Bench, root};

/// What one seed leaves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Hashes {
    state_hash: String,
    log_sha256: String,
}

/// By case and seed.
type Golden = BTreeMap<String, BTreeMap<String, Hashes>>;

const SEEDS: usize = 3;
const TTD: &str = "learner.kind=ttd";

/// What is learned with `ttd` too, the learner of the paper and of the first edition: the paper's behaviours, and some with goals,
/// with stages, with several views.
const BY_TTD: &[&str] = &[
    "wall",
    "wall-instant",
    "wall-left",
    "corridor",
    "corridor-erroneous",
    "corridor-speed",
    "platform",
    "object",
    "dock",
    "dock-search",
    "bridge",
];

/// Settings that no shipped script has, each with the script that it is tried on for 1,200 steps.
const VARIANTS: &[(&str, &str)] = &[
    ("wall", "learner.kind=q"),
    ("wall", "learner.kind=sarsa-lambda"),
    ("wall", "learner.kind=ttd-cichosz"),
    ("wall", "learner.kind=ttd learner.replay=3"),
    ("wall", "learner.kind=ttd learner.failure_is_terminal=true"),
    ("wall", "learner.failure_is_terminal=true"),
    ("corridor", "learner.kind=ttd learner.mirror=true"),
    ("corridor", "learner.mirror=true"),
    ("wall", "camera.lens=fisheye"),
    ("wall", "recovery.to=start"),
    ("wall", "world=room-textured"),
    ("wall", "world=room-shadows-tiles"),
    ("object", "light.shadows=true"),
    ("wall-left", "camera.exposure_drift=0.2"),
    ("wall-left", "grid.fill=false"),
];

const HEADER: &str =
    "# What every shipped behaviour left when it was recorded; tests/golden.rs says how to record it anew.\n\n";

/// Runs a shipped behaviour under every seed, in `bench`, with further arguments.
fn run(bench: &Bench, script: &str, further: &[&str]) -> BTreeMap<String, Hashes> {
    let path = root().join(format!("scripts/{script}.rhai"));
    let seeds = SEEDS.to_string();
    let mut arguments = vec!["run", path.to_str().unwrap(), "--seeds", &seeds, "--json"];
    arguments.extend(further);
    if !further.is_empty() {
        arguments.extend(["--out", "variant", "--force"]);
    }
    let output = bench.engine(&arguments);
    assert!(output.status.code().unwrap() <= 1, "{script}: {}", String::from_utf8_lossy(&output.stderr));
    let spread: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |seed: &serde_json::Value, key: &str| seed[key].as_str().unwrap().to_owned();
    let hashes = |seed: &serde_json::Value| {
        let hashes = Hashes { state_hash: text(seed, "state_hash"), log_sha256: text(seed, "log_sha256") };
        (seed["seed"].to_string(), hashes)
    };
    spread["seeds"].as_array().unwrap().iter().map(hashes).collect()
}

/// Everything that is recorded, as it comes out now.
fn now() -> Golden {
    let bench = Bench::new();
    let mut scripts: Vec<String> = std::fs::read_dir(root().join("scripts"))
        .unwrap()
        .filter_map(|entry| Some(entry.unwrap().file_name().to_str()?.strip_suffix(".rhai")?.to_owned()))
        .collect();
    scripts.sort();
    // What follow-and-avoid combines, and what find-and-dock uses.
    for script in ["avoid", "object", "dock"] {
        bench.engine(&["run", root().join(format!("scripts/{script}.rhai")).to_str().unwrap()]);
    }
    let shipped = scripts.iter().map(|script| (script.clone(), run(&bench, script, &[])));
    let by_ttd = BY_TTD.iter().map(|script| (format!("{script} by ttd"), run(&bench, script, &["--set", TTD])));
    let variants = VARIANTS.iter().map(|(script, change)| {
        let mut further = vec!["--steps", "1200", "--set", "run.test_steps=800"];
        for pair in change.split_whitespace() {
            match pair.strip_prefix("world=") {
                Some(world) => further.extend(["--world", world]),
                None => further.extend(["--set", pair]),
            }
        }
        (format!("{script} {change}"), run(&bench, script, &further))
    });
    shipped.chain(by_ttd).chain(variants).collect()
}

#[test]
fn every_shipped_behaviour_leaves_the_bytes_that_were_recorded() {
    let recorded: Golden = toml::from_str(&std::fs::read_to_string(root().join("tests/golden.toml")).unwrap()).unwrap();
    let now = now();
    for (case, seeds) in &now {
        assert_eq!(recorded.get(case), Some(seeds), "{case} (tests/golden.rs says how to record it anew)");
    }
    assert_eq!(recorded.len(), now.len(), "a case is recorded that is not there any more");
}

#[test]
#[ignore = "writes tests/golden.toml: only for a declared behaviour change"]
fn record_the_golden_values() {
    let text = format!("{HEADER}{}", toml::to_string(&now()).unwrap());
    std::fs::write(root().join("tests/golden.toml"), text).unwrap();
}
