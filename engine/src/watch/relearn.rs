//! Learns again after each save, from nothing, with all seeds; a newer save ends the older run.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::board::{Board, SavedRun, SeedRun};
use super::files::Files;
use crate::diagnostic::{Diagnostic, Kind, Result};
use crate::experiment::{Ledger, Overrides, Plan, RecordShape, in_parallel, learn_into, test_into};
use crate::filter::Catalogue;
use crate::page::{Document, Moments};
use crate::reward::Behaviour;

/// A save is often several writes; so long it must be quiet.
const QUIET: Duration = Duration::from_millis(15);
/// Room for the steps of all seeds, bytes; of longer runs the beginnings are kept.
const MOST_LEDGER_BYTES: usize = 512 << 20;
/// How often the end of the program is looked for.
const GLANCE: Duration = Duration::from_millis(100);

/// What is watched and how it is learned.
pub struct WatchSettings {
    /// The script.
    pub behaviour: PathBuf,
    /// The seeds.
    pub seeds: Vec<u64>,
    /// Threads to learn with; 0 is one for each core.
    pub threads: usize,
    /// What the command line changes.
    pub overrides: Overrides,
    /// Folders of filters.
    pub filter_folders: Vec<PathBuf>,
    /// Makes the catalogue of filters anew, since a filter may have been saved.
    pub filters: Box<dyn Fn() -> Result<Arc<Catalogue>> + Send>,
}

/// Asks for another run; may be shared with the server.
#[derive(Clone)]
pub struct Asker {
    sender: Sender<()>,
    running: Arc<Mutex<Arc<AtomicBool>>>,
}

impl Asker {
    /// Another run; the one that is running ends.
    pub fn again(&self) {
        self.end_running();
        // The one who listens is gone only when the program ends.
        let _ = self.sender.send(());
    }

    fn end_running(&self) {
        self.running.lock().unwrap_or_else(PoisonError::into_inner).store(true, Ordering::Relaxed);
    }
}

/// Learns after each save, on the thread that calls [`Relearner::serve`].
pub struct Relearner {
    settings: WatchSettings,
    board: Arc<Board>,
    asker: Asker,
    asked: Receiver<()>,
    save: u64,
}

impl Relearner {
    /// Nothing is learned yet.
    #[must_use]
    pub fn new(settings: WatchSettings, board: Arc<Board>) -> Self {
        let (sender, asked) = channel();
        let asker = Asker { sender, running: Arc::default() };
        Self { settings, board, asker, asked, save: 0 }
    }

    /// Asks for runs from elsewhere.
    #[must_use]
    pub fn asker(&self) -> Asker {
        self.asker.clone()
    }

    /// Learns now, and after each save, until `stop` is set.
    ///
    /// # Errors
    /// If files cannot be watched; a script that is wrong is only said on the board.
    pub fn serve(mut self, stop: &AtomicBool) -> Result<()> {
        // Runs are ended from the thread that sees the save: this one is busy learning.
        let (saves, seen) = channel();
        let mut files = Files::new(move || {
            let _ = saves.send(());
        })?;
        files.watch(self.watched())?;
        let files = Arc::new(Mutex::new(files));
        std::thread::scope(|scope| {
            let (watched, asker) = (Arc::clone(&files), self.asker());
            scope.spawn(move || follow(&seen, &watched, &asker, stop));
            self.asker.again();
            while !stop.load(Ordering::Relaxed) {
                match self.asked.recv_timeout(GLANCE) {
                    Ok(()) => self.asked_for(&files),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
            }
            Ok(())
        })
    }

    fn asked_for(&mut self, files: &Mutex<Files>) {
        // All that was asked for until now is answered by what the files hold now.
        self.asked.try_iter().for_each(drop);
        let flag = Arc::new(AtomicBool::new(false));
        *self.asker.running.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&flag);
        self.save += 1;
        if let Err(error) = self.relearn(&flag, files)
            && !flag.load(Ordering::Relaxed)
        {
            self.board.failed(&error);
        }
    }

    fn relearn(&self, stop: &AtomicBool, files: &Mutex<Files>) -> Result<()> {
        let started = Instant::now();
        let (plan, count) = (self.plan()?, self.settings.seeds.len());
        let world = plan.layout.source.path.clone();
        files.lock().unwrap_or_else(PoisonError::into_inner).watch([world])?;
        let seeds = if count == 1 { "one seed".to_owned() } else { format!("{count} seeds") };
        self.board.working(&format!("learning {seeds}, {} steps each", plan.settings.run.steps));
        let room = (MOST_LEDGER_BYTES / (2 * count * RecordShape::of(&plan).bytes())) as u64;
        let learned = in_parallel(&self.settings.seeds, self.settings.threads, |seed| {
            let mut learning = Ledger::new(&plan, plan.settings.run.steps.min(room));
            let learned = learn_into(&plan, seed, stop, &|_| (), &mut learning)?.whole()?;
            Ok(SeedRun { learned: Arc::new(learned), learning: Arc::new(learning), test: None, tested: Ledger::off() })
        })?;
        if stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let learned_s = started.elapsed().as_secs_f64();
        let text = format!("save {}: learned in {learned_s:.2} s; testing", self.save);
        let run = self.show(plan, learned, false, &text)?;
        let tested = in_parallel(&(0..count as u64).collect::<Vec<_>>(), self.settings.threads, |index| {
            let seed = &run.seeds[index as usize].learned;
            let mut tested = Ledger::new(&run.plan, run.plan.settings.run.test_steps.min(room));
            let test = test_into(&run.plan, &seed.policy, seed.seed, stop, &mut tested)?;
            Ok((test.figures, tested))
        })?;
        if stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let seeds_done = run.seeds.iter().zip(tested).map(|(seed, (test, tested))| SeedRun {
            learned: Arc::clone(&seed.learned),
            learning: Arc::clone(&seed.learning),
            test: Some(test),
            tested,
        });
        let text = format!("save {}: learned in {learned_s:.2} s, tested", self.save);
        self.show(run.plan.clone(), seeds_done.collect(), true, &text).map(drop)
    }

    fn plan(&self) -> Result<Plan> {
        let behaviour = Arc::new(Behaviour::load(&self.settings.behaviour)?);
        let plan = Plan::with_filters(behaviour, &self.settings.overrides, (self.settings.filters)()?)?;
        if plan.settings.policies.is_empty() {
            return Ok(plan);
        }
        Diagnostic::new(Kind::Input, "E-WATCH-POLICIES", "this behaviour combines learned policies: it learns nothing")
            .help("watch one of the behaviours that it combines, or run it: engine run SCRIPT")
            .into()
    }

    fn show(&self, plan: Plan, seeds: Vec<SeedRun>, done: bool, text: &str) -> Result<Arc<SavedRun>> {
        let data: Vec<_> = seeds.iter().map(SeedRun::data).collect();
        let document = Document::new(&plan, &data, Moments { shots: 0, scans: done, seeds: Some(1) })?;
        let run = Arc::new(SavedRun { save: self.save, plan, seeds });
        self.board.run(&run, done, text, &document)?;
        Ok(run)
    }

    fn watched(&self) -> Vec<PathBuf> {
        let folders = self.settings.filter_folders.iter();
        let libraries = folders.filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
        std::iter::once(self.settings.behaviour.clone()).chain(libraries.map(|entry| entry.path())).collect()
    }
}

/// Ends the running run and asks for the next one whenever a watched file has another content than before.
fn follow(seen: &Receiver<()>, files: &Mutex<Files>, asker: &Asker, stop: &AtomicBool) {
    while !stop.load(Ordering::Relaxed) {
        match seen.recv_timeout(GLANCE) {
            Ok(()) => while seen.recv_timeout(QUIET).is_ok() {},
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => return,
        }
        if files.lock().unwrap_or_else(PoisonError::into_inner).changed() {
            asker.again();
        }
    }
    asker.end_running();
}
