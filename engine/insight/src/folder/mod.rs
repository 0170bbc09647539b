//! A run's folder, written: what `store` reads again, the pictures of `report` and the page of `page`.

mod certificate;
mod drawn;
mod explained;
mod files;
mod pages;
mod pictures;
mod removal;
mod taken;
mod test_folder;
mod unfinished;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::disk::{Staged, write_atomic};
use crate::lint::Report;
use crate::store::{POLICY_FILE, RUN_FILE, SUMMARY_FILE, run_to_toml};
use engine::diagnostic::Result;
use engine::experiment::{Learned, Plan, RunLog, SeedRun, Spread};
use files::{write_log, write_policy, write_run, write_seed};
use removal::retire;
use taken::{Claim, taken, unfinished};

pub use certificate::{CERTIFICATE_FILE, CertificateFolder, certificate_lines, read_certificate};
pub use drawn::Redrawn;
pub use explained::{ExplainedStep, Side};
pub use files::{CURVE_FILE, DISAGREEMENTS_FILE, create_folder, curve_of, disagreements_of, write_json};
pub use removal::remove_run;
pub use test_folder::{TEST_FILE, TestFolder};
pub use unfinished::{ALL_SEGMENTS, Unfinished};

/// One seed's results.
#[derive(Debug, Clone)]
pub struct SeedResult {
    /// What was learned, the test and the figures.
    pub run: SeedRun,
    /// Every step, of a run of one seed; the logs of many are written as soon as each is done.
    pub log: Option<RunLog>,
}

/// A folder for one run, of one seed or many: complete or absent, see [`RunFolder::commit`].
#[derive(Debug)]
pub struct RunFolder {
    /// Its place.
    path: PathBuf,
    /// Where it is written: beside its place, unless it is drawn again elsewhere.
    work: PathBuf,
    /// Where its logs are: the same folder, unless it is drawn again elsewhere.
    logs: PathBuf,
    staged: Option<Staged>,
    /// Whether each seed has a folder of its own in it.
    many: bool,
    /// Whether it holds what a failure left.
    broken: AtomicBool,
    /// Whether a checkpoint was kept.
    marked: AtomicBool,
}

/// What to do if a folder holds another run: another script, other settings, another seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IfTaken {
    /// That run is replaced.
    Replace,
    /// It is replaced if it is an older one of the same script and the same seeds; else it stays, and nothing is written.
    ReplaceOwn,
    /// It stays, and nothing is run.
    Refuse,
    /// It stays, and the new run goes to the next number: `1.2` beside `1`.
    Number,
}

impl RunFolder {
    /// Creates the folder beside its place and writes `run.toml`, so that a folder that cannot be written is known before
    /// learning. What stands in its place stays.
    ///
    /// # Errors
    /// If it cannot be made; `E-LOCKED` if another process writes to it; `E-RUN-TAKEN` if it holds another run that must stay,
    /// `E-RUN-UNFINISHED` if one was killed that can be gone on with.
    pub fn create(path: &Path, plan: &Plan, seeds: &[u64], if_taken: IfTaken) -> Result<Self> {
        let run = run_to_toml(plan, seeds.first().copied().unwrap_or_default())?;
        let claim = Claim { run: &run, seeds };
        loop {
            let path = match if_taken {
                IfTaken::Number => claim.numbered(path)?,
                IfTaken::Replace | IfTaken::ReplaceOwn | IfTaken::Refuse => path.to_owned(),
            };
            let mut staged = Staged::beside(&path, retire)?;
            if if_taken == IfTaken::Replace {
                staged.discard_resumable()?;
            } else if staged.can_be_resumed() {
                return unfinished(&path).fail();
            }
            // Another process may have been done since the number was found.
            let denied = match if_taken {
                IfTaken::Replace => false,
                IfTaken::ReplaceOwn => claim.is_of_others(&path)?,
                IfTaken::Refuse | IfTaken::Number => claim.is_denied(&path)?,
            };
            if denied && if_taken == IfTaken::Number {
                continue;
            }
            if denied {
                return taken(&path).fail();
            }
            let work = staged.folder().to_owned();
            write_atomic(&work.join(RUN_FILE), run.as_bytes())?;
            return Ok(Self { path, staged: Some(staged), ..Self::elsewhere(&work, &work, seeds.len() > 1) });
        }
    }

    /// Where the run that stands in its place goes if it is another one and has a tag; nothing if none does.
    ///
    /// # Errors
    /// If that cannot be told.
    pub fn set_aside(&self) -> Result<Option<PathBuf>> {
        removal::set_aside(&self.path, &self.work, &self.path)
    }

    /// Puts the folder into its place: until then whoever looks there finds what stood there before.
    ///
    /// # Errors
    /// If that fails; what stood there is then unchanged.
    pub fn commit(self) -> Result<()> {
        self.staged.map_or(Ok(()), Staged::commit)
    }

    /// Puts the folder into its place if it holds what a failure left, see [`RunFolder::keep_broken`].
    ///
    /// # Errors
    /// As [`RunFolder::commit`].
    pub fn commit_broken(self) -> Result<()> {
        if self.broken.load(Ordering::Relaxed) { self.commit() } else { Ok(()) }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder of one seed, made if it is not there.
    fn of_seed(&self, seed: u64) -> Result<PathBuf> {
        let folder = if self.many { self.work.join(seed.to_string()) } else { self.work.clone() };
        create_folder(&folder)?;
        Ok(folder)
    }

    /// Writes the log of a seed as soon as it is done, so that no more of them are in memory than threads.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep_log(&self, plan: &Plan, seed: u64, log: &RunLog) -> Result<()> {
        write_log(&self.of_seed(seed)?, plan, seed, log)
    }

    /// Writes what there is of a seed that a failure ended: its policy, whose path is returned, and its steps, not tested.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn keep_broken(&self, plan: &Plan, learned: &Learned, log: &RunLog) -> Result<PathBuf> {
        let folder = self.of_seed(learned.seed)?;
        write_run(&folder, plan, learned.seed)?;
        write_log(&folder, plan, learned.seed, log)?;
        write_policy(&folder, plan, learned)?;
        self.broken.store(true, Ordering::Relaxed);
        let own = if self.many { self.path.join(learned.seed.to_string()) } else { self.path.clone() };
        Ok(own.join(POLICY_FILE))
    }

    /// Writes figures, policies, pictures and pages; of many seeds, a folder for each and the spread above them. The logs
    /// were kept before.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
        if self.many {
            let spread = Spread::new(results.iter().map(|result| result.run.summary.clone()).collect());
            write_json(&self.work.join(SUMMARY_FILE), &spread)?;
        }
        for result in results {
            let folder = self.of_seed(result.run.summary.seed)?;
            if self.many {
                write_run(&folder, plan, result.run.summary.seed)?;
            }
            write_seed(&folder, plan, result)?;
        }
        self.show(plan, results, checked)
    }

    /// Pictures and pages.
    fn show(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
        if self.many {
            pictures::draw_paths(&self.work, plan, results)?;
        }
        if plan.learns() {
            self.show_learned(plan, results, checked)
        } else {
            self.show_combined(plan, results, checked)
        }
    }

    /// Of many seeds, the one that fails most in its test is the one to look at.
    fn show_learned(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
        let failures = |result: &SeedResult| result.run.summary.test.failures_per_1000;
        let Some(worst) = results.iter().max_by(|a, b| failures(a).total_cmp(&failures(b))) else { return Ok(()) };
        let folder = self.of_seed(worst.run.summary.seed)?;
        // The page plays the whole run again, which takes about as long as all pictures.
        std::thread::scope(|scope| {
            let page = scope.spawn(|| pages::write_page(&self.work, &self.logs, plan, results, checked));
            let drawn = pictures::draw_curve(&self.work, plan, results)
                .and_then(|()| pictures::draw_seed(&folder, plan, worst));
            let written = page.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            drawn.and(written)
        })
    }

    /// Each seed has its own pictures and its own page.
    fn show_combined(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
        for result in results {
            let folder = self.of_seed(result.run.summary.seed)?;
            pictures::draw_seed(&folder, plan, result)?;
            let logs = if self.many { self.logs.join(result.run.summary.seed.to_string()) } else { self.logs.clone() };
            pages::write_page(&folder, &logs, plan, std::slice::from_ref(result), checked)?;
        }
        Ok(())
    }
}
