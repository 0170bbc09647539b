//! The one reader of files that a stranger may have put there: nothing but ordinary files, and no more than a limit.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result as IoResult};
use std::path::Path;

use engine::diagnostic::{Diagnostic, Result};

/// Whether something stands at a path, a link that leads nowhere too.
///
/// # Errors
/// `E-IO` if that cannot be told: only "there is no such file" means that there is none.
pub fn is_there(path: &Path) -> Result<bool> {
    match std::fs::symlink_metadata(path) {
        Ok(_) => Ok(true),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(false),
        Err(error) => Err(Box::new(Diagnostic::disk("read", path, &error))),
    }
}

/// The bytes of an ordinary file. A pipe does not make it wait, and a device is not read.
///
/// # Errors
/// Of kind `InvalidInput` if it is no ordinary file, `FileTooLarge` if it has more than `most` bytes; those of the system.
pub fn read_file(path: &Path, most: u64) -> IoResult<Vec<u8>> {
    let mut bytes = Vec::new();
    open_file(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(Error::new(ErrorKind::FileTooLarge, format!("it has more than {most} bytes")));
    }
    Ok(bytes)
}

/// An ordinary file, opened for whoever reads it piece by piece.
///
/// # Errors
/// Of kind `InvalidInput` if it is no ordinary file; those of the system.
pub fn open_file(path: &Path) -> IoResult<File> {
    let is_file = |file: &std::fs::Metadata| match file.is_file() {
        true => Ok(()),
        false => Err(Error::new(ErrorKind::InvalidInput, "it is not an ordinary file")),
    };
    // Asked before, since to open a device may do something; and after, since another may have taken its place.
    is_file(&std::fs::metadata(path)?)?;
    let file = open(path)?;
    is_file(&file.metadata()?)?;
    Ok(file)
}

fn open(path: &Path) -> IoResult<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, rustix::fs::OFlags::NONBLOCK.bits() as i32);
    options.open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_the_limit_and_not_beyond() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "four").unwrap();
        assert_eq!(read_file(&path, 4).unwrap(), b"four");
        assert_eq!(read_file(&path, 3).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(read_file(&folder.path().join("b"), 3).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn folders_devices_and_pipes_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.is_ok_and(|status| status.success()));
        for path in [folder.path(), Path::new("/dev/zero"), &pipe] {
            assert_eq!(read_file(path, 1 << 20).unwrap_err().kind(), ErrorKind::InvalidInput, "{}", path.display());
        }
    }

    #[test]
    fn only_what_is_not_found_is_not_there() {
        let folder = tempfile::tempdir().unwrap();
        assert!(is_there(folder.path()).unwrap() && !is_there(&folder.path().join("none")).unwrap());
        // A name that is longer than any can be.
        assert_eq!(is_there(&folder.path().join("x".repeat(5000))).unwrap_err().code, "E-IO");
    }
}
