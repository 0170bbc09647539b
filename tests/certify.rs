use serde_json::Value;

use crate::support::Bench;

const SCRIPT: &str = r#"world("room");
grid(#{ rows: 3, columns: 3, occupied: 0.015 });
camera(#{ height_m: 0.675 });
run(#{ steps: 1200, test_steps: 200 });
rule "too close" when laser.nearest <= 0.25 => -1 then recover;
rule "contact" when robot.contact => -1 then recover;
"#;

/// A folder with a run of a room, which is a world of `small.toml`'s size here.
fn learned() -> Bench {
    let bench = Bench::new();
    bench.write("worlds/room.toml", bench.read("worlds/small.toml"));
    bench.write("room.rhai", SCRIPT);
    let output = bench.engine(&["run", "room.rhai", "--out", "a"]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&output.stderr));
    bench
}

fn certify(bench: &Bench, arguments: &[&str]) -> Value {
    let output = bench.engine(&[&["certify", "a", "--json"], arguments].concat());
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(bench: &Bench, arguments: &[&str], status: i32) -> String {
    let output = bench.engine(&[&["certify"], arguments].concat());
    assert_eq!(output.status.code(), Some(status), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_certificate_has_the_same_bytes_with_any_number_of_threads_and_is_drawn_again() {
    let bench = learned();
    let few = ["--draws", "6", "--steps", "120"];
    let one = certify(&bench, &[&few[..], &["--threads", "1"]].concat());
    let bytes = bench.read("a/certificate.json");
    certify(&bench, &[&few[..], &["--threads", "3", "--out", "b"]].concat());
    assert_eq!(bytes, bench.read("b/certificate.json"));
    // Its own family is that which the world is named after.
    assert_eq!(
        (&one["worlds"][0], &one["draws"], &one["each_its_own_world"]),
        (&"rooms".into(), &6.into(), &true.into())
    );
    assert_eq!(one["failures"]["steps"], 720);
    assert_eq!(one["untrained_failures"]["steps"], 720);
    assert!(bench.path().join("a/certificate.svg").exists() && bench.path().join("a/certificate.png").exists());
    // It stands in the page, which is otherwise the one that was drawn.
    assert_eq!(bench.read("a/report.html").matches("id=\"certificate\"").count(), 1);
    assert_eq!(bench.engine(&["replay", "a", "--verify"]).status.code(), Some(0));
    let again = bench.engine(&["certify", "a", "--again"]);
    assert!(String::from_utf8_lossy(&again.stdout).contains("every figure of certificate.json comes out the same"));
    let others = bench.engine(&["certify", "a", "--again", "--seed", "77"]);
    assert!(String::from_utf8_lossy(&others.stdout).contains("the intervals of the failures"));
    assert_eq!(bytes, bench.read("a/certificate.json"), "drawing again writes nothing");
    bench.write("a/certificate.json", bytes.replace("\"draws\": 6,", "\"draws\": 5,"));
    assert!(refused(&bench, &["a", "--again"], 7).contains("does not come out as it stands there"));
}

#[test]
fn the_worst_draw_is_the_test_that_its_command_does_again() {
    let bench = learned();
    let certificate = certify(&bench, &["--draws", "4", "--steps", "150", "--set", "camera.noise=4"]);
    let (worst, all) = (&certificate["worst"][0], certificate["failures"]["failures"].as_u64().unwrap());
    let (world, seed) = (worst["world"].as_str().unwrap(), worst["seed"].to_string());
    let again = bench.engine(&[
        "test",
        "a",
        "--world",
        world,
        "--seed",
        &seed,
        "--steps",
        "150",
        "--set",
        "camera.noise=4",
        "--json",
    ]);
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["failures"], worst["failures"]);
    assert_eq!(again["untrained"]["failures_per_1000"], worst["untrained_per_1000"]);
    let sum = |spread: &Value| {
        spread.as_array().unwrap().iter().map(|pair| pair[0].as_u64().unwrap() * pair[1].as_u64().unwrap()).sum::<u64>()
    };
    assert_eq!(sum(&certificate["spread"]), all);
}

#[test]
fn a_bound_takes_as_many_draws_as_a_pilot_says_and_tells_whether_it_is_reached() {
    let bench = learned();
    let certificate = certify(&bench, &["--bound", "900", "--steps", "20"]);
    let aim = &certificate["aim"];
    assert_eq!((&aim["pilot_draws"], &aim["reached"], &certificate["draws"]), (&100.into(), &true.into(), &200.into()));
    let counted = certify(&bench, &["--bound", "0.0001", "--draws", "3", "--steps", "20", "--force"]);
    assert_eq!((&counted["aim"]["reached"], &counted["draws"]), (&false.into(), &3.into()));
}

#[test]
fn worlds_that_it_learned_in_are_told_and_what_cannot_be_drawn_is_one_error() {
    let bench = learned();
    let own = certify(&bench, &["--worlds", "room", "--draws", "3", "--steps", "40"]);
    assert_eq!((&own["learned_in"], &own["each_its_own_world"]), (&3.into(), &false.into()));
    assert!(refused(&bench, &["a"], 6).contains("'a' holds a certificate"));
    assert!(refused(&bench, &["a", "--worlds", "romos:3", "--out", "x"], 3).contains("there is no family of worlds"));
    assert!(refused(&bench, &["a", "--again", "--draws", "3"], 2).contains("cannot be used with"));
    assert!(
        refused(&bench, &["a", "--set", "learner.kind=q", "--out", "x"], 2).contains("nothing is learned in a test")
    );
    bench.engine(&["run", "short.rhai", "--out", "small"]);
    let message = refused(&bench, &["small"], 2);
    assert!(
        message.contains("there is no family of worlds like 'small'") && message.contains("--worlds small"),
        "{message}"
    );
    // A run that is done again has no certificate of what stood there before.
    bench.engine(&["run", "room.rhai", "--out", "a", "--force"]);
    assert!(!bench.path().join("a/certificate.json").exists());
}
