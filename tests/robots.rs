use crate::support::{Bench, root};

/// A behaviour of some robot, short enough for a test.
fn script(robot: &str, period_s: f64) -> String {
    format!(
        "{robot}\nworld(\"small\");\nrun(#{{ steps: 400, test_steps: 200, period_s: {period_s} }});\n\
         rule \"hit\" when robot.contact => -1 then recover;\n"
    )
}

fn summary(bench: &Bench, run: &str) -> serde_json::Value {
    serde_json::from_str(&bench.read(&format!("{run}/summary.json"))).unwrap()
}

#[test]
fn every_robot_that_ships_learns_and_its_run_is_reproduced() {
    let bench = Bench::new();
    for (robot, period_s) in [("duckiebot", 0.3), ("f1tenth", 0.2), ("turtlebot3", 0.5)] {
        bench.write(&format!("{robot}.rhai"), script(&format!("robot(\"{robot}\");"), period_s));
        bench.engine(&["run", &format!("{robot}.rhai"), "--out", robot]);
        assert!(summary(&bench, robot)["test"]["distance_m"].as_f64().unwrap() > 1.0, "{robot}");
        bench.ok(&["replay", robot, "--verify"]);
    }
}

#[test]
fn the_pioneer_by_its_name_leaves_the_bytes_of_a_script_without_a_name() {
    let bench = Bench::new();
    bench.write("named.rhai", script("robot(\"pioneer2at\");", 0.5));
    bench.write("plain.rhai", script("", 0.5));
    for run in ["named", "plain"] {
        bench.engine(&["run", &format!("{run}.rhai"), "--out", run]);
    }
    assert_eq!(summary(&bench, "named")["state_hash"], summary(&bench, "plain")["state_hash"]);
}

#[test]
fn a_run_and_a_pack_keep_the_body_that_stood_beside_the_script() {
    let bench = Bench::new();
    let body = std::fs::read_to_string(root().join("robots/turtlebot3.toml")).unwrap();
    bench.write("robots/mine.toml", body.replace("radius_m = 0.105", "radius_m = 0.2"));
    bench.write("own.rhai", script("robot(\"mine\");", 0.5));
    bench.engine(&["run", "own.rhai", "--out", "a"]);
    bench.ok(&["pack", "new", "ada/own", "--from", "own.rhai"]);
    std::fs::remove_dir_all(bench.path().join("robots")).unwrap();
    bench.ok(&["replay", "a", "--verify"]);
    assert!(bench.read("own/robots/mine.toml").contains("radius_m = 0.2"));
    bench.ok(&["pack", "build", "own", "--out", "own.pack"]);
    let text = bench.failure(&["check", "own.rhai"]);
    assert!(text.contains("error[E-ROBOT-FILE]: there is no robot 'mine'"), "{text}");
    let listed = bench.read("own/pack.toml").replace("\"robots/mine.toml\",", "");
    bench.write("own/pack.toml", listed);
    std::fs::remove_file(bench.path().join("own/robots/mine.toml")).unwrap();
    let text = bench.failure(&["run", "own"]);
    assert!(text.contains("error[E-PACK-ROBOT]") && text.contains("puts robots/mine.toml into the pack"), "{text}");
}
