use std::io::BufReader;
use std::net::TcpStream;

use serde_json::Value;

use super::served::{Served, message};
use crate::support::{Bench, SCRIPT};

/// The run of a save, learned and tested.
fn done(events: &mut BufReader<TcpStream>, save: u64) -> Value {
    message(events, |said| said["kind"] == "run" && said["save"] == save && said["done"] == true)
}

/// Waits until the folder holds a run of so many steps.
fn written(served: &Served, steps: u64) {
    let is_there = || {
        let text = std::fs::read_to_string(served.bench.path().join("kept/report.html")).ok();
        let summary = std::fs::read_to_string(served.bench.path().join("kept/2/summary.json")).ok();
        let summary: Option<Value> = summary.and_then(|summary| serde_json::from_str(&summary).ok());
        text.is_some_and(|text| text.contains(&format!("\"planned_steps\":{steps}")))
            && summary.is_some_and(|summary| summary["steps"] == steps)
    };
    for _ in 0..600 {
        if is_there() {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    panic!("no run of {steps} steps was written");
}

#[test]
fn a_kept_table_learns_on_and_the_run_on_disk_is_reproduced_bit_for_bit() {
    for (how, table) in [("--keep", "keep"), ("--keep=decay", "decay"), ("--keep=reset", "reset")] {
        let served = Served::new(&["--port", "0", how, "--out", "kept"]);
        let mut events = served.events();
        let first = done(&mut events, 1);
        assert!(first["document"]["swaps"].as_array().unwrap().is_empty());
        served
            .bench
            .write("short.rhai", SCRIPT.replace("<= 0.25 => -1", "<= 0.4 => -2").replace("\"contact\"", "\"touch\""));
        let second = done(&mut events, 2);
        let document = &second["document"];
        assert_eq!(document["swaps"], serde_json::json!([{ "step": 800, "table": table }]));
        let curve = document["seeds"][1]["curve"].as_array().unwrap();
        assert_eq!((curve.len(), &curve[..2]), (4, &first["document"]["seeds"][1]["curve"].as_array().unwrap()[..]));
        assert!(second["text"].as_str().unwrap().contains(&format!("swapped before step 800, table: {table}")));

        written(&served, 1600);
        let told = served.bench.ok(&["replay", "kept/2", "--verify"]);
        assert!(told.contains("1600 steps of learning and 400 of the test"), "{told}");
        let told = served.bench.ok(&["replay", "kept/2", "--from", "799", "--to", "800"]);
        assert!(told.contains("each is the recorded one, bit for bit"), "{told}");
        assert!(told.contains(&format!("swapped:   the reward before step 800; of the table: {table}")), "{told}");
        assert!(told.contains("\ntouch ") && told.contains("\ncontact "), "{told}");
        let told = served.bench.ok(&["explain", "kept/2", "--step", "800", "--json"]);
        let told: Value = serde_json::from_str(&told).unwrap();
        assert_eq!(told["rules"][1]["name"], "touch");
        let told = served.bench.engine(&["test", "kept/2"]);
        assert!(told.stderr.is_empty() && String::from_utf8_lossy(&told.stdout).contains("400 steps"), "{told:?}");
        let told = served.bench.failure(&["rescore", "kept/2", "short.rhai"]);
        assert!(told.starts_with("exit status 7") && told.contains("swapped while it learned"), "{told}");
    }
}

#[test]
fn a_save_while_the_robots_learn_swaps_the_reward_at_a_step_that_replay_finds_again() {
    let served = Served::new(&["--port", "0", "--keep", "--out", "kept"]);
    let mut events = served.events();
    done(&mut events, 1);
    served.bench.write("short.rhai", SCRIPT.replace("steps: 800", "steps: 300_000"));
    message(&mut events, |said| said["kind"] == "run" && said["save"] == 2);
    served.bench.write("short.rhai", SCRIPT.replace("steps: 800", "steps: 400").replace("=> -1", "=> -3"));
    let swapped = done(&mut events, 3);
    let swaps = swapped["document"]["swaps"].as_array().unwrap();
    let step = swaps[1]["step"].as_u64().unwrap();
    assert_eq!((swaps.len(), swaps[0]["step"].as_u64(), step % 400), (2, Some(800), 0));
    assert!((801..300_800).contains(&step), "{step}");
    for seed in swapped["document"]["seeds"].as_array().unwrap() {
        assert_eq!(seed["curve"].as_array().unwrap().len() as u64, step / 400 + 1);
    }
    written(&served, step + 400);
    let told = served.bench.ok(&["replay", "kept/2", "--verify"]);
    assert!(told.contains(&format!("{} steps of learning", step + 400)), "{told}");
}

#[test]
fn a_bad_save_lets_the_robots_learn_on_under_the_last_good_script() {
    let served = Served::new(&["--port", "0", "--keep", "--out", "kept"]);
    let mut events = served.events();
    done(&mut events, 1);
    served.bench.write("short.rhai", SCRIPT.replace("steps: 800", "steps: 150_000"));
    message(&mut events, |said| said["kind"] == "run" && said["save"] == 2);
    served.bench.write("short.rhai", SCRIPT.replace("laser.nearest", "laser.nearst"));
    message(&mut events, |said| said["kind"] == "failed");
    let run = done(&mut events, 3);
    assert_eq!(run["document"]["planned_steps"], 150_800);
    assert!(run["document"]["script"].as_str().unwrap().contains("150_000"));
    // The error stays in sight.
    assert_eq!(message(&mut events, |_| true)["kind"], "failed");
    served.bench.write("short.rhai", SCRIPT);
    assert_eq!(done(&mut events, 4)["document"]["planned_steps"], 151_600);
}

#[test]
fn what_changes_more_than_the_reward_goes_on_or_is_learned_from_nothing() {
    let served = Served::new(&["--port", "0", "--keep", "--out", "kept"]);
    let mut events = served.events();
    done(&mut events, 1);
    served.bench.write("short.rhai", format!("camera(#{{ tilt_deg: 40 }});\n{SCRIPT}"));
    let run = done(&mut events, 2);
    assert_eq!(
        (run["document"]["swaps"].as_array().unwrap().len(), &run["document"]["planned_steps"]),
        (0, &800.into())
    );
    let kept = "camera.tilt_deg changed: kept the memory of 800 steps, forgot how often";
    assert!(run["text"].as_str().unwrap().contains(kept), "{}", run["text"]);
    served.bench.write("short.rhai", format!("grid(#{{ rows: 2 }});\n{SCRIPT}"));
    let run = done(&mut events, 3);
    assert!(run["text"].as_str().unwrap().contains(" changed, so from nothing"), "{}", run["text"]);
    // Whoever asks for it gets it from nothing too.
    let own = format!("Origin: http://127.0.0.1:{}\r\nContent-Length: 0\r\n", served.port);
    assert_eq!(served.status("POST", "/relearn", &own), 202);
    assert!(done(&mut events, 4)["document"]["swaps"].as_array().unwrap().is_empty());
}

#[test]
fn a_script_that_uses_a_policy_learns_on_while_the_policy_stays_the_same() {
    let script = |limit: &str| {
        format!(
            "policy(\"old\", \"runs/old/1\");\nuse \"old\" when laser.front < 1.0;\n{}",
            SCRIPT.replace("<= 0.25", limit)
        )
    };
    let bench = Bench::new();
    bench.write("old.rhai", SCRIPT);
    bench.engine(&["run", "old.rhai"]);
    bench.write("short.rhai", script("<= 0.25"));
    let served = Served::of(bench, "short.rhai", &["--port", "0", "--keep", "--out", "kept"]);
    let mut events = served.events();
    done(&mut events, 1);
    served.bench.write("short.rhai", script("<= 0.4"));
    let second = done(&mut events, 2);
    assert_eq!(second["document"]["swaps"][0]["step"], 800, "{}", second["text"]);
    written(&served, 1600);
    let told = served.bench.ok(&["replay", "kept/2", "--verify"]);
    assert!(told.contains("1600 steps of learning"), "{told}");
}

#[test]
fn the_run_of_another_script_is_not_replaced_by_watching_and_an_older_one_of_this_script_is() {
    let bench = Bench::new();
    bench.write("other.rhai", SCRIPT);
    for (script, out) in [("other.rhai", "theirs"), ("short.rhai", "one")] {
        bench.engine(&["run", script, "--seeds", if out == "one" { "1" } else { "2" }, "--out", out]);
        let before = bench.read(&format!("{out}/run.toml"));
        let told = bench.failure(&["watch", "short.rhai", "--seeds", "2", "--no-open", "--port", "0", "--out", out]);
        assert!(told.starts_with("exit status 6\n") && told.contains("E-RUN-TAKEN"), "{told}");
        assert_eq!(bench.read(&format!("{out}/run.toml")), before);
    }
    bench.engine(&["run", "short.rhai", "--seeds", "2", "--steps", "400", "--out", "kept"]);
    let served = Served::of(bench, "short.rhai", &["--port", "0", "--out", "kept"]);
    done(&mut served.events(), 1);
    written(&served, 800);
}
