use super::served::{Served, message};
use crate::support::{SCRIPT, WORLD};

#[test]
fn a_save_brings_a_new_run_with_the_one_before_behind_it() {
    let served = Served::new(&[]);
    let mut events = served.events();
    let first = message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    assert_eq!(first["save"], 1);
    assert_eq!(first["document"]["seeds"].as_array().unwrap().len(), 2);
    assert!(first["before"].is_null());
    served.bench.write("short.rhai", SCRIPT.replace("<= 0.25", "<= 0.4"));
    let second = message(&mut events, |said| said["kind"] == "run" && said["save"] == 2 && said["done"] == true);
    assert!(second["document"]["script"].as_str().unwrap().contains("<= 0.4"));
    assert_eq!(second["before"]["seeds"][1]["curve"], first["document"]["seeds"][1]["curve"]);
    assert_ne!(second["document"]["seeds"][0]["curve"], first["document"]["seeds"][0]["curve"]);
}

#[test]
fn what_the_page_shows_is_what_a_run_of_the_same_seed_gives() {
    let served = Served::new(&[]);
    let said = message(&mut served.events(), |said| said["kind"] == "run" && said["done"] == true);
    served.bench.engine(&["run", "short.rhai", "--seed", "2"]);
    let summary: serde_json::Value = serde_json::from_str(&served.bench.read("runs/short/2/summary.json")).unwrap();
    let seed = &said["document"]["seeds"][1];
    assert_eq!(seed["curve"], summary["reinforcement_per_400"]);
    assert_eq!(seed["test"], summary["test"]);
}

#[test]
fn a_bad_save_is_told_with_its_line_and_the_last_run_stays() {
    let served = Served::new(&[]);
    let mut events = served.events();
    message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    served.bench.write("short.rhai", SCRIPT.replace("laser.nearest", "laser.nearst"));
    let failed = message(&mut events, |said| said["kind"] == "failed");
    assert_eq!((failed["error"]["code"].as_str(), failed["error"]["line"].as_u64()), (Some("E-SCRIPT-FACT"), Some(3)));
    assert!(failed["text"].as_str().unwrap().contains("did you mean 'nearest'?"));
    let mut late = served.events();
    assert_eq!(message(&mut late, |said| said["kind"] == "run")["save"], 1);
    assert_eq!(message(&mut late, |_| true)["kind"], "failed");
    served.bench.write("short.rhai", SCRIPT);
    assert_eq!(message(&mut events, |said| said["kind"] == "run")["save"], 3);
}

#[test]
fn every_mistake_of_a_save_is_a_block_of_text() {
    let served = Served::new(&[]);
    let mut events = served.events();
    message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    served.bench.write("short.rhai", SCRIPT.replace("laser.nearest", "laser.nearst") + "filter(\"<b>\");\nworld(7);\n");
    let failed = message(&mut events, |said| said["kind"] == "failed");
    let blocks: Vec<&str> = failed["blocks"].as_array().unwrap().iter().map(|block| block.as_str().unwrap()).collect();
    assert_eq!(blocks.len(), 3, "{failed}");
    assert!(blocks[0].contains("nearst") && blocks[1].contains("'<b>'") && blocks[2].contains("world(\"room\")"));
    assert_eq!(failed["summary"], "3 mistakes in 'short.rhai'");
    assert_eq!(failed["error"]["others"][0]["line"], 5);
}

#[test]
fn the_world_is_watched_too() {
    let served = Served::new(&[]);
    let mut events = served.events();
    message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    served.bench.write("worlds/small.toml", WORLD.replace("[3.0, 0.7]", "[2.0, 0.7]"));
    assert_eq!(message(&mut events, |said| said["kind"] == "run")["save"], 2);
    served.bench.write("worlds/small.toml", WORLD.replace("[[wall]]", "[[wal]]"));
    let failed = message(&mut events, |said| said["kind"] == "failed");
    assert!(failed["error"]["file"].as_str().unwrap().ends_with("small.toml"), "{failed}");
}

#[test]
fn any_moment_of_any_seed_can_be_seen() {
    let served = Served::new(&[]);
    message(&mut served.events(), |said| said["kind"] == "run" && said["done"] == true);
    let ask = |path: &str| {
        let request = format!("GET {path}&token={} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", served.token, served.port);
        served.answer(request.as_bytes())
    };
    let body =
        |answer: &str| -> serde_json::Value { serde_json::from_str(answer.split_once("\r\n\r\n").unwrap().1).unwrap() };
    let shot = body(&ask("/frame?save=1&seed=2&phase=learning&step=77"));
    assert_eq!((shot["step"].as_u64(), shot["seed"].as_u64()), (Some(77), Some(2)));
    assert_eq!(shot["scan_mm"].as_array().unwrap().len(), 181);
    assert_eq!(body(&ask("/track?save=1&seed=2"))["learning"]["steps"], 800);
    for nothing in [
        "/frame?save=1&seed=2&phase=learning&step=800",
        "/frame?save=9&seed=2&phase=learning&step=1",
        "/frame?save=1&seed=2&phase=dream&step=1",
        "/track?save=1&seed=3",
    ] {
        assert_eq!(super::served::status(&ask(nothing)), 404, "{nothing}");
    }
    assert_eq!(super::served::status(&ask("/frame?save=1&seed=2&phase=test&step=-1")), 400);
}

#[test]
fn a_newer_save_ends_the_older_run() {
    let served = Served::new(&[]);
    let mut events = served.events();
    message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    served.bench.write("short.rhai", SCRIPT.replace("steps: 800", "steps: 100000000"));
    message(&mut events, |said| said["text"].as_str().unwrap().contains("100000000 steps"));
    served.bench.write("short.rhai", SCRIPT);
    assert_eq!(message(&mut events, |said| said["kind"] == "run" && said["save"] != 2)["save"], 3);
}
