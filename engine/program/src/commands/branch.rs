//! `engine run --branch RUN@STEP`: what would have come if another script had judged from a recorded step on.

use std::path::Path;
use std::sync::Arc;

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Ledger, Leg, Overrides, Plan, Record};
use engine::filter::Catalogue;
use engine::learner::Carry;
use insight::store::RecordedRun;

use super::words::motion;
use crate::console::{Console, ConsoleError};

/// A recorded run, and the step from which another script judges.
pub(super) struct Branch {
    seed: u64,
    step: u64,
    recorded: Ledger,
}

impl Branch {
    /// The plan that learns as the recorded run did up to the step, and then by its own rules: for so many steps, or as many as
    /// the run had left.
    ///
    /// # Errors
    /// `E-BRANCH` if the run has no such step, or the script differs in more than rules, learner and numbers of steps.
    pub(super) fn begin(plan: Plan, from: &str, steps: Option<u64>, filters: &Arc<Catalogue>) -> Result<(Plan, Self)> {
        let Some((run, step)) = from.rsplit_once('@').and_then(|(run, step)| Some((run, step.parse::<u64>().ok()?)))
        else {
            let message = format!("'{}' is not a run and a step", printable(from));
            return wrong(message, "write the folder, an @ and the step: --branch runs/wall/1@200").fail();
        };
        let RecordedRun { stored, log, .. } = RecordedRun::load(Path::new(run), Arc::clone(filters))?;
        let recorded = log.learning;
        if step == 0 || step > recorded.len() as u64 {
            let message = format!("'{}' has {} recorded steps of learning, not {step}", printable(run), recorded.len());
            return wrong(message, "name a step of them, from 1 on: so many are done as they were recorded").fail();
        }
        if let Some(what) = stored.plan.differs_beyond_reward(&plan) {
            let message = format!("{what} of the script is not that of the run '{}'", printable(run));
            return wrong(message, "branch with the same set-up and other rules; or go on from the whole run: --from")
                .fail();
        }
        let left = steps.unwrap_or_else(|| (recorded.steps() - step).max(1));
        let plan = plan.with_changes(&Overrides { steps: Some(left), ..Overrides::default() })?;
        let plan = plan.after(legs(&stored.plan, step));
        Ok((plan, Self { seed: stored.seed, step, recorded }))
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed
    }

    /// Prints the first step that differs from the recorded one.
    pub(super) fn tell(
        &self,
        plan: &Plan,
        learned: &Ledger,
        console: &mut Console,
    ) -> std::result::Result<(), ConsoleError> {
        let both = self.recorded.records().zip(learned.records()).enumerate();
        let Some((step, (old, new))) = both.into_iter().find(|(_, (old, new))| old != new) else {
            return console.line(&format!("branch:    from step {} on nothing differs", self.step));
        };
        if (step as u64) < self.step {
            let message = format!("step {step} came out otherwise than it was recorded: this engine is another one");
            return Err(Box::new(Diagnostic::new("E-LOG-DIFFERS", message)).into());
        }
        let what = difference(plan, &old, &new);
        console.line(&format!("branch:    the first step that differs from the recorded one is {step}: {what}"))
    }
}

/// The legs of a run up to a step.
fn legs(plan: &Plan, mut left: u64) -> Vec<Leg> {
    let mut legs = Vec::new();
    for leg in &plan.earlier {
        if left <= leg.steps {
            break;
        }
        left -= leg.steps;
        legs.push(leg.clone());
    }
    let under = plan.earlier.get(legs.len()).map_or_else(|| plan.clone().after(Vec::new()), |leg| leg.plan.clone());
    legs.push(Leg { plan: under, steps: left, then: Carry::Keep });
    legs
}

fn difference(plan: &Plan, old: &Record, new: &Record) -> String {
    let named = |action: u16| {
        plan.settings
            .actions
            .get(usize::from(action))
            .map_or("?".to_owned(), |twist| motion([twist.linear_m_per_s, twist.angular_rad_per_s]))
    };
    if old.action != new.action {
        return format!("in state {} it {} and not {}", new.state, named(new.action), named(old.action));
    }
    if old.reward.to_bits() != new.reward.to_bits() {
        return format!("the reward is {} and not {}", new.reward, old.reward);
    }
    if old.then != new.then {
        return "the attempt ends otherwise".to_owned();
    }
    format!("state {} and not {} follows", new.next_state, old.next_state)
}

fn wrong(message: String, help: &str) -> Diagnostic {
    Diagnostic::new("E-BRANCH", message).help(help)
}
