//! What strangers' bytes are fed to, one function for each reader: called by the fuzzers of this folder, and over the corpus and
//! mutants of it by `tests/fuzzed.rs`. A target fails by panicking; an error is what a reader is for.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

use engine::diagnostic::SourceText;
use engine::experiment::{Kept, Ledger, Overrides, Plan, RunLog, learn_into, test_and_watch};
use engine::filter::Catalogue;
use engine::script::Behaviour;
use engine::sensors::photograph_of;
use engine::settings::BodyShape;
use engine::world::Layout;
use insight::store::{CHECKPOINT_FILE, CheckpointWriter, RUN_FILE, STEPS_FILE, StoredCheckpoint, StoredPolicy};
use insight::store::{log_to_bytes, plan_of_run, policy_from_toml, policy_to_toml, read_log, run_to_toml};
use pack::{Pack, Signature, Statement, archive};
use sha2::{Digest, Sha256};

/// A reader of bytes.
pub(crate) type Target = fn(&[u8]);

/// Every reader, with the name of its folder in the corpus.
pub(crate) const TARGETS: [(&str, Target); 9] = [
    ("script", script),
    ("world", world),
    ("run", run),
    ("policy", policy),
    ("log", log),
    ("pack", pack),
    ("wire", wire),
    ("image", image),
    ("checkpoint", checkpoint),
];

/// The script of the runs in the corpus, and their seed.
pub(crate) const SCRIPT: &str = "scripts/wall.rhai";
pub(crate) const SEED: u64 = 1;
/// Their settings: a fuzzer likes small files.
pub(crate) const STEPS: u64 = 400;
pub(crate) const TEST_STEPS: &str = "run.test_steps=200";

fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().find(|folder| folder.join(SCRIPT).is_file()).unwrap_or(own).to_owned()
}

/// The plan of the runs in the corpus, and the text of their `run.toml`.
fn plan() -> &'static (Plan, String) {
    static PLAN: OnceLock<(Plan, String)> = OnceLock::new();
    PLAN.get_or_init(|| {
        let set = vec![TEST_STEPS.to_owned()];
        let overrides = Overrides { steps: Some(STEPS), set, ..Overrides::default() };
        let plan = Plan::load(&root().join(SCRIPT), &overrides, || Ok(Arc::new(Catalogue::linked_in()))).unwrap();
        let text = run_to_toml(&plan, SEED).unwrap();
        (plan, text)
    })
}

fn text(bytes: &[u8]) -> Option<SourceText> {
    Some(SourceText::new("fuzz", std::str::from_utf8(bytes).ok()?))
}

/// A script: parsed, tried, and each mistake shown.
pub(crate) fn script(bytes: &[u8]) {
    let Some(source) = text(bytes) else { return };
    if let Err(wrong) = Behaviour::parse("fuzz", source) {
        shown(&wrong.render(false));
    }
}

/// A world file.
pub(crate) fn world(bytes: &[u8]) {
    let Some(source) = text(bytes) else { return };
    if let Err(wrong) = Layout::parse(source, &BodyShape::pioneer2at()) {
        shown(&wrong.render(false));
    }
}

/// `run.toml`.
pub(crate) fn run(bytes: &[u8]) {
    let folder = scratch();
    std::fs::write(folder.join(RUN_FILE), bytes).unwrap();
    if let Err(wrong) = plan_of_run(&folder, Arc::new(Catalogue::linked_in())) {
        shown(&wrong.render(false));
    }
}

/// `policy.toml`: by itself, and as that of the run in the corpus.
pub(crate) fn policy(bytes: &[u8]) {
    let Some(source) = text(bytes) else { return };
    drop(StoredPolicy::parse(&source));
    if let Err(wrong) = policy_from_toml(&source, &plan().0) {
        shown(&wrong.render(false));
    }
}

/// `log.bin` of the run in the corpus.
pub(crate) fn log(bytes: &[u8]) {
    let (plan, run) = plan();
    drop(read_log(bytes, plan, SEED, run));
}

/// A pack: refused with an error, or read and then written again as the same bytes. Its bytes are tried as a signature and as a
/// statement on keys too, which are read before anything is trusted.
pub(crate) fn pack(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        drop(Signature::parse(text));
        drop(Statement::open(text));
    }
    let Ok(pack) = Pack::parse(Path::new("fuzz.pack"), bytes.to_vec()) else { return };
    let mut files: Vec<(&str, &[u8])> = pack.files().collect();
    files.sort_by_key(|(path, _)| (*path != "manifest.toml", *path));
    let mut again = Vec::new();
    archive::write(files, &mut again).unwrap();
    assert!(again == bytes, "a pack has one form");
}

/// What the worker of an isolated filter answers.
pub(crate) fn wire(bytes: &[u8]) {
    let _ = engine::filter::count_replies(bytes);
}

/// A PNG or JPEG file.
pub(crate) fn image(bytes: &[u8]) {
    if let Ok(image) = photograph_of(Path::new("fuzz.png"), bytes, 16, 12) {
        assert_eq!(image.pixels.len(), 16 * 12 * 3);
    }
}

/// `checkpoint.bin`: as it is, and with the digest that belongs to its bytes, or no mutant would come past that.
pub(crate) fn checkpoint(bytes: &[u8]) {
    let run = &plan().1;
    let folder = scratch();
    let body = &bytes[..bytes.len().saturating_sub(32)];
    std::fs::write(folder.join(STEPS_FILE), b"").unwrap();
    for forged in [bytes.to_vec(), [body, &Sha256::digest(body)].concat()] {
        std::fs::write(folder.join(CHECKPOINT_FILE), forged).unwrap();
        drop(StoredCheckpoint::read(&folder, run, SEED));
    }
}

/// What a target begins from: the files of `seeds/NAME`, those that ship, and what the run of the corpus leaves.
pub(crate) fn corpus(name: &str) -> Vec<Vec<u8>> {
    let ships = match name {
        "script" => "scripts",
        "world" => "worlds",
        _ => "",
    };
    let folders = [format!("tests/fuzz/seeds/{name}"), ships.to_owned()];
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in folders.iter().filter(|folder| !folder.is_empty()) {
        let Ok(entries) = std::fs::read_dir(root().join(folder)) else { continue };
        files.extend(entries.filter_map(|entry| Some(entry.ok()?.path())));
    }
    files.retain(|path| path.is_file() && path.extension().is_none_or(|ending| ending != "md"));
    files.sort();
    let read = files.iter().map(|path| std::fs::read(path).unwrap());
    read.chain(made(name)).collect()
}

/// What the run of the corpus leaves for a target.
fn made(name: &str) -> Option<Vec<u8>> {
    let (plan, run) = plan();
    match name {
        "run" => Some(run.clone().into_bytes()),
        "policy" | "log" => {
            let stop = AtomicBool::new(false);
            let steps = plan.settings.run.test_steps;
            let (mut learning, mut test) = (Ledger::new(plan, STEPS), Ledger::new(plan, steps));
            let learned = learn_into(plan, SEED, &stop, &|_| (), &mut learning).unwrap();
            if name == "policy" {
                return Some(policy_to_toml(plan, &learned.policy, Some(run)).unwrap().into_bytes());
            }
            test_and_watch(plan, &learned.policy, SEED, &stop, &mut test).unwrap();
            Some(log_to_bytes(&RunLog { learning, test }, plan, SEED, run, u64::MAX).unwrap())
        }
        // Two frames of 12 bytes, and a refusal.
        "wire" => {
            Some([&[0, 12, 0, 0, 0], &[7; 12][..], &[0, 12, 0, 0, 0], &[9; 12], &[1, 2, 0, 0, 0], b"no"].concat())
        }
        "checkpoint" => Some(empty_checkpoint()),
        _ => None,
    }
}

/// A checkpoint of that run before its first step.
fn empty_checkpoint() -> Vec<u8> {
    let folder = scratch();
    let run = &plan().1;
    let mut writer = CheckpointWriter::new(&folder, run, SEED, None).unwrap();
    writer.keep(Kept { steps: 0, records: &[], tail: &[], state: &[5; 64] }).unwrap();
    std::fs::read(folder.join(CHECKPOINT_FILE)).unwrap()
}

/// What a person is shown controls no terminal.
fn shown(words: &str) {
    let shown = engine::diagnostic::for_terminal(words);
    assert!(!shown.chars().any(|c| engine::diagnostic::is_hidden(c) && !matches!(c, '\n' | '\t')), "{shown:?}");
}

/// A folder of this process, written over again and again.
fn scratch() -> PathBuf {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| tempfile::tempdir().unwrap()).path().to_owned()
}
