//! Files that come into a folder together: none of them stands there before all are whole, and if one cannot be put there, none is.

use std::fs;
use std::io::Result as IoResult;
use std::path::{Path, PathBuf};

use super::lock::Lock;
use super::staged::{Staged, exchange, make};
use super::{is_there, is_unfinished, name_of, sync_folder};
use engine::diagnostic::{Diagnostic, Result};

/// Files that are being written for a folder. A new folder comes as a whole; in one that is there already they take the places of
/// files with their names, and all others stay. Dropped before [`Together::commit`], nothing is left.
#[derive(Debug)]
pub struct Together(Place);

#[derive(Debug)]
enum Place {
    New(Staged),
    Within { target: PathBuf, within: Within },
}

/// A folder within the one that is there, under a name that nobody can predict.
#[derive(Debug)]
struct Within {
    folder: PathBuf,
    /// Held while it is in use, so that nobody sweeps it.
    _lock: Lock,
}

impl Together {
    /// Files that are to come into a folder. What killed commands left there is swept.
    ///
    /// # Errors
    /// `E-IO` if nothing can be written there; `E-LOCKED` if another process is making the folder.
    pub fn into(target: &Path) -> Result<Self> {
        if !is_there(target)? {
            return Ok(Self(Place::New(Staged::beside(target, discard)?)));
        }
        sweep(target);
        let folder = make(target, &name_of(target));
        let folder = folder.map_err(|error| Box::new(Diagnostic::disk("write into", target, &error)))?;
        let lock = Lock::take_alone(&folder).inspect_err(|_| drop(fs::remove_dir(&folder)))?;
        Ok(Self(Place::Within { target: target.to_owned(), within: Within { folder, _lock: lock } }))
    }

    /// Where to write.
    #[must_use]
    pub fn folder(&self) -> &Path {
        match &self.0 {
            Place::New(staged) => staged.folder(),
            Place::Within { within, .. } => &within.folder,
        }
    }

    /// Puts all that was written into its place.
    ///
    /// # Errors
    /// `E-IO` if that fails; what stood there is then unchanged.
    pub fn commit(self) -> Result<()> {
        match self.0 {
            Place::New(staged) => staged.commit(),
            Place::Within { target, within } => {
                put(&within.folder, &target).map_err(|error| Box::new(Diagnostic::disk("write into", &target, &error)))
            }
        }
    }
}

impl Drop for Within {
    fn drop(&mut self) {
        drop(fs::remove_dir_all(&self.folder));
    }
}

fn discard(old: &Path, _: &Path) -> Result<()> {
    fs::remove_dir_all(old).map_err(|error| Box::new(Diagnostic::disk("remove", old, &error)))
}

/// Removes folders that killed commands left within one. Of one that cannot be removed nothing is said: it is in nobody's way.
fn sweep(target: &Path) {
    for entry in fs::read_dir(target).into_iter().flatten().flatten() {
        let is_left = is_unfinished(&entry.file_name().to_string_lossy());
        if is_left && entry.file_type().is_ok_and(|kind| kind.is_dir()) && Lock::take_alone(&entry.path()).is_ok() {
            drop(fs::remove_dir_all(entry.path()));
        }
    }
}

/// Moves all files of one folder into another. Where one fails, those before it go back.
fn put(from: &Path, to: &Path) -> IoResult<()> {
    let mut done = Vec::new();
    let all = files(from)?;
    let put = all.iter().try_for_each(|file| {
        let (new, place) = (from.join(file), to.join(file));
        place.parent().map_or(Ok(()), fs::create_dir_all)?;
        let old = match fs::symlink_metadata(&place) {
            Ok(old) if old.is_dir() => return Err(std::io::ErrorKind::IsADirectory.into()),
            Ok(_) => true,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => false,
            Err(error) => return Err(error),
        };
        if old { exchange(&new, &place) } else { fs::rename(&new, &place) }?;
        done.push((new, place, old));
        Ok(())
    });
    let put = put.and_then(|()| all.iter().filter_map(|file| to.join(file).parent().map(sync_folder)).collect());
    if put.is_err() {
        for (new, place, old) in done.iter().rev() {
            drop(if *old { exchange(place, new) } else { fs::rename(place, new) });
        }
    }
    put
}

/// The files of a folder, as paths within it; those of figures last, since they say that the others are there.
fn files(folder: &Path) -> IoResult<Vec<PathBuf>> {
    let (mut files, mut folders) = (Vec::new(), vec![PathBuf::new()]);
    while let Some(within) = folders.pop() {
        for entry in fs::read_dir(folder.join(&within))? {
            let entry = entry?;
            let path = within.join(entry.file_name());
            if entry.file_type()?.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.sort_by_key(|file| (file.extension().is_some_and(|ending| ending == "json"), file.clone()));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_new_folder_comes_as_a_whole_and_in_an_old_one_other_files_stay() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("out");
        for text in ["first", "second"] {
            let together = Together::into(&target).unwrap();
            fs::create_dir(together.folder().join("src")).unwrap();
            fs::write(together.folder().join("src/a.png"), text).unwrap();
            fs::write(together.folder().join("b.json"), text).unwrap();
            assert!(!target.join("b.json").exists() || fs::read(target.join("b.json")).unwrap() == b"first");
            together.commit().unwrap();
            fs::write(target.join("notes.md"), "mine").unwrap();
            assert_eq!(fs::read(target.join("src/a.png")).unwrap(), text.as_bytes());
        }
        assert_eq!((names(&target), names(place.path())), (names_of(["b.json", "notes.md", "src"]), names_of(["out"])));
    }

    fn names_of<const N: usize>(names: [&str; N]) -> Vec<String> {
        names.map(str::to_owned).to_vec()
    }

    #[test]
    fn where_one_file_cannot_be_put_all_others_are_as_they_were() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("a.png"), "old").unwrap();
        fs::create_dir(place.path().join("z.json")).unwrap();
        let together = Together::into(place.path()).unwrap();
        for name in ["a.png", "b.png", "z.json"] {
            fs::write(together.folder().join(name), "new").unwrap();
        }
        assert_eq!(together.commit().unwrap_err().code, "E-IO");
        assert_eq!(names(place.path()), names_of(["a.png", "z.json"]));
        assert_eq!(fs::read(place.path().join("a.png")).unwrap(), b"old");
    }

    #[test]
    fn what_is_dropped_or_was_killed_leaves_nothing_and_two_may_write_at_once() {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir(place.path().join(".run.abc.part")).unwrap();
        let (one, other) = (Together::into(place.path()).unwrap(), Together::into(place.path()).unwrap());
        fs::write(one.folder().join("a"), "one").unwrap();
        fs::write(other.folder().join("a"), "other").unwrap();
        drop(other);
        one.commit().unwrap();
        assert_eq!(names(place.path()), names_of(["a"]));
    }
}
