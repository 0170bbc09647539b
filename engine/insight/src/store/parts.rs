//! Whether the files of a run's folder belong together: each names the run that it belongs to by the digest of `run.toml`.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::log::{LOG_FILE, LogEnd, log_names};
use super::read_stored;
use crate::disk::is_there;
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use engine::digest::{Digest, hex};
use engine::experiment::DIGEST_BYTES;

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

/// The file that holds a run's tag.
pub(crate) const TAG_FILE: &str = "tag.txt";

/// The longest part of a log that is read to find out its run, bytes: prefix and header.
const MOST_HEADER_BYTES: u64 = 16 << 20;

/// The run that a summary names.
#[derive(Deserialize)]
struct NamedLog {
    log_sha256: Option<String>,
}

/// Checks that `log.bin` and `summary.json`, where they are there, belong to the run of this `run.toml`.
///
/// # Errors
/// `E-LOG-RUN` if one belongs to another run.
pub(super) fn check_parts(folder: &Path, run: &SourceText) -> Result<()> {
    let path = folder.join(LOG_FILE);
    let Some((log_run, log_end)) = of_log(&path) else { return Ok(()) };
    if log_run != Digest::of(run.text.as_bytes()).to_string() {
        return other(&path, &run.path).fail();
    }
    let path = folder.join(SUMMARY_FILE);
    if !is_there(&path)? {
        return Ok(());
    }
    let text = read_stored(&path)?;
    let named = serde_json::from_str(&text.text).ok().and_then(|NamedLog { log_sha256 }| log_sha256);
    match named {
        Some(named) if named != log_end => other(&path, &folder.join(LOG_FILE)).fail(),
        _ => Ok(()),
    }
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
