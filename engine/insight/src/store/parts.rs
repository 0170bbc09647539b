//! Whether the files of a run's folder belong together: each names the run that it belongs to by the digest of `run.toml`.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::log::{LOG_FILE, LogEnd, log_names};
use super::policy_file::POLICY_FILE;
use super::read_stored;
use crate::disk::is_there;
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use engine::digest::{Digest, hex};
use engine::experiment::{DIGEST_BYTES, Decider};
use engine::learner::Policy;

/// The name of the file that all others of a run's folder name.
pub const RUN_FILE: &str = "run.toml";
/// The name of the file of figures.
pub const SUMMARY_FILE: &str = "summary.json";
/// The folders of the seeds of a run of many, in their order; none of a folder that is not there.
///
/// # Errors
/// If it cannot be told what stands there.
pub fn seed_folders(folder: &Path) -> Result<Vec<(u64, PathBuf)>> {
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("read the folder", folder, &error));
    let entries = match std::fs::read_dir(folder) {
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => return Ok(Vec::new()),
        entries => entries.map_err(disk)?,
    };
    let mut seeds = Vec::new();
    for entry in entries {
        let entry = entry.map_err(disk)?;
        if let Some(seed) = entry.file_name().to_str().and_then(|name| name.parse().ok())
            && is_there(&entry.path().join(RUN_FILE))?
        {
            seeds.push((seed, entry.path()));
        }
    }
    seeds.sort();
    Ok(seeds)
}

/// Of the text of a `run.toml`: the behaviour, the seed and the path of its script; nothing if it is none.
pub(crate) fn script_of(run: &str) -> Option<(String, u64, String)> {
    #[derive(Deserialize)]
    struct Named {
        behaviour: String,
        seed: u64,
        script: PathEntry,
    }
    #[derive(Deserialize)]
    struct PathEntry {
        path: String,
    }
    let Named { behaviour, seed, script } = toml::from_str(run).ok()?;
    Some((behaviour, seed, script.path))
}

/// The file that holds a run's tag.
pub(crate) const TAG_FILE: &str = "tag.txt";

/// The longest part of a log that is read to find out its run, bytes: prefix and header.
const MOST_HEADER_BYTES: u64 = 16 << 20;

/// What a summary names of the files beside it; older ones name less.
#[derive(Deserialize, Default)]
struct NamedParts {
    log_sha256: Option<String>,
    policy_sha256: Option<String>,
}

impl NamedParts {
    /// Of the summary in a folder; nothing is named where there is none, or none that can be read.
    fn in_folder(folder: &Path) -> Result<Self> {
        let path = folder.join(SUMMARY_FILE);
        if !is_there(&path)? {
            return Ok(Self::default());
        }
        Ok(serde_json::from_str(&read_stored(&path)?.text).unwrap_or_default())
    }
}

/// Checks that `log.bin` and `summary.json`, where they are there, belong to the run of this `run.toml`, and what it decides by
/// to the summary.
///
/// # Errors
/// `E-LOG-RUN` if one belongs to another run.
pub(super) fn check_parts(folder: &Path, run: &SourceText, decider: &Decider) -> Result<()> {
    let (path, named) = (folder.join(LOG_FILE), NamedParts::in_folder(folder)?);
    if let Some((log_run, log_end)) = of_log(&path) {
        if log_run != Digest::of(run.text.as_bytes()).to_string() {
            return other(&path, &run.path).fail();
        }
        if named.log_sha256.is_some_and(|named| named != log_end) {
            return other(&folder.join(SUMMARY_FILE), &path).fail();
        }
    }
    match decider {
        Decider::Learned(policy) => check_policy(folder, named.policy_sha256.as_deref(), policy),
        Decider::Combined => Ok(()),
    }
}

/// Checks that a policy from a folder has the values by whose digest a summary names it; one that names none fits all.
///
/// # Errors
/// `E-LOG-RUN` if it has others: those of another seed or run, or somebody changed them.
pub(crate) fn check_policy(folder: &Path, named: Option<&str>, policy: &Policy) -> Result<()> {
    let fits = named.is_none_or(|named| policy.digest().to_string() == named);
    if fits { Ok(()) } else { other_values(folder).fail() }
}

/// Checks the same of a policy that is named by its file, by the summary that stands beside it.
///
/// # Errors
/// `E-LOG-RUN` likewise.
pub(super) fn check_policy_of_file(file: &Path, policy: &Policy) -> Result<()> {
    let folder = file.parent().unwrap_or(Path::new(""));
    check_policy(folder, NamedParts::in_folder(folder)?.policy_sha256.as_deref(), policy)
}

fn other_values(folder: &Path) -> Diagnostic {
    let shown = |file: &str| printable(&folder.join(file).display().to_string());
    let message = format!("'{}' does not hold what '{}' was written for", shown(POLICY_FILE), shown(SUMMARY_FILE));
    Diagnostic::new("E-LOG-RUN", message).help(
        "it is of another seed or run, or was changed: put the run's own back, or run the behaviour again. A table of \
         your own can be tested in a folder with run.toml and policy.toml alone",
    )
}

/// Checks that a part that names a run names this one.
///
/// # Errors
/// `E-LOG-RUN` if it names another one, or none.
pub(super) fn belongs(part: &SourceText, named: Option<&str>, run: &SourceText) -> Result<()> {
    let run_sha256 = Digest::of(run.text.as_bytes()).to_string();
    if named == Some(run_sha256.as_str()) { Ok(()) } else { other(&part.path, &run.path).fail() }
}

fn other(part: &Path, run: &Path) -> Diagnostic {
    let shown = |path: &Path| printable(&path.display().to_string());
    let message = format!("'{}' does not belong to '{}': it names another run", shown(part), shown(run));
    Diagnostic::new("E-LOG-RUN", message).help("keep the files of one run together, or run the behaviour again")
}

/// The run that a log names, and the digest that it ends with; nothing if there is no log, or none that can be read: whoever
/// needs the log itself says what is wrong with it.
fn of_log(path: &Path) -> Option<(String, String)> {
    let mut file = File::open(path).ok().filter(|file| file.metadata().is_ok_and(|data| data.is_file()))?;
    let mut start = Vec::new();
    (&mut file).take(MOST_HEADER_BYTES).read_to_end(&mut start).ok()?;
    let (run, end) = log_names(&start)?;
    let end = match end {
        LogEnd::Known(end) => end,
        LogEnd::OfFile => {
            let mut end = [0; DIGEST_BYTES];
            file.seek(SeekFrom::End(-(DIGEST_BYTES as i64))).ok()?;
            file.read_exact(&mut end).ok()?;
            end
        }
    };
    Some((run, hex(&end)))
}
