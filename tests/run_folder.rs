use crate::support::Bench;

#[test]
fn a_run_leaves_the_files_that_the_manual_names() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let mut names: Vec<String> = std::fs::read_dir(bench.path().join("runs/short/1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let pictures = ["frame", "learning-curve", "policy", "trajectories"];
    let mut wanted: Vec<String> =
        pictures.iter().flat_map(|stem| [format!("{stem}.png"), format!("{stem}.svg")]).collect();
    wanted
        .extend(["curve.csv", "log.bin", "policy.toml", "report.html", "run.toml", "summary.json"].map(str::to_owned));
    wanted.sort();
    assert_eq!(names, wanted);
}

#[test]
fn the_summary_has_every_field_of_the_manual() {
    let bench = Bench::new();
    let output = bench.engine(&["run", "short.rhai", "--json"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary, serde_json::from_str::<serde_json::Value>(&bench.read("runs/short/1/summary.json")).unwrap());
    for field in ["behaviour", "world", "seed", "steps", "steps_per_second", "learned_at", "reinforcement_per_400"] {
        assert!(summary.get(field).is_some(), "{field}");
    }
    assert_eq!(summary["steps"], 800);
    assert_eq!(summary["reinforcement_per_400"].as_array().unwrap().len(), 2);
    assert_eq!(summary["rules"][0]["name"], "too close");
    assert_eq!(summary["state_hash"].as_str().unwrap().len(), 64);
    let test = &summary["test"];
    for field in ["steps", "failures", "failures_per_1000", "distance_m", "net_route_m", "laps", "contacts"] {
        assert!(test[field].is_number(), "{field}");
    }
    assert!(test["mean_speed"].is_number() && test["spinning"].is_number());
    assert_eq!(test["steps"], 400);
}

#[test]
fn many_seeds_leave_a_summary_with_median_worst_and_converged() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--seeds", "3"]);
    let spread: serde_json::Value = serde_json::from_str(&bench.read("runs/short/1-3/summary.json")).unwrap();
    assert_eq!(spread["seeds"].as_array().unwrap().len(), 3);
    assert!(spread["median"]["failures_per_1000"].is_number() && spread["worst"]["laps"].is_number());
    assert!(spread["converged"].is_number());
    assert!(bench.path().join("runs/short/1-3/learning-curve.png").exists());
    assert!(bench.path().join("runs/short/1-3/2/policy.toml").exists());
}

#[test]
fn the_curve_adds_up_to_the_rules() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let table = bench.read("runs/short/1/curve.csv");
    let mut lines = table.lines();
    assert_eq!(lines.next().unwrap(), "step,reinforcement_per_400_steps,too close,contact");
    for line in lines {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(numbers[1], numbers[2] + numbers[3]);
    }
}

#[test]
fn a_setting_on_the_command_line_is_stored_with_the_run() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--set", "camera.tilt_deg=40", "--set", "filter.sobel.threshold=80"]);
    // The behaviour names no filter, so there is none to change: the run is refused before it starts.
    assert!(!bench.path().join("runs").exists());
    bench.engine(&["run", "short.rhai", "--set", "camera.tilt_deg=40"]);
    assert!(bench.read("runs/short/1/run.toml").contains("tilt_deg = 40.0"));
}

#[test]
fn ctrl_c_keeps_what_was_learned() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["run", "short.rhai", "--steps", "100000000", "--out", "stopped"])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The first line of progress says that learning has begun.
    let mut progress = std::io::BufReader::new(child.stderr.take().unwrap());
    std::io::BufRead::read_line(&mut progress, &mut String::new()).unwrap();
    let interrupted = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupted.success());
    std::io::copy(&mut progress, &mut std::io::sink()).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary: serde_json::Value = serde_json::from_str(&bench.read("stopped/summary.json")).unwrap();
    assert_eq!(summary["interrupted"], true);
    assert!(summary["steps"].as_u64().unwrap() < 100_000_000);
    assert!(bench.read("stopped/policy.toml").contains("[[state]]"));
    assert_eq!(bench.engine(&["replay", "stopped", "--verify"]).status.code(), Some(0));
}
