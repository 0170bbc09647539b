//! A log file read back: nothing in it is believed before it is checked.

use std::path::Path;

use super::segments::are_possible;
use super::stored_segments::{Whose, attach};
use super::{
    FORMAT, FORMAT_OF_LEGS, FORMAT_OF_SEGMENTS, FORMAT_OF_WORLDS, Header, MAGIC, PREFIX_BYTES, PhaseEntry, RuleEntry,
    SegmentEntry, damaged,
};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::digest::Digest;
use engine::experiment::{
    CHUNK_STEPS, DIGEST_BYTES, Ledger, LedgerLeg, MOST_STEPS, Plan, Record, RecordShape, RunLog, Segment, chained,
};

/// Reads the bytes of a log that must belong to a plan under a seed, whose `run.toml` has the text `run`.
///
/// # Errors
/// `E-LOG-FILE` if the file is no log, of another format, cut, changed, or holds what the plan cannot have done;
/// `E-LOG-RUN` if it belongs to another run.
pub fn read_log(bytes: &[u8], plan: &Plan, seed: u64, run: &str) -> Result<RunLog> {
    read_checked(bytes, plan, seed, run).map(|(log, _)| log)
}

/// Reads the bytes of a log as [`read_log`], and then the segments that lie beside it, which become part of it.
///
/// # Errors
/// As [`read_log`], of the segments too.
pub(super) fn read_whole(folder: &Path, bytes: &[u8], plan: &Plan, seed: u64, run: &str) -> Result<RunLog> {
    let (log, Follow { kept, before, run_sha256 }) = read_checked(bytes, plan, seed, run)?;
    let whose = Whose { run_sha256: &run_sha256, seed, possible: &Possible::of(plan)? };
    Ok(RunLog { learning: attach(folder, log.learning, kept, before, &whose)?, ..log })
}

/// What is known of the segments that follow.
struct Follow {
    /// How many of them are there, from the first on.
    kept: usize,
    /// The digest before them.
    before: [u8; DIGEST_BYTES],
    run_sha256: String,
}

fn read_checked(bytes: &[u8], plan: &Plan, seed: u64, run: &str) -> Result<(RunLog, Follow)> {
    let (header, body) = header(bytes)?;
    if header.run_sha256 != Digest::of(run.as_bytes()).to_string() || header.seed != seed {
        let message =
            format!("the log belongs to another run: of '{}' with seed {}", printable(&header.behaviour), header.seed);
        return Diagnostic::new("E-LOG-RUN", message).help("keep log.bin and run.toml of one run together").fail();
    }
    if header.behaviour != plan.behaviour.name() {
        let (named, of) = (printable(&header.behaviour), plan.behaviour.name());
        return damaged(format!("the log names the behaviour '{named}', and its run is of '{of}'")).fail();
    }
    let stretches = stretches(&header, plan)?;
    check_length(&stretches, body)?;
    let (mut before, mut rest, mut legs) = ([0; DIGEST_BYTES], body, Vec::new());
    let mut before_segments = before;
    let segments = segments(&header)?;
    for RecordStretch { name, phase, shape } in stretches {
        if name == TEST {
            before_segments = before;
            before = segments.last().map_or(before, |last| last.digest);
        }
        let bytes = phase_records(&mut rest, phase, shape.bytes(), &mut before, name)?;
        legs.push(LedgerLeg { shape, bytes, steps: phase.steps });
    }
    let test = legs.pop().and_then(|leg| Ledger::from_legs(vec![leg]));
    let Some((learning, test)) = Ledger::from_legs(legs).zip(test) else {
        return damaged("the log's counts do not fit its records".to_owned()).fail();
    };
    let learning = if segments.is_empty() { learning } else { learning.followed_by(segments) };
    let log = RunLog { learning, test };
    let possible = Possible::of(plan)?;
    for (name, ledger) in [(LEARNING, &log.learning), (TEST, &log.test)] {
        possible.check(ledger, 0, name)?;
    }
    let kept = header.segments.iter().take_while(|segment| segment.kept).count();
    Ok((log, Follow { kept, before: before_segments, run_sha256: header.run_sha256 }))
}

/// The segments that follow the records of learning, which must be as many as a log has room for.
fn segments(header: &Header) -> Result<Vec<Segment>> {
    let of = |entry: &SegmentEntry| Segment { records: entry.records, digest: *entry.sha256.bytes() };
    let segments: Vec<Segment> = header.segments.iter().map(of).collect();
    let more: u64 = segments.iter().map(|segment| segment.records).fold(0, u64::saturating_add);
    let PhaseEntry { steps, records } = header.learning;
    let whole = records as u64 == MOST_STEPS && more.checked_add(MOST_STEPS) == Some(steps);
    let fit = segments.is_empty() || whole && header.earlier.is_empty() && are_possible(&segments);
    if fit { Ok(segments) } else { damaged("the log's segments do not fit its steps".to_owned()).fail() }
}

const LEARNING: &str = "learning";
const TEST: &str = "the test";

/// Records that lie in one way, one after the other.
struct RecordStretch {
    name: &'static str,
    phase: PhaseEntry,
    shape: RecordShape,
}

/// Each leg of learning, then the test; every one as the plan says it must be.
fn stretches(header: &Header, plan: &Plan) -> Result<Vec<RecordStretch>> {
    let stretch = |name, plan: &Plan, rules: &[RuleEntry], record_bytes: usize, phase: PhaseEntry| {
        let shape = RecordShape::of(plan);
        if record_bytes != shape.bytes() || rules != RuleEntry::all(plan) {
            return Err(Box::new(damaged("the log's records do not fit the rules of its run".to_owned())));
        }
        Ok(RecordStretch { name, phase, shape })
    };
    let legs = || header.earlier.iter().zip(&plan.earlier);
    let counts_fit = legs().all(|(entry, leg)| entry.learning.steps == leg.steps);
    if header.earlier.len() != plan.earlier.len() || !counts_fit {
        return damaged("the log's legs are not those of its run".to_owned()).fail();
    }
    let mut all = Vec::new();
    for (entry, leg) in legs() {
        all.push(stretch(LEARNING, &leg.plan, &entry.rules, entry.record_bytes, entry.learning)?);
    }
    all.push(stretch(LEARNING, plan, &header.rules, header.record_bytes, header.learning)?);
    all.push(stretch(TEST, plan, &header.rules, header.record_bytes, header.test)?);
    Ok(all)
}

fn header(bytes: &[u8]) -> Result<(Header, &[u8])> {
    let word = |at: usize| bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word));
    let (Some(format), Some(length)) = (word(8), word(12)) else {
        return damaged(format!("the log ends after {} bytes, before its header", bytes.len())).fail();
    };
    if bytes[..8] != MAGIC {
        return damaged("this file is not a log of a run".to_owned()).fail();
    }
    if ![FORMAT, FORMAT_OF_LEGS, FORMAT_OF_WORLDS, FORMAT_OF_SEGMENTS].contains(&format) {
        let message =
            format!("the log has format {format}, this engine reads formats {FORMAT} to {FORMAT_OF_SEGMENTS}");
        let error = Diagnostic::new("E-LOG-FILE", message);
        return error.help("read it with the engine that wrote it, or run the behaviour again").fail();
    }
    let end = PREFIX_BYTES + length as usize;
    let (Some(all_before), Some(sum)) = (bytes.get(..end), bytes.get(end..end + DIGEST_BYTES)) else {
        return damaged(format!("the log ends after {} bytes, inside its header", bytes.len())).fail();
    };
    if Digest::of(all_before).bytes() != sum {
        return damaged("the log's header does not match its checksum".to_owned()).fail();
    }
    let header: Header = serde_json::from_slice(&all_before[PREFIX_BYTES..])
        .map_err(|error| Box::new(damaged(format!("the log's header cannot be read: {error}"))))?;
    if header.segments.is_empty() != (format != FORMAT_OF_SEGMENTS) {
        return damaged(format!("a log of format {format} cannot have {} segments", header.segments.len())).fail();
    }
    if format < FORMAT_OF_WORLDS && header.earlier.is_empty() != (format == FORMAT) {
        return damaged(format!("a log of format {format} cannot have {} earlier legs", header.earlier.len())).fail();
    }
    Ok((header, &bytes[end + DIGEST_BYTES..]))
}

/// The run that a log names, and where its last digest stands, from the beginning of its file; nothing if that is no log.
pub(in crate::store) fn log_names(start: &[u8]) -> Option<(String, LogEnd)> {
    let (header, _) = header(start).ok()?;
    let earlier: usize = header.earlier.iter().map(|leg| leg.learning.records).sum();
    let end = match (header.segments.last(), header.test.records, earlier + header.learning.records) {
        (Some(last), 0, _) => LogEnd::Known(*last.sha256.bytes()),
        (_, test, learning) if test + learning > 0 => LogEnd::OfFile,
        _ => LogEnd::Known([0; DIGEST_BYTES]),
    };
    Some((header.run_sha256, end))
}

/// Where the digest of a log's last chunk stands.
pub(in crate::store) enum LogEnd {
    /// At the end of the file.
    OfFile,
    /// It is known from the header.
    Known([u8; DIGEST_BYTES]),
}

/// Bytes of a phase's chunks with their digests; nothing if no file can be so long.
fn phase_bytes(phase: PhaseEntry, record_bytes: usize) -> Option<usize> {
    let possible = phase.records as u64 <= phase.steps.min(MOST_STEPS);
    let digests = phase.records.div_ceil(CHUNK_STEPS).checked_mul(DIGEST_BYTES)?;
    possible.then_some(phase.records)?.checked_mul(record_bytes)?.checked_add(digests)
}

fn check_length(stretches: &[RecordStretch], body: &[u8]) -> Result<()> {
    let wanted = stretches.iter().try_fold(0_usize, |sum, RecordStretch { phase, shape, .. }| {
        sum.checked_add(phase_bytes(*phase, shape.bytes())?)
    });
    let Some(wanted) = wanted else {
        return damaged("the log's header counts more steps than a log can hold".to_owned()).fail();
    };
    if body.len() == wanted {
        return Ok(());
    }
    let message = if body.len() < wanted {
        format!("the log is cut: it ends {} bytes before its last step", wanted - body.len())
    } else {
        format!("the log has {} bytes after its last step", body.len() - wanted)
    };
    damaged(message).fail()
}

/// The records of one phase, taken from the front of `rest`, which is long enough.
fn phase_records(
    rest: &mut &[u8],
    phase: PhaseEntry,
    record_bytes: usize,
    before: &mut [u8; DIGEST_BYTES],
    name: &str,
) -> Result<Vec<u8>> {
    let mut records = Vec::with_capacity(phase.records * record_bytes);
    while records.len() < phase.records * record_bytes {
        let length = (phase.records * record_bytes - records.len()).min(CHUNK_STEPS * record_bytes);
        let (chunk, tail) = rest.split_at(length);
        let (sum, tail) = tail.split_at(DIGEST_BYTES);
        *before = chained(before, chunk);
        if *before != sum {
            let first = records.len() / record_bytes;
            let last = first + length / record_bytes - 1;
            let message = format!("steps {first} to {last} of {name} in the log do not match their checksum");
            return damaged(message).fail();
        }
        records.extend_from_slice(chunk);
        *rest = tail;
    }
    Ok(records)
}

/// What the numbers of a record can be: a checksum can be made to fit, and what is used as a number of a state, an action or a beam
/// must be one.
pub(super) struct Possible {
    states: usize,
    actions: usize,
    beams: usize,
    worlds: usize,
}

impl Possible {
    pub(super) fn of(plan: &Plan) -> Result<Self> {
        let (states, actions) = (plan.state_map()?.states(), plan.motions().len());
        Ok(Self { states, actions, beams: plan.settings.laser.beams as usize, worlds: plan.worlds.layouts().len() })
    }

    fn holds(&self, record: &Record) -> bool {
        let prey = record.prey.unwrap_or_default();
        let wide = [record.reward, record.pose.x_m, record.pose.y_m, record.pose.yaw_rad];
        let narrow = [record.z_m, record.nearest_m, record.coverage, prey[0], prey[1], prey[2]];
        (record.state as usize) < self.states
            && (record.next_state as usize) < self.states
            && usize::from(record.action) < self.actions
            && usize::from(record.nearest_beam) < self.beams
            && record.beam.is_none_or(|beam| usize::from(beam) < self.beams)
            && wide.iter().all(|number| number.is_finite())
            && narrow.iter().all(|number| number.is_finite())
    }

    /// Checks the records of a ledger, the first of which is that of the step `first`.
    pub(super) fn check(&self, ledger: &Ledger, first: u64, name: &str) -> Result<()> {
        let was_there = |step: usize| {
            ledger.attempt(step).is_none_or(|attempt| {
                attempt.world < self.worlds && attempt.drawn.iter().all(|drawn| drawn.is_finite())
            })
        };
        let wrong = ledger.records().enumerate().find(|(step, record)| {
            !self.holds(record) || !ledger.fired(*step).all(|(_, value)| value.is_finite()) || !was_there(*step)
        });
        let Some((step, _)) = wrong else { return Ok(()) };
        let step = first + step as u64;
        damaged(format!("step {step} of {name} in the log is not one that the run can have done")).fail()
    }
}
