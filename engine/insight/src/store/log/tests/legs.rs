//! Runs whose reward was swapped while the robot learned: learned, written, read and driven again.

use super::*;
use crate::store::{StoredRun, policy_to_toml, run_to_toml};
use engine::experiment::{Learned, Learning, Leg, Phase, Playback, StepReasons};
use engine::learner::Carry;

/// The rules of the sample, another first rule with another name, and one rule more with a value of its own.
const SECOND: &str = "recovery(\"start\");\n\
                      rule \"touch\" when laser.nearest <= 0.35 => -2 then recover;\n\
                      rule \"fast\" when action.linear > 0.2 => action.linear;\n\
                      rule \"turning\" when action.angular > 0.1 => laser.nearest - 1;\n";
const THIRD: &str = "recovery(\"start\");\nlearner(#{ step_size: 0.2 });\n\
                     rule \"fast\" when action.linear > 0.1 => 1;\n\
                     rule \"too close\" when laser.nearest <= 0.5 => -3 then recover;\n";

fn plan(script: &str, steps: u64) -> Plan {
    let behaviour = Behaviour::parse("log", SourceText::new("log.rhai", script)).unwrap();
    let mut settings = behaviour.settings().clone();
    let layout = Arc::new(Layout::parse(SourceText::new("log.toml", WORLD), &settings.robot.body).unwrap());
    (settings.run.steps, settings.run.test_steps) = (steps, 40);
    Plan::with_layout(Arc::new(behaviour), settings, layout, Arc::new(Catalogue::linked_in())).unwrap()
}

/// Three scripts, swapped before step 1,100, which is within a chunk, and before step 1,500; the second one twice at once.
fn swapped(carry: Carry) -> Plan {
    // What was planned for a leg is not what was done.
    let leg = |script, steps, then| Leg { plan: plan(script, 2000), steps, then };
    plan(THIRD, 300).after(vec![leg(SCRIPT, 1100, carry), leg(SECOND, 0, Carry::Keep), leg(SECOND, 400, carry)])
}

fn learn(plan: &Plan) -> (Learned, RunLog) {
    let (mut log, stop) = (RunLog::new(plan), AtomicBool::new(false));
    let learned = learn_into(plan, SEED, &stop, &|_| (), &mut log.learning).unwrap();
    test_and_watch(plan, &learned.policy, SEED, &stop, &mut log.test).unwrap();
    (learned, log)
}

#[test]
fn every_step_of_every_leg_is_driven_again_bit_for_bit() {
    for (_, carry) in Carry::ALL {
        let plan = swapped(carry);
        let (learned, log) = learn(&plan);
        assert_eq!((learned.steps, log.learning.len(), log.learning.steps()), (1800, 1800, 1800));
        let mut playback = Playback::new(&plan, SEED, Phase::Learning, &log.learning).unwrap();
        while playback.advance().unwrap().is_some() {
            assert_eq!(playback.difference(), None, "step {}", playback.done() - 1);
        }
        assert_eq!(playback.done(), 1800);
        // Going back goes through the swaps again.
        playback.seek(1099).unwrap();
        for _ in 0..2 {
            playback.advance().unwrap();
            assert_eq!(playback.difference(), None);
        }
    }
}

#[test]
fn a_session_that_swaps_learns_what_the_plan_of_its_legs_learns() {
    for (_, carry) in Carry::ALL {
        let (wanted, log) = learn(&swapped(carry));
        let stop = AtomicBool::new(false);
        let (first, second, third) = (plan(SCRIPT, 1100), plan(SECOND, 400), plan(THIRD, 300));
        let mut learning = Learning::new(&first, SEED).unwrap();
        let mut ledger = Ledger::new(&first, 1100);
        // In pieces, as a page that shows how far it has come does.
        for steps in [400, 400, 300] {
            learning.run(steps, &stop, &|_| (), &mut ledger).unwrap();
            drop(learning.snapshot());
        }
        // A leg that is ended and shown goes on as one that is swapped at once.
        drop(learning.finish());
        learning.swap(&second, carry, &mut ledger).unwrap();
        learning.swap(&second, Carry::Keep, &mut ledger).unwrap();
        learning.run(400, &stop, &|_| (), &mut ledger).unwrap();
        learning.swap(&third, carry, &mut ledger).unwrap();
        learning.run(300, &stop, &|_| (), &mut ledger).unwrap();
        let learned = learning.finish();
        assert_eq!(ledger.first_difference(&log.learning), None);
        assert_eq!(
            (learned.state_hash, learned.policy, learned.tally),
            (wanted.state_hash, wanted.policy, wanted.tally)
        );
    }
}

#[test]
fn what_becomes_of_the_table_makes_another_run() {
    let hashes: Vec<String> = Carry::ALL.iter().map(|(_, carry)| learn(&swapped(*carry)).0.state_hash).collect();
    assert!(hashes[0] != hashes[1] && hashes[1] != hashes[2] && hashes[0] != hashes[2]);
    let unswapped = learn(&plan(SCRIPT, 1100)).1;
    let kept = learn(&swapped(Carry::Keep)).1;
    // Before the first swap, all are the run of the first script.
    assert!((0..1100).all(|step| unswapped.learning.record_bytes(step) == kept.learning.record_bytes(step)));
}

#[test]
fn a_swapped_run_comes_back_from_its_folder() {
    let folder = std::env::temp_dir().join(format!("engine-legs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let plan = swapped(Carry::Decay);
    let (learned, log) = learn(&plan);
    let run = run_to_toml(&plan, SEED).unwrap();
    assert!(run.starts_with("format = 2\n") && run.contains("table = \"decay\""), "{run}");
    std::fs::write(folder.join("run.toml"), &run).unwrap();
    let table = policy_to_toml(&plan, &learned.policy, Some(&run)).unwrap();
    std::fs::write(folder.join("policy.toml"), table).unwrap();
    let stored = StoredRun::load(&folder).unwrap();
    let file = log_to_bytes(&log, &plan, SEED, &run, 0).unwrap();
    assert_eq!(file[8], 2);
    assert_eq!(read_log(&file, &stored.plan, SEED, &run).unwrap(), log);
    // Learned again from what the folder says.
    assert_eq!(learn(&stored.plan).0.state_hash, learned.state_hash);
    // The same log beside a run without its legs is refused.
    let error = read_log(&file, &plan.clone().after(Vec::new()), SEED, &run).unwrap_err();
    assert_eq!(error.message, "the log's legs are not those of its run");
    // A leg that saw something else is refused.
    let other = run.replacen("tilt_deg = 42.0", "tilt_deg = 41.0", 2).replacen("tilt_deg = 41.0", "tilt_deg = 42.0", 1);
    assert_ne!(other, run);
    std::fs::write(folder.join("run.toml"), other).unwrap();
    let error = StoredRun::load(&folder).map(drop).unwrap_err();
    assert!(error.message.contains("differ in camera.tilt_deg"), "{}", error.message);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn reasons_are_those_of_the_script_of_the_leg() {
    let plan = swapped(Carry::Keep);
    let (_, log) = learn(&plan);
    let names = |step| {
        let mut playback = Playback::new(&plan, SEED, Phase::Learning, &log.learning).unwrap();
        playback.seek(step).unwrap();
        let reasons = StepReasons::of_next(&mut playback).unwrap().unwrap();
        let fired: Vec<(String, f64)> =
            reasons.rules.iter().filter_map(|rule| Some((rule.name.clone(), rule.added?))).collect();
        assert_eq!(fired.iter().map(|(_, added)| added).sum::<f64>(), reasons.reward, "step {step}");
        reasons.rules.into_iter().map(|rule| rule.name).collect::<Vec<_>>()
    };
    assert_eq!(names(1099), ["too close", "fast"]);
    assert_eq!(names(1100), ["touch", "fast", "turning"]);
    assert_eq!(names(1799), ["fast", "too close"]);
    assert_eq!(plan.rule_names(), ["fast", "too close", "touch", "turning"]);
}

#[test]
fn a_leg_that_was_too_long_to_be_kept_leaves_no_room_for_the_next() {
    let (first, second) = (plan(SCRIPT, 10), plan(SECOND, 400));
    let (mut learning, stop) = (Learning::new(&first, SEED).unwrap(), AtomicBool::new(false));
    let mut ledger = Ledger::new(&first, 10);
    learning.run(20, &stop, &|_| (), &mut ledger).unwrap();
    learning.swap(&second, Carry::Keep, &mut ledger).unwrap();
    learning.run(400, &stop, &|_| (), &mut ledger).unwrap();
    assert_eq!((ledger.len(), ledger.steps()), (10, 420));
}
