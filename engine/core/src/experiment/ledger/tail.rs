//! What follows the records that a ledger has room for: passed on chunk by chunk, so that a run of any length needs no more
//! memory, and its digest holds every step.

use super::MOST_STEPS;
use crate::diagnostic::Result;
use crate::experiment::run_log::{CHUNK_STEPS, DIGEST_BYTES, chained};
use crate::saved::{Loading, Passed, Passing, Saving, Unfit};

/// So many records wait in memory at most before they are passed on: whole chunks.
const WAITING_STEPS: u64 = 64 * CHUNK_STEPS as u64;
/// Chunks of a segment: as many as the ledger itself has room for, which is the first segment.
const SEGMENT_CHUNKS: u64 = MOST_STEPS / CHUNK_STEPS as u64;

/// Records that are passed on: a chunk of a segment after the first.
#[derive(Debug, Clone, Copy)]
pub struct PassedOn<'a> {
    /// The segment, from 1 on: 0 is what the ledger itself holds.
    pub segment: u64,
    /// The chunk's number in it.
    pub chunk: u64,
    /// Up to 1,024 records; fewer only at the end.
    pub records: &'a [u8],
    /// Bytes of one record.
    pub record_bytes: usize,
    /// The digest of the chunk before.
    pub before: [u8; DIGEST_BYTES],
    /// The digest of this chunk, which holds the one before.
    pub digest: [u8; DIGEST_BYTES],
}

/// A segment after the first: how many records it has, and the digest with which it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Segment {
    /// Its records.
    pub records: u64,
    /// The digest of its last chunk.
    pub digest: [u8; DIGEST_BYTES],
}

/// The records after those that a ledger has room for.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tail {
    /// Whether there may be any.
    is_on: bool,
    /// Records that wait.
    waiting: Vec<u8>,
    /// What was passed on.
    pub(super) segments: Vec<Segment>,
}

impl Tail {
    /// Room for what waits; nothing is allocated later.
    pub(super) fn new(record_bytes: usize, steps: u64) -> Self {
        let waiting = WAITING_STEPS.min(steps) as usize * record_bytes;
        Self { is_on: true, waiting: Vec::with_capacity(waiting), segments: Vec::new() }
    }

    /// One that was passed on long ago.
    pub(super) fn of(segments: Vec<Segment>) -> Self {
        Self { is_on: true, waiting: Vec::new(), segments }
    }

    pub(super) fn is_on(&self) -> bool {
        self.is_on
    }

    pub(super) fn waiting_mut(&mut self) -> &mut Vec<u8> {
        &mut self.waiting
    }

    /// How many more records can wait.
    pub(super) fn room(&self, record_bytes: usize) -> u64 {
        WAITING_STEPS - (self.waiting.len() / record_bytes) as u64
    }

    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty() && self.segments.is_empty()
    }

    /// Passes on what waits: whole chunks or, at the end, all. `first` is the digest of the ledger's own records.
    pub(super) fn pass_on(
        &mut self,
        record_bytes: usize,
        first: impl FnOnce() -> [u8; DIGEST_BYTES],
        at_the_end: bool,
        to: &mut dyn FnMut(PassedOn<'_>) -> Result<()>,
    ) -> Result<()> {
        let bytes = CHUNK_STEPS * record_bytes;
        let ready = if at_the_end { self.waiting.len() } else { self.waiting.len() / bytes * bytes };
        if ready == 0 {
            return Ok(());
        }
        let mut before = self.segments.last().map_or_else(first, |segment| segment.digest);
        for records in self.waiting[..ready].chunks(bytes) {
            let is_full = |segment: &Segment| segment.records == MOST_STEPS;
            if self.segments.last().is_none_or(is_full) {
                self.segments.push(Segment::default());
            }
            let number = self.segments.len() as u64;
            let Some(segment) = self.segments.last_mut() else { break };
            let (chunk, digest) = (segment.records / CHUNK_STEPS as u64, chained(&before, records));
            to(PassedOn { segment: number, chunk, records, record_bytes, before, digest })?;
            segment.records += (records.len() / record_bytes) as u64;
            (segment.digest, before) = (digest, digest);
        }
        self.waiting.drain(..ready);
        Ok(())
    }

    /// The first segment after the ledger's own that is another one in another run.
    pub(super) fn first_difference(&self, other: &Self) -> Option<usize> {
        let most = self.segments.len().max(other.segments.len());
        (0..most).find(|index| self.segments.get(*index) != other.segments.get(*index))
    }

    /// What a checkpoint needs to go on: the records that wait, and what was passed on.
    pub(super) fn save(&self) -> Vec<u8> {
        let mut by = Passing::Out(Saving::default());
        match (self.clone().pass(&mut by), by) {
            (Ok(()), Passing::Out(saving)) => saving.into_bytes(),
            // Writing always fits.
            _ => Vec::new(),
        }
    }

    /// Becomes what was saved after so many records of this ledger's tail.
    pub(super) fn load(&mut self, bytes: &[u8], record_bytes: usize, records: u64) -> Passed {
        let mut by = Passing::In(Loading::new(bytes));
        self.pass(&mut by)?;
        let Some((last, whole)) = self.segments.split_last() else {
            let fits = self.waiting.len() as u64 == records * record_bytes as u64;
            return if fits { Ok(()) } else { Err(Unfit) };
        };
        let passed_on: u64 = self.segments.iter().map(|segment| segment.records).fold(0, u64::saturating_add);
        let fits = whole.iter().all(|segment| segment.records == MOST_STEPS)
            && last.records <= MOST_STEPS
            && last.records.is_multiple_of(CHUNK_STEPS as u64)
            && self.waiting.len() < CHUNK_STEPS * record_bytes
            && passed_on.checked_add((self.waiting.len() / record_bytes) as u64) == Some(records);
        if fits { Ok(()) } else { Err(Unfit) }
    }

    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        let room = self.waiting.capacity();
        by.bytes(&mut self.waiting)?;
        self.waiting.reserve(room.saturating_sub(self.waiting.len()));
        by.list(&mut self.segments, |by, segment| {
            by.whole(&mut segment.records)?;
            let mut digest = segment.digest.to_vec();
            by.bytes(&mut digest)?;
            segment.digest = digest.try_into().map_err(|_| Unfit)?;
            Ok(())
        })
    }
}

/// The segment, from 0 on, and the chunk in it of a record of these segments.
#[must_use]
pub(super) fn place_of(record: u64) -> (u64, u64) {
    let chunk = record / CHUNK_STEPS as u64;
    (chunk / SEGMENT_CHUNKS, chunk % SEGMENT_CHUNKS)
}
