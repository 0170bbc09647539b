//! Every kind of run that learns goes on from its checkpoints as if nothing had happened.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use engine::diagnostic::SourceText;
use engine::experiment::{Checkpoints, Kept, Ledger, Leg, Overrides, Plan, learn_kept};
use engine::filter::Catalogue;
use engine::learner::Carry;
use engine::script::Behaviour;
use insight::store::plan_of_run;

use crate::support::filters::forms;
use crate::support::{Bench, SCRIPT};

/// Steps from one checkpoint to the next: in the middle of a window.
const EVERY: u64 = 170;

type Own = (Vec<u8>, Vec<u8>, u64);

fn plan_with(text: &str, bench: &Bench, filters: Arc<Catalogue>) -> Plan {
    let source = SourceText::new(bench.path().join("own.rhai"), text.to_owned());
    let behaviour = Arc::new(Behaviour::parse("own", source).unwrap());
    Plan::with_filters(behaviour, &Overrides::default(), filters).unwrap_or_else(|error| panic!("{error:?}"))
}

fn plan(text: &str, bench: &Bench) -> Plan {
    plan_with(text, bench, Arc::new(Catalogue::linked_in()))
}

/// What a seed learns, its records, and all checkpoints on the way.
fn learned(plan: &Plan, from: Option<Kept<'_>>) -> (String, Vec<Vec<u8>>, Vec<Own>) {
    let (stop, all) = (AtomicBool::new(false), Mutex::new(Vec::new()));
    let keep = |kept: Kept<'_>| {
        all.lock().unwrap().push((kept.state.to_vec(), kept.records.to_vec(), kept.steps));
        Ok(())
    };
    let mut ledger = Ledger::new(plan.first_leg(), plan.first_steps());
    let checkpoints = Checkpoints { every: EVERY, from, keep: &keep, take: &|_| Ok(()) };
    let learned = learn_kept(plan, 3, &stop, &|_| (), &mut ledger, checkpoints).unwrap();
    let records = ledger.legs().map(|(_, bytes)| bytes.to_vec()).collect();
    (learned.state_hash, records, all.into_inner().unwrap())
}

fn every_checkpoint_of(plan: &Plan) {
    let (hash, records, all) = learned(plan, None);
    assert!(all.len() > 3, "{}", all.len());
    for (state, stored, steps) in &all {
        let from = Kept { state, records: stored, tail: &[], steps: *steps };
        let (again, records_again, _) = learned(plan, Some(from));
        assert!((&again, &records_again) == (&hash, &records), "from step {steps}");
    }
}

#[test]
fn a_run_that_uses_policies_goes_on_from_every_checkpoint() {
    let bench = Bench::new();
    bench.write("slow.rhai", crate::used::SLOW);
    bench.engine(&["run", "slow.rhai"]);
    let stages = "policy(\"slow\", \"runs/slow/1\");\nstages([\"far\", \"near\"]);\n\
                  use \"slow\" in \"near\" when laser.front < 1.5;\n\
                  rule \"gets near\" in \"far\" when laser.nearest < 0.6 => 0 then stage \"near\";\n\
                  rule \"gets far\" in \"near\" when laser.nearest > 0.65 => 0 then stage \"far\";";
    bench.write("mine.rhai", format!("{stages}\n{SCRIPT}"));
    bench.engine(&["run", "mine.rhai"]);
    let (plan, _) = plan_of_run(&bench.path().join("runs/mine/1"), Arc::new(Catalogue::linked_in())).unwrap();
    assert!(!plan.used.is_empty());
    every_checkpoint_of(&plan);
}

#[test]
fn a_run_that_calibrates_in_world_after_world_goes_on_from_every_checkpoint() {
    let bench = Bench::new();
    let worlds = "worlds([\"small\", \"corridors:1-3\"]);\nrun(#{ steps: 800, stay_steps: 35 });\n\
                  fn calibrate(facts) { #{ front: facts.laser.front, all: [facts.laser.nearest, 1], name: \"a\" } }\n\
                  rule \"farther\" when laser.front > calibrated.front => laser.nearest - calibrated.all[0];\n\
                  rule \"hit\" when laser.nearest <= 0.25 => -1 then recover;";
    every_checkpoint_of(&plan(worlds, &bench));
}

#[test]
fn a_run_whose_rules_are_swapped_goes_on_from_every_checkpoint_of_every_leg() {
    let bench = Bench::new();
    let script = |rules: &str, learner: &str| format!("{learner}\n{SCRIPT}{rules}");
    for (learner, then) in [
        ("learner(#{ kind: \"ttd\" });", Carry::Decay),
        ("learner(#{ kind: \"memory\" });", Carry::Rescore),
        ("learner(#{ kind: \"memory\" });", Carry::Keep),
    ] {
        let first = plan(&script("", learner), &bench);
        let calibrated = "fn calibrate(facts) { facts.laser.front }\n\
                          rule \"farther\" when laser.front > calibrated => 0.1;\n";
        let last = plan(&script(calibrated, learner), &bench);
        // 510 is a checkpoint too: the swap comes after it.
        let last = last.after(vec![Leg { plan: first, steps: 510, then }]);
        every_checkpoint_of(&last);
    }
}

#[test]
fn a_run_whose_filter_comes_from_a_file_goes_on_with_what_the_filter_kept() {
    let bench = Bench::new();
    let filter = "filter(\"floor\", #{ memory: true });\ngrid(#{ occupied: 0.2 });\n";
    for (form, catalogue) in forms() {
        println!("{form}");
        every_checkpoint_of(&plan_with(&format!("{filter}{SCRIPT}"), &bench, catalogue));
    }
}

#[test]
fn a_checkpoint_that_is_asked_for_where_nothing_is_learned_is_refused() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    bench.engine(&["run", "short.rhai", "--seed", "2"]);
    let policies = "policy(\"a\", \"runs/short/1\");\npolicy(\"b\", \"runs/short/2\");\ncombine(\"sum\");\n";
    bench.write("both.rhai", format!("{policies}{SCRIPT}"));
    let told = bench.failure(&["run", "both.rhai", "--checkpoint", "400"]);
    let wanted = "learns nothing that a checkpoint could keep";
    assert!(told.starts_with("exit status 2\nerror[E-COMBINES]") && told.contains(wanted), "{told}");
}
