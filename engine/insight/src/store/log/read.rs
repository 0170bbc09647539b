//! A log file read back: nothing in it is believed before it is checked.

use super::{FORMAT, FORMAT_OF_LEGS, FORMAT_OF_WORLDS, Header, MAGIC, PREFIX_BYTES, PhaseEntry, RuleEntry, damaged};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::digest::Digest;
use engine::experiment::{
    CHUNK_STEPS, DIGEST_BYTES, Ledger, LedgerLeg, MOST_STEPS, Plan, Record, RecordShape, RunLog, chained,
};

/// Reads the bytes of a log that must belong to a plan under a seed, whose `run.toml` has the text `run`.
///
/// # Errors
/// `E-LOG-FILE` if the file is no log, of another format, cut, changed, or holds what the plan cannot have done;
/// `E-LOG-RUN` if it belongs to another run.
pub fn read_log(bytes: &[u8], plan: &Plan, seed: u64, run: &str) -> Result<RunLog> {
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
    for RecordStretch { name, phase, shape } in stretches {
        let bytes = phase_records(&mut rest, phase, shape.bytes(), &mut before, name)?;
        legs.push(LedgerLeg { shape, bytes, steps: phase.steps });
    }
    let test = legs.pop().and_then(|leg| Ledger::from_legs(vec![leg]));
    let Some((learning, test)) = Ledger::from_legs(legs).zip(test) else {
        return damaged("the log's counts do not fit its records".to_owned()).fail();
    };
    let log = RunLog { learning, test };
    check_records(&log, plan)?;
    Ok(log)
}

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
        all.push(stretch("learning", &leg.plan, &entry.rules, entry.record_bytes, entry.learning)?);
    }
    all.push(stretch("learning", plan, &header.rules, header.record_bytes, header.learning)?);
    all.push(stretch("the test", plan, &header.rules, header.record_bytes, header.test)?);
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
    if ![FORMAT, FORMAT_OF_LEGS, FORMAT_OF_WORLDS].contains(&format) {
        let message = format!("the log has format {format}, this engine reads formats {FORMAT} to {FORMAT_OF_WORLDS}");
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
    if format != FORMAT_OF_WORLDS && header.earlier.is_empty() != (format == FORMAT) {
        return damaged(format!("a log of format {format} cannot have {} earlier legs", header.earlier.len())).fail();
    }
    Ok((header, &bytes[end + DIGEST_BYTES..]))
}

/// The run that a log names, and how many records it holds, from the beginning of its file; nothing if that is no log.
pub(in crate::store) fn log_names(start: &[u8]) -> Option<(String, usize)> {
    let (header, _) = header(start).ok()?;
    let earlier: usize = header.earlier.iter().map(|leg| leg.learning.records).sum();
    Some((header.run_sha256, earlier + header.learning.records + header.test.records))
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

/// A checksum can be made to fit: what is used as a number of a state, an action or a beam must be one.
fn check_records(log: &RunLog, plan: &Plan) -> Result<()> {
    let (states, actions) = (plan.state_map()?.states(), plan.motions().len());
    let beams = plan.settings.laser.beams as usize;
    let is_possible = |record: &Record| {
        let prey = record.prey.unwrap_or_default();
        let wide = [record.reward, record.pose.x_m, record.pose.y_m, record.pose.yaw_rad];
        let narrow = [record.z_m, record.nearest_m, record.coverage, prey[0], prey[1], prey[2]];
        (record.state as usize) < states
            && (record.next_state as usize) < states
            && usize::from(record.action) < actions
            && usize::from(record.nearest_beam) < beams
            && record.beam.is_none_or(|beam| usize::from(beam) < beams)
            && wide.iter().all(|number| number.is_finite())
            && narrow.iter().all(|number| number.is_finite())
    };
    let worlds = plan.worlds.layouts().len();
    let was_there = |ledger: &Ledger, step: usize| {
        ledger
            .attempt(step)
            .is_none_or(|attempt| attempt.world < worlds && attempt.drawn.iter().all(|drawn| drawn.is_finite()))
    };
    for (name, ledger) in [("learning", &log.learning), ("the test", &log.test)] {
        let wrong = ledger.records().enumerate().find(|(step, record)| {
            !is_possible(record)
                || !ledger.fired(*step).all(|(_, value)| value.is_finite())
                || !was_there(ledger, *step)
        });
        if let Some((step, _)) = wrong {
            return damaged(format!("step {step} of {name} in the log is not one that the run can have done")).fail();
        }
    }
    Ok(())
}
