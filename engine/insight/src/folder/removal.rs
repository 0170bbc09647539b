//! A run's folder, removed: what the engine wrote there and nothing else.

use std::path::{Path, PathBuf};

use super::explained::ExplainedStep;
use super::pages::PAGE_FILE;
use super::pictures::PICTURES;
use super::{CERTIFICATE_FILE, CURVE_FILE, DISAGREEMENTS_FILE, TEST_FILE, certificate::CERTIFICATE_PICTURE};
use crate::disk::{Lock, RESUMABLE, is_there, is_unfinished};
use crate::store::{
    CHECKPOINT_FILE, LOG_FILE, POLICY_FILE, RUN_FILE, STEPS_FILE, SUMMARY_FILE, TAG_FILE, is_segment_file, read_stored,
};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};

/// Files of a run under names of their own.
const FILES: [&str; 12] = [
    RUN_FILE,
    SUMMARY_FILE,
    POLICY_FILE,
    LOG_FILE,
    CURVE_FILE,
    PAGE_FILE,
    TAG_FILE,
    RESUMABLE,
    CHECKPOINT_FILE,
    STEPS_FILE,
    DISAGREEMENTS_FILE,
    CERTIFICATE_FILE,
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
    if folder.is_symlink() {
        let message = format!("'{}' is a link to a run somewhere else", printable(&folder.display().to_string()));
        return Diagnostic::new("E-RUN-FILE", message).help("name the folder itself").fail();
    }
    let _lock = Lock::take(folder)?;
    let mut kept = Vec::new();
    remove(folder, &is_of_a_run, &mut kept)?;
    Ok(kept)
}

/// Removes a folder in whose place another one stands now. Of a run or a test what somebody else put there moves to the new one; of
/// any other folder all does. A run's tag and what was scored of it anew speak of its own steps: they move on if the same run was
/// done again. A run with a tag that is another one is kept whole, see [`set_aside`].
///
/// # Errors
/// If something cannot be removed or moved.
pub(super) fn retire(old: &Path, now: &Path) -> Result<()> {
    let (stays, mut kept) = (is_there(now)?, Vec::new());
    if let Some(aside) = set_aside(old, now, now)? {
        return std::fs::rename(old, &aside).map_err(|error| disk("move", old, &error));
    }
    if is_there(&old.join(RUN_FILE))? || is_there(&old.join(TEST_FILE))? {
        let again = stays && is_same_run(old, now);
        for path in entries(old)? {
            let name = name_of(&path);
            if again && (name == TAG_FILE || name.starts_with(RESCORE)) {
                move_on(&path, old, now)?;
            }
        }
        remove(old, &|name| is_of_a_run(name) || name == TEST_FILE || is_unfinished(name), &mut kept)?;
    } else {
        // Folders named by numbers may be runs of their own here.
        kept = entries(old)?;
        kept.retain(|path| !(path.is_file() && is_unfinished(&name_of(path))));
    }
    if !stays && !kept.is_empty() {
        return Ok(());
    }
    kept.iter().try_for_each(|path| move_on(path, old, now))?;
    match std::fs::remove_dir_all(old) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(disk("remove the old", old, &error)),
        _ => Ok(()),
    }
}

/// Whether two folders hold the same run, or none.
fn is_same_run(one: &Path, other: &Path) -> bool {
    let run = |folder: &Path| std::fs::read(folder.join(RUN_FILE)).ok();
    run(one) == run(other)
}

/// Where a run goes that has a tag, so that somebody wants to find it again, once another one takes its place: beside it under the
/// first number that is free, as in `1.2` beside `1`. Nothing if it has no tag, or the other one is the same run.
///
/// # Errors
/// If that cannot be told.
pub(super) fn set_aside(run: &Path, other: &Path, place: &Path) -> Result<Option<PathBuf>> {
    let tagged = is_there(&run.join(RUN_FILE))? && is_there(&run.join(TAG_FILE))?;
    if !tagged || is_same_run(run, other) {
        return Ok(None);
    }
    let numbered = |number: u64| place.with_file_name(format!("{}.{number}", name_of(place)));
    let mut number = 2;
    while is_there(&numbered(number))? {
        number += 1;
    }
    Ok(Some(numbered(number)))
}

/// Moves what stands in an old folder to the same place in the new one, under another name if there is such a file.
fn move_on(path: &Path, old: &Path, now: &Path) -> Result<()> {
    let wanted = now.join(path.strip_prefix(old).unwrap_or(path));
    let (mut to, mut number) = (wanted.clone(), 0);
    while is_there(&to)? {
        number += 1;
        to = wanted.with_file_name(format!("{}.old{number}", name_of(&wanted)));
    }
    let made = to.parent().map_or(Ok(()), std::fs::create_dir_all);
    made.and_then(|()| std::fs::rename(path, &to)).map_err(|error| disk("move", path, &error))
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn disk(what: &str, path: &Path, error: &std::io::Error) -> Box<Diagnostic> {
    Box::new(Diagnostic::disk(what, path, error))
}

/// What stands in a folder, in the order of the names.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let entries = entries.map_err(|error| disk("read the folder", folder, &error))?;
    let mut paths: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
    paths.sort();
    Ok(paths)
}

/// Removes the files of a folder that are `own`, then the folder if it is empty.
fn remove(folder: &Path, own: &dyn Fn(&str) -> bool, kept: &mut Vec<PathBuf>) -> Result<()> {
    let before = kept.len();
    for path in entries(folder)? {
        let name = name_of(&path);
        if path.is_file() && !path.is_symlink() && own(&name) {
            std::fs::remove_file(&path).map_err(|error| disk("remove", &path, &error))?;
        } else if is_unfinished(&name) && path.is_dir() && !path.is_symlink() {
            // What a killed command was about to put there.
            std::fs::remove_dir_all(&path).map_err(|error| disk("remove", &path, &error))?;
        } else if is_rescored(&path, &name) {
            remove(&path, &|name| RESCORE_FILES.contains(&name), kept)?;
        } else if is_of_a_seed(&path, &name) {
            remove(&path, &is_of_a_run, kept)?;
        } else {
            kept.push(path);
        }
    }
    if kept.len() == before {
        std::fs::remove_dir(folder).map_err(|error| disk("remove", folder, &error))?;
    }
    Ok(())
}

/// Whether a folder within a run's is what `engine rescore` wrote: whoever else calls one so has no figures of it there.
fn is_rescored(path: &Path, name: &str) -> bool {
    name.starts_with(RESCORE) && path.is_dir() && !path.is_symlink() && path.join(RESCORE_FILES[0]).is_file()
}

/// Whether a folder within a run's is the run of the seed that it is named by.
fn is_of_a_seed(path: &Path, name: &str) -> bool {
    let names_it = |run: &SourceText| run.text.lines().any(|line| line.strip_prefix("seed = ") == Some(name));
    let may = name.parse::<u64>().is_ok() && path.is_dir() && !path.is_symlink();
    may && read_stored(&path.join(RUN_FILE)).is_ok_and(|run| names_it(&run))
}

/// Whether a file of this name is one that the engine writes into a run's folder: its own, pictures, steps that were explained.
fn is_of_a_run(name: &str) -> bool {
    let picture = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
    FILES.contains(&name)
        || is_segment_file(name)
        || picture.is_some_and(|stem| PICTURES.contains(&stem) || stem == CERTIFICATE_PICTURE)
        || ExplainedStep::of_file(name).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, files: &[&str]) {
        for file in files {
            let path = folder.join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            let seed = path.parent().and_then(|folder| folder.file_name()).unwrap().to_string_lossy().into_owned();
            std::fs::write(path, format!("seed = {seed}\n")).unwrap();
        }
    }

    #[test]
    fn a_run_goes_with_its_seeds_its_pictures_and_its_folder() {
        let place = tempfile::tempdir().unwrap();
        let run = place.path().join("1-2");
        write(&run, &["run.toml", "summary.json", "paths.svg", "tag.txt", "1/run.toml", "1/log.bin", "2/run.toml"]);
        write(&run, &["step-7-before.png", "test-step-7-after.svg", "rescore-mine/rescore.json"]);
        write(&run, &["certificate.json", "certificate.svg"]);
        assert_eq!(remove_run(&run).unwrap(), Vec::<PathBuf>::new());
        assert!(!run.exists());
    }

    #[test]
    fn what_only_looks_like_a_part_of_a_run_stays() {
        let place = tempfile::tempdir().unwrap();
        let run = place.path().join("1");
        write(&run, &["run.toml", "step-by-step-before.png", "step-7-beside.png"]);
        // A folder of numbers that is no seed, one of another seed's run, one that only sounds like a rescoring.
        write(&run, &["2024/summary.json", "rescore-notes/policy-diff.png", "curve.csv/mine.txt"]);
        std::fs::create_dir_all(run.join("8")).unwrap();
        std::fs::write(run.join("8/run.toml"), "seed = 9\n").unwrap();
        let kept = ["2024", "8", "curve.csv", "rescore-notes", "step-7-beside.png", "step-by-step-before.png"]
            .map(|path| run.join(path));
        assert_eq!(remove_run(&run).unwrap(), kept);
        assert!(
            run.join("2024/summary.json").exists() && run.join("8/run.toml").exists() && !run.join("run.toml").exists()
        );
    }

    #[test]
    fn a_run_behind_a_link_is_not_removed() {
        let place = tempfile::tempdir().unwrap();
        write(&place.path().join("1"), &["run.toml", "log.bin"]);
        let link = place.path().join("link");
        std::os::unix::fs::symlink(place.path().join("1"), &link).unwrap();
        assert!(remove_run(&link).unwrap_err().message.contains("is a link"));
        assert!(place.path().join("1/log.bin").exists());
    }

    #[test]
    fn what_somebody_else_put_into_a_run_moves_to_the_run_that_replaces_it() {
        let place = tempfile::tempdir().unwrap();
        let (old, now) = (place.path().join(".1.x.part"), place.path().join("1"));
        write(&old, &["run.toml", "log.bin", "test.json", ".log.bin.x.part", "7/run.toml"]);
        write(&old, &["notes.md", "7/mine.txt", "rescore-a/rescore.json", "rescore-a/thesis.tex"]);
        write(&now, &["run.toml"]);
        retire(&old, &now).unwrap();
        for moved in ["notes.md", "7/mine.txt", "rescore-a/thesis.tex"] {
            assert!(now.join(moved).exists(), "{moved}");
        }
        assert!(!old.exists() && !now.join("log.bin").exists());
        // It is of steps that are not there any more.
        assert!(!now.join("rescore-a/rescore.json").exists());
    }

    #[test]
    fn tag_and_rescorings_stay_with_a_run_that_is_done_again_and_a_tagged_run_makes_room_for_another() {
        let place = tempfile::tempdir().unwrap();
        let (old, now) = (place.path().join(".1.x.part"), place.path().join("1"));
        write(&old, &["log.bin", "tag.txt", "rescore-a/rescore.json"]);
        write(&now, &["log.bin"]);
        for folder in [&old, &now] {
            std::fs::write(folder.join("run.toml"), "seed = 1\n").unwrap();
        }
        retire(&old, &now).unwrap();
        assert!(now.join("tag.txt").exists() && now.join("rescore-a/rescore.json").exists() && !old.exists());

        write(&place.path().join("1.2"), &["mine"]);
        std::fs::rename(&now, &old).unwrap();
        write(&now, &["log.bin"]);
        std::fs::write(now.join("run.toml"), "seed = 2\n").unwrap();
        assert_eq!(set_aside(&old, &now, &now).unwrap(), Some(place.path().join("1.3")));
        retire(&old, &now).unwrap();
        let kept = place.path().join("1.3");
        for file in ["run.toml", "log.bin", "tag.txt", "rescore-a/rescore.json"] {
            assert!(kept.join(file).exists(), "{file}");
        }
        assert!(!now.join("tag.txt").exists() && !now.join("rescore-a").exists() && !old.exists());
    }

    #[test]
    fn of_a_folder_that_is_no_run_everything_moves_and_nothing_is_lost() {
        let place = tempfile::tempdir().unwrap();
        let (old, now) = (place.path().join(".wall.x.part"), place.path().join("wall"));
        write(&old, &["1/run.toml", "1/log.bin", "2/run.toml", "report.html"]);
        write(&now, &["run.toml", "report.html"]);
        retire(&old, &now).unwrap();
        for moved in ["1/run.toml", "1/log.bin", "2/run.toml", "report.html", "report.html.old1"] {
            assert!(now.join(moved).exists(), "{moved}");
        }
        assert!(!old.exists());
    }

    #[test]
    fn what_somebody_else_put_into_a_run_stays_and_is_named() {
        let place = tempfile::tempdir().unwrap();
        let run = place.path().join("1");
        write(&run, &["run.toml", "log.bin", "notes.md", "photos/a.png", "rescore-mine/thesis.tex", "7/mine.txt"]);
        write(&run, &["rescore-mine/rescore.json", "7/run.toml"]);
        let kept = ["7/mine.txt", "notes.md", "photos", "rescore-mine/thesis.tex"].map(|path| run.join(path));
        assert_eq!(remove_run(&run).unwrap(), kept);
        assert!(kept.iter().all(|path| path.exists()) && !run.join("log.bin").exists());
        assert!(remove_run(&run).is_err(), "it is a run no longer");
    }
}
