use std::process::{Command, Stdio};

use insta::assert_snapshot;

use crate::support::{Bench, SCRIPT, WORLD, told};

fn script(text: impl AsRef<[u8]>) -> String {
    let bench = Bench::new();
    bench.write("mine.rhai", text);
    bench.failure(&["run", "mine.rhai"])
}

fn rule(line: &str) -> String {
    script(format!("world(\"small\");\n{line}\n"))
}

fn world(from: &str, to: &str) -> String {
    let bench = Bench::new();
    assert!(WORLD.contains(from));
    bench.write("worlds/small.toml", WORLD.replacen(from, to, 1));
    bench.failure(&["run", "short.rhai"])
}

// Files

#[test]
fn a_missing_script() {
    assert_snapshot!(Bench::new().failure(&["run", "shrot.rhai"]));
}

#[test]
fn a_folder_as_script() {
    assert_snapshot!(Bench::new().failure(&["run", "worlds"]));
}

#[test]
fn a_picture_as_script() {
    assert_snapshot!(script(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01"));
}

#[test]
fn invalid_utf_8() {
    assert_snapshot!(script(b"world(\"small\");\n// caf\xe9\n"));
}

#[test]
fn an_empty_script() {
    assert_snapshot!(script(""));
}

// The language

#[test]
fn an_unterminated_comment() {
    assert_snapshot!(rule("/* this never ends\nrule \"close\" when laser < 0.25 => -1;"));
}

#[test]
fn an_unterminated_text() {
    assert_snapshot!(rule("rule \"close when laser < 0.25 => -1;"));
}

#[test]
fn an_unknown_function() {
    assert_snapshot!(rule("wrold(\"small\");"));
}

#[test]
fn an_unknown_fact() {
    assert_snapshot!(rule("rule \"lost\" when laser.rigth > 1.0 => -1;"));
}

#[test]
fn an_unknown_fact_inside_a_function() {
    assert_snapshot!(rule("fn reward(facts) {\n    -facts.action.lineer\n}"));
}

#[test]
fn a_variable_that_is_not_there() {
    assert_snapshot!(rule("rule \"lost\" when lasre.right > 1.0 => -1;"));
}

#[test]
fn a_rule_without_a_value() {
    assert_snapshot!(rule("rule \"close\" when laser < 0.25;"));
}

#[test]
fn a_rule_whose_condition_is_a_number() {
    assert_snapshot!(rule("rule \"close\" when laser.nearest => -1;"));
}

#[test]
fn two_rules_of_one_name() {
    assert_snapshot!(rule("rule \"close\" when laser < 0.25 => -1;\nrule \"close\" when laser < 0.5 => -1;"));
}

#[test]
fn a_beam_that_the_laser_does_not_have() {
    assert_snapshot!(rule("rule \"close\" when laser[200] < 0.25 => -1;"));
}

#[test]
fn a_persistence_of_no_steps() {
    assert_snapshot!(rule("rule \"close\" when laser < 0.25 for 0 steps => -1;"));
}

#[test]
fn a_setting_with_another_unit() {
    assert_snapshot!(rule("camera(#{ height_cm: 81 });\nrule \"close\" when laser < 0.25 => -1;"));
}

#[test]
fn a_setting_out_of_range() {
    assert_snapshot!(rule("camera(#{ tilt_deg: 420 });\nrule \"close\" when laser < 0.25 => -1;"));
}

#[test]
fn a_filter_that_is_not_there() {
    assert_snapshot!(rule("filter(\"sobell\");\nrule \"close\" when laser < 0.25 => -1;"));
}

#[test]
fn a_filter_parameter_out_of_range() {
    assert_snapshot!(rule("filter(\"sobel\", #{ threshold: -3 });\nrule \"close\" when laser < 0.25 => -1;"));
}

#[test]
fn too_many_states() {
    assert_snapshot!(rule("grid(#{ rows: 16, columns: 16 });\nrule \"close\" when laser < 0.25 => -1;"));
}

#[test]
fn a_loop_without_end_at_the_top() {
    assert_snapshot!(rule("loop { }"));
}

#[test]
fn a_loop_without_end_in_the_reward() {
    assert_snapshot!(rule("fn reward(facts) {\n    loop { }\n}"));
}

#[test]
fn a_reward_that_is_not_a_number() {
    assert_snapshot!(rule("fn reward(facts) {\n    sqrt(facts.laser.front - 100.0)\n}"));
}

#[test]
fn a_reward_that_is_text() {
    assert_snapshot!(rule("fn reward(facts) {\n    \"good\"\n}"));
}

#[test]
fn a_rule_value_that_is_not_finite() {
    assert_snapshot!(rule("rule \"close\" when laser < 9.0 => -1.0 / robot.linear * 0.0;"));
}

#[test]
fn a_reward_with_two_parameters() {
    assert_snapshot!(rule("fn reward(facts, more) {\n    -1\n}"));
}

#[test]
fn a_script_that_asks_for_files_and_clocks() {
    assert_snapshot!(rule("import \"/etc/passwd\" as secret;"));
    assert_snapshot!(rule("let now = timestamp();"));
    assert_snapshot!(rule("eval(\"1\");"));
}

// Worlds

#[test]
fn a_world_that_does_not_exist() {
    assert_snapshot!(script(SCRIPT.replace("small", "smal")));
    assert_snapshot!(Bench::new().failure(&["run", "short.rhai", "--world", "nowhere.toml"]));
}

#[test]
fn a_world_with_an_error_in_line_7() {
    assert_snapshot!(world("name = \"floor\"\n", "nmae = \"floor\"\n"));
}

#[test]
fn a_world_in_centimetres() {
    assert_snapshot!(world("height_m = 1.0", "height_cm = 100"));
}

#[test]
fn a_world_with_a_size_of_zero() {
    assert_snapshot!(world("thickness_m = 0.1", "thickness_m = 0"));
}

#[test]
fn a_world_with_a_number_that_is_none() {
    assert_snapshot!(world("height_m = 1.0", "height_m = nan"));
}

#[test]
fn a_world_with_an_unknown_material() {
    assert_snapshot!(world("material = \"wall\"", "material = \"wal\""));
}

#[test]
fn a_start_inside_a_wall() {
    assert_snapshot!(world("position_m = [3.0, 0.7]", "position_m = [3.0, 0.1]"));
}

// Worlds that a behaviour cannot be learned in

#[test]
fn a_recovery_to_a_route_in_a_world_without_one() {
    assert_snapshot!(world("name = \"lap\"", "name = \"other\""));
}

#[test]
fn a_colour_filter_that_never_sees_its_colour() {
    assert_snapshot!(rule(
        "filter(\"colour\", #{ hue_deg: 240 });\nrule \"lost\" when !camera.seen => -1 then recover;"
    ));
}

#[test]
fn a_laser_tilt_at_which_a_rule_can_never_fire() {
    assert_snapshot!(rule("laser(#{ tilt_deg: 45 });\nrule \"far\" when laser.front > 1.0 => -1;"));
}

#[test]
fn a_start_that_a_mover_blocks() {
    let bench = Bench::new();
    // A mover stands on the only start, and there is no lap to go to.
    let parked = "\n[[mover]]\nname = \"van\"\nroute = \"track\"\nspeed_m_per_s = 0.1\noffset_m = 2.3\n\
                  boxes = [{ centre_m = [0, 0, 0.3], size_m = [1, 1, 0.5], material = \"wall\" }]\n";
    bench.write("worlds/small.toml", WORLD.replacen("name = \"lap\"", "name = \"track\"", 1) + parked);
    bench.write("short.rhai", format!("recovery(\"start\");\n{SCRIPT}"));
    assert_snapshot!(bench.failure(&["run", "short.rhai"]));
}

// The command line

#[test]
fn zero_steps() {
    assert_snapshot!(Bench::new().failure(&["run", "short.rhai", "--steps", "0"]));
}

#[test]
fn a_negative_seed() {
    assert_snapshot!(Bench::new().failure(&["run", "short.rhai", "--seed", "-1"]));
}

#[test]
fn a_misspelt_command_and_a_misspelt_flag() {
    assert_snapshot!(Bench::new().failure(&["rnu", "short.rhai"]));
    assert_snapshot!(Bench::new().failure(&["run", "short.rhai", "--sed", "1"]));
}

#[test]
fn a_setting_that_is_not_there() {
    assert_snapshot!(Bench::new().failure(&["run", "short.rhai", "--set", "camera.tlit_deg=40"]));
    assert_snapshot!(Bench::new().failure(&["run", "short.rhai", "--set", "tilt_deg=40"]));
    let shown = Bench::new().failure(&["run", "short.rhai", "--set", "weather.gain=0.5"]);
    assert!(shown.contains("the groups are: run, robot, camera, light, laser, ground, grid, learner"), "{shown}");
}

#[test]
fn an_error_for_a_program_is_one_json_object() {
    let bench = Bench::new();
    bench.write("mine.rhai", "world(\"small\");\nrule \"lost\" when laser.rigth > 1.0 => -1;\n");
    let output = bench.engine(&["run", "mine.rhai", "--json"]);
    assert!(output.stdout.is_empty());
    let error: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!((&error["code"], &error["line"]), (&"E-SCRIPT-FACT".into(), &2.into()));
}

// Runs that are not there

#[test]
fn a_test_of_a_folder_without_a_run() {
    assert_snapshot!(Bench::new().failure(&["test", "worlds"]));
}

#[test]
fn a_damaged_policy() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "a"]);
    bench.write("a/policy.toml", &bench.read("a/policy.toml")[..300]);
    assert!(bench.failure(&["test", "a"]).starts_with("exit status 7\n"));
}

// Disks and pipes

#[test]
fn a_full_disk_behind_standard_output() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let bench = Bench::new();
    let output = bench.command(&["run", "short.rhai", "--json"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(6));
    assert!(told(&output).contains("cannot write to standard output"));
    // What was learned is in the run's folder all the same.
    assert!(bench.path().join("runs/short/1/policy.toml").exists());
}

#[test]
fn a_file_that_cannot_grow() {
    let bench = Bench::new();
    let script = format!("trap '' XFSZ; ulimit -f 0; exec '{}' run short.rhai", env!("CARGO_BIN_EXE_engine"));
    let output = Command::new("sh").args(["-c", &script]).current_dir(bench.path()).output().unwrap();
    assert_snapshot!(told(&output));
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let bench = Bench::new();
    let mut child = bench.command(&["reference"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(told(&output), "exit status 0\n");
}

#[cfg(unix)]
#[test]
fn a_read_only_folder() {
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::process::CommandExt;
    let bench = Bench::new();
    std::fs::set_permissions(bench.path(), std::fs::Permissions::from_mode(0o555)).unwrap();
    let mut command = bench.command(&["run", "short.rhai"]);
    if std::fs::write(bench.path().join("probe"), "").is_ok() {
        // Root may write anywhere; nobody may not.
        command.uid(65_534);
    }
    assert_snapshot!(told(&command.output().unwrap()));
}

#[cfg(not(feature = "tui"))]
#[test]
fn a_view_that_is_not_built_in_names_its_feature() {
    let text = Bench::new().failure(&["watch", "short.rhai", "--tui"]);
    assert!(text.starts_with("exit status 2\n") && text.contains("cargo build --release --features tui"), "{text}");
}
