//! `log.bin`: every step of a run, seekable and hashed.
//!
//! | bytes | hold |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | format, little-endian like every number here |
//! | 4 | length of the header |
//! | that many | the header, JSON: engine, behaviour, seed, digest of `run.toml`, rules, bytes of a record, counts of both phases, and `earlier`: the same of each leg before the reward was swapped |
//! | 32 | SHA-256 of all before |
//! | chunks | up to 1,024 records of learning, then 32 bytes: SHA-256 of the digest of the chunk before and these records; each leg begins a chunk of its own; the test follows in the same way |
//!
//! A run of more than 1,048,576 steps of learning has the steps after these in segments: files of their own, see `segments.rs`. The
//! header then has `segments`, in their order: how many records each has, the digest of its last chunk, and whether it was `kept`.
//! The chain of digests goes from the chunks of learning here through those of all segments to the test.
//!
//! The format is 1, 2 if there are earlier legs, 4 if there are segments, and 3 of a run in several worlds or with values that are drawn for each attempt,
//! with legs or without. A swap is so an event in the log: it comes after as many steps as the
//! legs before it have; what became of the table stands with the script in `run.toml`.
//!
//! The chain of digests begins with 32 zeros and ends as `log_sha256` in `summary.json`. All sizes follow from the header,
//! so chunk `n` of learning begins at `48 + header + n * (1,024 * record + 32)`, and each chunk can be checked by itself. A
//! record is laid out as in `experiment/ledger/record.rs`: reward, x, y, yaw as 8-byte floats; state, next state; action, flags
//! (recover, contact, fallen, explored, prey), beam of the rule, nearest beam as 2 bytes each; nearest range, height, prey
//! x, y, yaw and coverage as 4-byte floats; a bit for each rule; an 8-byte float for each rule without a fixed value;
//! in format 3 the number of the world (0 is the home world) and whether the attempt is broken off after the step, 4 bytes each,
//! and an 8-byte float for each value that is drawn.

mod read;
mod segments;
mod stored;
mod stored_segments;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use engine::diagnostic::{Diagnostic, Result};
use engine::digest::{Digest, hex};
use engine::experiment::{Ledger, Plan, RunLog};

pub use read::read_log;
pub(super) use read::{LogEnd, log_names};
pub(crate) use segments::settle;
pub use segments::{SegmentWriter, is_segment_file, segment_file};
pub use stored::RecordedRun;

/// The name of the file in a run's folder.
pub const LOG_FILE: &str = "log.bin";
/// How the file begins.
pub const MAGIC: [u8; 8] = *b"engnlog\n";
const FORMAT: u32 = 1;
/// The format of a log with more than one leg.
const FORMAT_OF_LEGS: u32 = 2;
/// The format of a log whose records hold the world and what was drawn.
const FORMAT_OF_WORLDS: u32 = 3;
/// The format of a log with segments, in several worlds or in one.
const FORMAT_OF_SEGMENTS: u32 = 4;
/// Magic, format, length of the header.
const PREFIX_BYTES: usize = 16;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    engine: String,
    behaviour: String,
    seed: u64,
    run_sha256: String,
    record_bytes: usize,
    rules: Vec<RuleEntry>,
    /// Learning before the reward was swapped for the last time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    earlier: Vec<LogLegEntry>,
    learning: PhaseEntry,
    /// What of learning follows in files of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    segments: Vec<SegmentEntry>,
    test: PhaseEntry,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentEntry {
    records: u64,
    sha256: Digest,
    kept: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LogLegEntry {
    record_bytes: usize,
    rules: Vec<RuleEntry>,
    learning: PhaseEntry,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleEntry {
    name: String,
    /// What it adds whenever it fires; null if each record holds its value.
    value: Option<f64>,
}

/// Steps that were done, and how many of them were kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PhaseEntry {
    steps: u64,
    records: usize,
}

impl PhaseEntry {
    fn of_last_leg(ledger: &Ledger) -> Self {
        let (steps, records) = ledger.last_leg();
        Self { steps, records }
    }
}

impl RuleEntry {
    fn all(plan: &Plan) -> Vec<Self> {
        let rules = plan.behaviour.rules().iter().enumerate();
        rules.map(|(index, rule)| Self { name: rule.name.clone(), value: plan.behaviour.fixed_value(index) }).collect()
    }
}

/// The whole file of the log of a run whose `run.toml` has the text `run`.
///
/// Of the segments that follow, the first `kept` are there.
///
/// # Errors
/// Never in practice: only if the header cannot be written as JSON.
pub fn log_to_bytes(log: &RunLog, plan: &Plan, seed: u64, run: &str, kept: u64) -> Result<Vec<u8>> {
    let legs = plan.earlier.iter().zip(log.learning.earlier());
    let earlier = legs.map(|(leg, records)| LogLegEntry {
        record_bytes: records.shape.bytes(),
        rules: RuleEntry::all(&leg.plan),
        learning: PhaseEntry { steps: records.steps, records: records.len() },
    });
    let segments = (1..).zip(log.learning.segments()).map(|(number, segment)| SegmentEntry {
        records: segment.records,
        sha256: Digest::from(segment.digest),
        kept: number <= kept,
    });
    let header = Header {
        engine: env!("CARGO_PKG_VERSION").to_owned(),
        behaviour: plan.behaviour.name().to_owned(),
        seed,
        run_sha256: hex(&Sha256::digest(run.as_bytes())),
        record_bytes: log.learning.shape().bytes(),
        rules: RuleEntry::all(plan),
        earlier: earlier.collect(),
        segments: segments.collect(),
        learning: PhaseEntry::of_last_leg(&log.learning),
        test: PhaseEntry::of_last_leg(&log.test),
    };
    let format = match header.earlier.is_empty() {
        _ if !header.segments.is_empty() => FORMAT_OF_SEGMENTS,
        _ if plan.varies() => FORMAT_OF_WORLDS,
        true => FORMAT,
        false => FORMAT_OF_LEGS,
    };
    let text = serde_json::to_vec(&header)
        .map_err(|error| Box::new(damaged(format!("the log's header cannot be written: {error}"))))?;
    let records: usize = log.chunks().map(|(records, digest)| records.len() + digest.len()).sum();
    let mut file = Vec::with_capacity(records + text.len() + 4096);
    file.extend_from_slice(&MAGIC);
    file.extend_from_slice(&format.to_le_bytes());
    file.extend_from_slice(&(text.len() as u32).to_le_bytes());
    file.extend_from_slice(&text);
    let all_before = Sha256::digest(&file);
    file.extend_from_slice(&all_before);
    for (records, digest) in log.chunks() {
        file.extend_from_slice(records);
        file.extend_from_slice(&digest);
    }
    Ok(file)
}

fn damaged(message: String) -> Diagnostic {
    Diagnostic::new("E-LOG-FILE", message).help("copy the folder of the run again, or run the behaviour again")
}

#[cfg(test)]
mod tests;
