//! A run with its log, read back from its folder.

use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

use super::read::read_whole;
use super::{LOG_FILE, damaged};
use crate::disk::{is_there, read_file};
use crate::store::{SUMMARY_FILE, StoredRun, check_policy, read_stored};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Decider, RunLog, Summary};
use engine::filter::Catalogue;

/// The longest log that is read, bytes: two phases of the most steps with a dozen reward functions each.
const MAX_BYTES: u64 = 512 << 20;

/// A run whose steps are known.
pub struct RecordedRun {
    /// Plan, seed and what decides.
    pub stored: StoredRun,
    /// Every step.
    pub log: RunLog,
    /// The figures as they were written; none of a run that a failure ended, which was not tested.
    pub summary: Option<Summary>,
}

impl RecordedRun {
    /// Reads `run.toml`, `policy.toml`, `log.bin` and `summary.json` of the folder of one seed,
    /// which may use these filters. Without steps of a test, the summary may be missing.
    ///
    /// # Errors
    /// If one is missing or damaged, or the four do not belong together.
    pub fn load(folder: &Path, filters: Arc<Catalogue>) -> Result<Self> {
        let (stored, run) = StoredRun::read(folder, filters)?;
        let path = folder.join(LOG_FILE);
        let bytes = read_bytes(&path)?;
        let mut log = read_whole(folder, &bytes, &stored.plan, stored.seed, &run.text).map_err(|mut error| {
            error.message = format!("'{}': {}", path.display(), error.message);
            error
        })?;
        log.learning.set_out_from(&stored.plan.kept_before(stored.seed)?);
        if let Decider::Learned(policy) = &stored.decider {
            log.test.set_out_from(policy.kept());
        }
        let path = folder.join(SUMMARY_FILE);
        if log.test.is_empty() && !log.learning.is_empty() && !is_there(&path)? {
            return Ok(Self { stored, log, summary: None });
        }
        let text = read_stored(&path)?;
        let summary: Summary = serde_json::from_str(&text.text).map_err(|error| {
            let message = format!("'{}' is not the summary of a run: {error}", text.path.display());
            Box::new(Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again"))
        })?;
        if summary.log_sha256.as_deref() != Some(log.sha256().as_str()) {
            let message = format!("'{}' is not the log that '{}' was written for", path.display(), text.path.display());
            let error = Diagnostic::new("E-LOG-RUN", message);
            return error.help("keep the files of one run together").fail();
        }
        if let Decider::Learned(policy) = &stored.decider {
            check_policy(folder, summary.policy_sha256.as_deref(), policy)?;
        }
        Ok(Self { stored, log, summary: Some(summary) })
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let unfit = |message: String| {
        Diagnostic::new("E-LOG-FILE", message)
            .help("give the folder of one seed, such as runs/wall/1 or runs/wall/1-30/7; an older run has no log: run it again")
    };
    match read_file(path, MAX_BYTES) {
        Ok(bytes) => Ok(bytes),
        Err(error) if error.kind() == ErrorKind::FileTooLarge => {
            damaged(format!("'{}' has more than {MAX_BYTES} bytes", path.display())).fail()
        }
        Err(error) if error.kind() == ErrorKind::InvalidInput => {
            unfit(format!("'{}' is not a file", path.display())).fail()
        }
        Err(error) => unfit(Diagnostic::disk("read", path, &error).message).fail(),
    }
}
