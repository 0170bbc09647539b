use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{
    Ledger, Overrides, Phase, Plan, Playback, Snapshot, learn, learn_into, rescore, test_and_watch,
};
use engine::script::Behaviour;

use crate::support::root;

/// A shipped behaviour with fewer steps.
fn plan(script: &str, steps: u64) -> Plan {
    let behaviour = Behaviour::load(&root().join(format!("scripts/{script}.rhai"))).unwrap();
    let overrides = Overrides { steps: Some(steps), test_steps: Some(400), ..Overrides::default() };
    Plan::new(Arc::new(behaviour), &overrides).unwrap()
}

fn recorded(plan: &Plan, seed: u64) -> Ledger {
    let mut ledger = Ledger::new(plan, plan.settings.run.steps);
    learn_into(plan, seed, &AtomicBool::new(false), &|_| (), &mut ledger).unwrap();
    ledger
}

#[test]
fn keeping_the_ledger_changes_nothing_that_is_learned() {
    let plan = plan("wall", 800);
    let stop = AtomicBool::new(false);
    let without = learn(&plan, 3, &stop, &|_| ()).unwrap();
    let with = learn_into(&plan, 3, &stop, &|_| (), &mut Ledger::new(&plan, 800)).unwrap();
    assert_eq!(without.state_hash, with.state_hash);
}

#[test]
fn a_step_takes_80_bytes_and_88_with_a_reward_function() {
    let bytes = |plan: &Plan| recorded(plan, 1).legs().map(|(_, bytes)| bytes.len()).sum::<usize>();
    assert_eq!(bytes(&plan("wall", 400)), 80 * 400);
    assert_eq!(bytes(&plan("corridor-speed", 400)), 88 * 400);
}

#[test]
fn the_rules_of_a_step_add_up_to_its_reward() {
    for script in ["wall", "corridor-speed", "platform", "object"] {
        let ledger = recorded(&plan(script, 800), 1);
        let mut fired = 0;
        for (step, record) in ledger.records().enumerate() {
            let values: Vec<f64> = ledger.fired(step).map(|(_, value)| value).collect();
            assert_eq!(values.iter().sum::<f64>(), record.reward, "{script}, step {step}");
            fired += values.len();
        }
        assert!(fired >= 3, "{script}");
    }
}

#[test]
fn a_rule_that_reads_the_laser_names_the_beam_behind_it() {
    let plan = plan("wall", 1200);
    let ledger = recorded(&plan, 1);
    let mut named = [0, 0];
    for (step, record) in ledger.records().enumerate() {
        match ledger.fired(step).last() {
            // "too close" asks for the nearest beam, "contact" for none, "wall lost" for beam 0.
            Some((0, _)) => {
                assert_eq!(record.beam, Some(record.nearest_beam));
                assert!(record.nearest_m <= 0.25 && record.then.is_some());
                named[0] += 1;
            }
            Some((2, _)) => {
                assert_eq!(record.beam, Some(0));
                named[1] += 1;
            }
            _ => assert_eq!(record.beam, None),
        }
    }
    assert!(named[0] > 0 && named[1] > 0, "{named:?}");
}

#[test]
fn recorded_actions_bring_every_step_back() {
    for script in ["wall", "corridor-speed", "platform", "object", "avoid"] {
        let plan = plan(script, 800);
        let ledger = recorded(&plan, 5);
        let mut playback = Playback::new(&plan, 5, Phase::Learning, &ledger).unwrap();
        while let Some(step) = playback.advance().unwrap() {
            assert_eq!(playback.difference(), None, "{script}, step {}", step.index);
        }
        assert_eq!(playback.done(), 800);
    }
}

#[test]
fn another_seed_does_not_fit_a_ledger() {
    let plan = plan("wall", 400);
    let ledger = recorded(&plan, 5);
    let mut playback = Playback::new(&plan, 6, Phase::Learning, &ledger).unwrap();
    playback.advance().unwrap();
    assert_eq!(playback.difference(), Some("x"));
}

#[test]
fn a_test_is_played_back_as_learning_is() {
    let plan = plan("object", 800);
    let stop = AtomicBool::new(false);
    let learned = learn(&plan, 2, &stop, &|_| ()).unwrap();
    let mut ledger = Ledger::new(&plan, 400);
    test_and_watch(&plan, &learned.policy, 2, &stop, &mut ledger).unwrap();
    assert!(ledger.records().all(|record| record.prey.is_some()));
    let mut playback = Playback::new(&plan, 2, Phase::Test, &ledger).unwrap();
    while playback.advance().unwrap().is_some() {
        assert_eq!(playback.difference(), None);
    }
}

#[test]
fn going_to_a_step_forwards_or_back_shows_the_state_in_which_its_action_was_chosen() {
    let plan = plan("wall", 400);
    let ledger = recorded(&plan, 1);
    let after_a_failure = ledger.records().position(|record| record.then.is_some()).unwrap() + 1;
    let mut playback = Playback::new(&plan, 1, Phase::Learning, &ledger).unwrap();
    let mut first = None;
    for step in [after_a_failure, 300, after_a_failure, 0] {
        playback.seek(step).unwrap();
        let snapshot = Snapshot::of(playback.cycle());
        assert_eq!(snapshot.state as u32, ledger.record(step).unwrap().state);
        if step == after_a_failure {
            let image = first.get_or_insert_with(|| snapshot.image.clone());
            assert_eq!(*image, snapshot.image);
        }
    }
    assert_eq!(playback.seek(401).unwrap_err().code, "E-LOG-STEP");
}

#[test]
fn a_ledger_says_where_two_runs_part() {
    let plan = plan("wall", 400);
    let (one, two) = (recorded(&plan, 1), recorded(&plan, 2));
    assert_eq!(one.first_difference(&one.clone()), None);
    assert_eq!(one.first_difference(&two), Some((0, "x")));
}

#[test]
fn a_learner_led_along_its_own_steps_learns_its_own_table() {
    for (script, set) in [
        ("wall", ""),
        ("object", ""),
        ("wall", "learner.kind=ttd"),
        ("corridor-speed", "learner.kind=q"),
        ("platform", "learner.kind=ttd learner.replay=3"),
    ] {
        let mut plan = plan(script, 800);
        if !set.is_empty() {
            let set = set.split_whitespace().map(str::to_owned).collect();
            plan = plan.with_changes(&Overrides { set, ..Overrides::default() }).unwrap();
        }
        let mut ledger = Ledger::new(&plan, 800);
        let learned = learn_into(&plan, 9, &AtomicBool::new(false), &|_| (), &mut ledger).unwrap();
        let same = rescore(&plan, &plan, 9, &ledger, 1).unwrap();
        assert_eq!(same.policy_before, learned.policy, "{script}");
        assert_eq!(same.policy_after, learned.policy, "{script}");
        assert_eq!((same.steps_changed, same.changed_states()), (0, vec![]), "{script}");
    }
}

#[test]
fn more_rules_than_a_word_has_bits_are_told_apart() {
    let rules: String =
        (0..70).map(|rule| format!("rule \"r{rule}\" when time.step % 70 == {rule} => {rule} / 2.0;\n")).collect();
    let script = format!("world(\"room\");\nrun(#{{ steps: 400 }});\n{rules}");
    let path = root().join("scripts/many.rhai");
    let behaviour = Behaviour::parse("many", SourceText::new(path, script)).unwrap();
    let ledger = recorded(&Plan::new(Arc::new(behaviour), &Overrides::default()).unwrap(), 1);
    for step in 0..400 {
        let rule = (step + 1) % 70;
        let value = rule as f64 / 2.0;
        assert_eq!(ledger.fired(step).collect::<Vec<_>>(), [(rule, value)]);
        assert_eq!(ledger.record(step).unwrap().reward, value);
    }
}

#[test]
fn many_passes_stay_within_what_the_rewards_can_add_up_to() {
    let plan = plan("wall", 2_000);
    let ledger = recorded(&plan, 1);
    let rescored = rescore(&plan, &plan, 1, &ledger, 200).unwrap();
    assert_eq!(rescored.changed_states(), Vec::<usize>::new());
    // Punishments of -1 in every step, discounted by 0.99, come to -100.
    let values = rescored.policy_after.rows().flat_map(|(_, row)| &row.values);
    assert!(values.clone().all(|value| (-100.0..=0.0).contains(value)));
    assert!(values.clone().any(|value| *value < -1.0));
}

#[test]
fn a_script_that_reads_no_camera_is_driven_without_an_image_and_shows_one_where_it_is_asked_for() {
    for (script, looks) in [("raceway", false), ("vacuum", false), ("wall", true)] {
        let plan = plan(script, 400);
        assert_eq!(plan.looks(), looks, "{script}");
        let ledger = recorded(&plan, 5);
        let mut playback = Playback::new(&plan, 5, Phase::Learning, &ledger).unwrap();
        while playback.advance().unwrap().is_some() {
            assert_eq!(playback.difference(), None, "{script}");
        }
        let seen = Snapshot::of(playback.cycle());
        let drawn = playback.cycle().observation().image.pixels.len();
        assert_eq!((drawn > 0, seen.views.len()), (looks, usize::from(looks)), "{script}");
        // The picture is drawn for whoever looks on.
        assert!(seen.image.pixels.len() == 160 * 120 * 3 && seen.image.pixels.iter().any(|level| *level > 0));
        assert_eq!(ledger.records().any(|record| record.coverage > 0.0), looks, "{script}");
    }
}

#[test]
fn other_rules_that_read_a_view_open_the_eyes_of_a_recorded_run_without_changing_it() {
    let written = |rule: &str| {
        let text = format!(
            "world(\"room\"); run(#{{ steps: 400, test_steps: 400 }}); state(bins(laser.front, [1.0]));
             rule \"hit\" when laser.nearest < 0.3 => -1 then fail; {rule}"
        );
        let behaviour = Behaviour::parse("blind", SourceText::new(root().join("scripts/blind.rhai"), text)).unwrap();
        Plan::new(Arc::new(behaviour), &Overrides::default()).unwrap()
    };
    let (plan, sees) = (written(""), written("rule \"sees\" when camera.seen => 0.5;"));
    assert!(!plan.looks() && sees.looks());
    let rescored = rescore(&plan, &sees, 1, &recorded(&plan, 1), 1).unwrap();
    // In the room something with edges is nearly always in sight.
    let added = rescored.reward_after - rescored.reward_before;
    assert!(rescored.steps_changed > 200 && added == 0.5 * rescored.steps_changed as f64, "{rescored:?}");
}
