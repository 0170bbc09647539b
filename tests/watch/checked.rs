use super::served::{Served, message, status};
use crate::support::{Bench, SCRIPT};

/// Whoever hardly moves is paid.
const SLOW: &str = "rule \"slow\" when action.linear < 0.1 => 1;";

#[test]
fn after_the_test_the_page_is_told_what_the_reward_can_be_had_for() {
    let served = Served::new(&[]);
    let mut events = served.events();
    let run = message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    assert!(run["document"]["checked"].is_null());
    let first = message(&mut events, |said| said["kind"] == "checked");
    assert_eq!(first["save"], 1);
    served.bench.write("short.rhai", format!("{SCRIPT}{SLOW}"));
    let second = message(&mut events, |said| said["kind"] == "checked");
    let exploits = &second["checked"]["exploits"];
    assert_eq!((&second["save"], &exploits["verdict"]), (&2.into(), &"pays".into()));
    let cheapest = &exploits["behaviours"][exploits["cheapest"].as_u64().unwrap() as usize];
    assert_eq!(cheapest["nowhere"], true);
    assert!(exploits["sentence"].as_str().unwrap().contains(cheapest["behaviour"].as_str().unwrap()));
    let codes: Vec<_> = second["findings"].as_array().unwrap().iter().map(|found| found["code"].as_str()).collect();
    assert!(codes.contains(&Some("W-EXPLOIT")), "{codes:?}");
    // Who comes later gets the run and what was found in it, in this order.
    let mut late = served.events();
    assert_eq!(message(&mut late, |_| true)["kind"], "run");
    assert_eq!(message(&mut late, |_| true)["checked"], second["checked"]);
}

#[test]
fn the_check_of_the_page_is_that_of_the_command() {
    let served = Served::new(&[]);
    let told = message(&mut served.events(), |said| said["kind"] == "checked");
    let report = served.bench.engine(&["check", "short.rhai", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&report.stdout).unwrap();
    assert_eq!(told["checked"]["exploits"], report["exploits"]);
    assert_eq!(told["checked"]["steps"], report["steps"]);
}

#[test]
fn combined_policies_are_tested_on_each_save_of_the_script_and_of_a_policy() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    bench.write("other.rhai", SCRIPT.replace("0.25", "0.4"));
    bench.engine(&["run", "other.rhai"]);
    let both = format!("policy(\"one\", \"runs/short/1\"); policy(\"two\", \"runs/other/1\");\n{SCRIPT}");
    bench.write("both.rhai", &both);
    let served = Served::of(bench, "both.rhai", &[]);
    let mut events = served.events();
    let first = message(&mut events, |said| said["kind"] == "run");
    assert_eq!((&first["save"], &first["done"]), (&1.into(), &true.into()));
    let seed = &first["document"]["seeds"][1];
    assert!(seed["learning"].is_null() && seed["curve"].as_array().unwrap().is_empty());
    assert_eq!(message(&mut events, |said| said["kind"] == "checked")["checked"]["exploits"], serde_json::Value::Null);
    served.bench.engine(&["run", "both.rhai", "--seed", "2"]);
    let summary: serde_json::Value = serde_json::from_str(&served.bench.read("runs/both/2/summary.json")).unwrap();
    assert_eq!(seed["test"], summary["test"]);
    served.bench.write("both.rhai", both.replace("test_steps: 400", "test_steps: 200"));
    let second = message(&mut events, |said| said["kind"] == "run");
    assert_eq!(second["document"]["seeds"][0]["tested"]["steps"], 200);
    let policy = served.bench.read("runs/other/1/policy.toml");
    served.bench.write("runs/other/1/policy.toml", "nothing");
    let failed = message(&mut events, |said| said["kind"] == "failed");
    assert_eq!(failed["error"]["code"], "E-POLICY");
    served.bench.write("runs/other/1/policy.toml", policy);
    message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
}

#[test]
fn where_nothing_is_learned_nothing_can_be_kept() {
    let bench = Bench::new();
    bench
        .write("both.rhai", format!("policy(\"one\", \"runs/short/1\"); policy(\"two\", \"runs/other/1\");\n{SCRIPT}"));
    let served = Served::of(bench, "both.rhai", &["--port", "0", "--out", "kept"]);
    let failed = message(&mut served.events(), |said| said["kind"] == "failed");
    assert_eq!(failed["error"]["code"], "E-WATCH-POLICIES");
    assert!(failed["text"].as_str().unwrap().contains("leave out --keep and --out"), "{failed}");
}

#[test]
fn a_filter_that_comes_later_is_noticed_once_it_is_whole() {
    let bench = Bench::new();
    bench.write("filters/readme.txt", "filters go here");
    let served = Served::of(bench, "short.rhai", &["--port", "0", "--filter-dir", "filters"]);
    let mut events = served.events();
    message(&mut events, |said| said["kind"] == "checked");
    served.bench.write("filters/readme.txt", "this is no filter");
    served.bench.write("filters/libedges.so", "half of it");
    std::thread::sleep(std::time::Duration::from_millis(50));
    served.bench.write("filters/libedges.so", "half of it, and the rest");
    assert_eq!(message(&mut events, |said| said["kind"] == "run")["save"], 2);
    message(&mut events, |said| said["kind"] == "checked");
    // One save for the two writes: the next one is the script's.
    served.bench.write("short.rhai", SCRIPT.replace("<= 0.25", "<= 0.4"));
    let third = message(&mut events, |said| said["kind"] == "run");
    assert_eq!(third["save"], 3);
    assert!(third["document"]["script"].as_str().unwrap().contains("<= 0.4"));
}

/// Posts another value of a parameter; gives the status.
fn set(served: &Served, save: u64, name: &str, value: &str) -> u16 {
    let Served { port, token, .. } = served;
    let path = format!("/param?save={save}&name={name}&value={value}&token={token}");
    status(&served.answer(
        format!("POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n\r\n").as_bytes(),
    ))
}

#[test]
fn a_parameter_that_is_set_on_the_page_is_learned_with_as_after_a_save() {
    let bench = Bench::new();
    let script = SCRIPT.replace("0.25", "near");
    bench.write("short.rhai", format!("const near = param(0.25, #{{ low: 0.1, high: 0.5 }});\n{script}"));
    let served = Served::of(bench, "short.rhai", &[]);
    let mut events = served.events();
    let first = message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    assert_eq!(first["document"]["params"][0]["value"], 0.25);
    assert_eq!(
        [set(&served, 1, "near", "0.6"), set(&served, 1, "far", "0.3"), set(&served, 9, "near", "0.3")],
        [400, 400, 404]
    );
    assert_eq!(set(&served, 1, "near", "0.4"), 202);
    let second = message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    assert_eq!((&second["save"], &second["document"]["params"][0]["value"]), (&2.into(), &0.4.into()));
    // Gone from the script, it is not asked for any more.
    served.bench.write("short.rhai", SCRIPT);
    let third = message(&mut events, |said| said["kind"] == "run" && said["done"] == true);
    assert!(third["document"]["params"].is_null());
}
