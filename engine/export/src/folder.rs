//! The folder of an exported policy: complete or absent, and nobody else's file is lost.

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result, printable};
use insight::disk::{Staged, is_there, write_atomic};

use crate::Port;

/// The file by which such a folder is known.
const KNOWN_BY: &str = "conformance.bin";
const FILES: [&str; 7] = ["policy.h", "policy.c", "check.c", "policy.py", "check.py", "README.md", KNOWN_BY];

impl Port {
    /// Writes the files into a folder.
    ///
    /// # Errors
    /// `E-RUN-TAKEN` if something stands there: an export without `force`, anything else in any case; `E-IO` if a file cannot be
    /// written, `E-LOCKED` if another process writes there.
    pub fn write(&self, path: &Path, force: bool) -> Result<()> {
        let staged = Staged::beside(path, retire)?;
        let shown = printable(&path.display().to_string());
        let taken = |message: String, help: &str| Diagnostic::new("E-RUN-TAKEN", message).help(help).fail();
        let is_empty = std::fs::read_dir(path).map_or(true, |mut entries| entries.next().is_none());
        if !is_empty && !is_there(&path.join(KNOWN_BY))? {
            return taken(format!("'{shown}' holds something else than an export"), "name another folder with --out");
        }
        if !is_empty && !force {
            let help = "name another folder with --out, or replace that export with --force";
            return taken(format!("'{shown}' holds another export"), help);
        }
        self.files.iter().try_for_each(|(name, content)| write_atomic(&staged.folder().join(name), content))?;
        staged.commit()
    }
}

/// Removes an export in whose place another one stands now; what somebody else put there moves to the new one.
fn retire(old: &Path, now: &Path) -> Result<()> {
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("remove the old", old, &error));
    for entry in std::fs::read_dir(old).and_then(Iterator::collect::<std::io::Result<Vec<_>>>).map_err(disk)? {
        let name = entry.file_name();
        if FILES.iter().any(|own| name == *own) {
            std::fs::remove_file(entry.path()).map_err(disk)?;
        } else if is_there(now)? && !is_there(&now.join(&name))? {
            std::fs::rename(entry.path(), now.join(&name)).map_err(disk)?;
        }
    }
    // What is left is somebody's: it stays.
    drop(std::fs::remove_dir(old));
    Ok(())
}
