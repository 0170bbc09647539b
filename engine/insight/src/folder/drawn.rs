//! What a run's folder shows to people, drawn again and compared with what stands there.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::certificate::without_certificate;
use super::pages::PAGE_FILE;
use super::{RunFolder, SeedResult};
use crate::lint::Report;
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::Plan;

/// The pictures and pages of a run, beside those that come out of it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Redrawn {
    /// How many are the same, byte for byte.
    pub same: usize,
    /// Those that differ, as paths within the folder.
    pub different: Vec<PathBuf>,
    /// Those that are not there, as paths within the folder.
    pub missing: Vec<PathBuf>,
}

impl RunFolder {
    /// The folder of a run that is done; `many` if each seed has a folder of its own in it.
    #[must_use]
    pub fn of_run(path: &Path, many: bool) -> Self {
        Self::elsewhere(path, path, many)
    }

    pub(super) fn elsewhere(work: &Path, logs: &Path, many: bool) -> Self {
        let (path, work, logs) = (logs.to_owned(), work.to_owned(), logs.to_owned());
        let (broken, marked) = (AtomicBool::new(false), AtomicBool::new(false));
        Self { path, work, logs, staged: None, many, broken, marked }
    }

    /// Whether its page shows what a check of the script found.
    #[must_use]
    pub fn shows_check(&self) -> bool {
        let pages = crate::store::seed_folders(&self.path).unwrap_or_default().into_iter().map(|(_, folder)| folder);
        let mut pages = pages.chain([self.path.clone()]).filter_map(|of| std::fs::read(of.join(PAGE_FILE)).ok());
        pages.any(|page| !page.windows(UNCHECKED.len()).any(|bytes| bytes == UNCHECKED))
    }

    /// Draws everything again, as [`Self::write`] did, and compares it. Nothing in the folder changes.
    ///
    /// # Errors
    /// If something cannot be drawn, a log not be read, or a folder for scratch not be made.
    pub fn redraw(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<Redrawn> {
        let disk = |error: &std::io::Error| Diagnostic::disk("make a folder in", &std::env::temp_dir(), error);
        let scratch = tempfile::tempdir().map_err(|error| Box::new(disk(&error)))?;
        let again = Self::elsewhere(scratch.path(), &self.path, self.many);
        again.show(plan, results, checked)?;
        let mut redrawn = Redrawn::default();
        for file in files(scratch.path(), Path::new(""))? {
            let read = |folder: &Path| std::fs::read(folder.join(&file));
            match (read(&self.path), read(scratch.path())) {
                (Err(error), _) if error.kind() == std::io::ErrorKind::NotFound => redrawn.missing.push(file),
                (Ok(old), Ok(new)) if old == new || is_page_of(&old, &new) => redrawn.same += 1,
                _ => redrawn.different.push(file),
            }
        }
        Ok(redrawn)
    }
}

/// Whether a page is another one with a certificate in it, which 'engine certify --again' draws again.
fn is_page_of(old: &[u8], new: &[u8]) -> bool {
    std::str::from_utf8(old).is_ok_and(|old| without_certificate(old).as_bytes() == new)
}

/// Stands in the data of a page without a check; in a text of the data it would have backslashes.
const UNCHECKED: &[u8] = br#""checked":null"#;

/// All files under a folder, in the order of their names.
fn files(folder: &Path, within: &Path) -> Result<Vec<PathBuf>> {
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("read the folder", folder, &error));
    let entries = std::fs::read_dir(folder.join(within)).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let mut found = Vec::new();
    for entry in entries.map_err(disk)? {
        let path = within.join(entry.file_name());
        if folder.join(&path).is_dir() {
            found.extend(files(folder, &path)?);
        } else {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
