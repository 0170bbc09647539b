//! Replay: the steps since the last recovery are learned again, backwards, so that a failure reaches all that led to it.
//!
//! The recorded steps are gone through from the last to the first, `passes` times, each towards its lambda-return
//! (Sutton and Barto, section 12.1, written recursively):
//! G(t) = r(t) + gamma ((1 - lambda) max Q(s(t+1)) + lambda G(t+1)), and after the last step G = max Q.
//! Each step itself was learned before by the way of learning that is set: replay comes on top (Lin 1992 replays so).

use super::QTable;
use super::backup::{Backup, Lesson};
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::LearnerSettings;

/// A segment ends with a recovery or after this many steps, and is learned again then.
const SEGMENT_STEPS: usize = 60;

/// Learns step by step, and segment by segment again.
pub(super) struct Replay {
    online: Box<dyn Backup>,
    passes: u64,
    step_size: f64,
    discount: f64,
    trace_decay: f64,
    /// Oldest first.
    segment: Vec<Lesson>,
}

impl Replay {
    pub(super) fn new(settings: &LearnerSettings, online: Box<dyn Backup>) -> Self {
        Self {
            online,
            passes: settings.replay,
            step_size: settings.step_size,
            discount: settings.discount,
            trace_decay: settings.trace_decay,
            segment: Vec::with_capacity(SEGMENT_STEPS),
        }
    }

    fn learn_again(&mut self, table: &mut QTable) {
        let Some(last) = self.segment.last() else { return };
        for _ in 0..self.passes {
            let mut lambda_return = last.next_best(table);
            for lesson in self.segment.iter().rev() {
                let utility = lesson.next_best(table);
                let mixed = (1.0 - self.trace_decay) * utility + self.trace_decay * lambda_return;
                lambda_return = lesson.target(self.discount, mixed);
                let error = lambda_return - table.value(lesson.state, lesson.action);
                table.add(lesson.state, lesson.action, self.step_size * error);
            }
        }
        self.segment.clear();
    }
}

impl Backup for Replay {
    fn learn(&mut self, table: &mut QTable, lesson: &Lesson) {
        self.online.learn(table, lesson);
        if self.segment.len() == SEGMENT_STEPS {
            self.learn_again(table);
        }
        self.segment.push(*lesson);
    }

    fn forget(&mut self, table: &mut QTable) {
        self.online.forget(table);
        self.learn_again(table);
    }

    fn save(&self, to: &mut Saving) {
        self.online.save(to);
        to.whole(self.segment.len() as u64);
        self.segment.iter().for_each(|lesson| lesson.save(to));
    }

    fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit> {
        self.online.load(from, table)?;
        let count = from.index(SEGMENT_STEPS + 1)?;
        self.segment.clear();
        for _ in 0..count {
            self.segment.push(Lesson::load(from, table)?);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::allowed::Allowed;
    use crate::settings::Settings;

    /// Learns nothing by itself, so that a test sees the replay alone.
    struct Idle;

    impl Backup for Idle {
        fn learn(&mut self, _table: &mut QTable, _lesson: &Lesson) {}
        fn forget(&mut self, _table: &mut QTable) {}
        fn save(&self, _to: &mut Saving) {}
        fn load(&mut self, _from: &mut Loading<'_>, _table: &QTable) -> Result<(), Unfit> {
            Ok(())
        }
    }

    fn replay(passes: u64) -> Replay {
        let mut settings = Settings::default().learner;
        settings.replay = passes;
        Replay::new(&settings, Box::new(Idle))
    }

    fn step(state: usize, reward: f64) -> Lesson {
        Lesson { state, action: 0, reward, next_state: state + 1, terminal: false, next_allowed: Allowed::ALL }
    }

    #[test]
    fn a_failure_reaches_every_step_that_led_to_it() {
        let mut table = QTable::new(4, 1, || 0.0);
        let mut replay = replay(1);
        for (state, reward) in [(0, 0.0), (1, 0.0), (2, -1.0)] {
            replay.learn(&mut table, &step(state, reward));
        }
        assert_eq!(table.values(), [0.0; 4]);
        replay.forget(&mut table);
        // G(2) = -1, so Q(2) = -0.2. G(1) = 0.99 (0.1 * -0.2 + 0.9 * -1) = -0.9108, so Q(1) = -0.18216.
        // G(0) = 0.99 (0.1 * -0.18216 + 0.9 * -0.9108) = -0.82955664, so Q(0) = -0.165911328.
        for (state, value) in [-0.165_911_328, -0.182_16, -0.2, 0.0].into_iter().enumerate() {
            assert!((table.value(state, 0) - value).abs() < 1e-12, "{state}");
        }
    }

    #[test]
    fn a_second_pass_learns_on_from_the_first() {
        let mut table = QTable::new(2, 1, || 0.0);
        let mut replay = replay(2);
        replay.learn(&mut table, &step(0, -1.0));
        replay.forget(&mut table);
        // -0.2, then -0.2 + 0.2 * (-1 + 0.2).
        assert!((table.value(0, 0) - -0.36).abs() < 1e-12);
    }

    #[test]
    fn nothing_is_replayed_twice() {
        let mut table = QTable::new(2, 1, || 0.0);
        let mut replay = replay(1);
        replay.learn(&mut table, &step(0, -1.0));
        replay.forget(&mut table);
        replay.forget(&mut table);
        assert!((table.value(0, 0) - -0.2).abs() < 1e-12);
    }

    #[test]
    fn a_long_segment_is_replayed_without_a_failure_and_takes_no_more_memory() {
        let mut table = QTable::new(2, 1, || 0.0);
        let mut replay = replay(1);
        let room = replay.segment.capacity();
        for _ in 0..=SEGMENT_STEPS {
            replay.learn(&mut table, &Lesson { next_state: 1, ..step(0, -1.0) });
        }
        assert!(table.value(0, 0) < -0.9);
        assert_eq!((replay.segment.len(), replay.segment.capacity()), (1, room));
    }

    #[test]
    fn a_terminal_step_expects_nothing() {
        let mut table = QTable::new(2, 1, || -0.5);
        let mut replay = replay(1);
        replay.learn(&mut table, &Lesson { terminal: true, ..step(0, -1.0) });
        replay.forget(&mut table);
        assert!((table.value(0, 0) - (-0.5 + 0.2 * (-1.0 + 0.5))).abs() < 1e-15);
    }
}
