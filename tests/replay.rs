use crate::support::{Bench, SCRIPT};
use serde_json::Value;

fn json(bench: &Bench, arguments: &[&str]) -> Value {
    let mut all = arguments.to_vec();
    all.push("--json");
    let output = bench.engine(&all);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn recorded(arguments: &[&str]) -> Bench {
    let bench = Bench::new();
    let mut all = vec!["run", "short.rhai", "--out", "a"];
    all.extend(arguments);
    bench.engine(&all);
    bench
}

/// A learning step in which "too close" fired.
fn a_punished_step(bench: &Bench) -> usize {
    let report = json(bench, &["replay", "a"]);
    report["rules"][0]["first_step"].as_u64().unwrap() as usize
}

#[test]
fn a_run_is_reproduced_bit_for_bit_without_its_script_and_world() {
    let bench = recorded(&[]);
    std::fs::remove_file(bench.path().join("short.rhai")).unwrap();
    std::fs::remove_dir_all(bench.path().join("worlds")).unwrap();
    let verified = json(&bench, &["replay", "a", "--verify"]);
    let summary: Value = serde_json::from_str(&bench.read("a/summary.json")).unwrap();
    assert_eq!(verified["reproduced"], true);
    for field in ["log_sha256", "state_hash"] {
        assert_eq!(verified[field], summary[field], "{field}");
    }
    assert_eq!((&verified["learning_steps"], &verified["test_steps"]), (&800.into(), &400.into()));
}

#[test]
fn every_seed_of_a_run_of_many_keeps_its_own_log() {
    let bench = recorded(&["--seeds", "3"]);
    for seed in ["1", "2", "3"] {
        let folder = format!("a/{seed}");
        assert_eq!(json(&bench, &["replay", &folder, "--verify"])["seed"].to_string(), seed);
    }
    assert!(bench.failure(&["replay", "a"]).contains("policy.toml"));
}

#[test]
fn a_combination_is_reproduced_too() {
    let bench = recorded(&[]);
    let script = format!("policy(\"one\", \"a\");\npolicy(\"two\", \"a\");\n{SCRIPT}");
    bench.write("both.rhai", script.replace("steps: 800, ", ""));
    bench.engine(&["run", "both.rhai", "--out", "b"]);
    let verified = json(&bench, &["replay", "b", "--verify"]);
    assert_eq!((&verified["learning_steps"], &verified["test_steps"]), (&0.into(), &400.into()));
    let told = bench.failure(&["rescore", "b", "short.rhai"]);
    assert!(told.starts_with("exit status 7") && told.contains("it learned nothing"), "{told}");
}

#[test]
fn a_run_whose_files_were_changed_is_refused() {
    let bench = recorded(&[]);
    bench.engine(&["run", "short.rhai", "--seed", "2", "--out", "b"]);
    let log = std::fs::read(bench.path().join("a/log.bin")).unwrap();
    let refused = |code: &str, words: &str| {
        for command in [&["replay", "a"][..], &["explain", "a", "--step", "3"], &["rescore", "a", "short.rhai"]] {
            let told = bench.failure(command);
            assert!(told.starts_with("exit status 7") && told.contains(code) && told.contains(words), "{told}");
        }
    };
    bench.write("a/log.bin", &log[..log.len() - 700]);
    refused("E-LOG-FILE", "the log is cut");
    bench.write("a/log.bin", std::fs::read(bench.path().join("b/log.bin")).unwrap());
    refused("E-LOG-RUN", "another run: of 'short' with seed 2");
    std::fs::remove_file(bench.path().join("a/log.bin")).unwrap();
    refused("E-LOG-FILE", "there is no such file");
    bench.write("a/log.bin", &log);
    let summary = bench.read("a/summary.json");
    bench.write("a/summary.json", bench.read("b/summary.json"));
    refused("E-LOG-RUN", "is not the log that");
    bench.write("a/summary.json", summary.replace("\"state_hash\": \"", "\"state_hash\": \"0"));
    let told = bench.failure(&["replay", "a", "--verify"]);
    assert!(
        told.contains("E-LOG-DIFFERS") && told.contains("summary.json does not say what the run gives: state_hash"),
        "{told}"
    );
}

#[test]
fn a_forged_figure_curve_or_table_is_no_run_that_was_reproduced() {
    let bench = recorded(&[]);
    let forged = |file: &str, from: &str, to: &str, words: &str| {
        let text = bench.read(&format!("a/{file}"));
        let changed = text.replacen(from, to, 1);
        assert_ne!(text, changed, "{from}");
        bench.write(&format!("a/{file}"), changed);
        let told = bench.failure(&["replay", "a", "--verify"]);
        assert!(told.starts_with("exit status 7") && told.contains("E-LOG-DIFFERS") && told.contains(words), "{told}");
        bench.write(&format!("a/{file}"), text);
    };
    let summary = bench.read("a/summary.json");
    for (place, words) in [
        ("/learned_at", "learned_at"),
        ("/test/laps", "test.laps"),
        ("/test/failures", "test.failures"),
        ("/states_seen", "states_seen"),
        ("/rules/0/total", "rules[0].total"),
        ("/untrained/distance_m", "untrained.distance_m"),
        ("/reinforcement_per_400/0", "reinforcement_per_400[0]"),
    ] {
        let mut figures: Value = serde_json::from_str(&summary).unwrap();
        *figures.pointer_mut(place).unwrap() = Value::from(1234);
        bench.write("a/summary.json", figures.to_string());
        let told = bench.failure(&["replay", "a", "--verify"]);
        assert!(told.starts_with("exit status 7") && told.contains(&format!("{words} is 1234")), "{told}");
    }
    bench.write("a/summary.json", &summary);
    let curve = bench.read("a/curve.csv");
    let last = curve.lines().last().unwrap();
    forged("curve.csv", last, &format!("{last}1"), "curve.csv");
    let policy = bench.read("a/policy.toml");
    let visits = policy.lines().find(|line| line.starts_with("visits")).unwrap();
    bench.write("a/policy.toml", policy.replacen(visits, &format!("{visits}0"), 1));
    let told = bench.failure(&["replay", "a", "--verify"]);
    assert!(
        told.starts_with("exit status 7") && told.contains("error[E-LOG-RUN]: 'a/policy.toml' does not hold"),
        "{told}"
    );
    bench.write("a/policy.toml", &policy);
    assert!(bench.ok(&["replay", "a", "--verify"]).contains("and every figure"));
}

#[test]
fn a_forged_picture_or_page_is_named_and_one_that_is_gone_is_told() {
    let bench = recorded(&[]);
    let drawn = ["frame", "learning-curve", "policy", "trajectories"];
    let files = drawn.iter().flat_map(|stem| [format!("{stem}.png"), format!("{stem}.svg")]);
    for file in files.chain(["report.html".to_owned()]) {
        let path = bench.path().join("a").join(&file);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, [&bytes[..], b" "].concat()).unwrap();
        let told = bench.failure(&["replay", "a", "--verify"]);
        assert!(told.starts_with("exit status 7") && told.contains("E-LOG-DIFFERS"), "{told}");
        assert!(told.contains(&format!("drawn again, {file} differs")), "{told}");
        std::fs::write(&path, bytes).unwrap();
    }
    assert!(bench.ok(&["replay", "a", "--verify"]).contains("9 pictures and pages again"));
    std::fs::remove_file(bench.path().join("a/frame.png")).unwrap();
    let told = bench.ok(&["replay", "a", "--verify"]);
    assert!(told.contains("8 pictures and pages") && told.contains("not compared: frame.png"), "{told}");
}

#[test]
fn pictures_of_explained_steps_are_drawn_again_too() {
    let bench = recorded(&[]);
    bench.ok(&["explain", "a", "--step", "3"]);
    bench.ok(&["explain", "a", "--step", "3", "--test"]);
    // Of either step before and after, each in two files.
    assert!(bench.ok(&["replay", "a", "--verify"]).contains("17 pictures and pages again"));
    let (three, four) = (bench.path().join("a/step-3-after.png"), bench.path().join("a/step-4-after.png"));
    let bytes = std::fs::read(&three).unwrap();
    std::fs::write(&four, &bytes).unwrap();
    let told = bench.failure(&["replay", "a", "--verify"]);
    assert!(told.contains("E-LOG-DIFFERS") && told.contains("drawn again, step-4-after.png differs"), "{told}");
    std::fs::rename(&four, bench.path().join("a/step-99999-after.png")).unwrap();
    assert!(bench.failure(&["replay", "a", "--verify"]).contains("step-99999-after.png differs"));
}

#[test]
fn what_is_drawn_of_a_checked_run_of_many_seeds_and_of_a_combination_is_compared() {
    let bench = recorded(&["--seeds", "3", "--check"]);
    // Curve, paths and the page; of the worst seed frame, policy and trajectories.
    assert!(bench.ok(&["replay", "a", "--verify"]).contains("11 pictures and pages again"));
    let page = bench.read("a/report.html");
    bench.write("a/report.html", page.replacen("short", "shirt", 1));
    assert!(bench.failure(&["replay", "a", "--verify"]).contains("report.html differs"));

    let bench = recorded(&[]);
    let script = format!("policy(\"one\", \"a\");\npolicy(\"two\", \"a\");\n{SCRIPT}");
    bench.write("both.rhai", script.replace("steps: 800, ", ""));
    bench.engine(&["run", "both.rhai", "--seeds", "2", "--out", "b"]);
    bench.ok(&["replay", "b", "--verify"]);
    let table = bench.read("b/2/disagreements.csv");
    bench.write("b/2/disagreements.csv", format!("{table}1"));
    assert!(bench.failure(&["replay", "b", "--verify"]).contains("disagreements.csv does not say what the run gives"));
    bench.write("b/2/disagreements.csv", table);
    bench.write("b/2/report.html", bench.read("b/1/report.html"));
    assert!(bench.failure(&["replay", "b", "--verify"]).contains("2/report.html differs"));
}

#[test]
fn what_stands_above_the_folders_of_many_seeds_is_that_of_the_first() {
    let bench = recorded(&["--seeds", "2"]);
    let run = bench.read("a/run.toml");
    bench.write("a/run.toml", run.replacen("steps = 800", "steps = 900", 1));
    let told = bench.failure(&["replay", "a", "--verify"]);
    assert!(told.starts_with("exit status 7") && told.contains("run.toml does not say what the run gives"), "{told}");
    bench.write("a/run.toml", run);
    bench.ok(&["replay", "a", "--verify"]);
}

#[test]
fn a_log_that_names_other_rules_is_refused_though_its_digests_fit() {
    let bench = recorded(&[]);
    let path = bench.path().join("a/log.bin");
    let log = std::fs::read(&path).unwrap();
    let forged = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let end = 16 + u32::from_le_bytes(log[12..16].try_into().unwrap()) as usize;
        let header = String::from_utf8(log[16..end].to_vec()).unwrap();
        let changed = header.replacen(from, to, 1);
        assert_ne!(header, changed, "{from}");
        let start = [&log[..16], changed.as_bytes()].concat();
        std::fs::write(&path, [&start[..], engine::digest::Digest::of(&start).bytes(), &log[end + 32..]].concat())
            .unwrap();
        let told = bench.failure(&["replay", "a", "--verify"]);
        assert!(told.starts_with("exit status 7") && told.contains("E-LOG-FILE"), "{told}");
    };
    forged("\"name\":\"too close\"", "\"name\":\"too loose\"");
    forged("\"value\":-1.0", "\"value\":-2.0");
    forged("\"behaviour\":\"short\"", "\"behaviour\":\"shirt\"");
}

#[test]
fn steps_are_listed_with_their_rules_and_only_those_that_there_are() {
    let bench = recorded(&[]);
    let step = a_punished_step(&bench);
    let (from, to) = (step.to_string(), (step + 1).to_string());
    let listed = json(&bench, &["replay", "a", "--from", &from, "--to", &to]);
    let listed = listed["listed"].as_array().unwrap();
    assert_eq!(listed.len(), 2);
    assert_eq!((&listed[0]["reward"], &listed[0]["recover"]), (&Value::from(-1.0), &true.into()));
    assert_eq!(listed[0]["rules"][0][0], "too close");
    assert!(bench.failure(&["replay", "a", "--from", "799", "--to", "800"]).starts_with("exit status 2"));
    assert!(bench.failure(&["replay", "a", "--to", "8"]).starts_with("exit status 2"));
    assert_eq!(json(&bench, &["replay", "a", "--test"])["steps"], 400);
}

#[test]
fn an_explained_step_names_rule_line_fact_and_beam_and_leaves_its_pictures() {
    let bench = recorded(&[]);
    let step = a_punished_step(&bench);
    let explained = json(&bench, &["explain", "a", "--step", &step.to_string()]);
    let rule = &explained["rules"][0];
    assert_eq!((&rule["name"], &rule["line"], &rule["added"]), (&"too close".into(), &3.into(), &Value::from(-1.0)));
    let part = &rule["parts"][0];
    assert_eq!((&part["text"], &part["holds"]), (&"laser.nearest <= 0.25".into(), &true.into()));
    let fact = &part["facts"][0];
    let (beam, angle) = (fact["beam"].as_f64().unwrap(), fact["angle_deg"].as_f64().unwrap());
    assert!(fact["value"].as_f64().unwrap() <= 0.25 && angle == beam - 90.0);
    assert_eq!(explained["rules"][1]["asked"], false);
    for picture in explained["pictures"].as_array().unwrap() {
        assert!(bench.path().join(picture.as_str().unwrap()).exists());
    }
    let text = String::from_utf8(bench.engine(&["explain", "a", "--step", &step.to_string()]).stdout).unwrap();
    assert!(text.contains("short.rhai:3:23") && text.contains("^^^ laser.nearest = 0.2"), "{text}");
    for wrong in [&["explain", "a"][..], &["explain", "a", "--step", "800"], &["explain", "a", "--step", "-1"]] {
        assert!(bench.failure(wrong).starts_with("exit status 2"));
    }
}

#[test]
fn a_condition_of_many_parts_blames_the_part_that_held() {
    let bench = Bench::new();
    let rule = "rule \"both\" when (laser.left < 0.1 || laser[90] < 9.0) && !robot.fallen => action.linear - 1.0;";
    bench.write("short.rhai", format!("{SCRIPT}{rule}\nfn reward(facts) {{ 0.5 * facts.robot.linear - facts.laser.sector(40, 60).nearest / 100.0 }}\n"));
    bench.engine(&["run", "short.rhai", "--out", "a"]);
    let explained = json(&bench, &["explain", "a", "--step", "0"]);
    let both = &explained["rules"][2];
    let parts: Vec<(&str, &Value)> =
        both["parts"].as_array().unwrap().iter().map(|part| (part["text"].as_str().unwrap(), &part["holds"])).collect();
    let wanted = [("laser.left < 0.1", false), ("laser[90] < 9.0", true), ("!robot.fallen", true)];
    assert_eq!(parts, wanted.map(|(text, holds)| (text, &*Box::leak(Box::new(Value::from(holds))))));
    assert_eq!(both["parts"][1]["facts"][0]["beam"], 90);
    let reward = &explained["rules"][3];
    assert_eq!((&reward["name"], &reward["parts"][0]["facts"][0]["name"]), (&"reward".into(), &"robot.linear".into()));
    let sector = &reward["parts"][0]["facts"][1];
    assert_eq!(sector["name"], "laser.sector(40, 60).nearest");
    assert!((40..=60).contains(&sector["beam"].as_u64().unwrap()));
    let sum: f64 = [both, reward].iter().map(|rule| rule["added"].as_f64().unwrap()).sum();
    assert!((explained["reward"].as_f64().unwrap() - sum).abs() < 1e-12);
    let listed = json(&bench, &["replay", "a", "--from", "0", "--to", "0"]);
    assert_eq!(listed["listed"][0]["rules"][1][1], reward["added"]);
    assert_eq!(json(&bench, &["replay", "a", "--verify"])["reproduced"], true);
}

#[test]
fn the_page_of_a_code_is_printed_and_a_wrong_code_gets_the_nearest() {
    let bench = Bench::new();
    let page = json(&bench, &["explain", "E-SCRIPT-FACT"]);
    assert!(page["page"].as_str().unwrap().contains("scripts/README.md"));
    assert_eq!(json(&bench, &["explain", "e-script-fact"]), page);
    assert!(bench.failure(&["explain", "E-SCRIPT-FACT", "--step", "3"]).starts_with("exit status 2"));
    let told = bench.failure(&["explain", "E-SCRIPT-FACTS"]);
    assert!(told.starts_with("exit status 2") && told.contains("did you mean 'E-SCRIPT-FACT'?"), "{told}");
}

#[test]
fn the_same_script_rescored_changes_nothing() {
    let bench = recorded(&["--set", "learner.mirror=true"]);
    let same = json(&bench, &["rescore", "a", "short.rhai"]);
    assert_eq!((&same["steps_changed"], &same["states_changed"]), (&0.into(), &Value::Array(vec![])));
    assert_eq!(same["reward_before"], same["reward_after"]);
    let summary: Value = serde_json::from_str(&bench.read("a/summary.json")).unwrap();
    for (rule, total) in same["rules"].as_array().unwrap().iter().zip(summary["rules"].as_array().unwrap()) {
        for side in ["before", "after"] {
            assert_eq!((&rule[side]["fired"], &rule[side]["total"]), (&total["fired"], &total["total"]));
        }
    }
}

#[test]
fn another_reward_is_told_by_rule_and_by_state() {
    let bench = recorded(&[]);
    let edited = SCRIPT.replace("<= 0.25", "<= 0.6").replace("\"contact\"", "\"touch\"");
    bench.write("edited.rhai", edited);
    let report = json(&bench, &["rescore", "a", "edited.rhai", "--out", "diff"]);
    let rule = |name: &str| report["rules"].as_array().unwrap().iter().find(|rule| rule["name"] == name).unwrap();
    let fired = |side: &str| rule("too close")[side]["fired"].as_u64().unwrap();
    assert!(fired("after") > fired("before"));
    assert!(rule("contact")["after"].is_null() && rule("touch")["before"].is_null());
    let changed = report["states_changed"].as_array().unwrap();
    assert!(!changed.is_empty());
    for state in changed {
        assert_ne!(state["before"]["action"], state["after"]["action"]);
        assert!(state["gain"].as_f64().unwrap() >= 0.0);
        let tried = |side: &str| state[side]["tried"].as_u64().unwrap();
        assert!(tried("before") + tried("after") <= state["visits"].as_u64().unwrap());
    }
    assert!(changed.windows(2).all(|pair| pair[0]["visits"].as_u64() >= pair[1]["visits"].as_u64()));
    for file in ["rescore.json", "policy-diff.svg", "policy-diff.png"] {
        assert!(bench.path().join("diff").join(file).exists(), "{file}");
    }
    assert_eq!(json(&bench, &["rescore", "a", "edited.rhai", "--passes", "5"])["passes"], 5);
}

#[test]
fn a_script_that_sees_something_else_cannot_judge_a_record() {
    let bench = recorded(&[]);
    for (setting, words) in [
        ("camera(#{ tilt_deg: 30 });", "sets camera.tilt_deg otherwise"),
        ("filter(\"sobel\", #{ threshold: 90 });", "sets the filters otherwise"),
        ("actions([[0.2, 0.0], [0.2, 0.5]]);", "sets the actions otherwise"),
    ] {
        bench.write("other.rhai", SCRIPT.replace("run(#{", &format!("{setting}\nrun(#{{")));
        let told = bench.failure(&["rescore", "a", "other.rhai"]);
        assert!(told.starts_with("exit status 7") && told.contains(words) && told.contains("other.rhai:2:"), "{told}");
    }
    // How it learns, and for how long, may differ: the record can be learned in any way.
    bench.write(
        "other.rhai",
        SCRIPT.replace("steps: 800", "steps: 900").replace("run(", "learner(#{ memory_lambda: 0.5 });\nrun("),
    );
    json(&bench, &["rescore", "a", "other.rhai"]);
}

#[test]
fn a_run_that_a_failure_ended_keeps_its_steps_and_fails_again_in_the_same_one() {
    let bench = Bench::new();
    let script = "world(\"small\");\nrun(#{ steps: 800, test_steps: 400 });\n\
                  fn reward(facts) { if facts.time.step > 500 { throw \"no more\" } -facts.laser.nearest }\n";
    bench.write("ends.rhai", script);
    let told = bench.failure(&["run", "ends.rhai"]);
    assert!(told.contains("what was learned in 500 steps is kept") && told.contains("no more (in step 500)"), "{told}");
    let told = bench.ok(&["replay", "runs/ends/1", "--verify"]);
    assert!(told.contains("500 steps of learning and 0 of the test"), "{told}");
    assert!(bench.ok(&["explain", "runs/ends/1", "--step", "499"]).contains("fn reward"));
}
