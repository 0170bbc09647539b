//! One seed from beginning to end: learned or combined, tested, counted. A pure function of its plan and its seed.

use std::sync::atomic::AtomicBool;

use super::{BrokenOff, Decider, Learned, Plan, Progress, RunLog, Summary, TestRun, base_lines, learn_into};
use crate::verdict::BaseLines;

/// What one seed leaves.
#[derive(Debug, Clone)]
pub struct SeedRun {
    /// What was learned; nothing of a behaviour that combines learned policies.
    pub learned: Option<Learned>,
    /// The test.
    pub tested: TestRun,
    /// The figures; how long it took is not among them, see [`Summary::timed`].
    pub summary: Summary,
}

/// Learns a plan under a seed, unless it combines policies, and tests what came of it, with every step kept in `log`
/// that it has room for. Once `stop` is set, it ends after the present window.
///
/// # Errors
/// If a sensor, a filter or the script fails; what was learned before is in the error, and in the log.
pub fn run_seed(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    log: &mut RunLog,
) -> Result<SeedRun, Box<BrokenOff>> {
    let learned = if plan.learns() { Some(learn_into(plan, seed, stop, report, &mut log.learning)?) } else { None };
    let tested = match Decider::of(learned.as_ref()).test(plan, seed, stop, &mut log.test) {
        Ok(tested) => tested,
        Err(error) => return Err(Box::new(BrokenOff { error, learned })),
    };
    match base_lines(plan, seed, &tested, stop) {
        Ok(lines) => Ok(SeedRun::new(plan, seed, learned, tested, &lines, log)),
        Err(error) => Err(Box::new(BrokenOff { error, learned })),
    }
}

impl SeedRun {
    /// What was learned and tested elsewhere, a piece at a time, with the base lines of its test and the steps that were
    /// kept.
    #[must_use]
    pub fn new(
        plan: &Plan,
        seed: u64,
        learned: Option<Learned>,
        tested: TestRun,
        lines: &BaseLines,
        log: &RunLog,
    ) -> Self {
        let mut summary = Summary::new(plan, seed, learned.as_ref(), &tested, lines);
        summary.log_sha256 = log.is_kept().then(|| log.sha256());
        Self { learned, tested, summary }
    }
}
