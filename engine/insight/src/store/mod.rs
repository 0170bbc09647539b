//! Files that a run leaves and that a later command reads.

mod checkpoint;
mod filter_entry;
mod going_on;
mod log;
mod members;
mod parts;
mod policy_file;
mod run_file;
mod used;

pub use checkpoint::{CHECKPOINT_FILE, CheckpointWriter, STEPS_FILE, StoredCheckpoint};
pub use going_on::going_on_from;
pub(crate) use log::settle;
pub use log::{LOG_FILE, MAGIC, RecordedRun, SegmentWriter, is_segment_file, log_to_bytes, read_log, segment_file};
pub use members::{PolicyText, policy_files, with_policies, with_policies_or, with_policy_texts};
pub use parts::{RUN_FILE, SUMMARY_FILE, seed_folders};
pub(crate) use parts::{TAG_FILE, check_policy, script_of};
pub use policy_file::{POLICY_FILE, StoredPolicy, policy_from_toml, policy_to_toml};
pub use run_file::{StoredRun, plan_of_run, run_to_toml};

use crate::disk::read_file;
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use std::path::Path;

/// The largest stored file that is read, bytes.
const MAX_BYTES: u64 = 256 << 20;
/// Of the runs in a folder so many are named.
const MOST_NAMED: usize = 12;

/// Reads a text file of a stored run.
///
/// # Errors
/// If it is missing, too large or not text: exit status 7, since a run that lacks it does not fit.
pub fn read_stored(path: &Path) -> Result<SourceText> {
    let unfit = |message: String| Diagnostic::new("E-RUN-FILE", message).help(which_run(path));
    let failed = |error: &std::io::Error| Box::new(unfit(Diagnostic::disk("read", path, error).message));
    let bytes = read_file(path, MAX_BYTES).map_err(|error| failed(&error))?;
    let text = String::from_utf8(bytes).map_err(|_| failed(&std::io::Error::other("it is not text in UTF-8")))?;
    Ok(SourceText::new(path, text))
}

/// Which folder to give instead of one without this file: the runs that stand in it, if there are any.
fn which_run(missing: &Path) -> String {
    let folder = missing.parent().unwrap_or(Path::new("."));
    let is_run = |entry: &std::fs::DirEntry| entry.path().join(RUN_FILE).is_file();
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().filter(is_run);
    let mut runs: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    // 2 before 10.
    runs.sort_by(|a, b| a.len().cmp(&b.len()).then_with(|| a.cmp(b)));
    let Some(first) = runs.first() else { return "give the folder of a finished run, such as runs/wall/1".to_owned() };
    let (shown, more) = (runs.len().min(MOST_NAMED), runs.len().saturating_sub(MOST_NAMED));
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let first = printable(&folder.join(first).display().to_string());
    format!("it holds the runs {}{more}: write {first}", printable(&runs[..shown].join(", ")))
}

/// A TOML error as a diagnostic that points into the file.
fn toml_error(source: &SourceText, error: &toml::de::Error) -> Box<Diagnostic> {
    let span = error.span().unwrap_or(0..0);
    let message = format!("'{}' is not a stored run of this engine", source.path.display());
    Box::new(Diagnostic::new("E-RUN-FILE", message).at(source, span, error.message().to_owned()))
}
