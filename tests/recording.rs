use crate::support::Bench;

#[cfg(feature = "mcap")]
mod with_recording {
    use std::process::Command;

    use serde_json::Value;

    use super::Bench;
    use crate::support::root;

    /// A Python that has the readers, if there is one: `.ci/run` makes it.
    fn python() -> Option<String> {
        let python = std::env::var("ENGINE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let found = Command::new(&python).args(["-c", "import mcap, mcap_protobuf"]).output();
        let found = found.is_ok_and(|output| output.status.success());
        if !found {
            println!("skipped: no Python with the packages mcap and mcap-protobuf-support (set ENGINE_PYTHON)");
        }
        found.then_some(python)
    }

    #[test]
    fn a_recording_is_read_back_by_another_reader() {
        let bench = Bench::new();
        bench.engine(&["run", "short.rhai", "--record", "run.mcap", "--record-every", "100", "--out", "out"]);
        let Some(python) = python() else { return };
        let reader = root().join("tests/fixtures/read_mcap.py");
        let output = Command::new(python).arg(reader).arg(bench.path().join("run.mcap")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let read: Value = serde_json::from_slice(&output.stdout).unwrap();
        // 800 steps of learning and 400 of the test, two images every 100, each with the camera's place and lens; the world and
        // the laser's place once for each phase.
        let counts = [
            ("/scan", 1200),
            ("/step", 1200),
            ("/tf", 1214),
            ("/camera", 12),
            ("/calibration", 12),
            ("/mask", 12),
            ("/world", 2),
        ];
        for (topic, count) in counts {
            assert_eq!(read["counts"][topic], count, "{topic}");
        }
        assert_eq!(read["schemas"]["/scan"], "foxglove.LaserScan");
        assert_eq!(read["schemas"]["/camera"], "foxglove.CompressedImage");
        assert_eq!((&read["camera"], &read["calibrated"]), (&"camera".into(), &"camera".into()));
        // 160 x 120 pixels over 80 degrees: 80 / tan 40, and the middle where pixels begin at 0.
        let [focal, x, y] = [0, 2, 5].map(|at| read["k"][at].as_f64().unwrap());
        assert!((focal - 95.340).abs() < 0.01 && (x, y) == (79.5, 59.5), "{focal} {x} {y}");
        assert_eq!((&read["beams"], &read["png"]), (&181.into(), &true.into()));
        assert_eq!(read["last"]["phase"], "test");
        let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
        let rules = summary["rules"].as_array().unwrap().iter();
        let learned: f64 = rules.map(|rule| rule["total"].as_f64().unwrap()).sum();
        let failures = summary["test"]["failures"].as_f64().unwrap();
        assert!((read["reward"].as_f64().unwrap() - (learned - failures)).abs() < 1e-9);
    }

    #[test]
    fn a_recording_that_cannot_be_made_is_refused_before_learning() {
        let bench = Bench::new();
        assert!(bench.failure(&["run", "short.rhai", "--record", "nowhere/run.mcap"]).starts_with("exit status 6"));
        assert!(
            bench.failure(&["run", "short.rhai", "--record", "run.mcap", "--seeds", "2"]).starts_with("exit status 2")
        );
    }
}

#[test]
#[cfg(not(feature = "mcap"))]
fn an_engine_without_recording_says_how_to_build_one() {
    let text = Bench::new().failure(&["run", "short.rhai", "--record", "run.mcap"]);
    assert!(text.contains("E-RECORD-BUILD") && text.contains("--features mcap"), "{text}");
}
