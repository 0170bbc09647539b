//! The steps of one phase at a glance: which rule fired when, how often, and what it added.

use crate::WatchedSeed;
use engine::experiment::{Ledger, Phase, Plan};
use insight::page::Document;

/// One firing of a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StoryMark {
    pub step: usize,
    pub rule: usize,
    /// Where the robot was then, metres.
    pub place_m: (f64, f64),
}

/// The phase.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Story {
    /// Steps that were done; more than are kept, if the run was very long.
    pub steps: u64,
    /// Steps that are kept.
    pub kept: usize,
    /// By rule: how often it fired.
    pub fired: Vec<u64>,
    /// By rule: the sum of what it added.
    pub totals: Vec<f64>,
    /// Firings in their order; of a rule whose value varies only if it does not fire in half of the steps or more.
    pub marks: Vec<StoryMark>,
    /// Firings of the rules whose value varies, `fn reward` among them: step, rule, what it added.
    varied: Vec<(usize, usize, f64)>,
    /// By step: the stage in which it was chosen; empty of a script without stages.
    stages: Vec<u8>,
    /// By leg of learning: its first step, and where each of its rules stands among the plan's own.
    legs: Vec<(usize, Vec<Option<usize>>)>,
}

impl Story {
    /// A phase of a seed; the tally of learning counts those steps too that a ledger has no room for.
    pub(super) fn new(plan: &Plan, document: &Document, seed: &WatchedSeed, phase: Phase) -> Self {
        let (rules, learning) = (document.rules.len(), phase == Phase::Learning);
        let ledger = if learning { &*seed.learning } else { &seed.tested };
        let mut story = Self {
            steps: ledger.steps(),
            kept: ledger.len(),
            fired: vec![0; rules],
            totals: vec![0.0; rules],
            marks: Vec::new(),
            varied: Vec::new(),
            stages: Vec::new(),
            legs: legs(plan, learning),
        };
        for (step, record) in ledger.records().enumerate() {
            let fired: Vec<_> = story.fired_at(ledger, step).collect();
            for (rule, value) in fired {
                story.fired[rule] += 1;
                story.totals[rule] += value;
                story.marks.push(StoryMark { step, rule, place_m: (record.pose.x_m, record.pose.y_m) });
                if document.rules[rule].value.is_none() {
                    story.varied.push((step, rule, value));
                }
            }
            story.stages.extend(document.stages.as_ref().map(|stages| stages.of_state(record.state) as u8));
        }
        let covers = |rule: usize| document.rules[rule].value.is_none() && 2 * story.fired[rule] >= story.kept as u64;
        let covering: Vec<bool> = (0..rules).map(covers).collect();
        story.marks.retain(|mark| !covering[mark.rule]);
        let tally = seed.learned.as_ref().map(|learned| &learned.tally).filter(|tally| tally.fired.len() >= rules);
        if let Some(tally) = tally.filter(|_| learning) {
            // Rules that only earlier legs had come after the plan's own.
            story.fired.copy_from_slice(&tally.fired[..rules]);
            for (rule, total) in story.totals.iter_mut().enumerate() {
                *total = (0..tally.windows.len()).map(|window| tally.by_rule(window)[rule]).sum();
            }
        }
        story
    }

    /// The rules that fired in a step, by their number among the plan's own, each with what it added.
    pub(super) fn fired_at<'a>(&'a self, ledger: &'a Ledger, step: usize) -> impl Iterator<Item = (usize, f64)> + 'a {
        let leg = self.legs.iter().rev().find(|(from, _)| *from <= step);
        let own = move |rule: usize| *leg?.1.get(rule)?;
        let own = move |(rule, value)| own(rule).filter(|rule| *rule < self.fired.len()).map(|rule| (rule, value));
        ledger.fired(step).filter_map(own)
    }

    /// The nearest step after or before this one at which a rule fired.
    pub(super) fn mark_beside(&self, step: usize, forward: bool) -> Option<usize> {
        let mut steps = self.marks.iter().map(|mark| mark.step);
        if forward { steps.find(|at| *at > step) } else { steps.rfind(|at| *at < step) }
    }

    /// How often a rule fired in each of so many equal parts of the phase.
    pub(super) fn parts(&self, rule: usize, parts: usize) -> Vec<u32> {
        let mut counts = vec![0; parts];
        for mark in self.marks.iter().filter(|mark| mark.rule == rule) {
            if let Some(count) = counts.get_mut(part(mark.step, self.kept, parts)) {
                *count += 1;
            }
        }
        counts
    }
}

impl Story {
    /// What a rule whose value varies added in each of so many equal parts of the phase.
    pub(super) fn sums(&self, rule: usize, parts: usize) -> Vec<f64> {
        let mut sums = vec![0.0; parts];
        for (step, _, value) in self.varied.iter().filter(|(_, of, _)| *of == rule) {
            if let Some(sum) = sums.get_mut(part(*step, self.kept, parts)) {
                *sum += value;
            }
        }
        sums
    }

    /// In how many steps of each of so many equal parts of the phase the robot was in a stage.
    pub(super) fn steps_in(&self, stage: usize, parts: usize) -> Vec<u32> {
        let mut counts = vec![0; parts];
        for (step, _) in self.stages.iter().enumerate().filter(|(_, now)| usize::from(**now) == stage) {
            if let Some(count) = counts.get_mut(part(step, self.kept, parts)) {
                *count += 1;
            }
        }
        counts
    }
}

/// A reward that was swapped while learning has rules of its own; those of the same name are one.
fn legs(plan: &Plan, learning: bool) -> Vec<(usize, Vec<Option<usize>>)> {
    let own = plan.behaviour.rules();
    let place = |name: &str| own.iter().position(|rule| rule.name == name);
    let places = |leg: &Plan| leg.behaviour.rules().iter().map(|rule| place(&rule.name)).collect();
    if !learning {
        return vec![(0, places(plan))];
    }
    let swaps = plan.swaps().map(|(from, _, leg, _)| (from as usize, places(leg)));
    std::iter::once((0, places(plan.first_leg()))).chain(swaps).collect()
}

/// Which of so many equal parts a step falls into.
pub(super) fn part(step: usize, steps: usize, parts: usize) -> usize {
    (step * parts / steps.max(1)).min(parts.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_fall_into_equal_parts() {
        assert_eq!([0, 199, 200, 799].map(|step| part(step, 800, 4)), [0, 0, 1, 3]);
        assert_eq!(part(5, 0, 4), 3);
    }

    #[test]
    fn marks_are_found_on_both_sides() {
        let mark = |step, rule| StoryMark { step, rule, place_m: (0.0, 0.0) };
        let story = Story { kept: 100, marks: vec![mark(3, 0), mark(3, 1), mark(60, 0)], ..Story::default() };
        assert_eq!([story.mark_beside(3, true), story.mark_beside(60, false)], [Some(60), Some(3)]);
        assert_eq!([story.mark_beside(60, true), story.mark_beside(3, false)], [None, None]);
        assert_eq!(story.parts(0, 2), [1, 1]);
    }

    #[test]
    fn stages_and_values_that_vary_are_counted_by_parts() {
        let varied = vec![(0, 1, 0.5), (1, 1, -0.25), (3, 1, 2.0), (3, 0, 9.0)];
        let story = Story { kept: 4, varied, stages: vec![0, 1, 1, 0], ..Story::default() };
        assert_eq!(story.sums(1, 2), [0.25, 2.0]);
        assert_eq!([story.steps_in(0, 2), story.steps_in(1, 2)], [[1, 1], [1, 1]]);
        assert_eq!(story.steps_in(1, 4), [0, 1, 1, 0]);
    }
}
