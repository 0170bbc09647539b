//! Learning that can be left and taken up again, bit for bit.
//!
//! A checkpoint is the state itself: to do the steps again would take as long as they took. What a run makes of its plan and
//! seed is not in it (calibration, worlds, tables of rays): the robot that takes it up is made anew, and then becomes what was
//! passed. Records stand beside it, see [`super::Ledger::stored`].

use std::sync::atomic::{AtomicBool, Ordering};

use super::{Learning, Ledger, PassedOn, Plan, Progress};
use crate::diagnostic::{Diagnostic, Result};

/// What was kept of one seed.
#[derive(Debug, Clone, Copy)]
pub struct Kept<'a> {
    /// All that goes on, see [`Learning::save`].
    pub state: &'a [u8],
    /// Records of the steps, see [`Ledger::stored`].
    pub records: &'a [u8],
    /// Of a run that is longer than a ledger: what goes on of the records after these; else empty.
    pub tail: &'a [u8],
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
    /// Takes the records that a ledger has no room for, in their order.
    pub take: &'a (dyn Fn(PassedOn<'_>) -> Result<()> + Sync),
}

impl Checkpoints<'_> {
    /// Nothing is kept.
    pub const NONE: Checkpoints<'static> = Checkpoints { every: 0, from: None, keep: &|_| Ok(()), take: &|_| Ok(()) };

    /// How many steps to learn until there is something to keep, or so many are done.
    fn stretch(self, done: u64, end: u64) -> u64 {
        if self.every == 0 { end - done } else { (end - done).min(self.every - done % self.every) }
    }

    /// Whether one is to be kept after so many steps.
    fn is_due(self, done: u64) -> bool {
        self.every > 0 && done.is_multiple_of(self.every)
    }

    fn keep(self, learning: &mut Learning, ledger: &Ledger) -> Result<()> {
        if self.every == 0 && self.from.is_none() {
            return Ok(());
        }
        let state = learning.save().map_err(|_| Box::new(unfit("this run has a state that cannot be kept")))?;
        let (records, tail) = (ledger.stored(), ledger.stored_tail());
        (self.keep)(Kept { state: &state, records: &records, tail: &tail, steps: learning.steps() })
    }
}

/// Learns through all legs of a plan, with checkpoints on the way or from one on; the rules of another plan may judge along, for
/// what comes after the last leg.
pub(super) fn learn_through(
    plan: &Plan,
    seed: u64,
    after: Option<&Plan>,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    ledger: &mut Ledger,
    checkpoints: Checkpoints<'_>,
) -> Result<Learning> {
    let others: Vec<&Plan> = plan.rescored().chain(after).collect();
    let mut learning = Learning::watched(plan.first_leg(), seed, &others)?;
    ledger.set_out_from(&learning.set_out_from);
    let swapped = checkpoints.from.map_or(Ok(0), |kept| take_up(plan, &mut learning, ledger, kept))?;
    let (all, mut swaps) = (plan.learning_steps(), plan.swaps().skip(swapped).peekable());
    loop {
        let (end, mut stopped) = (swaps.peek().map_or(all, |(from, ..)| *from), false);
        while learning.steps() < end && learning.fault().is_none() && !stopped {
            let stretch = checkpoints.stretch(learning.steps(), end).min(ledger.room());
            learning.go_on(stretch, stop, report, ledger)?;
            ledger.pass_on(false, &mut |passed_on| (checkpoints.take)(passed_on))?;
            stopped = stop.load(Ordering::Relaxed);
            let done = learning.steps();
            // Where rules are swapped, what is seen there is part of it: that checkpoint comes after the swap.
            let is_due = checkpoints.is_due(done) && done < end || stopped && (done < end || end == all);
            if is_due && learning.fault().is_none() {
                checkpoints.keep(&mut learning, ledger)?;
            }
        }
        match swaps.next() {
            Some((_, carry, leg, _)) if learning.steps() == end && learning.fault().is_none() => {
                learning.swap_next(leg, carry, ledger)?;
                if checkpoints.is_due(learning.steps()) && learning.fault().is_none() {
                    checkpoints.keep(&mut learning, ledger)?;
                }
            }
            _ => break,
        }
    }
    ledger.pass_on(true, &mut |passed_on| (checkpoints.take)(passed_on))?;
    Ok(learning)
}

/// Becomes what was kept: a robot as it stood before the first step, under the rules of the leg that the checkpoint was made in,
/// takes over all that goes on. Returns how many swaps were done.
fn take_up(plan: &Plan, learning: &mut Learning, ledger: &mut Ledger, kept: Kept<'_>) -> Result<usize> {
    let (mut records, mut left, mut fits, mut swapped) = (kept.records, kept.steps, true, 0);
    let before = plan.earlier.iter().map(|leg| leg.steps);
    for ((_, carry, leg, _), steps) in plan.swaps().take_while(|(from, ..)| *from <= kept.steps).zip(before) {
        fits &= ledger.take_up(&mut records, steps);
        (left, swapped) = (left - steps, swapped + 1);
        learning.swap_next(leg, carry, ledger)?;
    }
    fits &= ledger.take_up(&mut records, left) && records.is_empty() && ledger.take_up_tail(kept.tail);
    fits &= learning.load(kept.state).is_ok() && learning.steps() == kept.steps;
    if fits { Ok(swapped) } else { unfit("it does not fit the run that it stands beside").fail() }
}

fn unfit(what: &str) -> Diagnostic {
    let message = format!("the checkpoint cannot be used: {what}");
    Diagnostic::new("E-CHECKPOINT", message).help("start the run anew: engine run SCRIPT --force")
}
