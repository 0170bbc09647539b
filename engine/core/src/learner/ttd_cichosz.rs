//! Truncated TD as its inventor describes it: `ttd-cichosz` (P. Cichosz, JAIR 2, 1995, 287-318).
//!
//! The last m experiences wait in a buffer. Each step computes the truncated lambda-return of the *oldest* one backwards
//! through the buffer and moves only that pair towards it. Equation (1) of the paper is not this algorithm, though it
//! bears its name; both are here.

use std::collections::VecDeque;

use super::QTable;
use super::backup::{Backup, Lesson};
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::LearnerSettings;

struct Experience {
    state: usize,
    action: usize,
    reward: f64,
    /// Utility of the successor state when it was seen; 0 where nothing follows.
    utility: f64,
}

pub(super) struct TtdCichosz {
    step_size: f64,
    discount: f64,
    trace_decay: f64,
    window: usize,
    /// Oldest first.
    buffer: VecDeque<Experience>,
}

impl TtdCichosz {
    pub(super) fn new(settings: &LearnerSettings) -> Self {
        let window = settings.window as usize;
        Self {
            step_size: settings.step_size,
            discount: settings.discount,
            trace_decay: settings.trace_decay,
            window,
            buffer: VecDeque::with_capacity(window + 1),
        }
    }

    /// Moves the oldest pair towards its truncated return and drops it.
    fn learn_oldest(&mut self, table: &mut QTable) {
        let Some(newest) = self.buffer.back() else { return };
        let mut value = newest.utility;
        for experience in self.buffer.iter().rev() {
            let mixed = self.trace_decay * value + (1.0 - self.trace_decay) * experience.utility;
            value = experience.reward + self.discount * mixed;
        }
        if let Some(oldest) = self.buffer.pop_front() {
            let error = value - table.value(oldest.state, oldest.action);
            table.add(oldest.state, oldest.action, self.step_size * error);
        }
    }
}

impl Backup for TtdCichosz {
    fn learn(&mut self, table: &mut QTable, lesson: &Lesson) {
        let Lesson { state, action, reward, terminal, .. } = *lesson;
        let utility = if terminal { 0.0 } else { lesson.next_best(table) };
        self.buffer.push_back(Experience { state, action, reward, utility });
        if self.buffer.len() == self.window {
            self.learn_oldest(table);
        }
    }

    fn forget(&mut self, table: &mut QTable) {
        while !self.buffer.is_empty() {
            self.learn_oldest(table);
        }
    }

    fn save(&self, to: &mut Saving) {
        to.whole(self.buffer.len() as u64);
        for experience in &self.buffer {
            to.whole(experience.state as u64);
            to.whole(experience.action as u64);
            to.number(experience.reward);
            to.number(experience.utility);
        }
    }

    fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit> {
        let count = from.index(self.window + 1)?;
        self.buffer.clear();
        for _ in 0..count {
            let (state, action) = (from.index(table.states())?, from.index(table.actions())?);
            self.buffer.push_back(Experience { state, action, reward: from.number()?, utility: from.number()? });
        }
        Ok(())
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
    fn only_the_oldest_pair_moves_and_by_the_truncated_return() {
        let mut table = QTable::new(4, 1, || -1.0);
        let mut ttd = TtdCichosz::new(&Settings::default().learner);
        ttd.learn(&mut table, &step(0, 0.0, 1));
        ttd.learn(&mut table, &step(1, 0.0, 2));
        assert_eq!(table.values(), [-1.0; 4]);
        ttd.learn(&mut table, &step(2, -1.0, 3));
        // z = -1; -1 + 0.99 * -1 = -1.99; 0.99 * (0.9 * -1.99 + 0.1 * -1) = -1.87209; again: -1.767_032_19
        let value = 0.99 * (0.9 * (0.99 * (0.9 * -1.99 - 0.1)) - 0.1);
        assert!((value - -1.767_032_19_f64).abs() < 1e-9);
        assert!((table.value(0, 0) - (-1.0 + 0.2 * (value + 1.0))).abs() < 1e-12);
        assert_eq!(table.value(1, 0), -1.0);
    }

    #[test]
    fn a_buffer_of_one_is_one_step_q_learning() {
        let mut settings = Settings::default().learner;
        settings.window = 1;
        let mut table = QTable::new(2, 1, || -0.5);
        TtdCichosz::new(&settings).learn(&mut table, &step(0, -1.0, 1));
        assert!((table.value(0, 0) - (-0.5 + 0.2 * (-1.0 - 0.495 + 0.5))).abs() < 1e-15);
    }

    #[test]
    fn forgetting_learns_what_is_left_in_the_buffer() {
        let mut table = QTable::new(3, 1, || 0.0);
        let mut ttd = TtdCichosz::new(&Settings::default().learner);
        ttd.learn(&mut table, &step(0, -1.0, 1));
        ttd.learn(&mut table, &step(1, -1.0, 2));
        ttd.forget(&mut table);
        assert!((table.value(1, 0) - -0.2).abs() < 1e-12);
        assert!((table.value(0, 0) - 0.2 * (-1.0 - 0.99 * 0.9)).abs() < 1e-12);
    }
}
