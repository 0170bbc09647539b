//! One seed from beginning to end: learned or combined, tested, counted. A pure function of its plan and its seed.

use std::sync::atomic::AtomicBool;

use super::base_lines::{Ahead, base_lines};
use super::{BrokenOff, Checkpoints, Decider, Learned, Plan, Progress, RunLog, Summary, TestRun, learn_kept};
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
/// that it has room for. Once `stop` is set, it ends after the present step.
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
    run_seed_kept(plan, seed, stop, report, log, Checkpoints::NONE)
}

/// As [`run_seed`], to the bit, with checkpoints on the way or from one on.
///
/// # Errors
/// As [`run_seed`]; `E-CHECKPOINT` if what it is to go on from does not fit.
pub fn run_seed_kept(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    log: &mut RunLog,
    checkpoints: Checkpoints<'_>,
) -> Result<SeedRun, Box<BrokenOff>> {
    let (learned, tested) = learn_and_test(plan, seed, stop, report, log, checkpoints)?;
    let lines = base_lines(plan, seed, &tested, stop);
    SeedRun::or_broken(plan, seed, learned, tested, lines, log)
}

/// As [`run_seed_kept`], to the bit: for a seed that has the cores to itself. A second thread, if rayon has one here, measures
/// the base lines of the test meanwhile, unless a filter comes from a file: of those one robot at a time makes use. Of many
/// seeds, one that waits for it would take up another seed.
///
/// # Errors
/// As [`run_seed_kept`].
pub fn run_only_seed(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    log: &mut RunLog,
    checkpoints: Checkpoints<'_>,
) -> Result<SeedRun, Box<BrokenOff>> {
    let mut filters = plan.settings.views().flat_map(|view| &view.filters);
    if !filters.all(|filter| plan.filters.is_own(&filter.name)) {
        return run_seed_kept(plan, seed, stop, report, log, checkpoints);
    }
    let (tested, ahead) =
        rayon::join(|| learn_and_test(plan, seed, stop, report, log, checkpoints), || Ahead::of(plan, seed, stop));
    let (learned, tested) = tested?;
    let lines = ahead.and_then(|ahead| ahead.beside(plan, seed, &tested, stop));
    SeedRun::or_broken(plan, seed, learned, tested, lines, log)
}

/// What a plan learns under a seed, if it learns, and its test.
fn learn_and_test(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    log: &mut RunLog,
    checkpoints: Checkpoints<'_>,
) -> Result<(Option<Learned>, TestRun), Box<BrokenOff>> {
    let learned = match plan.learns() {
        true => Some(learn_kept(plan, seed, stop, report, &mut log.learning, checkpoints)?),
        false => None,
    };
    log.test.set_out_from(learned.as_ref().map_or(&[], |learned| learned.policy.kept()));
    match Decider::of(learned.as_ref()).test(plan, seed, stop, &mut log.test) {
        Ok(tested) => Ok((learned, tested)),
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

    fn or_broken(
        plan: &Plan,
        seed: u64,
        learned: Option<Learned>,
        tested: TestRun,
        lines: crate::diagnostic::Result<BaseLines>,
        log: &RunLog,
    ) -> Result<Self, Box<BrokenOff>> {
        match lines {
            Ok(lines) => Ok(Self::new(plan, seed, learned, tested, &lines, log)),
            Err(error) => Err(Box::new(BrokenOff { error, learned })),
        }
    }
}
