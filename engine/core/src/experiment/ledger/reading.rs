//! Records read: one step's, all of them, and the first that is another one in another ledger.

use std::borrow::Cow;

use super::record::{FIXED_BYTES, first_field};
use super::{Attempt, Ledger, MOST_STEPS, Record};

impl Ledger {
    /// The first step, with its first field, in which two ledgers differ; nothing if they are the same bit for bit.
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<(usize, &'static str)> {
        let mut steps = 0..self.held().max(other.held());
        let found = steps.find_map(|step| Some((step, self.field_that_differs(step, other, step)?)));
        let later = || {
            let segment = self.tail.first_difference(&other.tail)?;
            Some(((segment + 1) * MOST_STEPS as usize, "something in this or one of the 1,048,575 steps after it"))
        };
        let found = found.or_else(later);
        found.or_else(|| (self.steps() != other.steps()).then_some((self.len(), "number of steps")))
    }

    /// The first field in which a step differs from a step of another ledger.
    pub(in crate::experiment) fn field_that_differs(
        &self,
        step: usize,
        other: &Self,
        other_step: usize,
    ) -> Option<&'static str> {
        match (self.record_bytes(step), other.record_bytes(other_step)) {
            (Some(own), Some(others)) if own == others => None,
            (Some(own), Some(others)) => {
                let at = own.iter().zip(others.iter()).position(|(a, b)| a != b).unwrap_or(own.len());
                Some(first_field(at, self.leg_of(step).0))
            }
            (None, None) => None,
            _ => Some("number of steps"),
        }
    }

    /// The bytes of one record.
    #[must_use]
    pub fn record_bytes(&self, step: usize) -> Option<Cow<'_, [u8]>> {
        if let Some(later) = step.checked_sub(self.held()) {
            return self.pages.as_ref()?.record(later, self.shape.bytes()).map(Cow::Owned);
        }
        let (shape, bytes, step) = self.leg_of(step);
        bytes.get(step * shape.bytes()..)?.get(..shape.bytes()).map(Cow::Borrowed)
    }

    /// One step's record.
    #[must_use]
    pub fn record(&self, step: usize) -> Option<Record> {
        Some(Record::from_bytes(self.record_bytes(step)?.first_chunk()?))
    }

    /// What was drawn for the attempt of a step; nothing in a run that does not vary.
    #[must_use]
    pub fn attempt(&self, step: usize) -> Option<Attempt> {
        self.leg_of(step).0.attempt(&self.record_bytes(step)?)
    }

    /// The number of the world in which a step was done.
    #[must_use]
    pub fn world(&self, step: usize) -> usize {
        self.attempt(step).map_or(0, |attempt| attempt.world)
    }

    /// Every record, first to last.
    pub fn records(&self) -> impl Iterator<Item = Record> + '_ {
        let records = self.legs().flat_map(|(shape, bytes)| bytes.chunks_exact(shape.bytes()));
        let held = records.filter_map(|bytes| bytes.first_chunk()).map(Record::from_bytes);
        held.chain((self.held()..self.len()).map_while(|step| self.record(step)))
    }

    /// The rules that fired in one step, by their number in the script of its leg, each with what it added.
    pub fn fired(&self, step: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let shape = self.leg_of(step).0;
        let record = self.record_bytes(step).unwrap_or_default();
        let rules = if record.is_empty() { &[] } else { shape.values() };
        let mut own = FIXED_BYTES + 8 * shape.words();
        rules.iter().enumerate().filter_map(move |(rule, fixed)| {
            let value = match fixed {
                Some(value) => *value,
                None => {
                    let bytes = record.get(own..own + 8)?.try_into().ok()?;
                    own += 8;
                    f64::from_le_bytes(bytes)
                }
            };
            let set = record.get(FIXED_BYTES + rule / 8).copied().unwrap_or(0);
            (set >> (rule % 8) & 1 == 1).then_some((rule, value))
        })
    }
}
