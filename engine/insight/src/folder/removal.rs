//! A run's folder, removed: what the engine wrote there and nothing else.

use std::path::{Path, PathBuf};

use super::pages::PAGE_FILE;
use super::pictures::PICTURES;
use super::{CERTIFICATE_FILE, CURVE_FILE, certificate::CERTIFICATE_PICTURE};
use crate::store::{LOG_FILE, POLICY_FILE, RUN_FILE, SUMMARY_FILE, TAG_FILE, read_stored};
use engine::diagnostic::{Diagnostic, Result};

/// Files of a run under names of their own.
const FILES: [&str; 9] = [
    RUN_FILE,
    SUMMARY_FILE,
    POLICY_FILE,
    LOG_FILE,
    CURVE_FILE,
    PAGE_FILE,
    TAG_FILE,
    CERTIFICATE_FILE,
    "disagreements.csv",
];
/// What `engine rescore` writes into a folder of its own within the run's.
const RESCORE: &str = "rescore-";
const RESCORE_FILES: [&str; 3] = ["rescore.json", "policy-diff.svg", "policy-diff.png"];

/// Removes a run with all that the engine wrote into its folder; the folder itself too, unless something else stands in it.
/// What stays comes back: somebody else put it there.
///
/// # Errors
/// `E-RUN-FILE` if the folder is no run; if a file cannot be removed.
pub fn remove_run(folder: &Path) -> Result<Vec<PathBuf>> {
    read_stored(&folder.join(RUN_FILE))?;
    let mut kept = Vec::new();
    remove(folder, &is_of_a_run, &mut kept)?;
    Ok(kept)
}

/// Removes the files of a folder that are `own`, then the folder if it is empty.
fn remove(folder: &Path, own: &dyn Fn(&str) -> bool, kept: &mut Vec<PathBuf>) -> Result<()> {
    let disk = |what: &str, path: &Path, error| Box::new(Diagnostic::disk(what, path, &error));
    let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let mut paths: Vec<PathBuf> =
        entries.map_err(|error| disk("read the folder", folder, error))?.iter().map(std::fs::DirEntry::path).collect();
    paths.sort();
    let before = kept.len();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_file() && !path.is_symlink() && own(&name) {
            std::fs::remove_file(&path).map_err(|error| disk("remove", &path, error))?;
        } else if path.is_dir() && !path.is_symlink() && name.starts_with(RESCORE) {
            remove(&path, &|name| RESCORE_FILES.contains(&name), kept)?;
        } else if path.is_dir() && !path.is_symlink() && name.parse::<u64>().is_ok() {
            // The folder of a seed.
            remove(&path, &is_of_a_run, kept)?;
        } else {
            kept.push(path);
        }
    }
    if kept.len() == before {
        std::fs::remove_dir(folder).map_err(|error| disk("remove", folder, error))?;
    }
    Ok(())
}

/// Whether a file of this name is one that the engine writes into a run's folder: its own, pictures, steps that were explained.
fn is_of_a_run(name: &str) -> bool {
    let picture = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
    let explained = |stem: &str| {
        let step = stem.strip_prefix("step-").and_then(|rest| rest.rsplit_once('-'));
        step.is_some_and(|(_, side)| ["before", "after"].contains(&side))
    };
    FILES.contains(&name)
        || picture.is_some_and(|stem| PICTURES.contains(&stem) || stem == CERTIFICATE_PICTURE || explained(stem))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, files: &[&str]) {
        for file in files {
            let path = folder.join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
    }

    #[test]
    fn a_run_goes_with_its_seeds_its_pictures_and_its_folder() {
        let place = tempfile::tempdir().unwrap();
        let run = place.path().join("1-2");
        write(&run, &["run.toml", "summary.json", "paths.svg", "tag.txt", "1/run.toml", "1/log.bin", "2/run.toml"]);
        write(&run, &["step-7-before.png", "rescore-mine/rescore.json", "certificate.json", "certificate.svg"]);
        assert_eq!(remove_run(&run).unwrap(), Vec::<PathBuf>::new());
        assert!(!run.exists());
    }

    #[test]
    fn what_somebody_else_put_into_a_run_stays_and_is_named() {
        let place = tempfile::tempdir().unwrap();
        let run = place.path().join("1");
        write(&run, &["run.toml", "log.bin", "notes.md", "photos/a.png", "rescore-mine/thesis.tex", "7/mine.txt"]);
        let kept = ["7/mine.txt", "notes.md", "photos", "rescore-mine/thesis.tex"].map(|path| run.join(path));
        assert_eq!(remove_run(&run).unwrap(), kept);
        assert!(kept.iter().all(|path| path.exists()) && !run.join("log.bin").exists());
        assert!(remove_run(&run).is_err(), "it is a run no longer");
    }
}
