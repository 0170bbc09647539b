//! The learner that the settings name: the one place that knows them all.

use super::{TableLearner, Task};
use crate::settings::LearnerSettings;

/// Every learner that ships; today each of them keeps a table.
pub type ShippedLearner = TableLearner;

/// The learner that the settings name, for a task.
#[must_use]
pub fn shipped_learner(settings: &LearnerSettings, task: Task) -> ShippedLearner {
    TableLearner::new(settings, task)
}
