//! The steps of one phase at a glance: which rule fired when, how often, and what it added.

use crate::experiment::{Ledger, Tally};
use crate::page::Document;

/// One firing of a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
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
    /// Firings in their order; `fn reward` speaks at nearly every step and leaves none.
    pub marks: Vec<Mark>,
}

impl Story {
    /// The steps of a ledger; the tally counts those too that a ledger has no room for.
    pub(super) fn new(document: &Document, ledger: &Ledger, tally: Option<&Tally>) -> Self {
        let rules = document.rules.len();
        let mut story = Self {
            steps: ledger.steps(),
            kept: ledger.len(),
            fired: vec![0; rules],
            totals: vec![0.0; rules],
            marks: Vec::new(),
        };
        for (step, record) in ledger.records().enumerate() {
            for (rule, value) in ledger.fired(step).filter(|(rule, _)| *rule < rules) {
                story.fired[rule] += 1;
                story.totals[rule] += value;
                if document.rules[rule].value.is_some() {
                    story.marks.push(Mark { step, rule, place_m: (record.pose.x_m, record.pose.y_m) });
                }
            }
        }
        if let Some(tally) = tally.filter(|tally| tally.fired.len() == rules) {
            story.fired.clone_from(&tally.fired);
            for (rule, total) in story.totals.iter_mut().enumerate() {
                *total = (0..tally.windows.len()).map(|window| tally.by_rule(window)[rule]).sum();
            }
        }
        story
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
        let mark = |step, rule| Mark { step, rule, place_m: (0.0, 0.0) };
        let story = Story { kept: 100, marks: vec![mark(3, 0), mark(3, 1), mark(60, 0)], ..Story::default() };
        assert_eq!([story.mark_beside(3, true), story.mark_beside(60, false)], [Some(60), Some(3)]);
        assert_eq!([story.mark_beside(60, true), story.mark_beside(3, false)], [None, None]);
        assert_eq!(story.parts(0, 2), [1, 1]);
    }
}
