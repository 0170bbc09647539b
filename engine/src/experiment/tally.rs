//! What is counted while the robot learns: reinforcement for each window of steps, and for each rule.

use super::Step;

/// Steps in a window: each point of the paper's Figure 3 is the reinforcement of the last 400 steps.
pub const WINDOW_STEPS: u64 = 400;

/// One window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Steps that it holds; fewer than 400 only in the last window of a run.
    pub steps: u64,
    /// Sum of the rewards.
    pub reinforcement: f64,
}

/// Counts over a whole run.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// All windows, first to last.
    pub windows: Vec<Window>,
    /// By rule: how often it fired.
    pub fired: Vec<u64>,
    /// Steps that asked for recovery without a reward.
    pub failures: u64,
    /// Steps that asked for recovery after a reward: goals reached.
    pub goals: u64,
    /// Steps in which the body touched something.
    pub contacts: u64,
    /// By window, then by rule: sum of what the rule added.
    by_rule: Vec<f64>,
}

impl Tally {
    /// Counts for so many rules over so many steps; nothing is allocated later.
    #[must_use]
    pub fn new(rules: usize, steps: u64) -> Self {
        let windows = steps.div_ceil(WINDOW_STEPS).min(1 << 20) as usize;
        let (windows, by_rule) = (Vec::with_capacity(windows), Vec::with_capacity(windows * rules));
        Self { windows, fired: vec![0; rules], failures: 0, goals: 0, contacts: 0, by_rule }
    }

    /// Counts one step; true if it ended a window.
    pub fn count(&mut self, step: &Step, fired: &[Option<f64>]) -> bool {
        if self.windows.last().is_none_or(|window| window.steps == WINDOW_STEPS) {
            self.windows.push(Window { steps: 0, reinforcement: 0.0 });
            self.by_rule.resize(self.windows.len() * self.fired.len(), 0.0);
        }
        self.failures += u64::from(step.failed());
        self.goals += u64::from(step.reached());
        self.contacts += u64::from(step.contact);
        let Some(window) = self.windows.last_mut() else { return false };
        window.steps += 1;
        window.reinforcement += step.reward;
        let sums = self.by_rule.len() - self.fired.len();
        for ((count, sum), value) in self.fired.iter_mut().zip(&mut self.by_rule[sums..]).zip(fired) {
            if let Some(value) = value {
                *count += 1;
                *sum += value;
            }
        }
        window.steps == WINDOW_STEPS
    }

    /// By rule: what it added in one window.
    #[must_use]
    pub fn by_rule(&self, window: usize) -> &[f64] {
        &self.by_rule[window * self.fired.len()..(window + 1) * self.fired.len()]
    }

    /// Reinforcement of each window, first to last.
    #[must_use]
    pub fn curve(&self) -> Vec<f64> {
        self.windows.iter().map(|window| window.reinforcement).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_holds_400_steps_and_sums_by_rule() {
        let mut tally = Tally::new(2, 401);
        let step = |reward, failed| Step {
            index: 0,
            state: 0,
            action: 0,
            reward,
            next_state: 0,
            recover: failed,
            contact: failed,
        };
        for index in 0..401 {
            let failed = index % 100 == 0;
            let fired = [failed.then_some(-1.0), None];
            let ended = tally.count(&step(if failed { -1.0 } else { 0.0 }, failed), &fired);
            assert_eq!(ended, index == 399);
        }
        assert_eq!(tally.curve(), [-4.0, -1.0]);
        assert_eq!((tally.fired.as_slice(), tally.failures, tally.contacts), (&[5, 0][..], 5, 5));
        assert_eq!(tally.by_rule(0), [-4.0, 0.0]);
    }
}
