//! Folders that hold a run already: no run destroys another without a word.

use std::path::{Path, PathBuf};

use crate::disk::{is_there, read_file};
use crate::store::{LOG_FILE, RUN_FILE, script_of, seed_folders};
use engine::diagnostic::{Diagnostic, Result, printable};

/// The longest `run.toml` that is compared, bytes.
const MOST_RUN_BYTES: u64 = 256 << 20;

/// A run as its folder is known by: `run.toml`, and its seeds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Claim<'a> {
    pub run: &'a str,
    pub seeds: &'a [u64],
}

impl Claim<'_> {
    /// Whether a folder holds another run: of another script, of one seed instead of many, of seeds that are not among these.
    ///
    /// # Errors
    /// If that cannot be told.
    pub(super) fn is_denied(self, folder: &Path) -> Result<bool> {
        let path = folder.join(RUN_FILE);
        if !is_there(&path)? {
            // The folder of several runs is none of them.
            return Ok(!seed_folders(folder)?.is_empty());
        }
        let one = is_there(&folder.join(LOG_FILE))?;
        let others = seed_folders(folder)?.into_iter().any(|(seed, _)| !self.seeds.contains(&seed) || !self.is_many());
        // One that cannot be read is somebody's too.
        Ok(one && self.is_many()
            || others
            || read_file(&path, MOST_RUN_BYTES).map_or(true, |old| old != self.run.as_bytes()))
    }

    /// Whether a folder holds a run of another script, or of other seeds; not if only what the script says has changed since.
    ///
    /// # Errors
    /// If that cannot be told.
    pub(super) fn is_of_others(self, folder: &Path) -> Result<bool> {
        if !is_there(&folder.join(RUN_FILE))? {
            return Ok(!seed_folders(folder)?.is_empty());
        }
        let others = seed_folders(folder)?.into_iter().any(|(seed, _)| !self.seeds.contains(&seed));
        let one = is_there(&folder.join(LOG_FILE))?;
        let old = read_file(&folder.join(RUN_FILE), MOST_RUN_BYTES).ok().and_then(|old| String::from_utf8(old).ok());
        let script = |run: &str| script_of(run).map(|(behaviour, seed, path)| (behaviour, seed, whole(&path)));
        Ok(one == self.is_many() || others || old.is_none_or(|old| script(&old) != script(self.run)))
    }

    fn is_many(self) -> bool {
        self.seeds.len() > 1
    }

    /// The folder itself, or the first with a number behind its name that does not hold another run.
    ///
    /// # Errors
    /// If that cannot be told.
    pub(super) fn numbered(self, folder: &Path) -> Result<PathBuf> {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (mut path, mut number) = (folder.to_owned(), 1_u64);
        while self.is_denied(&path)? {
            number += 1;
            path = folder.with_file_name(format!("{name}.{number}"));
        }
        Ok(path)
    }
}

/// A path that means the same file however it is written, if the file is still there.
fn whole(path: &str) -> PathBuf {
    Path::new(path).canonicalize().unwrap_or_else(|_| PathBuf::from(path))
}

pub(super) fn taken(folder: &Path) -> Diagnostic {
    let shown = printable(&folder.display().to_string());
    let message = format!("'{shown}' holds another run: of another script, other settings or other seeds");
    Diagnostic::new("E-RUN-TAKEN", message).help("name another folder with --out, or replace that run with --force")
}

pub(super) fn unfinished(folder: &Path) -> Diagnostic {
    let shown = printable(&folder.display().to_string());
    let message = format!("a run into '{shown}' was killed, and its checkpoint would be lost");
    Diagnostic::new("E-RUN-UNFINISHED", message)
        .help(format!("go on with it: engine run --resume {shown}; or start anew: add --force"))
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
        let numbered = |run: &str| Claim { run, seeds: &[1] }.numbered(&folder).unwrap();
        assert_eq!(numbered("a"), folder);
        write("1", "a");
        assert_eq!((numbered("a"), numbered("b")), (folder.clone(), place.path().join("1.2")));
        write("1.2", "b");
        assert_eq!((numbered("b"), numbered("c")), (place.path().join("1.2"), place.path().join("1.3")));
    }

    #[test]
    fn a_script_that_was_changed_since_replaces_its_own_run_and_no_other_one() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        let run = |behaviour: &str, seed: u64, path: &str, text: &str| {
            format!("behaviour = \"{behaviour}\"\nseed = {seed}\n[script]\npath = \"{path}\"\ntext = \"{text}\"\n")
        };
        std::fs::write(folder.join(RUN_FILE), run("wall", 1, "s/wall.rhai", "old")).unwrap();
        std::fs::write(folder.join(LOG_FILE), "").unwrap();
        let denied = |run: &str, seeds: &[u64]| Claim { run, seeds }.is_of_others(folder).unwrap();
        assert!(!denied(&run("wall", 1, "s/wall.rhai", "new"), &[1]));
        assert!(denied(&run("wall", 1, "t/wall.rhai", "old"), &[1]));
        assert!(denied(&run("line", 1, "s/line.rhai", "new"), &[1]));
        assert!(denied(&run("wall", 2, "s/wall.rhai", "new"), &[2]));
        assert!(denied(&run("wall", 1, "s/wall.rhai", "new"), &[1, 2]));
        std::fs::write(folder.join(RUN_FILE), "not a run").unwrap();
        assert!(denied(&run("wall", 1, "s/wall.rhai", "new"), &[1]));
    }

    #[test]
    fn one_seed_and_many_are_different_runs() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        std::fs::write(folder.join(RUN_FILE), "a").unwrap();
        std::fs::write(folder.join(LOG_FILE), "").unwrap();
        let (one, two) = (Claim { run: "a", seeds: &[1] }, Claim { run: "a", seeds: &[1, 2] });
        let denied = |claim: Claim<'_>| claim.is_denied(folder).unwrap();
        assert!(!denied(one) && denied(two));
        std::fs::remove_file(folder.join(LOG_FILE)).unwrap();
        for seed in ["1", "2", "3"] {
            std::fs::create_dir_all(folder.join(seed)).unwrap();
            std::fs::write(folder.join(seed).join(RUN_FILE), "a").unwrap();
        }
        // The third seed would stand there as if it were this run's.
        assert!(denied(two) && denied(one) && !denied(Claim { run: "a", seeds: &[1, 2, 3] }));
    }
}
