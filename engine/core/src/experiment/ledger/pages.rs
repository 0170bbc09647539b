//! Records of a long run, read as they are wanted: a chunk of them is in memory at a time.

use std::sync::{Arc, Mutex, PoisonError};

use super::tail::place_of;
use crate::experiment::run_log::CHUNK_STEPS;

/// Where the records of the segments after the first lie.
pub trait StoredSegments: Send + Sync {
    /// Reads a chunk of a segment, both as in [`super::PassedOn`]; whether it is the one that was written.
    fn read(&self, segment: u64, chunk: u64, into: &mut Vec<u8>) -> bool;
}

/// The records of the segments after the first.
#[derive(Clone)]
pub(super) struct Pages {
    stored: Arc<dyn StoredSegments>,
    /// How many there are.
    records: u64,
    /// The chunk that was wanted last, by segment and number.
    open: Arc<Mutex<Page>>,
}

#[derive(Default)]
struct Page {
    place: Option<(u64, u64)>,
    bytes: Vec<u8>,
}

impl Pages {
    pub(super) fn new(stored: Arc<dyn StoredSegments>, records: u64) -> Self {
        Self { stored, records, open: Arc::default() }
    }

    pub(super) fn len(&self) -> usize {
        self.records as usize
    }

    /// One record, counted from the first of the second segment; nothing if it is not there, or cannot be read any more.
    pub(super) fn record(&self, record: usize, bytes: usize) -> Option<Vec<u8>> {
        let wanted = Some(record as u64).filter(|record| *record < self.records)?;
        let (segment, chunk) = place_of(wanted);
        let mut page = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let page = &mut *page;
        if page.place != Some((segment, chunk)) {
            page.place = None;
            page.bytes.clear();
            if self.stored.read(segment + 1, chunk, &mut page.bytes) {
                page.place = Some((segment, chunk));
            }
        }
        page.place?;
        let at = record % CHUNK_STEPS * bytes;
        page.bytes.get(at..at + bytes).map(<[u8]>::to_vec)
    }
}

impl std::fmt::Debug for Pages {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pages").field("records", &self.records).finish_non_exhaustive()
    }
}

/// What the records are, their digests say.
impl PartialEq for Pages {
    fn eq(&self, other: &Self) -> bool {
        self.records == other.records
    }
}
