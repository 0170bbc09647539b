use std::path::Path;
use std::process::Command;

use crate::support::{Bench, root};

const ALIKE: &str = "50 of 50 frames: mask, cells, state and action alike";

/// Every filter that has a port, ranges, what is true or false, guards.
const MANY: &str = "world(\"WORLDS/dock.toml\"); recovery(\"start\");\n\
    view(\"edges\", filter(\"blur\"), filter(\"sobel\"), filter(\"horizon\", #{ narrowing: 0.3 }), grid(#{ rows: 3, columns: 3, fill: false }));\n\
    view(\"blue\", filter(\"colour\", #{ hue_deg: 240 }), grid(#{ rows: 1, columns: 3, occupied: 0.01 }));\n\
    state(\"edges\", bins(laser.front, [0.5, 1.0, 2.0]), \"blue\", bins(robot.contact));\n\
    run(#{ steps: 600, test_steps: 300 });\n\
    forbid \"ahead\" when laser.front < 0.9 => action.linear > 0.1;\n\
    rule \"hit\" when robot.contact => -1 then recover;\n";
const REMEMBERS: &str = "world(\"WORLDS/room.toml\");\nfilter(\"scharr\"); grid(#{ remember_s: 2.0, rows: 2 });\nlearner(#{ kind: \"ttd\" });\n\
    run(#{ steps: 600, test_steps: 300 });\nrule \"hit\" when robot.contact => -1 then recover;\n";
const BRIGHT: &str = "world(\"WORLDS/room-coloured.toml\");\nfilter(\"threshold\", #{ threshold: 100, invert: true });\n\
    run(#{ steps: 600, test_steps: 300 });\nrule \"hit\" when robot.contact => -1 then recover;\n";
const CHROMA: &str = "world(\"WORLDS/room-coloured.toml\");\nfilter(\"chroma\");\n\
    run(#{ steps: 600, test_steps: 300 });\nrule \"hit\" when robot.contact => -1 then recover;\n";

/// With the worlds that ship.
fn in_place(script: &str) -> String {
    script.replace("WORLDS", &root().join("worlds").display().to_string())
}

/// Runs a script, exports what it learned to `out`.
fn exported(script: &str) -> Bench {
    let bench = Bench::new();
    bench.write("own.rhai", in_place(script));
    bench.engine(&["run", "own.rhai", "--out", "run"]);
    bench.success(&["export", "run", "--out", "out"]);
    bench
}

/// What a program says in the folder of the export; nothing where the program is not there.
fn said(bench: &Bench, program: &Path, arguments: &[&str]) -> Option<String> {
    let folder = bench.path().join("out");
    let output = Command::new(program).args(arguments).current_dir(folder).output().ok()?;
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(output.status.success(), "{}: {text}", program.display());
    Some(text)
}

/// Holds the C files against the kit: built by a compiler with a flag, run by an emulator if one is named.
fn checked_in_c(bench: &Bench, compiler: &str, flag: &str, emulator: Option<&str>) {
    let options = [
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        "-static",
        flag,
        "-o",
        "check",
        "check.c",
        "policy.c",
    ];
    let built = said(bench, Path::new(compiler), &options);
    let found = match (built, emulator) {
        (None, _) => None,
        (Some(_), None) => said(bench, &bench.path().join("out/check"), &[]),
        (Some(_), Some(emulator)) => said(bench, Path::new(emulator), &["./check"]),
    };
    match found {
        Some(text) => assert_eq!(text.trim(), ALIKE, "{compiler} {flag}"),
        None => assert!(!required(), "{compiler} or {emulator:?} is missing"),
    }
}

fn required() -> bool {
    std::env::var_os("ENGINE_COMPILERS").is_some_and(|value| value == "required")
}

#[test]
fn the_c_port_makes_of_every_frame_what_the_engine_made_of_it() {
    for script in [MANY, REMEMBERS, BRIGHT, CHROMA] {
        let bench = exported(script);
        for flag in ["-O0", "-O3"] {
            checked_in_c(&bench, "cc", flag, None);
        }
        if Path::new("/usr/bin/qemu-arm").exists() {
            checked_in_c(&bench, "arm-linux-gnueabihf-gcc", "-O2", Some("qemu-arm"));
        } else {
            println!("skipped: ARM, no qemu-arm");
        }
    }
}

#[test]
fn the_python_port_makes_of_every_frame_what_the_engine_made_of_it() {
    let cache = std::env::var_os("XDG_CACHE_HOME").map(std::path::PathBuf::from);
    let home = std::env::var_os("HOME").map(|home| Path::new(&home).join(".cache"));
    let python = cache.or(home).map(|cache| cache.join("engine-ci-python/bin/python"));
    let numpy = |python: &std::path::PathBuf| {
        Command::new(python).args(["-c", "import numpy"]).output().is_ok_and(|output| output.status.success())
    };
    let Some(python) = python.filter(numpy) else {
        println!("skipped: Python, no numpy");
        return;
    };
    for script in [MANY, REMEMBERS, BRIGHT, CHROMA] {
        assert_eq!(said(&exported(script), &python, &["check.py"]).unwrap().trim(), ALIKE);
    }
}

#[test]
fn a_port_that_is_wrong_is_told_so_and_in_what() {
    let bench = exported(REMEMBERS);
    let wrong = bench.read("out/policy.c").replace("height = row + 1;", "height = row;");
    bench.write("out/policy.c", wrong);
    let folder = bench.path().join("out");
    let built = Command::new("cc").args(["-o", "check", "check.c", "policy.c"]).current_dir(&folder).output();
    if !built.is_ok_and(|output| output.status.success()) {
        println!("skipped: no C compiler");
        return;
    }
    let output = Command::new(folder.join("check")).current_dir(&folder).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text.contains(" differs in: state") && !text.contains("differs in: mask"), "{text}");
}

#[test]
fn a_folder_with_something_else_is_left_alone_and_an_export_only_replaced_if_asked() {
    let bench = exported(REMEMBERS);
    let text = bench.failure(&["export", "run", "--out", "out"]);
    assert!(text.contains("error[E-RUN-TAKEN]: 'out' holds another export"), "{text}");
    bench.write("out/mine.c", "int mine;\n");
    bench.success(&["export", "run", "--out", "out", "--force"]);
    assert_eq!(bench.read("out/mine.c"), "int mine;\n");
    let text = bench.failure(&["export", "run", "--out", "run", "--force"]);
    assert!(text.contains("error[E-RUN-TAKEN]: 'run' holds something else than an export"), "{text}");
    assert!(bench.path().join("run/policy.toml").exists());
}

#[test]
fn what_has_no_port_is_told_with_what_has_one() {
    let bench = Bench::new();
    bench.write(
        "own.rhai",
        in_place(BRIGHT)
            .replace("filter(\"threshold\", #{ threshold: 100, invert: true })", "filter(\"where\", \"r > g\")"),
    );
    bench.engine(&["run", "own.rhai", "--out", "run"]);
    let text = bench.failure(&["export", "run", "--out", "out"]);
    assert!(text.contains("error[E-EXPORT]: filter 'where' has no port"), "{text}");
    assert!(!bench.path().join("out").exists());
}
