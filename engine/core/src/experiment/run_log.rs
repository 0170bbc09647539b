//! Every step of one seed: the ledgers of learning and of the test, and the digest that names them.

use sha2::{Digest, Sha256};

use super::{Ledger, Plan};
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
    /// An empty log with room for the steps of a plan.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        Self::with_room(plan, u64::MAX)
    }

    /// An empty log with room for at most so many steps of each phase.
    #[must_use]
    fn with_room(plan: &Plan, most: u64) -> Self {
        let learning = Ledger::new(plan.first_leg(), if plan.learns() { plan.first_steps().min(most) } else { 0 });
        Self { learning, test: Ledger::new(plan, plan.settings.run.test_steps.min(most)) }
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

    /// SHA-256 over the records of both phases, chunk by chunk, 64 hexadecimal digits.
    #[must_use]
    pub fn sha256(&self) -> String {
        hex(&self.chunks().last().map_or([0; DIGEST_BYTES], |(_, digest)| digest))
    }

    /// The chunks of both phases, each with its digest, which holds the one before it.
    pub fn chunks(&self) -> impl Iterator<Item = (&[u8], [u8; DIGEST_BYTES])> {
        let phases = [&self.learning, &self.test].into_iter();
        let legs = phases.flat_map(Ledger::legs);
        let chunks = legs.flat_map(|(shape, bytes)| bytes.chunks(CHUNK_STEPS * shape.bytes()));
        chunks.scan([0; DIGEST_BYTES], |before, records| {
            *before = chained(before, records);
            Some((records, *before))
        })
    }
}

/// The digest of a chunk's records after the digest of the chunk before.
#[must_use]
pub fn chained(before: &[u8; DIGEST_BYTES], records: &[u8]) -> [u8; DIGEST_BYTES] {
    Sha256::new().chain_update(before).chain_update(records).finalize().into()
}
