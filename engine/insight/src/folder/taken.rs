//! Folders that hold a run already: no run destroys another without a word.

use std::path::{Path, PathBuf};

use super::CURVE_FILE;
use super::removal::remove_seed;
use crate::store::{LOG_FILE, POLICY_FILE, RUN_FILE, seed_folders};
use engine::diagnostic::{Diagnostic, Result, printable};

/// A run as its folder is known by: `run.toml`, and its seeds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Claim<'a> {
    pub run: &'a str,
    pub seeds: &'a [u64],
}

impl Claim<'_> {
    /// Whether a folder holds another run: of another script, of one seed instead of many, of seeds that are not among these.
    pub(super) fn is_denied(self, folder: &Path) -> bool {
        let path = folder.join(RUN_FILE);
        if !path.exists() {
            return false;
        }
        let one = folder.join(LOG_FILE).exists();
        let others = seed_folders(folder).into_iter().any(|(seed, _)| !self.seeds.contains(&seed) || !self.is_many());
        // One that cannot be read is somebody's too.
        one && self.is_many() || others || std::fs::read(path).map_or(true, |old| old != self.run.as_bytes())
    }

    fn is_many(self) -> bool {
        self.seeds.len() > 1
    }

    /// Removes what another run left in a folder that is replaced, and that this one would not write over.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub(super) fn clear(self, folder: &Path) -> Result<()> {
        let stale = |seed: &u64| !self.is_many() || !self.seeds.contains(seed);
        for (_, seed) in seed_folders(folder).into_iter().filter(|(seed, _)| stale(seed)) {
            remove_seed(&seed)?;
        }
        for name in [LOG_FILE, POLICY_FILE, CURVE_FILE] {
            let path = folder.join(name);
            if self.is_many() && path.exists() {
                std::fs::remove_file(&path).map_err(|error| Box::new(Diagnostic::disk("remove", &path, &error)))?;
            }
        }
        Ok(())
    }

    /// The folder itself, or the first with a number behind its name that does not hold another run.
    pub(super) fn numbered(self, folder: &Path) -> PathBuf {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let numbers = (2_u64..).map(|number| folder.with_file_name(format!("{name}.{number}")));
        let mut all = std::iter::once(folder.to_owned()).chain(numbers);
        all.find(|folder| !self.is_denied(folder)).unwrap_or_else(|| folder.to_owned())
    }
}

pub(super) fn taken(folder: &Path) -> Diagnostic {
    let shown = printable(&folder.display().to_string());
    let message = format!("'{shown}' holds another run: of another script, other settings or other seeds");
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
        let numbered = |run: &str| Claim { run, seeds: &[1] }.numbered(&folder);
        assert_eq!(numbered("a"), folder);
        write("1", "a");
        assert_eq!((numbered("a"), numbered("b")), (folder.clone(), place.path().join("1.2")));
        write("1.2", "b");
        assert_eq!((numbered("b"), numbered("c")), (place.path().join("1.2"), place.path().join("1.3")));
    }

    #[test]
    fn one_seed_and_many_are_different_runs_and_what_one_left_is_removed_with_force() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        std::fs::write(folder.join(RUN_FILE), "a").unwrap();
        std::fs::write(folder.join(LOG_FILE), "").unwrap();
        let (one, two) = (Claim { run: "a", seeds: &[1] }, Claim { run: "a", seeds: &[1, 2] });
        assert!(!one.is_denied(folder) && two.is_denied(folder));
        two.clear(folder).unwrap();
        for seed in ["1", "2", "3"] {
            std::fs::create_dir_all(folder.join(seed)).unwrap();
            std::fs::write(folder.join(seed).join(RUN_FILE), "a").unwrap();
        }
        // The third seed would stand there as if it were this run's.
        assert!(two.is_denied(folder) && one.is_denied(folder));
        assert!(!Claim { run: "a", seeds: &[1, 2, 3] }.is_denied(folder));
        two.clear(folder).unwrap();
        assert!(!two.is_denied(folder) && !folder.join("3").exists() && folder.join("2").exists());
        one.clear(folder).unwrap();
        assert!(!one.is_denied(folder) && seed_folders(folder).is_empty());
    }
}
