//! Files and folders that are there whole or not at all, each with one writer at a time.
//!
//! | file | what |
//! |---|---|
//! | `atomic` | a file, replaced as a whole |
//! | `calendar` | the day on which a lock was taken, or a word signed |
//! | `lock` | one writer of a file or folder, who is named to others |
//! | `staged` | a folder, made beside its place and swapped in |
//! | `together` | files that come into a folder together |
//! | `reading` | the one reader of files that a stranger may have put there |
//!
//! A new file or folder has a name that nobody can predict until it is whole, no link is followed where something is written, and
//! only "there is no such file" means that there is none.

mod atomic;
mod calendar;
mod lock;
mod reading;
mod staged;
mod together;

pub use atomic::write_atomic;
pub use calendar::date;
pub use lock::Lock;
pub use reading::{is_there, open_file, read_file};
pub use staged::{RESUMABLE, Staged};
pub use together::Together;

use std::path::Path;

/// How the name of what is not whole yet ends; it begins with a dot and the name that it is to have.
const PART: &str = ".part";
/// How the name of a lock ends; it begins likewise.
const LOCK: &str = ".lock";

/// The folder in which a path stands.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The name of a path within its folder.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The name that a file or folder is to have which is not whole yet: `1` of `.1.x3Zq9w.part`.
pub(crate) fn wanted_name(part: &str) -> Option<&str> {
    Some(part.strip_prefix('.')?.strip_suffix(PART)?.rsplit_once('.')?.0)
}

/// Whether a file of this name is one that a killed process has not made whole.
pub(crate) fn is_unfinished(name: &str) -> bool {
    wanted_name(name).is_some()
}

/// An error of whoever makes files of random names, without the path that it ends with: the user's stands in the message already.
fn plain(error: &std::io::Error) -> std::io::Error {
    let text = error.to_string();
    std::io::Error::new(error.kind(), text.split(" at path ").next().unwrap_or_default())
}

/// Makes the names in a folder last through a power cut.
fn sync_folder(folder: &Path) -> std::io::Result<()> {
    // Elsewhere a folder cannot be opened.
    if cfg!(unix) { std::fs::File::open(folder)?.sync_all() } else { Ok(()) }
}
