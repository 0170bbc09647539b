//! Every step of one seed: the ledgers of learning and of the test, and the digest that names them.

use sha2::{Digest, Sha256};

use super::{Ledger, Plan, RecordShape};
use crate::digest::hex;

/// Bytes of a digest.
pub const DIGEST_BYTES: usize = 32;
/// Records of a chunk: a file that ends early is noticed at the end of the last whole one.
pub const CHUNK_STEPS: usize = 1024;

/// What was done while learning, then in the test.
#[derive(Debug, Clone, PartialEq)]
pub struct RunLog {
    /// Steps of learning.
    pub learning: Ledger,
    /// Steps of the frozen policy's test.
    pub test: Ledger,
}

impl RunLog {
    /// An empty log for the steps of a plan: of those of learning that it has no room for, a plan without earlier legs passes the
    /// records on.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        let ledger = if plan.earlier.is_empty() { Ledger::without_end } else { Ledger::new };
        let learning = ledger(plan.first_leg(), if plan.learns() { plan.first_steps() } else { 0 });
        Self { learning, test: Ledger::new(plan, plan.settings.run.test_steps) }
    }

    /// An empty log for the same steps as another, whose digest holds those that it holds there.
    #[must_use]
    pub fn like(&self, plan: &Plan) -> Self {
        let new = Self::new(plan);
        if self.learning.has_no_end() || !new.learning.has_no_end() {
            return new;
        }
        Self { learning: Ledger::new(plan, plan.first_steps()), ..new }
    }

    /// A log that keeps nothing.
    #[must_use]
    pub fn off() -> Self {
        Self { learning: Ledger::off(), test: Ledger::off() }
    }

    /// Whether any step was kept.
    #[must_use]
    pub(crate) fn is_kept(&self) -> bool {
        self.learning.len() + self.test.len() > 0
    }

    /// SHA-256 over the records of both phases, chunk by chunk, those that were passed on too: 64 hexadecimal digits.
    #[must_use]
    pub fn sha256(&self) -> String {
        let end = self.learning.segments().last().map(|segment| segment.digest);
        let last = || self.chunks().last().map(|(_, digest)| digest);
        let last = if self.test.is_empty() { end.or_else(last) } else { last() };
        hex(&last.unwrap_or([0; DIGEST_BYTES]))
    }

    /// The chunks of both phases, each with its digest, which holds the one before it: before the first of the test comes the last
    /// one that was passed on.
    pub fn chunks(&self) -> impl Iterator<Item = (&[u8], [u8; DIGEST_BYTES])> {
        let end = self.learning.segments().last().map(|segment| segment.digest);
        let of = |(shape, bytes): (&RecordShape, _)| <[u8]>::chunks(bytes, CHUNK_STEPS * shape.bytes()).map(Some);
        let all = self.learning.legs().flat_map(of).chain([None]).chain(self.test.legs().flat_map(of));
        all.scan([0; DIGEST_BYTES], move |before, records| {
            *before = records.map_or(end.unwrap_or(*before), |records| chained(before, records));
            Some(records.map(|records| (records, *before)))
        })
        .flatten()
    }
}

/// The digest of a chunk's records after the digest of the chunk before.
#[must_use]
pub fn chained(before: &[u8; DIGEST_BYTES], records: &[u8]) -> [u8; DIGEST_BYTES] {
    Sha256::new().chain_update(before).chain_update(records).finalize().into()
}
