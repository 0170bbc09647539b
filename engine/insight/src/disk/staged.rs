//! A folder that is made beside its place under a name that nobody can predict, and then takes its place at once.

use std::fs;
use std::io::Result as IoResult;
use std::path::{Path, PathBuf};

use super::lock::Lock;
use super::{PART, folder_of, is_there, name_of, plain, sync_folder, wanted_name};
use engine::diagnostic::{Diagnostic, Result, printable};

/// A folder that is not whole and holds this file waits for whoever goes on with it, and is not swept.
pub const RESUMABLE: &str = "resume.json";

/// What happens to a folder whose place another has taken: what the engine wrote there goes, and what somebody else put there
/// moves into the folder that stands in its place now.
pub(crate) type Retire = fn(old: &Path, now: &Path) -> Result<()>;

/// A folder that is being written; what stood in its place stays until [`Staged::commit`]. Dropped before that, nothing is left.
#[derive(Debug)]
pub struct Staged {
    /// Given back last.
    _lock: Lock,
    target: PathBuf,
    folder: PathBuf,
    retire: Retire,
    done: bool,
    /// What a killed command has left of the same folder, for who goes on with it.
    resumable: Option<PathBuf>,
}

impl Staged {
    /// An empty folder that is to become `target`, whose lock it holds. Leftovers of killed commands beside it are swept.
    ///
    /// # Errors
    /// `E-LOCKED` if another process writes to `target`; `E-IO` if the folder cannot be made, or `target` is a link, a file or
    /// without a name.
    pub fn beside(target: &Path, retire: Retire) -> Result<Self> {
        let disk = |error: std::io::Error| Box::new(Diagnostic::disk("create the folder", target, &error));
        if target.file_name().is_none() {
            return refused(target, "has no name of its own").fail();
        }
        let parent = folder_of(target);
        fs::create_dir_all(parent).map_err(disk)?;
        let lock = Lock::take_alone(target)?;
        match fs::symlink_metadata(target) {
            Ok(found) if found.is_symlink() => return refused(target, "is a link").fail(),
            Ok(found) if !found.is_dir() => return refused(target, "is a file").fail(),
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(disk(error)),
            _ => {}
        }
        let resumable = sweep(target, retire);
        let folder = make(parent, &name_of(target)).map_err(disk)?;
        Ok(Self { _lock: lock, target: target.to_owned(), folder, retire, done: false, resumable })
    }

    /// Whether a killed command has left something of the same folder that can be gone on with.
    #[must_use]
    pub fn can_be_resumed(&self) -> bool {
        self.resumable.is_some()
    }

    /// Removes what could have been gone on with.
    ///
    /// # Errors
    /// `E-IO` if it cannot be removed.
    pub fn discard_resumable(&mut self) -> Result<()> {
        self.resumable.take().map_or(Ok(()), |left| (self.retire)(&left, &self.target))
    }

    /// Goes on with what a killed command has left of the same folder.
    #[must_use]
    pub fn resume(mut self) -> Self {
        if let Some(left) = self.resumable.take() {
            // Nothing is in it yet.
            drop(fs::remove_dir(&self.folder));
            self.folder = left;
        }
        self
    }

    /// Where to write.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Puts the folder into its place, with all that is in it on the disk: whoever looks finds the old one or the new one.
    ///
    /// # Errors
    /// `E-IO` if that fails; what stood there is then unchanged.
    pub fn commit(self) -> Result<()> {
        self.commit_then(|_| Ok(()))
    }

    /// Puts the folder into its place, and does something there while nobody else may.
    ///
    /// # Errors
    /// As [`Staged::commit`], and what that fails with.
    pub fn commit_then(mut self, after: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let disk = |error: std::io::Error| Box::new(Diagnostic::disk("write", &self.target, &error));
        sync(&self.folder).map_err(disk)?;
        let there = is_there(&self.target)?;
        if there { exchange(&self.folder, &self.target) } else { fs::rename(&self.folder, &self.target) }
            .map_err(disk)?;
        sync_folder(folder_of(&self.target)).map_err(disk)?;
        self.done = true;
        if there {
            // What could be gone on with of the old one is not of this one.
            drop(fs::remove_file(self.folder.join(RESUMABLE)));
        }
        let after = after(&self.target);
        let retired = if there { (self.retire)(&self.folder, &self.target) } else { Ok(()) };
        after.and(retired)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if !self.done && !is_resumable(&self.folder) {
            drop(fs::remove_dir_all(&self.folder));
        }
    }
}

/// Whether a folder waits for whoever goes on with it; also if that cannot be told.
fn is_resumable(folder: &Path) -> bool {
    is_there(&folder.join(RESUMABLE)).unwrap_or(true)
}

fn refused(target: &Path, what: &str) -> Diagnostic {
    let message = format!("cannot create the folder '{}': it {what}", printable(&target.display().to_string()));
    Diagnostic::new("E-IO", message).help("name a folder that is not there yet, such as runs/mine/1")
}

/// A folder for what is to have this name, which nobody else has.
pub(super) fn make(parent: &Path, name: &str) -> IoResult<PathBuf> {
    let prefix = format!(".{name}.");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(PART);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    let made = builder.tempdir_in(parent).map_err(|error| plain(&error))?.keep();
    // As the user has written the place.
    Ok(parent.join(made.file_name().unwrap_or_default()))
}

/// Removes what killed commands left in a folder, of `target` and of whatever else nobody writes to now. Of one that cannot be
/// removed nothing is said: it is in nobody's way. Returns what can be gone on with of `target`.
fn sweep(target: &Path, retire: Retire) -> Option<PathBuf> {
    let (parent, own, mut resumable) = (folder_of(target), name_of(target), None);
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(wanted) = wanted_name(&name) else { continue };
        if !entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            continue;
        }
        if is_resumable(&entry.path()) {
            resumable = if wanted == own { Some(entry.path()) } else { resumable };
            continue;
        }
        let place = parent.join(wanted);
        if wanted == own {
            drop(retire(&entry.path(), &place));
        } else if let Ok(_lock) = Lock::take_alone(&place) {
            drop(retire(&entry.path(), &place));
        }
    }
    resumable
}

/// Makes all that is in a folder last through a power cut.
fn sync(folder: &Path) -> IoResult<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            sync(&entry.path())?;
        } else {
            fs::File::open(entry.path())?.sync_all()?;
        }
    }
    sync_folder(folder)
}

/// Two folders, or two files, change places, at once where the system can do that.
pub(super) fn exchange(one: &Path, other: &Path) -> IoResult<()> {
    #[cfg(any(target_os = "linux", target_os = "macos"))]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        use rustix::io::Errno;
        match renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE) {
            Err(Errno::INVAL | Errno::NOSYS | Errno::NOTSUP) => {}
            done => return Ok(done?),
        }
    }
    // Between the first step and the second there is neither: the old one then stands beside, whole.
    let aside = one.with_extension("aside");
    fs::rename(other, &aside)?;
    fs::rename(one, other).inspect_err(|_| drop(fs::rename(&aside, other)))?;
    fs::rename(&aside, one)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn remove(old: &Path, _: &Path) -> Result<()> {
        fs::remove_dir_all(old).map_err(|error| Box::new(Diagnostic::disk("remove", old, &error)))
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn the_old_folder_stays_until_the_new_one_is_whole() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("runs/1");
        for text in ["old", "new"] {
            let staged = Staged::beside(&target, remove).unwrap();
            fs::create_dir(staged.folder().join("7")).unwrap();
            fs::write(staged.folder().join("7/a"), text).unwrap();
            if text == "new" {
                assert_eq!(fs::read(target.join("7/a")).unwrap(), b"old");
            }
            staged.commit().unwrap();
            assert_eq!(fs::read(target.join("7/a")).unwrap(), text.as_bytes());
            assert_eq!(names(&place.path().join("runs")), ["1"]);
        }
    }

    #[test]
    fn what_is_not_committed_leaves_nothing_and_two_cannot_write() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("1");
        let staged = Staged::beside(&target, remove).unwrap();
        assert_eq!(Staged::beside(&target, remove).unwrap_err().code, "E-LOCKED");
        drop(staged);
        assert_eq!(names(place.path()), Vec::<String>::new());
    }

    #[test]
    fn leftovers_of_killed_commands_are_swept_and_what_can_be_resumed_stays() {
        let place = tempfile::tempdir().unwrap();
        for name in [".1.abc.part/7", ".2.abc.part", ".3.abc.part", "mine.part"] {
            fs::create_dir_all(place.path().join(name)).unwrap();
        }
        fs::write(place.path().join(".3.abc.part").join(RESUMABLE), "").unwrap();
        let held = Lock::take(&place.path().join("2")).unwrap();
        drop(Staged::beside(&place.path().join("1"), remove).unwrap());
        drop(held);
        assert_eq!(names(place.path()), [".2.abc.part", ".3.abc.part", "mine.part"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_and_a_file_are_not_replaced() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("file"), "mine").unwrap();
        std::os::unix::fs::symlink(place.path(), place.path().join("link")).unwrap();
        for name in ["file", "link", ".."] {
            assert_eq!(Staged::beside(&place.path().join(name), remove).unwrap_err().code, "E-IO", "{name}");
        }
        assert_eq!(names(place.path()), ["file", "link"]);
    }
}
