//! Files that a run leaves and that a later command reads.

mod log;
mod members;
mod policy_file;
mod run_file;

pub use log::{LOG_FILE, MAGIC, RecordedRun, RunLog, read_log};
pub use members::{load_members, members_from_texts, policy_files};
pub use policy_file::{StoredPolicy, policy_from_toml, policy_to_toml};
pub use run_file::{Decider, StoredRun, run_to_toml};

use engine::diagnostic::{Diagnostic, Result, SourceText};
use std::path::Path;

/// The largest stored file that is read, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Reads a text file of a stored run.
///
/// # Errors
/// If it is missing, too large or not text: exit status 7, since a run that lacks it does not fit.
pub fn read_stored(path: &Path) -> Result<SourceText> {
    let unfit = |message: String| {
        Diagnostic::new("E-RUN-FILE", message).help("give the folder of a finished run, such as runs/wall/1")
    };
    let length =
        std::fs::metadata(path).map_err(|error| Box::new(unfit(Diagnostic::disk("read", path, &error).message)))?.len();
    if length > MAX_BYTES {
        return unfit(format!("'{}' has {length} bytes, more than the limit of {MAX_BYTES}", path.display())).fail();
    }
    let text = std::fs::read_to_string(path)
        .map_err(|error| Box::new(unfit(Diagnostic::disk("read", path, &error).message)))?;
    Ok(SourceText::new(path, text))
}

/// A TOML error as a diagnostic that points into the file.
fn toml_error(source: &SourceText, error: &toml::de::Error) -> Box<Diagnostic> {
    let span = error.span().unwrap_or(0..0);
    let message = format!("'{}' is not a stored run of this engine", source.path.display());
    Box::new(Diagnostic::new("E-RUN-FILE", message).at(source, span, error.message().to_owned()))
}
