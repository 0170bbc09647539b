//! Which files a behaviour depends on, and when one of them was saved.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use sha2::{Digest, Sha256};

use crate::diagnostic::{Diagnostic, Kind, Result};

/// Watches the folders of some files: editors replace files, so a watch on the file itself would go with the old one.
pub(super) struct Files {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
    /// Each with the digest of what it held last; none of a file that cannot be read.
    files: BTreeMap<PathBuf, Option<[u8; 32]>>,
}

impl Files {
    /// Calls `changed` whenever anything in a watched folder was written.
    ///
    /// # Errors
    /// If the system cannot watch files.
    pub(super) fn new(changed: impl Fn() + Send + 'static) -> Result<Self> {
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            if event.is_ok_and(|event| !matches!(event.kind, EventKind::Access(_))) {
                changed();
            }
        });
        let watcher = watcher.map_err(|error| failed(&error))?;
        Ok(Self { watcher, folders: BTreeSet::new(), files: BTreeMap::new() })
    }

    /// Watches these files too.
    ///
    /// # Errors
    /// If a folder cannot be watched.
    pub(super) fn watch(&mut self, files: impl IntoIterator<Item = PathBuf>) -> Result<()> {
        for file in files {
            let folder = match file.parent() {
                Some(folder) if folder != Path::new("") => folder.to_owned(),
                _ => PathBuf::from("."),
            };
            if !self.folders.contains(&folder) {
                self.watcher.watch(&folder, RecursiveMode::NonRecursive).map_err(|error| failed(&error))?;
                self.folders.insert(folder);
            }
            self.files.entry(file).or_insert_with_key(|file| digest(file));
        }
        Ok(())
    }

    /// Whether any of the files holds something else than when this was asked last.
    pub(super) fn changed(&mut self) -> bool {
        let mut changed = false;
        for (file, known) in &mut self.files {
            let now = digest(file);
            changed |= now != *known;
            *known = now;
        }
        changed
    }
}

fn digest(file: &Path) -> Option<[u8; 32]> {
    std::fs::read(file).ok().map(|content| Sha256::digest(content).into())
}

fn failed(error: &notify::Error) -> Box<Diagnostic> {
    let message = format!("cannot watch the files of the behaviour: {error}");
    Box::new(Diagnostic::new(Kind::Disk, "E-WATCH-FILES", message).help("close other programs that watch many files"))
}
