//! A run that was ended before it was done: what is kept to go on with it, and how that is found again.

use std::path::Path;
use std::sync::atomic::Ordering;

use serde::{Deserialize, Serialize};

use super::removal::retire;
use super::{RunFolder, create_folder, write_json};
use crate::disk::{RESUMABLE, Staged, is_there};
use crate::store::{
    CHECKPOINT_FILE, CheckpointWriter, RUN_FILE, STEPS_FILE, SegmentWriter, StoredCheckpoint, read_stored, run_to_toml,
    segment_file,
};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Kept, Plan};

/// What of a run is not in its `run.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unfinished {
    /// The first seed.
    pub seed: u64,
    /// How many there are.
    pub seeds: u64,
    /// Steps from one checkpoint to the next.
    pub every: u64,
    /// How many segments of the log are kept.
    #[serde(default = "all", skip_serializing_if = "is_all")]
    pub segments: u64,
}

/// Every segment of the log is kept.
pub const ALL_SEGMENTS: u64 = u64::MAX;

fn all() -> u64 {
    ALL_SEGMENTS
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
fn is_all(segments: &u64) -> bool {
    *segments == ALL_SEGMENTS
}

impl Unfinished {
    /// Its seeds.
    #[must_use]
    pub fn all_seeds(&self) -> Vec<u64> {
        (self.seed..self.seed.saturating_add(self.seeds)).collect()
    }
}

impl RunFolder {
    /// The folder of a run that was killed or stopped, to be gone on with. It is written beside its place, as at first.
    ///
    /// # Errors
    /// `E-LOCKED` if it is still running, `E-CHECKPOINT` if there is nothing to go on with.
    pub fn resume(path: &Path) -> Result<(Self, Unfinished)> {
        let staged = Staged::beside(path, retire)?;
        let killed = staged.can_be_resumed();
        let staged = staged.resume();
        let work = staged.folder().to_owned();
        if !killed {
            take_from_place(path, &work)?;
        }
        let text = read_stored(&work.join(RESUMABLE))?;
        let wrong = |_| nothing(path, "what stands there of its seeds is damaged");
        let unfinished: Unfinished = serde_json::from_str(&text.text).map_err(wrong)?;
        let folder = Self { path: path.to_owned(), ..Self::elsewhere(&work, &work, unfinished.seeds > 1) };
        folder.marked.store(true, Ordering::Relaxed);
        Ok((Self { staged: Some(staged), ..folder }, unfinished))
    }

    /// Where it is written.
    #[must_use]
    pub fn work(&self) -> &Path {
        &self.work
    }

    /// The checkpoint of a seed, if one was kept.
    ///
    /// # Errors
    /// `E-CHECKPOINT` if it is damaged or another run's.
    pub fn checkpoint(&self, plan: &Plan, seed: u64) -> Result<Option<StoredCheckpoint>> {
        let folder = if self.many { self.work.join(seed.to_string()) } else { self.work.clone() };
        StoredCheckpoint::read(&folder, &run_to_toml(plan, seed)?, seed)
    }

    /// Keeps the checkpoints of a seed, going on after one.
    ///
    /// # Errors
    /// If the seed's folder or its file of records cannot be made.
    pub fn keeper(&self, plan: &Plan, seed: u64, after: Option<&StoredCheckpoint>) -> Result<CheckpointWriter> {
        CheckpointWriter::new(&self.of_seed(seed)?, &run_to_toml(plan, seed)?, seed, after)
    }

    /// Keeps the segments of a seed's log, the first so many of them.
    ///
    /// # Errors
    /// If the seed's folder cannot be made.
    pub fn segments(&self, plan: &Plan, seed: u64, most: u64) -> Result<SegmentWriter> {
        Ok(SegmentWriter::new(&self.of_seed(seed)?, &run_to_toml(plan, seed)?, seed, most))
    }

    /// Keeps a checkpoint. From then on the folder waits for whoever goes on with it, should this process be killed.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep_checkpoint(&self, writer: &mut CheckpointWriter, kept: Kept<'_>, unfinished: Unfinished) -> Result<()> {
        writer.keep(kept)?;
        if !self.marked.swap(true, Ordering::Relaxed) {
            write_json(&self.work.join(RESUMABLE), &unfinished)?;
        }
        Ok(())
    }

    /// Whether a checkpoint was kept.
    #[must_use]
    pub fn can_be_resumed(&self) -> bool {
        self.marked.load(Ordering::Relaxed)
    }

    /// Puts the folder of a run that is done into its place, and removes its checkpoints there: should it be killed before that,
    /// they serve.
    ///
    /// # Errors
    /// As [`RunFolder::commit`], and if one cannot be removed.
    pub fn commit_done(self, seeds: &[u64]) -> Result<()> {
        let many = self.many;
        self.staged.map_or(Ok(()), |staged| staged.commit_then(|place| forget_checkpoints(place, many, seeds)))
    }
}

fn forget_checkpoints(place: &Path, many: bool, seeds: &[u64]) -> Result<()> {
    let folder = |seed: &u64| if many { place.join(seed.to_string()) } else { place.to_owned() };
    let files = seeds.iter().flat_map(|seed| [CHECKPOINT_FILE, STEPS_FILE].map(|file| folder(seed).join(file)));
    // The one that says that there are others goes last.
    for file in files.chain([place.join(RESUMABLE)]) {
        match std::fs::remove_file(&file) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Diagnostic::disk("remove", &file, &error).fail();
            }
            _ => {}
        }
    }
    Ok(())
}

/// Copies what was kept of a run that was stopped, and so stands in its place.
fn take_from_place(place: &Path, work: &Path) -> Result<()> {
    if !is_there(&place.join(RESUMABLE))? {
        let what = if is_there(&place.join(RUN_FILE))? {
            "the run that stands there is done"
        } else {
            "no run was begun there"
        };
        return Err(nothing(place, what));
    }
    let copy = |from: &Path, to: &Path, files: &[&str]| -> Result<()> {
        for file in files {
            if is_there(&from.join(file))? {
                let copied = std::fs::copy(from.join(file), to.join(file));
                let synced = copied.and_then(|_| std::fs::File::open(to.join(file))?.sync_all());
                synced.map_err(|error| Diagnostic::disk("copy", &from.join(file), &error))?;
            }
        }
        Ok(())
    };
    let of_seed = [RUN_FILE, STEPS_FILE, CHECKPOINT_FILE];
    let copy_seed = |from: &Path, to: &Path| {
        copy(from, to, &of_seed)?;
        // Until one is missing.
        for name in (1..).map(segment_file) {
            if !is_there(&from.join(&name))? {
                break;
            }
            copy(from, to, &[&name])?;
        }
        Ok::<(), Box<Diagnostic>>(())
    };
    copy_seed(place, work)?;
    for (seed, folder) in crate::store::seed_folders(place)? {
        let to = work.join(seed.to_string());
        create_folder(&to)?;
        copy_seed(&folder, &to)?;
    }
    // Last: until it is there, what was copied is nothing to go on with.
    copy(place, work, &[RESUMABLE])
}

fn nothing(place: &Path, what: &str) -> Box<Diagnostic> {
    let shown = printable(&place.display().to_string());
    let message = format!("there is nothing to go on with in '{shown}': {what}");
    let help = "give the folder that the run was to have, such as runs/wall/1; or start it: engine run SCRIPT";
    Box::new(Diagnostic::new("E-CHECKPOINT", message).help(help))
}
