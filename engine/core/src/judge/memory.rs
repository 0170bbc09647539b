//! What a script remembers from step to step: measures, windows over numbers, and when each rule fired. All of it is forgotten
//! when the robot is brought back.

use super::expression::{Number, StepFacts, Typed};
use super::rule::Persistence;
use crate::saved::{Passed, Passing, Unfit};

/// `since("rule")` of a rule that has not fired yet, seconds.
pub(crate) const NEVER_S: f64 = 1e6;

/// What is worked out in every step, in the order in which it stands here: each may read what stands above it.
#[derive(Debug)]
pub(crate) enum Remembered {
    /// `measure name = x;`
    Measure(Measure),
    /// `change(x)` or `change(x, seconds)`: the newest value less the one so long ago.
    Change(Number, Persistence),
    /// `average(x, seconds)`.
    Average(Number, Persistence),
}

/// A named expression of a script.
#[derive(Debug, Clone)]
pub(crate) struct Measure {
    pub name: String,
    pub typed: Typed,
}

/// One run's memory.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    /// What was worked out in this step.
    values: Vec<f64>,
    rings: Vec<Ring>,
    /// For each rule, how often it has fired, and how many steps ago it fired last.
    rules: Vec<(u32, Option<u32>)>,
    period_s: f64,
}

/// The last values of one number.
#[derive(Debug, Default)]
struct Ring {
    samples: Vec<f64>,
    /// Where the next one goes.
    next: usize,
    taken: usize,
}

impl Memory {
    /// Room for what a script remembers.
    pub(crate) fn new(remembered: &[Remembered], rules: usize, period_s: f64) -> Self {
        let ring = |one: &Remembered| match one {
            Remembered::Measure(_) => Ring::default(),
            Remembered::Change(_, span) => Ring::of(span.steps(period_s) as usize + 1),
            Remembered::Average(_, span) => Ring::of(span.steps(period_s) as usize),
        };
        Self {
            values: vec![0.0; remembered.len()],
            rings: remembered.iter().map(ring).collect(),
            rules: vec![(0, None); rules],
            period_s,
        }
    }

    pub(crate) fn value(&self, index: usize) -> f64 {
        self.values.get(index).copied().unwrap_or(f64::NAN)
    }

    /// How often a rule has fired since the attempt began.
    pub(super) fn fired(&self, rule: usize) -> f64 {
        self.rules.get(rule).map_or(0.0, |(fired, _)| f64::from(*fired))
    }

    /// How long ago a rule fired last, seconds.
    pub(super) fn since_s(&self, rule: usize) -> f64 {
        let steps = self.rules.get(rule).and_then(|(_, since)| *since);
        steps.map_or(NEVER_S, |steps| f64::from(steps) * self.period_s)
    }

    /// One more step has been done.
    pub(super) fn age(&mut self) {
        for (_, since) in &mut self.rules {
            *since = since.map(|steps| steps.saturating_add(1));
        }
    }

    pub(super) fn note_fired(&mut self, rule: usize) {
        if let Some(rule) = self.rules.get_mut(rule) {
            *rule = (rule.0.saturating_add(1), Some(0));
        }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.all(&mut self.values, Passing::number)?;
        by.all(&mut self.rings, |by, ring| ring.pass(by))?;
        by.all(&mut self.rules, |by, (fired, since)| {
            by.small(fired)?;
            by.option(since, Passing::small)
        })
    }

    pub(super) fn forget(&mut self) {
        self.rules.fill((0, None));
        for ring in &mut self.rings {
            (ring.next, ring.taken) = (0, 0);
        }
    }

    /// Takes the value of one thing that is remembered, as the facts and what stands above it give it.
    pub(super) fn take(&mut self, index: usize, sample: f64, remembered: &Remembered) {
        let ring = &mut self.rings[index];
        self.values[index] = match remembered {
            Remembered::Measure(_) => sample,
            Remembered::Change(..) => sample - ring.push(sample).oldest(),
            Remembered::Average(..) => ring.push(sample).mean(),
        };
    }
}

impl Remembered {
    /// What its expression is now.
    pub(super) fn sample(&self, inputs: StepFacts<'_>) -> f64 {
        match self {
            Self::Measure(Measure { typed: Typed::Number(of) | Typed::Whole(of), .. })
            | Self::Change(of, _)
            | Self::Average(of, _) => of.value(inputs),
            Self::Measure(Measure { typed: Typed::Flag(flag), .. }) => f64::from(u8::from(flag.holds(inputs))),
        }
    }
}

impl Ring {
    fn of(samples: usize) -> Self {
        Self { samples: vec![0.0; samples.max(1)], next: 0, taken: 0 }
    }

    fn push(&mut self, sample: f64) -> &Self {
        self.samples[self.next] = sample;
        self.next = (self.next + 1) % self.samples.len();
        self.taken = (self.taken + 1).min(self.samples.len());
        self
    }

    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.all(&mut self.samples, Passing::number)?;
        by.size(&mut self.next)?;
        by.size(&mut self.taken)?;
        let room = self.samples.len();
        if self.taken > room || self.next > 0 && self.next >= room { Err(Unfit) } else { Ok(()) }
    }

    /// The oldest sample that is kept.
    fn oldest(&self) -> f64 {
        if self.taken < self.samples.len() { self.samples[0] } else { self.samples[self.next] }
    }

    /// Summed anew each time, oldest first, so that it does not drift.
    fn mean(&self) -> f64 {
        let start = if self.taken < self.samples.len() { 0 } else { self.next };
        let (newer, older) = self.samples[..self.taken].split_at(start.min(self.taken));
        older.iter().chain(newer).sum::<f64>() / self.taken as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(samples: usize, values: &[f64]) -> Ring {
        let mut ring = Ring::of(samples);
        for value in values {
            ring.push(*value);
        }
        ring
    }

    #[test]
    fn a_window_that_is_not_full_begins_with_its_first_sample() {
        let ring = ring(4, &[1.0, 2.0, 6.0]);
        assert_eq!((ring.oldest(), ring.mean()), (1.0, 3.0));
    }

    #[test]
    fn a_full_window_forgets_what_is_older() {
        let ring = ring(3, &[1.0, 2.0, 6.0, 10.0]);
        assert_eq!((ring.oldest(), ring.mean()), (2.0, 6.0));
    }

    #[test]
    fn since_counts_from_the_step_in_which_a_rule_fired() {
        let mut memory = Memory::new(&[], 2, 0.5);
        assert_eq!((memory.fired(0), memory.since_s(0)), (0.0, NEVER_S));
        memory.note_fired(0);
        memory.age();
        memory.age();
        assert_eq!((memory.fired(0), memory.since_s(0), memory.since_s(1)), (1.0, 1.0, NEVER_S));
        memory.forget();
        assert_eq!((memory.fired(0), memory.since_s(0)), (0.0, NEVER_S));
    }
}
