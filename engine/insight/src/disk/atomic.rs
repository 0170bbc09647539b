//! Writes a file so that a reader finds the old one or the new one, never a part.

use std::io::Write;
use std::path::Path;

use super::{PART, folder_of, name_of, plain, sync_folder};
use engine::diagnostic::{Diagnostic, Result};

/// Writes `bytes` to a new file beside `path`, and renames it over `path` when they are on the disk.
///
/// # Errors
/// `E-IO` if the file cannot be written or renamed; the old file is then unchanged. Where only the new name cannot be made to last
/// through a power cut, the new file stands there, whole.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<()> {
    try_write(path, bytes).map_err(|error| Box::new(Diagnostic::disk("write", path, &error)))
}

fn try_write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let (folder, prefix) = (folder_of(path), format!(".{}.", name_of(path)));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(PART);
    // As any new file: what the user's mask leaves.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut part = builder.tempfile_in(folder).map_err(|error| plain(&error))?;
    part.write_all(bytes)?;
    part.as_file().sync_all()?;
    part.persist(path).map_err(|error| error.error)?;
    sync_folder(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
        assert!(error.message.contains("a.png") && error.message.contains("no such file"), "{}", error.message);
    }

    #[test]
    fn a_failed_rename_leaves_no_part_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        fs::create_dir(&path).unwrap();
        assert!(write_atomic(&path, b"x").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_the_place_of_a_file_is_replaced_and_what_it_leads_to_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (path, precious) = (folder.path().join("policy.toml"), folder.path().join("precious"));
        fs::write(&precious, "mine").unwrap();
        std::os::unix::fs::symlink("precious", &path).unwrap();
        // The name that a part once had, planted.
        std::os::unix::fs::symlink("precious", folder.path().join("policy.toml.part")).unwrap();
        write_atomic(&path, b"new").unwrap();
        assert_eq!(fs::read(&precious).unwrap(), b"mine");
        assert!(!path.is_symlink() && fs::read(&path).unwrap() == b"new");
    }
}
