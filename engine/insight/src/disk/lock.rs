//! One writer of a file or folder at a time. A lock stands beside it as `.NAME.lock`, is given back when its process ends in
//! whatever way, and says who holds it.

use std::fs::{File, Metadata, TryLockError};
use std::io::{Read, Result as IoResult, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::calendar::date;
use super::{LOCK, PART, folder_of, name_of};
use engine::diagnostic::{Diagnostic, Result, printable};

/// What is read of a holder, bytes.
const MOST_BYTES: u64 = 400;
/// Words of the command by which a holder is named.
const MOST_WORDS: usize = 4;
/// How often the lock may vanish while it is taken.
const TRIES: usize = 100;

/// The right to write one file or folder, until it is dropped.
#[derive(Debug)]
pub struct Lock {
    file: File,
    path: PathBuf,
}

impl Lock {
    /// Takes the lock of a file or folder that need not be there yet; its folder must be. What a killed process left of the
    /// file is removed.
    ///
    /// # Errors
    /// `E-LOCKED` if another process holds it: the message names it. `E-IO` if there can be no lock.
    pub fn take(of: &Path) -> Result<Self> {
        let lock = Self::take_alone(of)?;
        sweep_files(of);
        Ok(lock)
    }

    /// Who holds the lock of a file or folder, as it has named itself; nothing if nobody does, or that cannot be told.
    #[must_use]
    pub fn holder(of: &Path) -> Option<String> {
        let mut file = super::open_file(&lock_of(of)).ok()?;
        if !matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)) {
            return None;
        }
        let mut holder = Vec::new();
        (&mut file).take(MOST_BYTES).read_to_end(&mut holder).ok()?;
        Some(printable(&String::from_utf8_lossy(&holder)).to_string())
    }

    pub(super) fn take_alone(of: &Path) -> Result<Self> {
        let path = lock_of(of);
        let disk = |error: std::io::Error| Box::new(Diagnostic::disk("lock", of, &error));
        for _ in 0..TRIES {
            let mut file = open(&path).map_err(disk)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(Box::new(held(of, &mut file))),
                Err(TryLockError::Error(error)) => return Err(disk(error)),
            }
            // Whoever held it may have removed it meanwhile: then this one is nobody's.
            if std::fs::symlink_metadata(&path).is_ok_and(|found| same(&found, &file)) {
                introduce(&mut file).map_err(disk)?;
                return Ok(Self { file, path });
            }
        }
        Err(disk(std::io::Error::other("the lock is removed again and again")))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still held, so that nobody else's is removed.
        drop(std::fs::remove_file(&self.path));
        drop(self.file.unlock());
    }
}

fn lock_of(of: &Path) -> PathBuf {
    folder_of(of).join(format!(".{}{LOCK}", name_of(of)))
}

fn open(path: &Path) -> IoResult<File> {
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, flags.bits() as i32);
    }
    let file = options.open(path)?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(std::io::Error::other("its lock is not an ordinary file")) }
}

#[cfg(unix)]
fn same(found: &Metadata, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    file.metadata().is_ok_and(|own| (own.dev(), own.ino()) == (found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn same(found: &Metadata, _: &File) -> bool {
    found.is_file()
}

/// Writes who holds the lock.
fn introduce(file: &mut File) -> IoResult<()> {
    let words: Vec<String> =
        std::env::args_os().take(MOST_WORDS).map(|word| word.to_string_lossy().into_owned()).collect();
    let more = if std::env::args_os().len() > MOST_WORDS { " ..." } else { "" };
    file.set_len(0)?;
    file.rewind()?;
    write!(file, "process {} ({}{more})", std::process::id(), words.join(" "))
}

fn held(of: &Path, file: &mut File) -> Diagnostic {
    let since = file.metadata().and_then(|data| data.modified()).map_or_else(|_| String::new(), since);
    let mut holder = Vec::new();
    drop(file.take(MOST_BYTES).read_to_end(&mut holder));
    let holder = String::from_utf8_lossy(&holder);
    let holder = if holder.is_empty() { "another process" } else { &*holder };
    let shown = |text: &str| printable(text);
    let message = format!("'{}' is in use by {}{since}", shown(&of.display().to_string()), shown(holder));
    Diagnostic::new("E-LOCKED", message).help("wait until it has ended, or write to another place")
}

/// `, since 2026-11-28 09:15:00 UTC`
fn since(time: SystemTime) -> String {
    let seconds = time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, of_day) = (seconds / 86_400, seconds % 86_400);
    let (year, month, day) = date(days);
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!(", since {year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

/// Removes files that a killed process has not made whole; of one that cannot be removed nothing is said.
fn sweep_files(of: &Path) {
    let prefix = format!(".{}.", name_of(of));
    for entry in std::fs::read_dir(folder_of(of)).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_part = name.starts_with(&prefix) && name.ends_with(PART);
        if is_part && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            drop(std::fs::remove_file(entry.path()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_a_lock_and_others_are_told_who() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("1");
        let lock = Lock::take(&run).unwrap();
        let error = Lock::take(&run).unwrap_err();
        let process = format!("process {} (", std::process::id());
        assert!(error.code == "E-LOCKED" && error.message.contains(&process), "{error:?}");
        assert!(error.message.contains(", since 20") && error.message.ends_with(" UTC"), "{error:?}");
        Lock::take(&folder.path().join("2")).unwrap();
        drop(lock);
        Lock::take(&run).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_a_killed_process_left_does_not_hold_the_lock_and_is_swept() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("trust.toml");
        std::fs::write(folder.path().join(".trust.toml.lock"), "process 1 (engine)").unwrap();
        std::fs::write(folder.path().join(".trust.toml.abc123.part"), "half").unwrap();
        std::fs::write(folder.path().join(".mine.part"), "").unwrap();
        drop(Lock::take(&file).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_lock_that_is_a_link_or_a_pipe_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let precious = folder.path().join("precious");
        std::fs::write(&precious, "mine").unwrap();
        std::os::unix::fs::symlink(&precious, folder.path().join(".a.lock")).unwrap();
        assert_eq!(Lock::take(&folder.path().join("a")).unwrap_err().code, "E-IO");
        assert_eq!(std::fs::read(&precious).unwrap(), b"mine");
    }

    #[test]
    fn days_become_dates() {
        // 2000-02-29 is 11,016 days after 1970-01-01, and 2026-11-28 is 20,785.
        assert_eq!((date(0), date(11_016), date(20_785)), ((1970, 1, 1), (2000, 2, 29), (2026, 11, 28)));
    }
}
