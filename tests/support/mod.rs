//! Runs the engine in a scratch folder.

pub(crate) mod filters;
pub(crate) mod mutate;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The top of the repository.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A scratch folder with a small world and whatever files a test writes.
pub(crate) struct Bench {
    folder: tempfile::TempDir,
}

/// A room of 6 x 6 m with a lap 0.7 m off the wall.
pub(crate) const WORLD: &str = r#"description = "a small room"

[floor]
material = "floor"

[[material]]
name = "floor"
colour = [120, 120, 120]

[[material]]
name = "wall"
colour = [190, 190, 190]

[[wall]]
points_m = [[0, 0], [6, 0], [6, 6], [0, 6]]
closed = true
height_m = 1.0
thickness_m = 0.1
material = "wall"

[[start]]
position_m = [3.0, 0.7]
yaw_deg = 0

[[route]]
name = "lap"
points_m = [[0.7, 0.7], [5.3, 0.7], [5.3, 5.3], [0.7, 5.3]]
closed = true
"#;

/// A short behaviour in that room.
pub(crate) const SCRIPT: &str = r#"world("small");
run(#{ steps: 800, test_steps: 400 });
rule "too close" when laser.nearest <= 0.25 => -1 then recover;
rule "contact" when robot.contact => -1 then recover;
"#;

impl Bench {
    /// A folder with `worlds/small.toml` and `short.rhai`.
    pub(crate) fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        bench.write("worlds/small.toml", WORLD);
        bench.write("short.rhai", SCRIPT);
        bench
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path().join(name)).unwrap()
    }

    /// The engine, with the scratch folder as its working folder.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_engine"));
        command.args(arguments).current_dir(self.path()).env("NO_COLOR", "1").env("COLUMNS", "100");
        command.env("ENGINE_CONFIG_DIR", self.path().join(".config")).env("ENGINE_DATA_DIR", self.path().join(".data"));
        command
    }

    pub(crate) fn engine(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// What it printed on standard output, once it is seen to exit with 0.
    pub(crate) fn success(&self, arguments: &[&str]) -> String {
        let output = self.engine(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Standard output of a command that must succeed.
    #[track_caller]
    pub(crate) fn ok(&self, arguments: &[&str]) -> String {
        let output = self.engine(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", told(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Exit status and standard error, for a snapshot.
    pub(crate) fn failure(&self, arguments: &[&str]) -> String {
        told(&self.engine(arguments))
    }
}

/// Exit status and standard error; a panic fails the test.
pub(crate) fn told(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    format!("exit status {}\n{text}", output.status.code().unwrap())
}

/// What `engine test --json` prints is the test of a run's summary, with its base lines and its verdict.
pub(crate) fn assert_tested_again(summary: &serde_json::Value, stdout: &[u8]) {
    let mut again: serde_json::Value = serde_json::from_slice(stdout).unwrap();
    for part in ["untrained", "blind", "verdict"] {
        assert_eq!(again.as_object_mut().unwrap().remove(part).unwrap_or_default(), summary[part], "{part}");
    }
    assert_eq!(again, summary["test"]);
}
