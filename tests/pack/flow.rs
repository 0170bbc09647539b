use std::process::Command;

use crate::support::{Bench, root, told};

/// Seven short steps of learning, so that a build takes a moment.
pub(super) fn small_folder(bench: &Bench, folder: &str, name: &str) {
    let done = bench.engine(&["pack", "new", name, "--from", "short.rhai", "--out", folder]);
    assert!(done.status.success(), "{}", told(&done));
}

/// Builds and signs the small pack under a key that is trusted for its owner.
pub(crate) fn signed_pack(bench: &Bench, name: &str) -> String {
    let owner = name.split('/').next().unwrap();
    small_folder(bench, "made", name);
    let file = format!("{}-0.1.0.pack", name.replace('/', "-"));
    bench.ok(&["pack", "build", "made", "--out", &file]);
    bench.ok(&["pack", "keygen", owner, "--no-password"]);
    bench.ok(&["pack", "sign", &file, "--key", &format!("{owner}.key")]);
    bench.ok(&["pack", "trust", owner, "--key", &format!("{owner}.pub")]);
    std::fs::remove_dir_all(bench.path().join("made")).unwrap();
    file
}

#[test]
fn a_new_folder_runs_at_once_and_is_ready_to_build() {
    let bench = Bench::new();
    bench.ok(&["pack", "new", "ada/wall"]);
    assert!(bench.ok(&["run", "wall", "--out", "out"]).contains("behaviour: wall in room"));
    assert!(bench.ok(&["pack", "check", "wall"]).contains("ready to build"));
}

#[test]
fn what_an_author_forgot_is_said() {
    let bench = Bench::new();
    small_folder(&bench, "short", "ada/short");
    let text = bench.read("short/pack.toml");
    bench.write("short/extra.txt", "x");
    assert!(bench.failure(&["pack", "check", "short"]).contains("add \"extra.txt\" to 'files'"));
    bench.write("short/pack.toml", text.replace("\"readme.md\"", "\"redme.md\""));
    assert!(bench.failure(&["pack", "build", "short"]).contains("did you mean 'readme.md'?"));
    std::fs::remove_file(bench.path().join("short/extra.txt")).unwrap();
    std::fs::remove_file(bench.path().join("short/license")).unwrap();
    bench.write("short/pack.toml", text.replace("    \"license\",\n", "").replace("\"MIT\"", "\"do what you like!\""));
    let output = bench.engine(&["pack", "check", "short"]);
    let out = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(out.contains("add a file 'license'") && out.contains("is no SPDX expression"), "{out}");
}

#[test]
fn the_same_folder_gives_the_same_bytes() {
    let bench = Bench::new();
    small_folder(&bench, "one", "ada/short");
    let copy = bench.path().join("other/place/two");
    std::fs::create_dir_all(copy.join("scripts")).unwrap();
    std::fs::create_dir_all(copy.join("worlds")).unwrap();
    // Another path, another time, another umask: none of them is part of a pack.
    for file in ["worlds/small.toml", "scripts/short.rhai", "readme.md", "license", "pack.toml"] {
        std::fs::copy(bench.path().join("one").join(file), copy.join(file)).unwrap();
        let status = Command::new("chmod").arg("600").arg(copy.join(file)).status().unwrap();
        assert!(status.success());
        let status = Command::new("touch").args(["-d", "2001-02-03"]).arg(copy.join(file)).status().unwrap();
        assert!(status.success());
    }
    bench.ok(&["pack", "build", "one", "--out", "one.pack"]);
    let program = env!("CARGO_BIN_EXE_engine");
    let line = format!("umask 077 && cd other/place && '{program}' pack build two --out two.pack");
    let status = Command::new("sh").args(["-c", &line]).current_dir(bench.path()).status().unwrap();
    assert!(status.success());
    let read = |name: &str| std::fs::read(bench.path().join(name)).unwrap();
    assert!(read("one.pack") == read("other/place/two.pack"));
}

#[test]
fn a_signed_pack_is_verified_installed_run_tested_and_removed() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    assert!(bench.ok(&["pack", "verify", &file]).contains("valid, by key"));
    assert!(bench.ok(&["pack", "inspect", &file]).contains("asks for:  nothing"));
    assert!(bench.ok(&["pack", "install", &file]).contains("installed: ada/short 0.1.0"));
    assert!(bench.read("engine.lock").contains("name = \"ada/short\""));
    std::fs::remove_file(bench.path().join(&file)).unwrap();
    std::fs::remove_file(bench.path().join("worlds/small.toml")).unwrap();
    for name in ["ada/short", "short"] {
        let output = bench.engine(&["run", name, "--out", "out"]);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", told(&output));
        assert!(bench.read("out/summary.json").contains("\"behaviour\": \"short\""));
    }
    let tested = bench.engine(&["test", "ada/short", "--json"]);
    assert!(matches!(tested.status.code(), Some(0 | 1)), "{}", told(&tested));
    assert!(bench.ok(&["pack", "list"]).contains("ada/short 0.1.0"));
    bench.ok(&["pack", "remove", "short"]);
    assert!(!bench.ok(&["pack", "list"]).contains("ada/short"));
    assert_eq!(std::fs::read_dir(bench.path().join(".data/store")).unwrap().count(), 0);
}

#[test]
fn a_replay_says_bit_for_bit_or_where_it_differs() {
    let bench = Bench::new();
    small_folder(&bench, "short", "ada/short");
    bench.ok(&["pack", "build", "short", "--out", "a.pack"]);
    let verify = ["pack", "verify", "a.pack", "--allow-unsigned", "--replay"];
    assert!(bench.ok(&verify).contains("reproduced bit for bit: 3 seeds"));
    // An author who claims a better first window, in a pack that is in order otherwise.
    let pack = pack::Pack::load(&bench.path().join("a.pack")).unwrap();
    let text = pack.text("manifest.toml").unwrap().text;
    let start = text.find("reinforcement_per_400 = [").unwrap() + "reinforcement_per_400 = [".len();
    let end = start + text[start..].find(',').unwrap();
    let lied = format!("{}7.0{}", &text[..start], &text[end..]);
    let files: Vec<_> = pack.files().filter(|(path, _)| *path != "manifest.toml").collect();
    let mut bytes = Vec::new();
    pack::archive::write([("manifest.toml", lied.as_bytes())].into_iter().chain(files), &mut bytes).unwrap();
    bench.write("a.pack", bytes);
    let output = bench.engine(&verify);
    let out = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(out.contains("seed 1: the first difference is in steps 1 to 400: reinforcement 7 claimed"), "{out}");
    assert!(out.contains("the claims are not what the pack does"), "{out}");
}

#[test]
fn a_replay_names_the_first_step_that_differs() {
    use engine::experiment::Overrides;
    use engine::filter::Sources;
    use pack::{Pack, draft, measure, replay};

    let bench = Bench::new();
    let never = std::sync::atomic::AtomicBool::new(false);
    small_folder(&bench, "short", "ada/short");
    bench.ok(&["pack", "build", "short", "--out", "a.pack"]);
    let pack = Pack::load(&bench.path().join("a.pack")).unwrap();
    // Another behaviour than the one that was measured: a little more careful.
    let script = bench.read("short/scripts/short.rhai").replace("<= 0.25", "<= 0.3");
    bench.write("short/scripts/short.rhai", script);
    let other = draft(&bench.path().join("short")).unwrap();
    let runnable = other.plan(&[], &Overrides::default(), Sources::default()).unwrap();
    let differences = replay(&pack, &runnable, &never, &|_| ()).unwrap();
    let told = differences[0].step.unwrap();
    // The same from the ledgers themselves.
    let ledger = |pack: &Pack| {
        let runnable = pack.plan(&[], &Overrides::default(), Sources::default()).unwrap();
        let mut log = engine::experiment::RunLog::new(&runnable.plan);
        engine::experiment::learn_into(&runnable.plan, 1, &never, &|_| (), &mut log.learning).unwrap();
        log.learning
    };
    let first = ledger(&pack).first_difference(&ledger(&other)).unwrap().0;
    assert_eq!(told, first as u64 + 1);
    assert_eq!(differences[0].what, format!("the first step that differs is step {told} of learning"));
    assert!(measure(&runnable, &[1], 1, &never, &|_| ()).is_ok());
}

#[test]
fn a_behaviour_that_combines_policies_is_a_pack_too() {
    let bench = Bench::new();
    for seed in ["1", "2"] {
        bench.engine(&["run", "short.rhai", "--seed", seed]);
    }
    let script = "policy(\"a\", \"runs/short/1\");\npolicy(\"b\", \"runs/short/2\");\nworld(\"small\");\n\
                  run(#{ test_steps: 400 });\nrule \"contact\" when robot.contact => -1 then recover;\n";
    bench.write("both.rhai", script);
    bench.ok(&["pack", "new", "ada/both", "--from", "both.rhai"]);
    bench.ok(&["pack", "build", "both", "--out", "both.pack"]);
    for run in ["1", "2"] {
        std::fs::remove_dir_all(bench.path().join("runs/short").join(run)).unwrap();
    }
    assert!(bench.ok(&["pack", "verify", "both.pack", "--allow-unsigned", "--replay"]).contains("bit for bit"));
    let output = bench.engine(&["test", "both.pack", "--allow-unsigned"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", told(&output));
}

#[test]
fn every_script_that_ships_can_be_packed() {
    let bench = Bench::new();
    for entry in std::fs::read_dir(root().join("scripts")).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        // Their policies are learned first; another test builds one of each kind.
        let others = ["follow-and-avoid", "find-and-dock"];
        if path.extension().is_none_or(|ending| ending != "rhai") || others.contains(&stem.as_str()) {
            continue;
        }
        let script = path.to_str().unwrap();
        bench.ok(&["pack", "new", &format!("engine/{stem}"), "--from", script, "--out", &format!("folders/{stem}")]);
        pack::draft(&bench.path().join("folders").join(&stem)).unwrap();
    }
}

#[test]
fn the_gallery_has_a_card_for_each_pack_and_no_script() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    small_folder(&bench, "made", "eve/plain");
    bench.ok(&["pack", "build", "made", "--out", "eve-plain.pack"]);
    bench.ok(&["pack", "list", "--from", ".", "--gallery", "page"]);
    let page = bench.read("page/index.html");
    assert_eq!(page.matches("<article>").count(), 2);
    assert_eq!(page.matches("data:image/png;base64,").count(), 2);
    assert_eq!(page.matches("<polyline").count(), 6);
    assert!(page.contains("signed by") && page.contains("not signed"));
    assert!(!page.contains("<script") && !page.contains("http://") && !page.contains("https://"));
    assert!(file.starts_with("ada-short"));
}

#[test]
fn a_pack_goes_through_all_the_worlds_of_its_script() {
    let bench = Bench::new();
    let script = bench.read("short.rhai").replace("world(\"small\");", "worlds([\"small\", \"corridors:1-2\"]);");
    bench.write("many.rhai", script);
    bench.ok(&["pack", "new", "ada/many", "--from", "many.rhai", "--out", "many"]);
    let title = |from: &str, out: &str| {
        bench.engine(&["run", from, "--out", out]);
        let summary: serde_json::Value = serde_json::from_str(&bench.read(&format!("{out}/summary.json"))).unwrap();
        (summary["world"].clone(), summary["state_hash"].clone())
    };
    let plain = title("many.rhai", "plain");
    assert_eq!(plain.0, "small and 2 more");
    assert_eq!(title("many", "packed"), plain);
    bench.ok(&["replay", "packed", "--verify"]);
}

#[test]
fn a_run_in_worlds_from_the_command_line_is_verified() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--world", "corridors:1-3", "--out", "out"]);
    bench.ok(&["replay", "out", "--verify"]);
}
