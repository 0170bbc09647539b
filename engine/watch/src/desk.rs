//! What all of a watch have at hand: what is watched, how it is learned, and the board on which it is shown.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::board::{Board, SavedRun, WatchedSeed};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Decider, Learned, Ledger, Overrides, Plan, TestRun, base_lines};
use engine::filter::Catalogue;
use engine::learner::Carry;
use engine::verdict::BaseLines;
use insight::page::{Document, Moments};
use insight::store::PolicyText;

/// Called with every run that was learned and tested, its tests, and the seconds that both took.
pub type Finished = Box<dyn Fn(&SavedRun, Vec<TestRun>, f64) -> Result<()> + Send>;

/// Finds the policy of a pack by the path of its file or by its name; nothing if there is no such pack.
pub type Packed = Box<dyn Fn(&Path) -> Result<Option<PolicyText>> + Send>;

/// What is watched and how it is learned.
pub struct WatchSettings {
    /// The script.
    pub behaviour: PathBuf,
    /// The seeds.
    pub seeds: Vec<u64>,
    /// Threads to learn with; 0 is one for each core.
    pub threads: usize,
    /// Whether a save that changes only the reward goes on with what was learned, and what becomes of the table then.
    pub keep: Option<Carry>,
    /// What is done with finished runs.
    pub finished: Option<Finished>,
    /// What the command line changes.
    pub overrides: Overrides,
    /// Folders of filters.
    pub filter_folders: Vec<PathBuf>,
    /// Where policies are found that lie in packs.
    pub packed: Packed,
    /// Makes the catalogue of filters anew, since a filter may have been saved.
    pub filters: Box<dyn Fn() -> Result<Arc<Catalogue>> + Send>,
}

/// Settings, board, and the number of the save that is worked on.
pub(super) struct Desk {
    pub(super) settings: WatchSettings,
    pub(super) board: Arc<Board>,
    pub(super) save: u64,
}

impl Desk {
    /// Puts a run on the board, with what is wrong with the script that was saved meanwhile.
    pub(super) fn show(
        &self,
        plan: Plan,
        seeds: Vec<WatchedSeed>,
        done: bool,
        text: &str,
        error: Option<&Diagnostic>,
    ) -> Result<Arc<SavedRun>> {
        let data: Vec<_> = seeds.iter().map(WatchedSeed::data).collect();
        let document = Document::new(&plan, &data, Moments { shots: 0, scans: done, seeds: Some(1) })?;
        let run = Arc::new(SavedRun { save: self.save, plan, seeds });
        self.board.run(&run, done, text, &document)?;
        error.into_iter().for_each(|error| self.board.failed(error));
        Ok(run)
    }
}

/// A test, with its base lines, and the steps that were kept.
pub(super) struct SeedTest {
    pub run: TestRun,
    pub lines: BaseLines,
    pub kept: Ledger,
}

/// Tests what a seed learned, or what the plan combines; so many steps of it are kept.
pub(super) fn test_seed(
    plan: &Plan,
    seed: u64,
    learned: Option<&Learned>,
    room: u64,
    stop: &AtomicBool,
) -> Result<SeedTest> {
    let mut kept = Ledger::new(plan, plan.settings.run.test_steps.min(room));
    kept.set_out_from(learned.map_or(&[], |learned| learned.policy.kept()));
    let run = Decider::of(learned).test(plan, seed, stop, &mut kept)?;
    let lines = base_lines(plan, seed, &run, stop)?;
    Ok(SeedTest { run, lines, kept })
}
