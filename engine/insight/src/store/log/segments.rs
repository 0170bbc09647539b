//! `log-2.bin`, `log-3.bin`, ...: the steps of learning after the 1,048,576 that `log.bin` has room for.
//!
//! | bytes | hold |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | format, 1 |
//! | 4 | length of the header |
//! | that many | the header, JSON: engine, seed, digest of `run.toml`, the segment's number, bytes of a record, the digest of the chunk before its first |
//! | 32 | SHA-256 of all before |
//! | chunks | 1,024 records each, of the last one fewer, and a digest after each, as in `log.bin` |
//!
//! Segments are written while the robot learns. How many there are, how long each is and with which digest it ends stands in the
//! header of `log.bin`, which is written last. One that was not kept has its digest there all the same.

use std::fs::File;
use std::io::{ErrorKind, Result as IoResult, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::PREFIX_BYTES;
use engine::diagnostic::{Diagnostic, Result};
use engine::digest::{Digest, hex};
use engine::experiment::{CHUNK_STEPS, DIGEST_BYTES, MOST_STEPS, PassedOn, Segment};

/// How the file of a segment begins.
pub(super) const MAGIC: [u8; 8] = *b"engnseg\n";
pub(super) const FORMAT: u32 = 1;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SegmentHeader {
    pub engine: String,
    pub run_sha256: String,
    pub seed: u64,
    pub segment: u64,
    pub record_bytes: usize,
    pub before: String,
}

/// The name of the file of a segment; 1 is the first one after `log.bin`.
#[must_use]
pub fn segment_file(segment: u64) -> String {
    format!("log-{}.bin", segment.saturating_add(1))
}

/// Whether a file of this name is one of a segment.
#[must_use]
pub fn is_segment_file(name: &str) -> bool {
    let number = name.strip_prefix("log-").and_then(|rest| rest.strip_suffix(".bin")?.parse::<u64>().ok());
    number.is_some_and(|number| number > 1 && segment_file(number - 1) == name)
}

/// Bytes of so many records with their digests.
pub(super) fn bytes_of(records: u64, record_bytes: usize) -> u64 {
    records * record_bytes as u64 + records.div_ceil(CHUNK_STEPS as u64) * DIGEST_BYTES as u64
}

/// Writes the segments of one seed into its folder, chunk by chunk.
#[derive(Debug)]
pub struct SegmentWriter {
    folder: PathBuf,
    run_sha256: Digest,
    seed: u64,
    /// How many segments are kept, the first among them.
    most: u64,
    open: Option<(u64, File)>,
}

impl SegmentWriter {
    /// For a folder whose `run.toml` has the text `run`; of all segments the first `most` are kept.
    #[must_use]
    pub fn new(folder: &Path, run: &str, seed: u64, most: u64) -> Self {
        Self { folder: folder.to_owned(), run_sha256: Digest::of(run.as_bytes()), seed, most, open: None }
    }

    /// Writes a chunk after the one before; what a killed run has written after that goes.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn take(&mut self, chunk: PassedOn<'_>) -> Result<()> {
        if chunk.segment >= self.most {
            return Ok(());
        }
        let path = self.folder.join(segment_file(chunk.segment));
        let failed = |error: &std::io::Error| Box::new(Diagnostic::disk("write", &path, error));
        let mut file = match self.open.take() {
            Some((segment, file)) if segment == chunk.segment => file,
            last => {
                last.map_or(Ok(()), |(_, file)| file.sync_data()).map_err(|error| failed(&error))?;
                let file = if chunk.chunk == 0 { self.begin(&path, &chunk) } else { go_on(&path, &chunk) };
                file.map_err(|error| failed(&error))?
            }
        };
        let written = file.write_all(chunk.records).and_then(|()| file.write_all(&chunk.digest));
        written.map_err(|error| failed(&error))?;
        self.open = Some((chunk.segment, file));
        Ok(())
    }

    /// Makes what was written last through a power cut.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn sync(&self) -> Result<()> {
        let Some((segment, file)) = &self.open else { return Ok(()) };
        let path = self.folder.join(segment_file(*segment));
        file.sync_data().map_err(|error| Box::new(Diagnostic::disk("write", &path, &error)))
    }

    fn begin(&self, path: &Path, chunk: &PassedOn<'_>) -> IoResult<File> {
        let header = SegmentHeader {
            engine: env!("CARGO_PKG_VERSION").to_owned(),
            run_sha256: self.run_sha256.to_string(),
            seed: self.seed,
            segment: chunk.segment,
            record_bytes: chunk.record_bytes,
            before: hex(&chunk.before),
        };
        let text = serde_json::to_vec(&header).map_err(std::io::Error::other)?;
        let mut start = MAGIC.to_vec();
        start.extend_from_slice(&FORMAT.to_le_bytes());
        start.extend_from_slice(&(text.len() as u32).to_le_bytes());
        start.extend_from_slice(&text);
        let digest = Digest::of(&start);
        start.extend_from_slice(digest.bytes());
        // A name that nothing has: what a stranger may have put there is not written to.
        remove(path)?;
        let mut file = File::create_new(path)?;
        file.write_all(&start)?;
        Ok(file)
    }
}

/// Opens the file of a segment after so many of its chunks.
fn go_on(path: &Path, chunk: &PassedOn<'_>) -> IoResult<File> {
    let mut file = File::options().read(true).write(true).open(path)?;
    let begins = beginning(&mut file)?;
    let end = begins + bytes_of(chunk.chunk * CHUNK_STEPS as u64, chunk.record_bytes);
    if file.metadata()?.len() < end {
        return Err(std::io::Error::new(ErrorKind::UnexpectedEof, "it is shorter than its checkpoint says"));
    }
    file.set_len(end)?;
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}

/// Where the first chunk of an open file begins.
fn beginning(file: &mut File) -> IoResult<u64> {
    let mut start = [0; PREFIX_BYTES];
    std::io::Read::read_exact(file, &mut start)?;
    let length = start.last_chunk().map_or(0, |length| u32::from_le_bytes(*length));
    Ok((PREFIX_BYTES + DIGEST_BYTES) as u64 + u64::from(length))
}

fn remove(path: &Path) -> IoResult<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Leaves these segments in a folder, each as long as it is: a run that was killed may have come farther than the one that went on
/// from its checkpoint. Returns how many are there, the first one, which is `log.bin`, not counted.
///
/// # Errors
/// If a file cannot be cut or removed.
pub(crate) fn settle(folder: &Path, segments: &[Segment], record_bytes: usize) -> Result<u64> {
    let mut kept = 0;
    for segment in 1.. {
        let path = folder.join(segment_file(segment));
        let failed = |error: &std::io::Error| Box::new(Diagnostic::disk("write", &path, error));
        if !crate::disk::is_there(&path)? {
            break;
        }
        let Some(Segment { records, .. }) = segments.get(segment as usize - 1) else {
            remove(&path).map_err(|error| failed(&error))?;
            continue;
        };
        let cut = || -> IoResult<()> {
            let mut file = File::options().read(true).write(true).open(&path)?;
            let end = beginning(&mut file)? + bytes_of(*records, record_bytes);
            if file.metadata()?.len() > end {
                file.set_len(end)?;
            }
            file.sync_data()
        };
        cut().map_err(|error| failed(&error))?;
        kept = segment;
    }
    Ok(kept)
}

/// Whether a segment can be one of a run: all but the last are full, and none is empty.
pub(super) fn are_possible(segments: &[Segment]) -> bool {
    let full = segments.iter().rev().skip(1).all(|segment| segment.records == MOST_STEPS);
    full && segments.iter().all(|segment| (1..=MOST_STEPS).contains(&segment.records))
}
