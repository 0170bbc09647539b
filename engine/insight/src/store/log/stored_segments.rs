//! The segments of a run's log, read back: all of them once, chunk by chunk, then each chunk where a step of it is wanted.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::PREFIX_BYTES;
use super::damaged;
use super::read::Possible;
use super::segments::{FORMAT, MAGIC, SegmentHeader, bytes_of, segment_file};
use crate::disk::open_file;
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::digest::{Digest, hex};
use engine::experiment::{
    CHUNK_STEPS, DIGEST_BYTES, Ledger, LedgerLeg, MOST_STEPS, RecordShape, Segment, StoredSegments, chained,
};

/// The longest header that is read, bytes.
const MOST_HEADER_BYTES: usize = 1 << 16;

/// Segments that lie in a folder.
struct SegmentFiles {
    record_bytes: usize,
    files: Vec<SegmentFile>,
}

struct SegmentFile {
    path: PathBuf,
    /// Where its first chunk begins.
    begins: u64,
    records: u64,
    /// The digest before its first chunk, then that of each chunk.
    digests: Vec<[u8; DIGEST_BYTES]>,
}

/// What the segments of a log must belong to.
pub(super) struct Whose<'a> {
    pub run_sha256: &'a str,
    pub seed: u64,
    pub possible: &'a Possible,
}

/// A ledger with the first `kept` of the segments that follow it, each read once and found to be what its digest says.
///
/// # Errors
/// `E-LOG-FILE` if one is missing, cut, changed, or holds what the plan cannot have done; `E-LOG-RUN` if it is another run's.
pub(super) fn attach(
    folder: &Path,
    ledger: Ledger,
    kept: usize,
    before: [u8; DIGEST_BYTES],
    whose: &Whose<'_>,
) -> Result<Ledger> {
    let (shape, mut before) = (ledger.shape().clone(), before);
    let (mut files, mut records) = (Vec::new(), 0);
    for (index, segment) in ledger.segments().iter().take(kept).enumerate() {
        let path = folder.join(segment_file(index as u64 + 1));
        let named = |mut error: Box<Diagnostic>| {
            error.message = format!("'{}': {}", printable(&path.display().to_string()), error.message);
            error
        };
        let file = check(&path, index as u64 + 1, *segment, before, &shape, whose).map_err(named)?;
        before = segment.digest;
        records += segment.records;
        files.push(file);
    }
    if files.is_empty() {
        return Ok(ledger);
    }
    let stored = SegmentFiles { record_bytes: shape.bytes(), files };
    Ok(ledger.with_pages(Arc::new(stored), records))
}

fn check(
    path: &Path,
    number: u64,
    segment: Segment,
    before: [u8; DIGEST_BYTES],
    shape: &RecordShape,
    whose: &Whose<'_>,
) -> Result<SegmentFile> {
    let unread = |error: &std::io::Error| Box::new(damaged(Diagnostic::disk("read", path, error).message));
    let mut file = open_file(path).map_err(|error| unread(&error))?;
    let begins = check_header(&mut file, number, before, shape, whose)?;
    let length = file.metadata().map_err(|error| unread(&error))?.len();
    if length != begins + bytes_of(segment.records, shape.bytes()) {
        return damaged("the segment is not as long as the log says".to_owned()).fail();
    }
    let (mut digests, mut left, mut first) = (vec![before], segment.records, number * MOST_STEPS);
    while left > 0 {
        let records = left.min(CHUNK_STEPS as u64);
        let (mut bytes, mut digest) = (vec![0; records as usize * shape.bytes()], [0; DIGEST_BYTES]);
        let read = file.read_exact(&mut bytes).and_then(|()| file.read_exact(&mut digest));
        read.map_err(|error| unread(&error))?;
        let last = digests.last().copied().unwrap_or_default();
        if chained(&last, &bytes) != digest {
            let last = first + records - 1;
            return damaged(format!("steps {first} to {last} of learning do not match their checksum")).fail();
        }
        if let Some(ledger) = Ledger::from_legs(vec![LedgerLeg { shape: shape.clone(), bytes, steps: records }]) {
            whose.possible.check(&ledger, first, "learning")?;
        }
        digests.push(digest);
        (left, first) = (left - records, first + records);
    }
    if digests.last() != Some(&segment.digest) {
        return damaged("the segment is another one than the log says".to_owned()).fail();
    }
    Ok(SegmentFile { path: path.to_owned(), begins, records: segment.records, digests })
}

/// Where the first chunk begins.
fn check_header(
    file: &mut File,
    number: u64,
    before: [u8; DIGEST_BYTES],
    shape: &RecordShape,
    whose: &Whose<'_>,
) -> Result<u64> {
    let cut = |_| Box::new(damaged("the segment ends inside its header".to_owned()));
    let mut start = vec![0; PREFIX_BYTES];
    file.read_exact(&mut start).map_err(cut)?;
    let word = |at: usize| start.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word));
    let length = word(12).unwrap_or(0) as usize;
    if start[..8] != MAGIC || word(8) != Some(FORMAT) || length > MOST_HEADER_BYTES {
        return damaged("this file is not a segment of a log that this engine reads".to_owned()).fail();
    }
    start.resize(PREFIX_BYTES + length, 0);
    let mut digest = [0; DIGEST_BYTES];
    let read = file.read_exact(&mut start[PREFIX_BYTES..]).and_then(|()| file.read_exact(&mut digest));
    read.map_err(cut)?;
    if Digest::of(&start).bytes() != &digest {
        return damaged("the segment's header does not match its checksum".to_owned()).fail();
    }
    let header: SegmentHeader = serde_json::from_slice(&start[PREFIX_BYTES..])
        .map_err(|error| Box::new(damaged(format!("the segment's header cannot be read: {error}"))))?;
    if header.run_sha256 != whose.run_sha256 || header.seed != whose.seed {
        let error = Diagnostic::new("E-LOG-RUN", "the segment belongs to another run");
        return error.help("keep log.bin, its segments and run.toml of one run together").fail();
    }
    if (header.segment, header.record_bytes, header.before) != (number, shape.bytes(), hex(&before)) {
        return damaged("the segment does not follow the one before it".to_owned()).fail();
    }
    Ok((PREFIX_BYTES + length + DIGEST_BYTES) as u64)
}

impl StoredSegments for SegmentFiles {
    fn read(&self, segment: u64, chunk: u64, into: &mut Vec<u8>) -> bool {
        let read = || -> Option<Vec<u8>> {
            let file = self.files.get(usize::try_from(segment).ok()?.checked_sub(1)?)?;
            let from = chunk * CHUNK_STEPS as u64;
            let records = file.records.checked_sub(from)?.min(CHUNK_STEPS as u64);
            let mut bytes = vec![0; records as usize * self.record_bytes];
            let mut open = open_file(&file.path).ok()?;
            open.seek(SeekFrom::Start(file.begins + bytes_of(from, self.record_bytes))).ok()?;
            open.read_exact(&mut bytes).ok()?;
            let [before, digest] = *file.digests.get(chunk as usize..)?.first_chunk()?;
            (chained(&before, &bytes) == digest).then_some(bytes)
        };
        read().is_some_and(|bytes| {
            *into = bytes;
            true
        })
    }
}
