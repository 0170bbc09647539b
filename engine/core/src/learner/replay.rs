//! Replay: the steps since the last recovery are learned again, backwards, so that a failure reaches all that led to it.
//!
//! The recorded steps are gone through from the last to the first, `passes` times, each towards its lambda-return
//! (Sutton and Barto, section 12.1, written recursively):
//! G(t) = r(t) + gamma ((1 - lambda) max Q(s(t+1)) + lambda G(t+1)), and after the last step G = max Q.
//! Each step itself was learned before by the way of learning that is set: replay comes on top (Lin 1992 replays so).

use super::QTable;
use super::backup::{Backup, Transition};
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
    segment: Vec<Transition>,
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
            let mut lambda_return = table.best(last.next_state).1;
            for transition in self.segment.iter().rev() {
                let utility = table.best(transition.next_state).1;
                let mixed = (1.0 - self.trace_decay) * utility + self.trace_decay * lambda_return;
                lambda_return = transition.target(self.discount, mixed);
                let error = lambda_return - table.value(transition.state, transition.action);
                table.add(transition.state, transition.action, self.step_size * error);
            }
        }
        self.segment.clear();
    }
}

impl Backup for Replay {
    fn learn(&mut self, table: &mut QTable, transition: &Transition) {
        self.online.learn(table, transition);
        if self.segment.len() == SEGMENT_STEPS {
            self.learn_again(table);
        }
        self.segment.push(*transition);
    }

    fn forget(&mut self, table: &mut QTable) {
        self.online.forget(table);
        self.learn_again(table);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    /// Learns nothing by itself, so that a test sees the replay alone.
    struct Idle;

    impl Backup for Idle {
        fn learn(&mut self, _table: &mut QTable, _transition: &Transition) {}
        fn forget(&mut self, _table: &mut QTable) {}
    }

    fn replay(passes: u64) -> Replay {
        let mut settings = Settings::default().learner;
        settings.replay = passes;
        Replay::new(&settings, Box::new(Idle))
    }

    fn step(state: usize, reward: f64) -> Transition {
        Transition { state, action: 0, reward, next_state: state + 1, terminal: false }
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
            replay.learn(&mut table, &Transition { next_state: 1, ..step(0, -1.0) });
        }
        assert!(table.value(0, 0) < -0.9);
        assert_eq!((replay.segment.len(), replay.segment.capacity()), (1, room));
    }

    #[test]
    fn a_terminal_step_expects_nothing() {
        let mut table = QTable::new(2, 1, || -0.5);
        let mut replay = replay(1);
        replay.learn(&mut table, &Transition { terminal: true, ..step(0, -1.0) });
        replay.forget(&mut table);
        assert!((table.value(0, 0) - (-0.5 + 0.2 * (-1.0 + 0.5))).abs() < 1e-15);
    }
}
