//! TTD(lambda) Q-learning as the paper prints it, equations (1) and (2): the default, `ttd`; with a window of one, `q`.

use super::QTable;
use super::backup::{Backup, Lesson, credit};
use super::traces::Traces;
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::LearnerSettings;

/// One TD error for the last n distinct states.
pub(super) struct Ttd {
    step_size: f64,
    discount: f64,
    traces: Traces,
}

impl Ttd {
    pub(super) fn new(settings: &LearnerSettings) -> Self {
        Self::with_window(settings, settings.window as usize)
    }

    /// One-step Q-learning: only the present state learns.
    pub(super) fn one_step(settings: &LearnerSettings) -> Self {
        Self::with_window(settings, 1)
    }

    fn with_window(settings: &LearnerSettings, window: usize) -> Self {
        let traces = Traces::new(window, settings.discount * settings.trace_decay);
        Self { step_size: settings.step_size, discount: settings.discount, traces }
    }
}

impl Backup for Ttd {
    fn learn(&mut self, table: &mut QTable, lesson: &Lesson) {
        let Lesson { state, action, .. } = *lesson;
        let td_error = lesson.target(self.discount, lesson.next_best(table)) - table.value(state, action);
        self.traces.visit(state, action);
        credit(table, &self.traces, self.step_size, td_error);
    }

    fn forget(&mut self, _table: &mut QTable) {
        self.traces.clear();
    }

    fn save(&self, to: &mut Saving) {
        self.traces.save(to);
    }

    fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit> {
        self.traces.load(from, table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::allowed::Allowed;
    use crate::settings::Settings;

    fn step(state: usize, reward: f64, next_state: usize) -> Lesson {
        Lesson { state, action: 0, reward, next_state, terminal: false, next_allowed: Allowed::ALL }
    }

    #[test]
    fn one_error_moves_three_states_by_hand_computed_amounts() {
        let mut table = QTable::new(4, 2, || -1.0);
        let mut ttd = Ttd::new(&Settings::default().learner);
        // Unpunished steps from -1 to -1: error = 0 + 0.99 * -1 - -1 = 0.01, so Q(0) = -1 + 0.2 * 0.01.
        ttd.learn(&mut table, &step(0, 0.0, 1));
        assert!((table.value(0, 0) - -0.998).abs() < 1e-12);
        ttd.learn(&mut table, &step(1, 0.0, 2));
        assert!((table.value(1, 0) - -0.998).abs() < 1e-12);
        assert!((table.value(0, 0) - (-0.998 + 0.2 * 0.01 * 0.891)).abs() < 1e-12);
        // A punished step: error = -1 + 0.99 * -1 - -1 = -0.99.
        ttd.learn(&mut table, &step(2, -1.0, 3));
        assert!((table.value(2, 0) - (-1.0 - 0.2 * 0.99)).abs() < 1e-12);
        assert!((table.value(1, 0) - (-0.998 - 0.2 * 0.99 * 0.891)).abs() < 1e-12);
        assert!((table.value(0, 0) - (-0.998 + 0.002 * 0.891 - 0.2 * 0.99 * 0.891 * 0.891)).abs() < 1e-12);
    }

    #[test]
    fn after_forgetting_only_the_present_state_learns() {
        let mut table = QTable::new(4, 1, || 0.0);
        let mut ttd = Ttd::new(&Settings::default().learner);
        ttd.learn(&mut table, &step(0, 0.0, 1));
        ttd.forget(&mut table);
        ttd.learn(&mut table, &step(1, -1.0, 2));
        assert_eq!((table.value(0, 0), table.value(1, 0)), (0.0, -0.2));
    }

    #[test]
    fn a_window_of_one_is_one_step_q_learning() {
        let mut settings = Settings::default().learner;
        let (mut one, mut narrow) = (QTable::new(5, 2, || -0.5), QTable::new(5, 2, || -0.5));
        let mut q = Ttd::one_step(&settings);
        settings.window = 1;
        let mut ttd = Ttd::new(&settings);
        for index in 0..200 {
            let lesson = Lesson {
                state: index * 7 % 5,
                action: index % 2,
                reward: -f64::from(u8::from(index % 3 == 0)),
                next_state: index * 11 % 5,
                terminal: false,
                next_allowed: Allowed::ALL,
            };
            let Lesson { state, action, reward, next_state, .. } = lesson;
            q.learn(&mut one, &lesson);
            let by_hand = {
                let error = reward + 0.99 * narrow.best_among(next_state, Allowed::ALL).1 - narrow.value(state, action);
                narrow.value(state, action) + 0.2 * error
            };
            ttd.learn(&mut narrow, &lesson);
            assert!((narrow.value(state, action) - by_hand).abs() < 1e-15);
        }
        assert_eq!(one, narrow);
    }

    #[test]
    fn a_terminal_step_expects_nothing() {
        let mut table = QTable::new(2, 1, || -0.5);
        let mut ttd = Ttd::new(&Settings::default().learner);
        ttd.learn(&mut table, &Lesson { terminal: true, ..step(0, -1.0, 1) });
        assert!((table.value(0, 0) - (-0.5 + 0.2 * (-1.0 + 0.5))).abs() < 1e-15);
    }

    #[test]
    fn the_best_of_what_is_allowed_next_makes_the_target() {
        let mut table = QTable::new(2, 2, || 0.0);
        table.add(1, 0, 5.0);
        table.add(1, 1, 1.0);
        let mut q = Ttd::one_step(&Settings::default().learner);
        q.learn(&mut table, &Lesson { next_allowed: Allowed::NONE.with(1), ..step(0, 2.0, 1) });
        // 0.2 * (2 + 0.99 * 1 - 0)
        assert!((table.value(0, 0) - 0.598).abs() < 1e-12);
    }
}
