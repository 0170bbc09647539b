//! Learning that can be left and taken up again, bit for bit.
//!
//! A checkpoint is the state itself: to do the steps again would take as long as they took. What a run makes of its plan and
//! seed is not in it (calibration, worlds, tables of rays): the robot that takes it up is made anew, and then becomes what was
//! passed. Records stand beside it, see [`super::Ledger::stored`].

use std::sync::atomic::{AtomicBool, Ordering};

use super::{Learning, Ledger, Plan, Progress};
use crate::diagnostic::{Diagnostic, Result};

/// What was kept of one seed.
#[derive(Debug, Clone, Copy)]
pub struct Kept<'a> {
    /// All that goes on, see [`Learning::save`].
    pub state: &'a [u8],
    /// Records of the steps, see [`Ledger::stored`].
    pub records: &'a [u8],
    /// Steps that were done.
    pub steps: u64,
}

/// When to keep all that goes on, and what to go on from.
#[derive(Clone, Copy)]
pub struct Checkpoints<'a> {
    /// After so many steps each, and when learning is stopped; never if it is 0.
    pub every: u64,
    /// What to go on from.
    pub from: Option<Kept<'a>>,
    /// Keeps it.
    pub keep: &'a (dyn Fn(Kept<'_>) -> Result<()> + Sync),
}

impl Checkpoints<'_> {
    /// Nothing is kept.
    pub const NONE: Checkpoints<'static> = Checkpoints { every: 0, from: None, keep: &|_| Ok(()) };

    /// These, of a plan whose state can be kept; without them it learns as it always did.
    pub(super) fn of(self, plan: &Plan) -> Option<Self> {
        ((self.every > 0 || self.from.is_some()) && can_be_kept(plan)).then_some(self)
    }

    pub(super) fn learn(
        self,
        plan: &Plan,
        seed: u64,
        stop: &AtomicBool,
        report: &(dyn Fn(Progress) + Sync),
        ledger: &mut Ledger,
    ) -> Result<Learning> {
        let mut learning = Learning::new(plan, seed)?;
        if let Some(kept) = self.from {
            let fits = learning.load(kept.state).is_ok() && learning.steps() == kept.steps;
            if !fits || !ledger.go_on_after(kept.records, kept.steps) {
                return unfit("it does not fit the run that it stands beside").fail();
            }
        }
        ledger.set_out_from(&learning.set_out_from);
        let (all, every) = (plan.settings.run.steps, if self.every == 0 { u64::MAX } else { self.every });
        while learning.steps() < all && learning.fault().is_none() {
            let next = every - learning.steps() % every;
            learning.go_on(next.min(all - learning.steps()), stop, report, ledger)?;
            let stopped = stop.load(Ordering::Relaxed);
            if learning.fault().is_none() && (stopped || learning.steps() < all) {
                self.keep(&mut learning, ledger)?;
            }
            if stopped {
                break;
            }
        }
        Ok(learning)
    }

    fn keep(self, learning: &mut Learning, ledger: &Ledger) -> Result<()> {
        let state = learning.save().map_err(|_| Box::new(unfit("this run has a state that cannot be kept")))?;
        let (records, steps) = ledger.stored();
        (self.keep)(Kept { state: &state, records, steps })
    }
}

/// Whether all that goes on while a plan is learned can be kept: not where learned policies drive too, where the reward was
/// swapped, where a script calibrates in world after world, or where a filter comes from a file.
#[must_use]
pub fn can_be_kept(plan: &Plan) -> bool {
    let mut filters = plan.settings.views().flat_map(|view| &view.filters);
    let alone = plan.worlds.layouts().len() == 1 || !plan.behaviour.calibrates();
    plan.learns()
        && plan.used.is_empty()
        && plan.earlier.is_empty()
        && alone
        && filters.all(|filter| plan.filters.is_own(&filter.name))
}

fn unfit(what: &str) -> Diagnostic {
    let message = format!("the checkpoint cannot be used: {what}");
    Diagnostic::new("E-CHECKPOINT", message).help("start the run anew: engine run SCRIPT --force")
}
