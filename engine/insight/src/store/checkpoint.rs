//! `checkpoint.bin` and `steps.bin`: all that goes on while a seed learns, and the records of its steps until then, as many as a ledger has room for.
//!
//! | bytes of `checkpoint.bin` | hold |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | | engine, digest of `run.toml`, seed, steps that were done, bytes of `steps.bin` that count, their digest, what goes on of the records after those, the state: see `engine::saved` |
//! | 32 | SHA-256 of all before |
//!
//! `steps.bin` only grows, and `checkpoint.bin` is replaced as a whole after it: so whatever ends the run, the two fit, and the
//! bytes of `steps.bin` after those that count are of nobody.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use crate::disk::{is_there, read_file, write_atomic};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::digest::Digest;
use engine::experiment::Kept;
use engine::saved::{Loading, Saving, Unfit};

/// The name of the file of the state.
pub const CHECKPOINT_FILE: &str = "checkpoint.bin";
/// The name of the file of records.
pub const STEPS_FILE: &str = "steps.bin";
/// How the file of the state begins; the last digit is the format.
const MAGIC: [u8; 8] = *b"engnckp2";
/// The largest of the two that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Keeps the checkpoints of one seed in a folder.
#[derive(Debug)]
pub struct CheckpointWriter {
    folder: PathBuf,
    run_sha256: Digest,
    seed: u64,
    steps: File,
    /// Of the records that were written.
    written: usize,
    hasher: Sha256,
}

impl CheckpointWriter {
    /// Begins with no steps, or goes on after a checkpoint of this folder; `run` is its `run.toml`.
    ///
    /// # Errors
    /// If the file of records cannot be made.
    pub fn new(folder: &Path, run: &str, seed: u64, after: Option<&StoredCheckpoint>) -> Result<Self> {
        let (path, records) = (folder.join(STEPS_FILE), after.map_or(&[][..], |after| &after.records));
        let make = || -> std::io::Result<File> {
            if after.is_none() {
                // A name that nothing has: what a stranger may have put there is not written to.
                match std::fs::remove_file(&path) {
                    Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
                    _ => return File::create_new(&path),
                }
            }
            let mut file = File::options().write(true).open(&path)?;
            file.set_len(records.len() as u64)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let steps = make().map_err(|error| Box::new(Diagnostic::disk("write", &path, &error)))?;
        let (run_sha256, hasher) = (Digest::of(run.as_bytes()), Sha256::new().chain_update(records));
        Ok(Self { folder: folder.to_owned(), run_sha256, seed, steps, written: records.len(), hasher })
    }

    /// Keeps a checkpoint in the place of the last one, on the disk.
    ///
    /// # Errors
    /// If it cannot be written: the last one is then still there.
    pub fn keep(&mut self, kept: Kept<'_>) -> Result<()> {
        let new = kept.records.get(self.written..).unwrap_or_default();
        let append = |file: &mut File| file.write_all(new).and_then(|()| file.sync_data());
        append(&mut self.steps)
            .map_err(|error| Box::new(Diagnostic::disk("write", &self.folder.join(STEPS_FILE), &error)))?;
        self.hasher.update(new);
        self.written += new.len();
        let mut saving = Saving::default();
        saving.bytes(VERSION.as_bytes());
        saving.bytes(self.run_sha256.to_string().as_bytes());
        saving.whole(self.seed);
        saving.whole(kept.steps);
        saving.whole(self.written as u64);
        saving.bytes(&self.hasher.clone().finalize());
        saving.bytes(kept.tail);
        saving.bytes(kept.state);
        let mut bytes = [&MAGIC[..], &saving.into_bytes()].concat();
        let digest = Sha256::digest(&bytes);
        bytes.extend_from_slice(&digest);
        write_atomic(&self.folder.join(CHECKPOINT_FILE), &bytes)
    }
}

/// A checkpoint, read back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredCheckpoint {
    /// All that goes on.
    pub state: Vec<u8>,
    /// Records of the steps.
    pub records: Vec<u8>,
    /// What goes on of the records for which a ledger has no room.
    pub tail: Vec<u8>,
    /// Steps that were done.
    pub steps: u64,
}

impl StoredCheckpoint {
    /// As learning goes on from it.
    #[must_use]
    pub fn kept(&self) -> Kept<'_> {
        Kept { state: &self.state, records: &self.records, tail: &self.tail, steps: self.steps }
    }

    /// The checkpoint of a seed in a folder, if there is one; `run` is its `run.toml`.
    ///
    /// # Errors
    /// `E-CHECKPOINT` if it is damaged, of another engine, of another run or of another seed.
    pub fn read(folder: &Path, run: &str, seed: u64) -> Result<Option<Self>> {
        let path = folder.join(CHECKPOINT_FILE);
        if !is_there(&path)? {
            return Ok(None);
        }
        let failed = |path: &Path, error| Box::new(unusable(path, &Diagnostic::disk("read", path, &error).message));
        let bytes = read_file(&path, MOST_BYTES).map_err(|error| failed(&path, error))?;
        let steps = folder.join(STEPS_FILE);
        let mut records = read_file(&steps, MOST_BYTES).map_err(|error| failed(&steps, error))?;
        let Ok(found) = parse(&bytes) else { return Err(Box::new(unusable(&path, "it is damaged"))) };
        let wrong = if found.engine != VERSION {
            format!("it is of engine {}, this is {VERSION}", printable(&found.engine))
        } else if found.run_sha256 != Digest::of(run.as_bytes()).to_string() {
            "it is of another run".to_owned()
        } else if found.seed != seed {
            format!("it is of seed {}, not {seed}", found.seed)
        } else {
            records.truncate(usize::try_from(found.records).unwrap_or(usize::MAX));
            let fits = records.len() as u64 == found.records && Sha256::digest(&records)[..] == found.records_sha256;
            if fits {
                return Ok(Some(Self { state: found.state, records, tail: found.tail, steps: found.steps }));
            }
            format!("'{STEPS_FILE}' beside it is damaged")
        };
        unusable(&path, &wrong).fail()
    }
}

struct Found {
    engine: String,
    run_sha256: String,
    seed: u64,
    steps: u64,
    records: u64,
    records_sha256: Vec<u8>,
    tail: Vec<u8>,
    state: Vec<u8>,
}

fn parse(bytes: &[u8]) -> std::result::Result<Found, Unfit> {
    let (all, digest) = bytes.split_last_chunk::<32>().ok_or(Unfit)?;
    let rest = all.strip_prefix(&MAGIC).filter(|_| Sha256::digest(all)[..] == digest[..]).ok_or(Unfit)?;
    let mut loading = Loading::new(rest);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).map_err(|_| Unfit);
    let found = Found {
        engine: text(loading.bytes()?)?,
        run_sha256: text(loading.bytes()?)?,
        seed: loading.whole()?,
        steps: loading.whole()?,
        records: loading.whole()?,
        records_sha256: loading.bytes()?.to_vec(),
        tail: loading.bytes()?.to_vec(),
        state: loading.bytes()?.to_vec(),
    };
    loading.end()?;
    Ok(found)
}

fn unusable(path: &Path, what: &str) -> Diagnostic {
    let message = format!("the checkpoint '{}' cannot be used: {what}", printable(&path.display().to_string()));
    Diagnostic::new("E-CHECKPOINT", message).help("start the run anew: engine run SCRIPT --force")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(folder: &Path, records: &[u8]) -> CheckpointWriter {
        let mut writer = CheckpointWriter::new(folder, "run", 7, None).unwrap();
        for end in [1, records.len()] {
            writer.keep(Kept { state: b"state", records: &records[..end], tail: b"", steps: end as u64 }).unwrap();
        }
        writer
    }

    #[test]
    fn the_last_checkpoint_comes_back_and_is_gone_on_with() {
        let folder = tempfile::tempdir().unwrap();
        drop(kept(folder.path(), b"abc"));
        // A run that was killed after more records were written and before their checkpoint was.
        std::fs::write(folder.path().join(STEPS_FILE), "abcd").unwrap();
        let read = || StoredCheckpoint::read(folder.path(), "run", 7).unwrap().unwrap();
        let first = read();
        assert_eq!((first.records.as_slice(), first.steps, first.state.as_slice()), (&b"abc"[..], 3, &b"state"[..]));
        let mut writer = CheckpointWriter::new(folder.path(), "run", 7, Some(&first)).unwrap();
        writer.keep(Kept { state: b"", records: b"abcxy", tail: b"", steps: 5 }).unwrap();
        assert_eq!(read().records, b"abcxy");
    }

    #[test]
    fn every_bit_that_is_another_one_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        drop(kept(folder.path(), b"abc"));
        let code = |run: &str, seed| StoredCheckpoint::read(folder.path(), run, seed).map(|_| ()).unwrap_err().code;
        assert_eq!((code("other", 7), code("run", 8)), ("E-CHECKPOINT", "E-CHECKPOINT"));
        for file in [CHECKPOINT_FILE, STEPS_FILE] {
            let path = folder.path().join(file);
            let whole = std::fs::read(&path).unwrap();
            for at in 0..whole.len() {
                let mut bytes = whole.clone();
                bytes[at] ^= 4;
                std::fs::write(&path, &bytes).unwrap();
                assert_eq!(code("run", 7), "E-CHECKPOINT", "{file} at {at}");
                std::fs::write(&path, &whole[..at]).unwrap();
                assert_eq!(code("run", 7), "E-CHECKPOINT", "{file} up to {at}");
            }
            std::fs::write(&path, whole).unwrap();
        }
        assert!(StoredCheckpoint::read(&folder.path().join("none"), "run", 7).unwrap().is_none());
    }
}
