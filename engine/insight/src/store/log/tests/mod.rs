//! Logs written and read back; logs that were damaged.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};

use proptest::prelude::*;
use sha2::{Digest, Sha256};

mod legs;

use super::{PREFIX_BYTES, log_to_bytes, read_log};
use engine::diagnostic::{Kind, Result, SourceText};
use engine::digest::hex;
use engine::experiment::{DIGEST_BYTES, Ledger, LedgerLeg, Plan, RunLog, learn_into, test_and_watch};
use engine::filter::Catalogue;
use engine::script::Behaviour;
use engine::world::Layout;

const WORLD: &str = "[[wall]]\npoints_m = [[0, 0], [4, 0], [4, 4], [0, 4]]\nclosed = true\n\
                     [[start]]\nposition_m = [2, 2]\n";
const SCRIPT: &str = "recovery(\"start\");\n\
                      rule \"too close\" when laser.nearest <= 0.4 => -1 then recover;\n\
                      rule \"fast\" when action.linear > 0.2 => action.linear;\n";
const RUN: &str = "what run.toml says";
const SEED: u64 = 4;

struct Sample {
    plan: Plan,
    log: RunLog,
    file: Vec<u8>,
}

/// 1,200 steps of learning, so that there are two chunks, and 40 of the test.
static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let behaviour = Behaviour::parse("log", SourceText::new("log.rhai", SCRIPT)).unwrap();
    let mut settings = behaviour.settings().clone();
    let layout = Arc::new(Layout::parse(SourceText::new("log.toml", WORLD), &settings.robot.body).unwrap());
    (settings.run.steps, settings.run.test_steps) = (1200, 40);
    let plan = Plan::with_layout(Arc::new(behaviour), settings, layout, Arc::new(Catalogue::linked_in())).unwrap();
    let (mut learning, mut test) = (Ledger::new(&plan, 1200), Ledger::new(&plan, 40));
    let stop = AtomicBool::new(false);
    let learned = learn_into(&plan, SEED, &stop, &|_| (), &mut learning).unwrap();
    test_and_watch(&plan, &learned.policy, SEED, &stop, &mut test).unwrap();
    let log = RunLog { learning, test };
    let file = log_to_bytes(&log, &plan, SEED, RUN, 0).unwrap();
    Sample { plan, log, file }
});

fn ledger(bytes: Vec<u8>, steps: u64) -> Ledger {
    Ledger::from_legs(vec![LedgerLeg { shape: SAMPLE.log.test.shape().clone(), bytes, steps }]).unwrap()
}

fn bytes_of(ledger: &Ledger) -> Vec<u8> {
    ledger.legs().next().unwrap().1.to_vec()
}

fn read(bytes: &[u8]) -> Result<RunLog> {
    read_log(bytes, &SAMPLE.plan, SEED, RUN)
}

fn message(bytes: &[u8]) -> String {
    let error = read(bytes).unwrap_err();
    assert_eq!((error.code, error.kind()), ("E-LOG-FILE", Kind::State), "{}", error.message);
    error.message
}

/// The header changed, with a checksum that fits again.
fn with_header(change: impl Fn(String) -> String) -> Vec<u8> {
    let file = &SAMPLE.file;
    let length = u32::from_le_bytes(*file[12..].first_chunk().unwrap()) as usize;
    let header = change(String::from_utf8(file[PREFIX_BYTES..PREFIX_BYTES + length].to_vec()).unwrap());
    let mut changed = file[..12].to_vec();
    changed.extend_from_slice(&(header.len() as u32).to_le_bytes());
    changed.extend_from_slice(header.as_bytes());
    let sum = Sha256::digest(&changed);
    changed.extend_from_slice(&sum);
    changed.extend_from_slice(&file[PREFIX_BYTES + length + DIGEST_BYTES..]);
    changed
}

#[test]
fn a_log_comes_back_as_it_was_written() {
    assert_eq!(read(&SAMPLE.file).unwrap(), SAMPLE.log);
    assert_eq!(SAMPLE.log.learning.shape().bytes(), 88);
}

#[test]
fn a_log_that_holds_only_the_beginning_of_a_run_knows_how_long_the_run_was() {
    let learning = ledger(bytes_of(&SAMPLE.log.learning), 9_000_000);
    let file = log_to_bytes(&RunLog { learning, test: SAMPLE.log.test.clone() }, &SAMPLE.plan, SEED, RUN, 0).unwrap();
    let read = read(&file).unwrap().learning;
    assert_eq!((read.len(), read.steps()), (1200, 9_000_000));
}

#[test]
fn the_last_digest_of_the_file_is_the_digest_of_the_log() {
    let tail = &SAMPLE.file[SAMPLE.file.len() - DIGEST_BYTES..];
    assert_eq!(hex(tail), SAMPLE.log.sha256());
}

#[test]
fn a_log_that_is_cut_after_any_record_is_refused() {
    let records = 1200 + 40;
    let body = SAMPLE.file.len() - records * 88 - 3 * DIGEST_BYTES;
    for record in 0..records {
        message(&SAMPLE.file[..body + record * 88]);
    }
    for length in 0..body {
        message(&SAMPLE.file[..length]);
    }
    assert!(message(&SAMPLE.file[..SAMPLE.file.len() - 1]).contains("it ends 1 bytes before its last step"));
}

#[test]
fn a_changed_record_is_named_by_its_steps() {
    let mut file = SAMPLE.file.clone();
    let in_the_test = file.len() - DIGEST_BYTES - 1;
    file[in_the_test] ^= 1;
    assert_eq!(message(&file), "steps 0 to 39 of the test in the log do not match their checksum");
    let mut file = SAMPLE.file.clone();
    let in_learning = file.len() - 2 * DIGEST_BYTES - 40 * 88 - 1;
    file[in_learning] ^= 1;
    assert_eq!(message(&file), "steps 1024 to 1199 of learning in the log do not match their checksum");
}

#[test]
fn another_format_is_said_with_both_numbers() {
    let mut file = SAMPLE.file.clone();
    file[8] = 9;
    assert_eq!(message(&file), "the log has format 9, this engine reads formats 1 to 4");
}

#[test]
fn a_log_of_another_run_is_refused() {
    let error = read_log(&SAMPLE.file, &SAMPLE.plan, SEED, "another run.toml").unwrap_err();
    assert_eq!((error.code, error.kind()), ("E-LOG-RUN", Kind::State));
    assert_eq!(read_log(&SAMPLE.file, &SAMPLE.plan, SEED + 1, RUN).unwrap_err().code, "E-LOG-RUN");
}

#[test]
fn counts_that_no_file_can_hold_are_refused_before_anything_is_made_for_them() {
    for records in ["1201", "18446744073709551615", "100000000000000", "1048577"] {
        let counts = format!("\"learning\":{{\"steps\":18446744073709551615,\"records\":{records}}}");
        message(&with_header(|header| header.replace("\"learning\":{\"steps\":1200,\"records\":1200}", &counts)));
    }
    message(&with_header(|header| header.replace("\"record_bytes\":88", "\"record_bytes\":0")));
    message(&with_header(|header| header.replace("\"record_bytes\":88", "\"record_bytes\":9000000000000000000")));
    message(&with_header(|header| {
        header.replace("{\"name\":\"fast\",\"value\":null}", "{\"name\":\"fast\",\"value\":1.0}")
    }));
    message(&with_header(|_| "[".repeat(100_000)));
}

#[test]
fn a_state_that_the_grid_does_not_have_is_refused_even_with_a_checksum_that_fits() {
    let mut bytes = bytes_of(&SAMPLE.log.test);
    bytes[88 * 7 + 32..][..4].copy_from_slice(&64_u32.to_le_bytes());
    let test = ledger(bytes, 40);
    let log = RunLog { learning: SAMPLE.log.learning.clone(), test };
    let file = log_to_bytes(&log, &SAMPLE.plan, SEED, RUN, 0).unwrap();
    assert_eq!(message(&file), "step 7 of the test in the log is not one that the run can have done");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn a_log_with_any_byte_changed_is_an_error_and_no_panic(at in 0..SAMPLE.file.len(), by in 1_u8..) {
        let mut file = SAMPLE.file.clone();
        file[at] ^= by;
        prop_assert!(read(&file).is_err());
    }

    #[test]
    fn a_log_of_any_bytes_is_an_error_and_no_panic(tail in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut file = SAMPLE.file[..12].to_vec();
        file.extend(tail);
        prop_assert!(read(&file).is_err());
    }

    #[test]
    fn records_of_any_bytes_with_checksums_that_fit_are_read_or_refused(
        bytes in proptest::collection::vec(any::<u8>(), 88 * 3),
    ) {
        let test = ledger(bytes, 3);
        let log = RunLog { learning: SAMPLE.log.learning.clone(), test };
        let file = log_to_bytes(&log, &SAMPLE.plan, SEED, RUN, 0).unwrap();
        if let Ok(read) = read(&file) {
            prop_assert_eq!(read.sha256(), log.sha256());
        }
    }
}
