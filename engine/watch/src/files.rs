//! Which files a behaviour depends on, and when one of them was saved.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use engine::diagnostic::{Diagnostic, Result};
use engine::digest::Digest;
use engine::filter::is_filter_file;

/// A filter is linked in many writes; it is finished once it has not changed for so long.
pub(super) const SETTLE: Duration = Duration::from_millis(200);

/// What a look at the files tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct SeenFile {
    /// A file holds something else than at the last look.
    pub saved: bool,
    /// A filter is being written: it must be looked at again after [`SETTLE`].
    pub unfinished: bool,
}

/// Watches the folders of some files: editors replace files, so a watch on the file itself would go with the old one.
pub(super) struct Files {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
    contents: Contents,
}

/// What the files hold, without the watching.
#[derive(Debug, Default)]
struct Contents {
    /// Each with the digest of what it held last; none of a file that cannot be read.
    files: BTreeMap<PathBuf, Option<Digest>>,
    /// Folders whose filters count, whichever they are.
    filter_folders: BTreeSet<PathBuf>,
    /// The filters in them as they were when they were last finished.
    finished: BTreeMap<PathBuf, Digest>,
    /// What they held at the last look and since when, if that is something else.
    unfinished: Option<(Instant, BTreeMap<PathBuf, Digest>)>,
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
        Ok(Self { watcher, folders: BTreeSet::new(), contents: Contents::default() })
    }

    /// Watches these files too.
    ///
    /// # Errors
    /// If a folder cannot be watched.
    pub(super) fn watch(&mut self, files: impl IntoIterator<Item = PathBuf>) -> Result<()> {
        for file in files {
            self.watch_folder(match file.parent() {
                Some(folder) if folder != Path::new("") => folder,
                _ => Path::new("."),
            })?;
            self.contents.files.entry(file).or_insert_with_key(|file| digest(file));
        }
        Ok(())
    }

    /// Watches all filters in these folders, those that come later too.
    ///
    /// # Errors
    /// If a folder cannot be watched.
    pub(super) fn watch_filters(&mut self, folders: &[PathBuf]) -> Result<()> {
        for folder in folders {
            self.watch_folder(folder)?;
            self.contents.add_folder(folder);
        }
        Ok(())
    }

    /// What happened since this was asked last.
    pub(super) fn look(&mut self) -> SeenFile {
        self.contents.look(Instant::now())
    }

    fn watch_folder(&mut self, folder: &Path) -> Result<()> {
        if !self.folders.contains(folder) {
            self.watcher.watch(folder, RecursiveMode::NonRecursive).map_err(|error| failed(&error))?;
            self.folders.insert(folder.to_owned());
        }
        Ok(())
    }
}

impl Contents {
    fn add_folder(&mut self, folder: &Path) {
        self.filter_folders.insert(folder.to_owned());
        self.finished = self.filters();
    }

    /// A script is small and saved at once; half a library would be an error that means nothing.
    fn look(&mut self, now: Instant) -> SeenFile {
        let mut saved = false;
        for (file, known) in &mut self.files {
            let present = digest(file);
            saved |= present != *known;
            *known = present;
        }
        let filters = self.filters();
        let since = match self.unfinished.take() {
            Some((since, known)) if known == filters => since,
            _ => now,
        };
        if filters != self.finished {
            if now.duration_since(since) < SETTLE {
                self.unfinished = Some((since, filters));
                return SeenFile { saved, unfinished: true };
            }
            self.finished = filters;
            saved = true;
        }
        SeenFile { saved, unfinished: false }
    }

    /// The filters in the folders, those that can be read.
    fn filters(&self) -> BTreeMap<PathBuf, Digest> {
        let entries = self.filter_folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok());
        let paths = entries.flatten().flatten().map(|entry| entry.path()).filter(|path| is_filter_file(path));
        paths.filter_map(|path| digest(&path).map(|digest| (path, digest))).collect()
    }
}

fn digest(file: &Path) -> Option<Digest> {
    std::fs::read(file).ok().map(|content| Digest::of(&content))
}

fn failed(error: &notify::Error) -> Box<Diagnostic> {
    let message = format!("cannot watch the files of the behaviour: {error}");
    Box::new(Diagnostic::new("E-WATCH-FILES", message).help("close other programs that watch many files"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTHING: SeenFile = SeenFile { saved: false, unfinished: false };
    const UNFINISHED: SeenFile = SeenFile { saved: false, unfinished: true };
    const SAVED: SeenFile = SeenFile { saved: true, unfinished: false };

    #[test]
    fn a_filter_counts_once_it_has_not_changed_for_a_while() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("libedges.so");
        let mut contents = Contents::default();
        contents.add_folder(folder.path());
        let start = Instant::now();
        let mut look = |milliseconds| contents.look(start + Duration::from_millis(milliseconds));
        assert_eq!(look(0), NOTHING);
        std::fs::write(&file, "half").unwrap();
        assert_eq!((look(10), look(190)), (UNFINISHED, UNFINISHED));
        std::fs::write(&file, "half and half").unwrap();
        // 210 ms after the first write, but only now seen to be another file.
        assert_eq!((look(220), look(419)), (UNFINISHED, UNFINISHED));
        assert_eq!((look(420), look(700)), (SAVED, NOTHING));
    }

    #[test]
    fn a_filter_that_comes_back_as_it_was_is_no_save_and_one_that_stays_away_is() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("edges.wasm");
        std::fs::write(&file, "one").unwrap();
        let mut contents = Contents::default();
        contents.add_folder(folder.path());
        let start = Instant::now();
        let mut look = |milliseconds| contents.look(start + Duration::from_millis(milliseconds));
        std::fs::remove_file(&file).unwrap();
        assert_eq!(look(0), UNFINISHED);
        std::fs::write(&file, "one").unwrap();
        assert_eq!((look(100), look(400)), (NOTHING, NOTHING));
        std::fs::remove_file(&file).unwrap();
        assert_eq!((look(500), look(700)), (UNFINISHED, SAVED));
    }

    #[test]
    fn a_script_is_saved_at_once_and_other_files_of_a_filter_folder_are_none() {
        let folder = tempfile::tempdir().unwrap();
        let script = folder.path().join("wall.rhai");
        let mut contents = Contents::default();
        contents.add_folder(folder.path());
        contents.files.insert(script.clone(), digest(&script));
        std::fs::write(folder.path().join("notes.txt"), "one").unwrap();
        assert_eq!(contents.look(Instant::now()), NOTHING);
        std::fs::write(&script, "one").unwrap();
        assert_eq!(contents.look(Instant::now()), SAVED);
    }
}
