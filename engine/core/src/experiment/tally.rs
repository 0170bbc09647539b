//! What is counted while the robot learns: reinforcement for each window of steps, and for each rule.

use super::Step;
use crate::outcome::Endings;
use crate::saved::{Passed, Passing, Unfit};
use crate::verdict::{WINDOW_STEPS, Window, WindowCounts};

/// Counts over a whole run.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// All windows, first to last.
    pub windows: Vec<Window>,
    /// By rule: how often it fired.
    pub fired: Vec<u64>,
    /// By window, then by rule: sum of what the rule added, and how often it fired.
    by_rule: Vec<f64>,
    fired_by_rule: Vec<u32>,
}

impl Tally {
    /// Counts for so many rules over so many steps; nothing is allocated later.
    #[must_use]
    pub fn new(rules: usize, steps: u64) -> Self {
        let windows = steps.div_ceil(WINDOW_STEPS).min(1 << 20) as usize;
        let (by_rule, fired_by_rule) = (Vec::with_capacity(windows * rules), Vec::with_capacity(windows * rules));
        Self { windows: Vec::with_capacity(windows), fired: vec![0; rules], by_rule, fired_by_rule }
    }

    /// Counts one step; true if it ended a window.
    pub(super) fn count(&mut self, step: &Step, fired: &[Option<f64>]) -> bool {
        if self.windows.last().is_none_or(|window| window.steps == WINDOW_STEPS) {
            self.windows.push(Window::default());
            self.by_rule.resize(self.windows.len() * self.fired.len(), 0.0);
            self.fired_by_rule.resize(self.windows.len() * self.fired.len(), 0);
        }
        let Some(window) = self.windows.last_mut() else { return false };
        window.steps += 1;
        window.reinforcement += step.reward;
        window.endings.count(step.ending());
        window.endings.hops += u64::from(step.hop);
        window.contacts += u64::from(step.contact);
        window.stages += u64::from(step.entered.is_some());
        window.guarded += u64::from(step.guarded);
        window.rounds += u64::from(step.entered == Some(0));
        let from = self.by_rule.len() - self.fired.len();
        for (rule, value) in fired.iter().enumerate() {
            if let Some(value) = value {
                self.fired[rule] += 1;
                self.by_rule[from + rule] += value;
                self.fired_by_rule[from + rule] += 1;
            }
        }
        window.steps == WINDOW_STEPS
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.list(&mut self.windows, |by, window| {
            let Window { steps, reinforcement, endings, contacts, stages, rounds, guarded } = window;
            let Endings { failures, goals, restarts, hops } = endings;
            by.number(reinforcement)?;
            let counts = [steps, failures, goals, restarts, hops, contacts, stages, rounds, guarded];
            counts.into_iter().try_for_each(|count| by.whole(count))
        })?;
        by.all(&mut self.fired, Passing::whole)?;
        by.list(&mut self.by_rule, Passing::number)?;
        by.list(&mut self.fired_by_rule, Passing::small)?;
        let entries = self.windows.len() * self.fired.len();
        if (self.by_rule.len(), self.fired_by_rule.len()) == (entries, entries) { Ok(()) } else { Err(Unfit) }
    }

    /// Goes on for `steps` more with the rules `now`, in whose order all counts then stand; rules of the same name are one.
    pub(super) fn swap_rules(&mut self, before: &[String], now: &[String], steps: u64) {
        let place = |name: &String| now.iter().position(|other| other == name);
        let places: Vec<Option<usize>> = before.iter().map(place).collect();
        let mut next = Self::new(now.len(), steps + self.windows.iter().map(|window| window.steps).sum::<u64>());
        for (count, place) in self.fired.iter().zip(&places) {
            place.iter().for_each(|place| next.fired[*place] += count);
        }
        let (sums, fired) = (self.by_rule.chunks(before.len().max(1)), self.fired_by_rule.chunks(before.len().max(1)));
        for (sums, fired) in sums.zip(fired) {
            let from = next.by_rule.len();
            next.by_rule.resize(from + now.len(), 0.0);
            next.fired_by_rule.resize(from + now.len(), 0);
            for ((sum, fired), place) in sums.iter().zip(fired).zip(&places) {
                place.iter().for_each(|place| next.by_rule[from + place] += sum);
                place.iter().for_each(|place| next.fired_by_rule[from + place] += fired);
            }
        }
        next.windows.extend_from_slice(&self.windows);
        *self = next;
    }

    /// By rule: what it added in one window.
    #[must_use]
    pub fn by_rule(&self, window: usize) -> &[f64] {
        &self.by_rule[window * self.fired.len()..(window + 1) * self.fired.len()]
    }

    /// By rule: how often it fired in one window.
    #[must_use]
    pub(crate) fn fired_in(&self, window: usize) -> &[u32] {
        &self.fired_by_rule[window * self.fired.len()..(window + 1) * self.fired.len()]
    }

    /// Every window, with how often each rule fired in it.
    #[must_use]
    pub fn counts(&self) -> Vec<WindowCounts<'_>> {
        let windows = self.windows.iter().enumerate();
        windows.map(|(index, window)| WindowCounts { window: *window, fired: self.fired_in(index) }).collect()
    }

    /// How attempts ended, over the whole run.
    #[must_use]
    pub fn endings(&self) -> Endings {
        self.windows.iter().map(|window| window.endings).sum()
    }

    /// Steps in which the body touched something.
    #[must_use]
    pub fn contacts(&self) -> u64 {
        self.windows.iter().map(|window| window.contacts).sum()
    }

    /// Steps in whose choice a guard took an action away.
    #[must_use]
    pub fn guarded(&self) -> u64 {
        self.windows.iter().map(|window| window.guarded).sum()
    }

    /// Changes of the stage, and of these, changes to the first.
    #[must_use]
    pub fn stages(&self) -> (u64, u64) {
        self.windows.iter().fold((0, 0), |(stages, rounds), window| (stages + window.stages, rounds + window.rounds))
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
    use crate::outcome::Then;

    #[test]
    fn a_window_holds_400_steps_and_sums_by_rule() {
        let mut tally = Tally::new(2, 401);
        let step = |reward, failed: bool| Step {
            reward,
            then: failed.then_some(Then::Recover),
            contact: failed,
            ..Step::default()
        };
        for index in 0..401 {
            let failed = index % 100 == 0;
            let fired = [failed.then_some(-1.0), None];
            let ended = tally.count(&step(if failed { -1.0 } else { 0.0 }, failed), &fired);
            assert_eq!(ended, index == 399);
        }
        assert_eq!(tally.curve(), [-4.0, -1.0]);
        assert_eq!((tally.fired.as_slice(), tally.endings().failures, tally.contacts()), (&[5, 0][..], 5, 5));
        assert_eq!(
            (tally.by_rule(0), tally.fired_in(0), tally.fired_in(1)),
            (&[-4.0, 0.0][..], &[4, 0][..], &[1, 0][..])
        );
    }

    #[test]
    fn swapped_rules_keep_the_counts_of_their_names_and_of_those_that_are_gone() {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut tally = Tally::new(2, 2);
        let step = Step { reward: -1.5, then: Some(Then::Recover), ..Step::default() };
        tally.count(&step, &[Some(-1.0), Some(-0.5)]);
        tally.swap_rules(&names(&["wall", "lost"]), &names(&["lost", "slow", "wall"]), 400);
        tally.count(&step, &[Some(-2.0), None]);
        assert_eq!(tally.fired, [2, 0, 1]);
        assert_eq!(tally.by_rule(0), [-2.5, 0.0, -1.0]);
        assert_eq!((tally.endings().failures, tally.curve()), (2, vec![-3.0]));
        assert_eq!(tally.fired_in(0), [2, 0, 1]);
    }
}
