//! A behaviour that combines learned policies: each save tests the combination desk. Nothing is learned, so that a run
//! has no curve and no table of its own.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::board::WatchedSeed;
use super::desk::Desk;
use super::files::Files;
use super::findings;
use super::session::MOST_LEDGER_BYTES;
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Decider, Learned, Ledger, Plan, RecordShape, Tally, Trail, in_parallel};
use engine::learner::Policy;
use insight::store::{policy_files, with_policies};

/// Tests the combination with all seeds and shows it; its policies are watched from then on.
pub(super) fn retest(desk: &Desk, plan: Plan, stop: &AtomicBool, files: &Mutex<Files>) -> Result<()> {
    if desk.settings.finished.is_some() {
        let message = "this behaviour combines learned policies: nothing is learned that could be kept or written";
        let error = Diagnostic::new("E-WATCH-POLICIES", message);
        return error.help("leave out --keep and --out; engine run SCRIPT writes the folder of such a test").fail();
    }
    let started = Instant::now();
    files.lock().unwrap_or_else(PoisonError::into_inner).watch(policy_files(&plan))?;
    let plan = with_policies(plan)?;
    let seeds = &desk.settings.seeds;
    let count = if seeds.len() == 1 { "one seed".to_owned() } else { format!("{} seeds", seeds.len()) };
    let steps = plan.settings.run.test_steps;
    desk.board.working(&format!("testing {} policies as one, {count}, {steps} steps each", plan.members.len()));
    let room = MOST_LEDGER_BYTES / (seeds.len() * RecordShape::of(&plan).bytes()).max(1) as u64;
    let tested = in_parallel(seeds, desk.settings.threads, |seed| test(&plan, seed, room, stop))?;
    if stop.load(Ordering::Relaxed) {
        return Ok(());
    }
    let tested_s = started.elapsed().as_secs_f64();
    let text = format!("save {}: combined policies tested in {tested_s:.2} s", desk.save);
    let run = desk.show(plan, tested, true, &text, None)?;
    findings::tell(&desk.board, &run, desk.settings.threads, stop);
    Ok(())
}

fn test(plan: &Plan, seed: u64, room: u64, stop: &AtomicBool) -> Result<WatchedSeed> {
    let mut tested = Ledger::new(plan, plan.settings.run.test_steps.min(room));
    let run = Decider::Combined.test(plan, seed, stop, &mut tested)?;
    let learned = Arc::new(nothing_learned(plan, seed));
    Ok(WatchedSeed { learned, learning: Arc::new(Ledger::off()), test: Some(run.figures), tested })
}

/// No step of learning.
fn nothing_learned(plan: &Plan, seed: u64) -> Learned {
    let tally = Tally::new(plan.behaviour.rules().len(), 0);
    let policy = Policy::new(plan.settings.actions.len(), Vec::new());
    Learned { seed, steps: 0, tally, policy, early: Trail::default(), state_hash: String::new() }
}
