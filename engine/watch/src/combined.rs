//! A behaviour that combines learned policies: each save tests the combination. Nothing is learned, so that a run
//! has no curve and no table of its own.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::board::WatchedSeed;
use super::desk::{Desk, SeedTest, test_seed};
use super::files::Files;
use super::findings;
use super::session::MOST_LEDGER_BYTES;
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Ledger, Plan, RecordShape, in_parallel};
use insight::store::{policy_files, with_policies_or};

/// Tests the combination with all seeds and shows it; its policies are watched from then on.
pub(super) fn retest(desk: &Desk, plan: Plan, stop: &AtomicBool, files: &Mutex<Files>) -> Result<()> {
    if desk.settings.finished.is_some() {
        let message = "this behaviour combines learned policies: nothing is learned that could be kept or written";
        let error = Diagnostic::new("E-WATCH-POLICIES", message);
        return error.help("leave out --keep and --out; engine run SCRIPT writes the folder of such a test").fail();
    }
    let started = Instant::now();
    files.lock().unwrap_or_else(PoisonError::into_inner).watch(policy_files(&plan))?;
    let plan = with_policies_or(plan, &*desk.settings.packed)?;
    let seeds = &desk.settings.seeds;
    let count = if seeds.len() == 1 { "one seed".to_owned() } else { format!("{} seeds", seeds.len()) };
    let steps = plan.settings.run.test_steps;
    desk.board
        .working(&format!("testing {} policies as one, {count}, {steps} steps each", plan.settings.policies.len()));
    let room = MOST_LEDGER_BYTES / (seeds.len() * RecordShape::of(&plan).bytes()).max(1) as u64;
    let tested = in_parallel(seeds, desk.settings.threads, |seed| {
        let SeedTest { run, lines, kept } = test_seed(&plan, seed, None, room, stop)?;
        let (learning, lines) = (Arc::new(Ledger::off()), Some(lines));
        Ok(WatchedSeed { seed, learned: None, learning, test: Some(run.figures), lines, tested: kept })
    })?;
    if stop.load(Ordering::Relaxed) {
        return Ok(());
    }
    let tested_s = started.elapsed().as_secs_f64();
    let text = format!("save {}: combined policies tested in {tested_s:.2} s", desk.save);
    let run = desk.show(plan, tested, true, &text, None)?;
    findings::tell(&desk.board, &run, desk.settings.threads, stop);
    Ok(())
}
