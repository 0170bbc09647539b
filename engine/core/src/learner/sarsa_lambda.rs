//! Sarsa(lambda) with replacing traces (Sutton and Barto, section 12.7): `sarsa-lambda`.
//!
//! Its target needs the action that is chosen next, so a step is learned when the following one arrives.

use super::QTable;
use super::backup::{Backup, Lesson, credit};
use super::traces::Traces;
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::LearnerSettings;

/// Traces weaker than this are dropped.
const FAINTEST: f64 = 1e-3;

pub(super) struct SarsaLambda {
    step_size: f64,
    discount: f64,
    traces: Traces,
    /// The step whose next action is not known yet.
    pending: Option<Lesson>,
}

impl SarsaLambda {
    pub(super) fn new(settings: &LearnerSettings) -> Self {
        let decay = settings.discount * settings.trace_decay;
        let longest =
            if decay <= 0.0 { 1 } else { (libm::log(FAINTEST) / libm::log(decay.min(0.999))).ceil() as usize };
        let traces = Traces::new(longest.clamp(1, 1_000), decay);
        Self { step_size: settings.step_size, discount: settings.discount, traces, pending: None }
    }

    fn complete(&mut self, table: &mut QTable, lesson: &Lesson, next_value: f64) {
        let Lesson { state, action, .. } = *lesson;
        let td_error = lesson.target(self.discount, next_value) - table.value(state, action);
        self.traces.visit(state, action);
        credit(table, &self.traces, self.step_size, td_error);
    }
}

impl Backup for SarsaLambda {
    fn learn(&mut self, table: &mut QTable, lesson: &Lesson) {
        if let Some(earlier) = self.pending.replace(*lesson) {
            let next_value = table.value(lesson.state, lesson.action);
            self.complete(table, &earlier, next_value);
        }
    }

    fn forget(&mut self, table: &mut QTable) {
        // No action follows the last step before a recovery; the best one stands in for it.
        if let Some(last) = self.pending.take() {
            let next_value = last.next_best(table);
            self.complete(table, &last, next_value);
        }
        self.traces.clear();
    }

    fn save(&self, to: &mut Saving) {
        self.traces.save(to);
        to.whole(u64::from(self.pending.is_some()));
        if let Some(pending) = &self.pending {
            pending.save(to);
        }
    }

    fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit> {
        self.traces.load(from, table)?;
        self.pending = if from.index(2)? == 1 { Some(Lesson::load(from, table)?) } else { None };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::allowed::Allowed;
    use crate::settings::Settings;

    #[test]
    fn the_chosen_next_action_and_not_the_best_makes_the_target() {
        let mut table = QTable::new(3, 2, || 0.0);
        table.add(1, 0, 5.0);
        table.add(1, 1, 1.0);
        let mut sarsa = SarsaLambda::new(&Settings::default().learner);
        sarsa.learn(
            &mut table,
            &Lesson { state: 0, action: 0, reward: 2.0, next_state: 1, terminal: false, next_allowed: Allowed::ALL },
        );
        assert_eq!(table.value(0, 0), 0.0);
        sarsa.learn(
            &mut table,
            &Lesson { state: 1, action: 1, reward: 0.0, next_state: 2, terminal: false, next_allowed: Allowed::ALL },
        );
        // 0.2 * (2 + 0.99 * 1 - 0)
        assert!((table.value(0, 0) - 0.598).abs() < 1e-12);
    }

    #[test]
    fn the_last_step_before_a_recovery_is_learned_too() {
        let mut table = QTable::new(2, 1, || -0.5);
        let mut sarsa = SarsaLambda::new(&Settings::default().learner);
        sarsa.learn(
            &mut table,
            &Lesson { state: 0, action: 0, reward: -1.0, next_state: 1, terminal: false, next_allowed: Allowed::ALL },
        );
        sarsa.forget(&mut table);
        assert!((table.value(0, 0) - (-0.5 + 0.2 * (-1.0 - 0.495 + 0.5))).abs() < 1e-12);
    }
}
