//! Writes a file so that a reader finds the old one or the new one, never a part.

use std::fs;
use std::path::Path;

use engine::diagnostic::{Diagnostic, Result};

/// Writes `bytes` to a new file beside `path` and renames it over `path`.
///
/// # Errors
/// If the file cannot be written or renamed; the old file is then unchanged.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, path));
    written.map_err(|error| {
        // The first failure is the one to report; a part that was never made cannot be removed.
        drop(fs::remove_file(&part));
        Box::new(Diagnostic::disk("write", path, &error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        write_atomic(&path, b"old").unwrap();
        write_atomic(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named_in_the_error() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_atomic(&folder.path().join("none").join("a.png"), b"").unwrap_err();
        assert_eq!(error.code, "E-IO");
        assert!(error.message.contains("a.png"), "{}", error.message);
    }

    #[test]
    fn a_failed_rename_leaves_no_part_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        fs::create_dir(&path).unwrap();
        assert!(write_atomic(&path, b"x").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
