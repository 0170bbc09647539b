use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::{Diagnostic, SourceText};
use engine::experiment::{Cycle, Ledger, Overrides, Phase, Plan, Playback, learn_into, test};
use engine::robot::Robot;
use engine::script::Behaviour;

use crate::support::{Bench, WORLD, root};

const RULES: &str = "rule \"near\" when laser.nearest <= 0.25 => -1 then recover;\n";

/// A plan of a script that stands beside the shipped ones.
fn plan_of(text: &str) -> engine::diagnostic::Result<Plan> {
    let source = SourceText::new(root().join("scripts/own.rhai"), text.to_owned());
    Plan::new(Arc::new(Behaviour::parse("own", source)?), &Overrides::default())
}

fn plan(text: &str) -> Plan {
    plan_of(text).unwrap_or_else(|error| panic!("{error}: {:?}", error.help))
}

fn learned(plan: &Plan, seed: u64) -> (engine::experiment::Learned, Ledger) {
    let mut ledger = Ledger::new(plan, plan.settings.run.steps);
    let learned = learn_into(plan, seed, &AtomicBool::new(false), &|_| (), &mut ledger).unwrap();
    (learned, ledger)
}

#[test]
fn an_attempt_is_broken_off_after_its_longest_stay_and_that_is_no_outcome() {
    let script =
        format!("worlds(#{{ \"room\": 3, \"corridors:1-2\": 1 }});\nrun(#{{ steps: 4000, stay_steps: 30 }});\n{RULES}");
    let plan = plan(&script);
    let (learned, ledger) = learned(&plan, 5);
    let (mut stayed, mut ends, mut attempts, mut at_home) = (0, 0, 0, 0);
    for step in 0..ledger.len() {
        let (record, attempt) = (ledger.record(step).unwrap(), ledger.attempt(step).unwrap());
        stayed += 1;
        assert_eq!(attempt.hop, stayed == 30 && record.then.is_none(), "step {step}");
        ends += u64::from(record.then.is_some());
        if record.then.is_some() || attempt.hop {
            (stayed, attempts) = (0, attempts + 1);
            at_home += u64::from(ledger.world(step + 1) == 0);
        }
    }
    assert_eq!(learned.tally.endings().attempts(), ends);
    assert!(attempts > ends + 40, "{attempts} {ends}");
    // Three of four within four deviations.
    let (share, spread) = (at_home as f64 / attempts as f64, (0.75 * 0.25 / attempts as f64).sqrt());
    assert!((share - 0.75).abs() < 4.0 * spread, "{share} of {attempts}");
    assert_eq!(ledger.world(0), 0);
    assert_eq!(plan.worlds.title(), "room and 2 more");
}

#[test]
fn without_a_stay_and_in_scripts_with_goals_nothing_is_broken_off() {
    let hops = |run: &str, rules: &str| {
        let plan = plan(&format!("worlds([\"room\", \"rooms:1\"]);\nrun(#{{ steps: 900{run} }});\n{rules}"));
        let (_, ledger) = learned(&plan, 1);
        (0..ledger.len()).filter(|step| ledger.attempt(*step).unwrap().hop).count()
    };
    let goal = format!("{RULES}rule \"there\" when laser.front < 0.3 => 1 then goal;\n");
    assert_eq!((hops(", stay_steps: 0", RULES), hops("", &goal)), (0, 0));
    assert!(hops(", stay_steps: 40", &goal) > 3);
}

#[test]
fn coming_from_another_world_the_nearest_place_is_a_start() {
    let exact = "recovery(\"nearest\", #{ position_m: 0, yaw_deg: 0 });";
    let plan = plan(&format!("worlds([\"room\", \"rooms:3\"]);\nrun(#{{ stay_steps: 25 }});\n{exact}\n{RULES}"));
    let mut cycle = Cycle::new(&plan, Phase::Learning.robot(&plan, 1).unwrap()).unwrap();
    let (mut moves, mut stays) = (0, 0);
    for _ in 0..2000 {
        let step = cycle.step(1).unwrap();
        if !step.moves() {
            continue;
        }
        let before = cycle.robot().world_index();
        cycle.recover().unwrap();
        let (world, start) = (cycle.robot().world_index(), cycle.robot().start());
        assert_eq!(start.is_some(), world != before);
        if let Some(start) = start {
            let (here, there) =
                (cycle.robot().whereabouts().unwrap().pose, plan.worlds.layouts()[world].starts[start].pose);
            assert!(here.distance_m(there) < 1e-9);
        }
        (moves, stays) = (moves + u32::from(world != before), stays + u32::from(world == before));
    }
    assert!(moves > 10 && stays > 10, "{moves} {stays}");
}

/// Two worlds with the starts `a` and `b`, in another order and at another place.
fn two_worlds() -> Bench {
    let bench = Bench::new();
    let world = |starts: [(&str, f64); 2], size: f64| {
        let starts = starts.map(|(name, x)| format!("[[start]]\nname = \"{name}\"\nposition_m = [{x}, 1.0]\n\n"));
        let body = WORLD.split("[[start]]").next().unwrap().replace("6, ", &format!("{size}, "));
        let route = WORLD.split("[[route]]").nth(1).unwrap();
        format!("{body}{}[[route]]{route}", starts.concat())
    };
    bench.write("worlds/one.toml", world([("a", 1.0), ("b", 4.0)], 6.0));
    bench.write("worlds/other.toml", world([("b", 4.5), ("a", 2.0)], 9.0));
    bench
}

fn plan_in(bench: &Bench, script: &str) -> engine::diagnostic::Result<Plan> {
    let source = SourceText::new(bench.path().join("own.rhai"), script.to_owned());
    Plan::new(Arc::new(Behaviour::parse("own", source)?), &Overrides::default())
}

#[test]
fn a_place_that_a_rule_names_is_found_by_its_name_in_every_world() {
    let script = "worlds([\"one\", \"other\"]);\nrecovery(\"start\", #{ position_m: 0, yaw_deg: 0 });\n\
                  rule \"late\" when time.attempt_s > 1.0 => -1 then fail to \"a\";";
    let plan = plan_in(&two_worlds(), script).unwrap();
    let mut cycle = Cycle::new(&plan, Phase::Learning.robot(&plan, 2).unwrap()).unwrap();
    let mut been = [0, 0];
    for _ in 0..200 {
        if cycle.step(1).unwrap().moves() {
            cycle.recover().unwrap();
            let world = cycle.robot().world_index();
            assert_eq!(cycle.robot().whereabouts().unwrap().pose.x_m, [1.0, 2.0][world]);
            been[world] += 1;
        }
    }
    assert!(been[0] > 10 && been[1] > 10, "{been:?}");
}

#[test]
fn a_script_is_calibrated_once_in_each_world() {
    // From the start the wall ahead is 4 m away in one world, and 3 m farther in the other.
    let script = "worlds([\"one\", \"other\"]);\nrun(#{ stay_steps: 10 });\nlaser(#{ noise_m: 0 });\n\
                  recovery(\"a\", #{ position_m: 0, yaw_deg: 0 });\n\
                  fn calibrate(facts) { facts.laser.front }\n\
                  rule \"far\" when calibrated > 5.0 => 0.5;\n\
                  rule \"hit\" when robot.contact => -1 then fail;";
    let plan = plan_in(&two_worlds(), script).unwrap();
    let (_, ledger) = learned(&plan, 3);
    let wrong = (0..ledger.len()).find(|step| {
        let far = ledger.fired(*step).any(|(rule, _)| rule == 0);
        far != (ledger.world(*step) == 1)
    });
    assert_eq!(wrong, None);
    assert!((0..ledger.len()).any(|step| ledger.world(step) == 1));
}

#[test]
fn a_world_that_lacks_what_the_script_names_is_told_at_its_place() {
    let bench = two_worlds();
    let help = |script: &str| {
        let error = *plan_in(&bench, script).map(drop).unwrap_err();
        let marked = error.place.map(|place| place.source.text[place.span].to_owned()).unwrap_or_default();
        format!("{}: {} [{marked}] {}", error.code, error.message, error.help.unwrap_or_default())
    };
    let rules = "recovery(\"start\");\nrule \"hit\" when robot.contact => -1 then fail";
    assert_eq!(
        help(&format!("worlds([\"one\", \"small\"]);\n{rules} to \"a\";")),
        "E-SCRIPT-PLACE: the world 'small' has no start \"a\" [\"a\"] there are: start 1, nearest, random, start, behind"
    );
    assert_eq!(
        help(&format!("worlds([\"one\", \"smal\"]);\n{rules};")),
        "E-WORLD-FILE: there is no world 'smal' [\"smal\"] did you mean \"small\"?"
    );
    assert_eq!(
        help(&format!("worlds([\"one\", \"corridor:3\"]);\n{rules};")),
        "E-WORLD-FILE: there is no family of worlds 'corridor' [\"corridor:3\"] did you mean \"corridors:3\"?"
    );
    assert_eq!(
        help(&format!("world(\"one\"); randomise(#{{ \"colour.wal\": [0, 9] }});\n{rules};")),
        "E-SCRIPT-PLACE: the world 'one' has no material \"wal\" [\"] did you mean \"wall\"?"
    );
}

/// Code, message, marked text and help of a mistake.
fn mistake(setup: &str) -> String {
    let script = format!("{setup}\n{RULES}");
    let error: Diagnostic = *plan_of(&script).map(drop).unwrap_err();
    assert!(error.others.is_empty(), "one cause, one error: {setup}: {:?}", error.others);
    let marked = error.place.map(|place| place.source.text[place.span].to_owned()).unwrap_or_default();
    format!("{}: {} [{marked}] {}", error.code, error.message, error.help.unwrap_or_default())
}

#[test]
fn a_wrong_list_of_worlds_or_a_wrong_draw_is_one_error_with_what_to_write() {
    let many: Vec<String> = (0..65).map(|number| format!("\"rooms:{number}\"")).collect();
    let mistakes = [
        "worlds([]);".to_owned(),
        format!("worlds([{}]);", many.join(", ")),
        "worlds([\"rooms:1-65\"]);".to_owned(),
        "worlds([\"room\", \"room\"]);".to_owned(),
        "worlds(#{ \"room\": 0, \"hallway\": 1 });".to_owned(),
        "worlds(#{ \"room\": 1.5 });".to_owned(),
        "world(\"room\"); worlds([\"room\", \"hallway\"]);".to_owned(),
        "worlds(\"room\");".to_owned(),
        "randomise(#{});".to_owned(),
        "randomise(#{ \"run.period_s\": [0.3, 0.6] });".to_owned(),
        "randomise(#{ \"camera.tilt_dg\": [40, 44] });".to_owned(),
        "randomise(#{ start: #{ yaw_deg: [0, 10] } });".to_owned(),
        "randomise(#{ \"camera.tilt_deg\": [44, 40] });".to_owned(),
        "randomise(#{ \"camera.tilt_deg\": 42 });".to_owned(),
        "randomise(#{ \"camera.tilt_deg\": [40] });".to_owned(),
        "randomise(#{ \"camera.tilt_deg\": [40, 440] });".to_owned(),
        "randomise(#{ \"recovery.to\": [\"nearest\", \"behnd\"] });".to_owned(),
        "randomise(#{ \"mover.prey.speed\": [1, 2] });".to_owned(),
    ];
    let told: Vec<String> = mistakes.iter().map(|setup| mistake(setup)).collect();
    insta::assert_snapshot!("worlds-mistakes", told.join("\n"));
}

#[test]
fn a_value_that_is_drawn_cannot_be_set_beside_it() {
    let bench = Bench::new();
    let script = "world(\"small\"); randomise(#{ \"camera.tilt_deg\": [40, 44] });\n";
    bench.write("own.rhai", format!("{script}{RULES}"));
    let told = bench.failure(&["run", "own.rhai", "--set", "camera.tilt_deg=41"]);
    assert!(told.contains("'camera.tilt_deg' is drawn anew for each attempt"), "{told}");
}

#[test]
fn what_is_drawn_is_what_the_attempt_has() {
    let draws = "\"camera.noise\": [0, 1, 2], \"laser.max_range_m\": [3, 5], \"movers.speed\": [0.5, 2], \"start.shift_m\": [-0.1, 0.1]";
    let script = format!(
        "world(\"object\");\nrandomise(#{{ {draws} }});\nrun(#{{ steps: 1500, stay_steps: 40 }});\n\
         rule \"far\" when laser.max_range_m > 4.0 => 0.25;\nrule \"lost\" when !camera.seen => -1 then recover;\n\
         filter(\"colour\"); recovery(\"behind\");"
    );
    let plan = plan(&script);
    let (_, ledger) = learned(&plan, 7);
    let (mut values, mut far) = (Vec::new(), 0);
    for step in 0..ledger.len() {
        let attempt = ledger.attempt(step).unwrap();
        // In the order of the keys: noise, range, speed, shift.
        let [noise, range_m, speed, shift_m] = attempt.drawn[..] else { panic!("{attempt:?}") };
        assert!([0.0, 1.0, 2.0].contains(&noise) && (3.0..5.0).contains(&range_m));
        assert!((0.5..2.0).contains(&speed) && (-0.1..0.1).contains(&shift_m));
        let is_far = ledger.fired(step).any(|(rule, _)| rule == 0);
        assert_eq!(is_far, range_m > 4.0, "step {step}");
        far += u32::from(is_far);
        values.push(range_m.to_bits());
    }
    values.dedup();
    assert!(values.len() > 20 && far > 100, "{} {far}", values.len());
    // Every step comes back, and the movers are where they were without a simulation.
    let mut playback = Playback::new(&plan, 7, Phase::Learning, &ledger).unwrap();
    let mut movers = engine::experiment::RecordedMovers::new(&plan, 7, Phase::Learning);
    let mut step = 0;
    while playback.advance().unwrap().is_some() {
        assert_eq!(playback.difference(), None);
        movers.seek(&ledger, step);
        let (there, here) = (movers.poses().next().unwrap(), playback.cycle().robot().mover(0).unwrap());
        assert!(there.distance_m(here) < 1e-9, "step {step}");
        step += 1;
    }
    movers.seek(&ledger, 3);
}

/// The length of a closed route.
fn length_m(route: &engine::world::Route) -> f64 {
    let points: Vec<_> = route.drawn().collect();
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

#[test]
fn a_test_draws_by_numbers_of_its_own_and_counts_laps_in_each_world() {
    let script =
        format!("worlds([\"room\", \"rooms:2\"]);\nrun(#{{ steps: 400, test_steps: 900, stay_steps: 60 }});\n{RULES}");
    let plan = plan(&script);
    let (learned, ledger) = learned(&plan, 4);
    let mut tested = Ledger::new(&plan, 900);
    let run =
        engine::experiment::test_and_watch(&plan, &learned.policy, 4, &AtomicBool::new(false), &mut tested).unwrap();
    let worlds = |ledger: &Ledger| (0..400).map(|step| ledger.world(step)).collect::<Vec<_>>();
    assert_ne!(worlds(&ledger), worlds(&tested));
    let laps = run.figures.laps.unwrap();
    // The rooms are not of one length: laps are no share of all metres in either.
    let lengths =
        plan.worlds.layouts().iter().map(|layout| run.figures.net_route_m.unwrap() / length_m(&layout.routes[0]));
    let bounds: Vec<f64> = lengths.collect();
    assert!(bounds.iter().all(|bound| (bound - laps).abs() > 1e-6), "{laps} {bounds:?}");
    let again = test(&plan, &learned.policy, 4, &AtomicBool::new(false)).unwrap();
    assert_eq!(again.state_hash, run.state_hash);
}

#[test]
fn a_run_in_two_worlds_is_stored_verified_explained_judged_again_and_tested_elsewhere() {
    let bench = two_worlds();
    let script = format!(
        "worlds(#{{ \"one\": 2, \"other\": 1 }});\nrandomise(#{{ \"camera.tilt_deg\": [40, 44] }});\n\
         run(#{{ steps: 800, test_steps: 400, stay_steps: 50 }});\n{RULES}"
    );
    bench.write("own.rhai", &script);
    let ran = bench.engine(&["run", "own.rhai"]);
    assert!(ran.status.code().unwrap() <= 1, "{}", String::from_utf8_lossy(&ran.stderr));
    // The files that it learned in are not needed any more.
    std::fs::remove_dir_all(bench.path().join("worlds")).unwrap();
    let verified = bench.ok(&["replay", "runs/own/1", "--verify"]);
    assert!(verified.contains("reproduced bit for bit: 800 steps of learning and 400 of the test"), "{verified}");
    let replayed: serde_json::Value = serde_json::from_str(&bench.ok(&["replay", "runs/own/1", "--json"])).unwrap();
    let attempts = replayed["attempts"].as_array().unwrap();
    let hop = attempts.iter().find(|attempt| attempt["ending"] == "hop").unwrap();
    let step = hop["step"].as_u64().unwrap();
    let explained = bench.ok(&["explain", "runs/own/1", "--step", &(step + 49).to_string()]);
    let world = hop["world"].as_str().unwrap();
    assert!(explained.contains(&format!("world:     {world}\n")), "{explained}");
    let tilt = hop["drawn"][0][1].as_str().unwrap();
    assert!(explained.contains(&format!("drawn:     camera.tilt_deg = {tilt}\n")), "{explained}");
    assert!(explained.contains("then a hop"), "{explained}");
    let judged: serde_json::Value =
        serde_json::from_str(&bench.ok(&["rescore", "runs/own/1", "own.rhai", "--json"])).unwrap();
    assert_eq!((&judged["steps_changed"], judged["states_changed"].as_array().unwrap().len()), (&0.into(), 0));
    let title = |arguments: &[&str]| String::from_utf8(bench.engine(arguments).stdout).unwrap();
    assert!(title(&["test", "runs/own/1", "--plain"]).contains("own in one, learned"));
    assert!(title(&["test", "runs/own/1", "--worlds", "corridors:100-102"]).contains("corridors:100 and 2 more"));
    assert!(title(&["test", "runs/own/1"]).contains("own in one and 1 more, learned"));
    let policy = bench.read("runs/own/1/policy.toml");
    assert!(policy.contains("\"one: 2\"") && policy.contains("camera.tilt_deg: 40 to 44"), "{}", &policy[..600]);
    let page = bench.read("runs/own/1/report.html");
    assert!(page.contains("\"further_worlds\""));
}

#[test]
fn a_world_made_by_rule_is_written_once_and_is_the_world_of_its_name() {
    let bench = Bench::new();
    bench.ok(&["world", "new", "corridors:7"]);
    assert!(bench.failure(&["world", "new", "corridors:7"]).contains("'corridors-7.toml' exists already"));
    assert!(bench.failure(&["world", "new", "corridors:1-3"]).contains("write one, such as corridors:7"));
    bench.write("own.rhai", format!("world(\"corridors:7\"); run(#{{ steps: 400, test_steps: 400 }});\n{RULES}"));
    let hash = |arguments: &[&str]| {
        let summary: serde_json::Value = serde_json::from_slice(&bench.engine(arguments).stdout).unwrap();
        summary["state_hash"].as_str().unwrap().to_owned()
    };
    let named = hash(&["run", "own.rhai", "--json"]);
    assert_eq!(named, hash(&["run", "own.rhai", "--world", "corridors-7.toml", "--json", "--out", "file"]));
}

#[test]
fn an_empty_image_is_no_fault_where_the_state_shows_no_view() {
    let script = "world(\"object\");\ncamera(#{ noise: 0.0 });\nrun(#{ steps: 800 });\n".to_owned() + RULES;
    let blind = plan(&format!("{script}state(bins(laser.nearest, [1.0, 2.0]));\n"));
    assert_eq!(learned(&blind, 1).1.len(), 800);
    // On that floor the camera sees one colour in some places.
    let seeing = plan(&format!("{script}filter(\"threshold\", #{{ threshold: 50.0 }});\n"));
    let stopped = learn_into(&seeing, 1, &AtomicBool::new(false), &|_| (), &mut Ledger::new(&seeing, 800));
    assert_eq!(stopped.unwrap_err().error.code, "E-CAMERA-BLANK");
}
