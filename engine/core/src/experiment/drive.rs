//! The one loop: whoever chooses, whatever looks on.
//!
//! Learning, testing, playback, the lint's cheats and combining are [`Chooser`]s; counting, hashing, drawing and recording
//! are [`Observer`]s. The order of a step is
//!
//! ```text
//! choose -> act, sense, judge -> learn -> observers look -> recovery, if the attempt has ended -> observers are told
//! ```

use std::ops::ControlFlow;

use super::{Cycle, Hand, Step};
use crate::allowed::Allowed;
use crate::diagnostic::Result;
use crate::robot::Robot;

/// An action, and why it was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The action's number in `actions`.
    pub action: usize,
    /// It is not the best known one of its state.
    pub explored: bool,
}

/// Who chooses the actions, and may learn from what came of them.
pub trait Chooser {
    /// Chooses in the present states: the script's own first, then one for each further pair of eyes. The script's guards
    /// leave the actions that are `allowed`; in the place of any other one the slowest of them is taken.
    ///
    /// # Errors
    /// If there is nothing to choose: the run ends with this error.
    fn choose(&mut self, states: &[usize], allowed: Allowed) -> Result<Choice>;

    /// Lets a learned policy choose that the script uses now: an action by its place among [`super::Plan::motions`]. Whoever has
    /// none to hand over to chooses by itself.
    fn hand_over(&mut self, _hand: &Hand) -> Option<Choice> {
        None
    }

    /// What the script's own eyes are to go on from; empty for eyes that begin anew.
    fn kept(&self) -> &[u8] {
        &[]
    }

    /// Learns from a step, before any recovery.
    fn learn(&mut self, _step: &Step) {}

    /// The robot is about to be put elsewhere.
    fn forget(&mut self) {}
}

/// Who looks on. Looking changes nothing.
pub trait Observer<R> {
    /// A step was done, and no recovery yet. To break is to end the loop after this step and its recovery.
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()>;

    /// The robot was put elsewhere.
    fn recovered(&mut self, _cycle: &Cycle<R>) {}
}

/// Drives for `steps` steps, or until an observer breaks. Returns the steps that were done.
///
/// # Errors
/// If the robot, a filter or the script fails; the steps before that are done, see [`Cycle::steps`].
pub fn drive<R: Robot>(
    cycle: &mut Cycle<R>,
    chooser: &mut impl Chooser,
    observer: &mut impl Observer<R>,
    steps: u64,
) -> Result<u64> {
    for done in 0..steps {
        let (step, flow) = advance(cycle, chooser, observer)?;
        if step.moves() {
            recover(cycle, chooser, observer)?;
        }
        if flow.is_break() {
            return Ok(done + 1);
        }
    }
    Ok(steps)
}

/// The first half of the loop: one step, without the recovery that it may ask for.
///
/// # Errors
/// As [`drive`].
pub(super) fn advance<R: Robot>(
    cycle: &mut Cycle<R>,
    chooser: &mut impl Chooser,
    observer: &mut impl Observer<R>,
) -> Result<(Step, ControlFlow<()>)> {
    let handed = cycle.hand().and_then(|hand| Some((chooser.hand_over(&hand)?, hand.by)));
    let (choice, driver) = match handed {
        Some((choice, by)) => (choice, Some(by)),
        None => {
            let choice = chooser.choose(cycle.states(), cycle.allowed())?;
            (Choice { action: cycle.instead_of(choice.action), ..choice }, None)
        }
    };
    let step = Step { explored: choice.explored, driver, ..cycle.step(choice.action)? };
    chooser.learn(&step);
    let flow = observer.stepped(cycle, &step);
    Ok((step, flow))
}

/// The second half: what follows on a step that asks for recovery.
///
/// # Errors
/// If the robot cannot recover, or a sensor fails.
pub(super) fn recover<R: Robot>(
    cycle: &mut Cycle<R>,
    chooser: &mut impl Chooser,
    observer: &mut impl Observer<R>,
) -> Result<()> {
    chooser.forget();
    cycle.recover()?;
    observer.recovered(cycle);
    Ok(())
}

/// Nobody looks on.
impl<R> Observer<R> for () {
    fn stepped(&mut self, _: &Cycle<R>, _: &Step) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<R, O: Observer<R> + ?Sized> Observer<R> for &mut O {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        (**self).stepped(cycle, step)
    }

    fn recovered(&mut self, cycle: &Cycle<R>) {
        (**self).recovered(cycle);
    }
}

impl<R, O: Observer<R>> Observer<R> for Option<O> {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.as_mut().map_or(ControlFlow::Continue(()), |observer| observer.stepped(cycle, step))
    }

    fn recovered(&mut self, cycle: &Cycle<R>) {
        if let Some(observer) = self {
            observer.recovered(cycle);
        }
    }
}

/// Two that look on, the first one first; both see every step. Nest them for more.
impl<R, A: Observer<R>, B: Observer<R>> Observer<R> for (A, B) {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        let first = self.0.stepped(cycle, step);
        let second = self.1.stepped(cycle, step);
        if first.is_break() { first } else { second }
    }

    fn recovered(&mut self, cycle: &Cycle<R>) {
        self.0.recovered(cycle);
        self.1.recovered(cycle);
    }
}

/// Looks at every step by a function, and never at recoveries.
pub struct Each<F>(pub F);

impl<R, F: FnMut(&Cycle<R>, &Step)> Observer<R> for Each<F> {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        (self.0)(cycle, step);
        ControlFlow::Continue(())
    }
}
