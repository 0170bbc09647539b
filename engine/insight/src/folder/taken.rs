//! Folders that hold a run already: no run destroys another without a word.

use std::path::{Path, PathBuf};

use crate::store::RUN_FILE;
use engine::diagnostic::{Diagnostic, printable};

/// Whether a folder holds another run than that of this `run.toml`.
pub(super) fn holds_another(folder: &Path, run: &str) -> bool {
    let path = folder.join(RUN_FILE);
    // One that cannot be read is somebody's too.
    path.exists() && std::fs::read(path).map_or(true, |old| old != run.as_bytes())
}

/// The folder itself, or the first with a number behind its name that does not hold another run.
pub(super) fn numbered(folder: &Path, run: &str) -> PathBuf {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let numbers = (2_u64..).map(|number| folder.with_file_name(format!("{name}.{number}")));
    let mut all = std::iter::once(folder.to_owned()).chain(numbers);
    all.find(|folder| !holds_another(folder, run)).unwrap_or_else(|| folder.to_owned())
}

pub(super) fn taken(folder: &Path) -> Diagnostic {
    let shown = printable(&folder.display().to_string());
    let message = format!("'{shown}' holds another run: of another script, other settings or another seed");
    Diagnostic::new("E-RUN-TAKEN", message).help("name another folder with --out, or replace that run with --force")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_goes_to_its_own_folder_and_another_one_to_the_next_number() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("1");
        let write = |name: &str, run: &str| {
            std::fs::create_dir_all(place.path().join(name)).unwrap();
            std::fs::write(place.path().join(name).join(RUN_FILE), run).unwrap();
        };
        assert_eq!(numbered(&folder, "a"), folder);
        write("1", "a");
        assert_eq!((numbered(&folder, "a"), numbered(&folder, "b")), (folder.clone(), place.path().join("1.2")));
        write("1.2", "b");
        assert_eq!(
            (numbered(&folder, "b"), numbered(&folder, "c")),
            (place.path().join("1.2"), place.path().join("1.3"))
        );
        assert!(holds_another(&folder, "b") && !holds_another(&folder, "a"));
    }
}
