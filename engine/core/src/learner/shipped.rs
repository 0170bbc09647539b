//! The learner that the settings name: the one place that knows them all.

use super::{Carry, Learner, MemoryLearner, Mirror, Policy, Rejudged, TableLearner, Task, Transition};
use crate::allowed::Allowed;
use crate::random::Random;
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::{LearnerKind, LearnerSettings};

/// Every learner that ships.
pub enum ShippedLearner {
    /// One that keeps a table.
    Table(Box<TableLearner>),
    /// One that remembers its steps.
    Memory(Box<MemoryLearner>),
}

/// The learner that the settings name, for a task.
#[must_use]
pub fn shipped_learner(settings: &LearnerSettings, task: Task) -> ShippedLearner {
    match settings.kind {
        LearnerKind::Memory => ShippedLearner::Memory(Box::new(MemoryLearner::new(settings, task))),
        _ => ShippedLearner::Table(Box::new(TableLearner::new(settings, task))),
    }
}

impl ShippedLearner {
    /// The one that remembers its steps, if that is what learns.
    #[must_use]
    pub fn memory(&self) -> Option<&MemoryLearner> {
        match self {
            Self::Table(_) => None,
            Self::Memory(learner) => Some(learner),
        }
    }

    /// This learner with another stream of random numbers.
    #[must_use]
    pub(crate) fn with_random(self, random: Random) -> Self {
        match self {
            Self::Table(learner) => Self::Table(Box::new(learner.with_random(random))),
            Self::Memory(learner) => Self::Memory(Box::new(learner.with_random(random))),
        }
    }

    fn own(&self) -> &dyn Learner {
        match self {
            Self::Table(learner) => &**learner,
            Self::Memory(learner) => &**learner,
        }
    }

    fn own_mut(&mut self) -> &mut dyn Learner {
        match self {
            Self::Table(learner) => &mut **learner,
            Self::Memory(learner) => &mut **learner,
        }
    }
}

impl Learner for ShippedLearner {
    fn choose(&mut self, state: usize, allowed: Allowed) -> (usize, bool) {
        match self {
            Self::Table(learner) => learner.choose(state, allowed),
            Self::Memory(learner) => learner.choose(state, allowed),
        }
    }

    fn visit(&mut self, state: usize) {
        self.own_mut().visit(state);
    }

    fn learn(&mut self, transition: &Transition) {
        match self {
            Self::Table(learner) => learner.learn(transition),
            Self::Memory(learner) => learner.learn(transition),
        }
    }

    fn forget(&mut self) {
        self.own_mut().forget();
    }

    fn swap(&mut self, settings: &LearnerSettings, mirror: Option<Mirror>, carry: Carry) {
        self.own_mut().swap(settings, mirror, carry);
    }

    fn rescore(&mut self, steps: &[Rejudged]) {
        self.own_mut().rescore(steps);
    }

    fn policy(&self) -> Policy {
        self.own().policy()
    }

    fn numbers(&self, each: &mut dyn FnMut(f64)) {
        self.own().numbers(each);
    }

    fn save(&self, to: &mut Saving) {
        self.own().save(to);
    }

    fn load(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit> {
        self.own_mut().load(from)
    }
}
