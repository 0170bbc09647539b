//! One seed from beginning to end: learned or combined, tested, counted. A pure function of its plan and its seed.

use std::sync::atomic::AtomicBool;

use super::{BrokenOff, Decider, Learned, Plan, Progress, RunLog, Summary, TestRun, learn_into, test_untrained};
use crate::verdict::TestFigures;

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
    match test_untrained(plan, seed, stop) {
        Ok(untrained) => Ok(SeedRun::new(plan, seed, learned, tested, &untrained, log)),
        Err(error) => Err(Box::new(BrokenOff { error, learned })),
    }
}

impl SeedRun {
    /// What was learned and tested elsewhere, a piece at a time, with the test of a robot that knows nothing and the steps that
    /// were kept.
    #[must_use]
    pub fn new(
        plan: &Plan,
        seed: u64,
        learned: Option<Learned>,
        tested: TestRun,
        untrained: &TestFigures,
        log: &RunLog,
    ) -> Self {
        let mut summary = Summary::new(plan, seed, learned.as_ref(), &tested, untrained);
        summary.log_sha256 = log.is_kept().then(|| log.sha256());
        Self { learned, tested, summary }
    }
}
