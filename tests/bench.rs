use crate::support::Bench;

#[test]
fn a_bench_measures_every_stage_beside_its_yardsticks() {
    let bench = Bench::new();
    let arguments =
        ["--behaviour", "short.rhai", "--steps", "1200", "--size", "64x48", "--lens", "fisheye", "--texture"];
    let output = bench.engine(&[&["bench", "--json"][..], &arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["image"], serde_json::json!([64, 48]));
    assert_eq!((report["lens"].as_str(), report["textured"].as_bool()), (Some("fisheye"), Some(true)));
    let names: Vec<_> =
        report["stages"].as_array().unwrap().iter().map(|stage| stage["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["physics", "camera", "laser", "filter", "state", "script", "learner", "log"]);
    assert!(report["stages"].as_array().unwrap().iter().all(|stage| stage["us"].as_f64().unwrap() > 0.0));
    for figure in
        ["step_us", "steps_per_second_one_core", "steps_per_second_all_cores", "copy_of_one_frame_us", "empty_step_us"]
    {
        assert!(report[figure].as_f64().unwrap() > 0.0, "{figure}");
    }
    let copies = report["step_us"].as_f64().unwrap() / report["copy_of_one_frame_us"].as_f64().unwrap();
    assert!((report["step_in_copies"].as_f64().unwrap() - copies).abs() < 1e-9 * copies);
}

#[test]
fn a_size_that_is_none_is_a_usage_error_that_shows_one() {
    let failure = Bench::new().failure(&["bench", "--size", "320"]);
    assert!(failure.starts_with("exit status 2\n") && failure.contains("320x240"), "{failure}");
}
