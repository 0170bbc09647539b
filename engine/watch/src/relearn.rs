//! Learns again after each save, with all seeds: from nothing, and a newer save ends the older run; or, where what was
//! learned is to be kept, on from there under the new reward.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::board::{Board, SavedRun, WatchedSeed};
use super::desk::{Desk, SeedTest, WatchSettings, test_seed};
use super::files::{Files, SETTLE};
use super::session::Session;
use super::{combined, findings};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Plan, WINDOW_STEPS, in_parallel};
use engine::learner::Carry;
use engine::script::ParamValues;
use insight::store::{policy_files, with_policies_or};

/// A save is often several writes; so long it must be quiet.
const QUIET: Duration = Duration::from_millis(15);
/// How often the end of the program is looked for.
const GLANCE: Duration = Duration::from_millis(100);
/// How often a run that is being learned is shown.
const SHOWN_EVERY: Duration = Duration::from_secs(1);

/// Why a run is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Why {
    /// A file was saved.
    Saved,
    /// Somebody wants it, from nothing.
    Wanted,
}

/// Asks for another run; may be shared with the server.
#[derive(Clone)]
pub struct Asker {
    sender: Sender<Why>,
    /// Values of the script's parameters that somebody chose on the page.
    chosen: Arc<Mutex<ParamValues>>,
    running: Arc<Mutex<Arc<AtomicBool>>>,
}

impl Asker {
    /// Another run, from nothing; the one that is running ends.
    pub fn again(&self) {
        self.ask(Why::Wanted);
    }

    /// Another value of a parameter; what a save does happens then.
    pub fn set(&self, name: &str, value: f64) {
        self.chosen.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), value);
        self.ask(Why::Saved);
    }

    fn ask(&self, why: Why) {
        self.end_running();
        // The one who listens is gone only when the program ends.
        let _ = self.sender.send(why);
    }

    fn end_running(&self) {
        self.running.lock().unwrap_or_else(PoisonError::into_inner).store(true, Ordering::Relaxed);
    }
}

/// Learns after each save, on the thread that calls [`Relearner::serve`].
pub struct Relearner {
    desk: Desk,
    asker: Asker,
    asked: Receiver<Why>,
    /// What goes on with the next save.
    session: Option<Session>,
}

impl Relearner {
    /// Nothing is learned yet.
    #[must_use]
    pub fn new(settings: WatchSettings, board: Arc<Board>) -> Self {
        let (sender, asked) = channel();
        let asker = Asker { sender, chosen: Arc::default(), running: Arc::default() };
        Self { desk: Desk { settings, board, save: 0 }, asker, asked, session: None }
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
        files.watch([self.desk.settings.behaviour.clone()])?;
        files.watch_filters(&self.desk.settings.filter_folders)?;
        let files = Arc::new(Mutex::new(files));
        std::thread::scope(|scope| {
            let (watched, asker) = (Arc::clone(&files), self.asker());
            scope.spawn(move || follow(&seen, &watched, &asker, stop));
            self.asker.again();
            while !stop.load(Ordering::Relaxed) {
                match self.asked.recv_timeout(GLANCE) {
                    Ok(why) => self.asked_for(why, &files),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
            }
            Ok(())
        })
    }

    fn asked_for(&mut self, why: Why, files: &Mutex<Files>) {
        // All that was asked for until now is answered by what the files hold now.
        let wanted = self.asked.try_iter().fold(why, |all, why| if why == Why::Wanted { why } else { all });
        let flag = Arc::new(AtomicBool::new(false));
        *self.asker.running.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&flag);
        self.desk.save += 1;
        if let Err(error) = self.relearn(wanted, &flag, files)
            && !flag.load(Ordering::Relaxed)
        {
            self.desk.board.failed(&error);
        }
    }

    fn relearn(&mut self, why: Why, stop: &AtomicBool, files: &Mutex<Files>) -> Result<()> {
        let plan = self.plan(files);
        if plan.as_ref().is_ok_and(|plan| !plan.learns()) {
            self.session = None;
            return combined::retest(&self.desk, plan?, stop, files);
        }
        let (mut session, error) = match plan.and_then(|plan| self.next_session(plan, why)) {
            Ok(session) => (session, None),
            // The robots go on with the last good script; the error stays in sight.
            Err(error) => match self.session.take() {
                Some(session) if !session.is_tested() => (session, Some(error)),
                idle => {
                    self.session = idle;
                    return Err(error);
                }
            },
        };
        self.learn(&mut session, error.as_deref(), stop)?;
        self.session = Some(session).filter(|_| self.desk.settings.keep.is_some());
        Ok(())
    }

    /// What this save learns: from nothing, or what was learned before under another reward.
    fn next_session(&mut self, mut plan: Plan, why: Why) -> Result<Session> {
        let mut note = String::new();
        if self.desk.settings.keep.is_some() {
            // A window of the curve is of one reward only.
            let (asked, whole) = (plan.settings.run.steps, plan.settings.run.steps.next_multiple_of(WINDOW_STEPS));
            plan.settings.run.steps = whole;
            if whole != asked {
                note = format!("{whole} steps for {asked}, since --keep goes by whole windows of {WINDOW_STEPS}; ");
            }
        }
        let kept = self.session.take().filter(|_| why == Why::Saved);
        if let (Some(carry), Some(mut session)) = (self.desk.settings.keep, kept) {
            match plan.differs_beyond_reward(session.plan()) {
                None => {
                    session.swap(plan, carry)?;
                    return Ok(session);
                }
                Some(what) if carry == Carry::Reset => note.push_str(&format!("{what} changed, so from nothing; ")),
                Some(what) => {
                    let (on, how) = gone_on(plan, &session, &what)?;
                    plan = on;
                    note.push_str(&how);
                }
            }
        }
        let whole = self.desk.settings.keep.is_some() || self.desk.settings.finished.is_some();
        Session::new(plan, &self.desk.settings.seeds, self.desk.settings.threads, whole, note)
    }

    fn learn(&self, session: &mut Session, error: Option<&Diagnostic>, stop: &AtomicBool) -> Result<()> {
        let (started, mut shown, mut pause) = (Instant::now(), Instant::now(), SHOWN_EVERY);
        let (from, steps) = (session.done(), session.plan().learning_steps());
        let seeds = match self.desk.settings.seeds.len() {
            1 => "one seed".to_owned(),
            count => format!("{count} seeds"),
        };
        let note = session.note().to_owned();
        self.say(&format!("{note}learning {seeds}, {} steps each", steps - from), error);
        while !session.is_over() {
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            session.advance()?;
            if shown.elapsed() >= pause && !session.is_over() {
                let begun = Instant::now();
                let text = format!("save {}: {note}step {} of {steps}", self.desk.save, session.done());
                self.desk.show(session.plan().clone(), session.seeds(false)?, false, &text, error)?;
                // Showing takes a tenth of the time at most.
                (shown, pause) = (Instant::now(), SHOWN_EVERY.max(10 * begun.elapsed()));
            }
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let learned_s = started.elapsed().as_secs_f64();
        let text = format!("save {}: {note}learned in {learned_s:.2} s", self.desk.save);
        let run =
            self.desk.show(session.plan().clone(), session.seeds(true)?, false, &format!("{text}; testing"), error)?;
        let tested = self.test(&run, session.room(), stop)?;
        if stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let mut tests = Vec::new();
        let seeds = run.seeds.iter().zip(tested).map(|(seed, SeedTest { run: test, lines, kept })| {
            let figures = test.figures.clone();
            tests.push(test);
            WatchedSeed {
                seed: seed.seed,
                learned: seed.learned.clone(),
                learning: Arc::clone(&seed.learning),
                test: Some(figures),
                lines: Some(lines),
                tested: kept,
            }
        });
        let seeds = seeds.collect();
        let run = self.desk.show(run.plan.clone(), seeds, true, &format!("{text}, tested"), error)?;
        session.end();
        if let Some(finished) = &self.desk.settings.finished {
            finished(&run, tests, started.elapsed().as_secs_f64())?;
        }
        findings::tell(&self.desk.board, &run, self.desk.settings.threads, stop);
        Ok(())
    }

    fn test(&self, run: &SavedRun, room: u64, stop: &AtomicBool) -> Result<Vec<SeedTest>> {
        let indices: Vec<u64> = (0..run.seeds.len() as u64).collect();
        in_parallel(&indices, self.desk.settings.threads, |index| {
            let watched = &run.seeds[index as usize];
            test_seed(&run.plan, watched.seed, watched.learned.as_deref(), room, stop)
        })
    }

    /// The script with the values that somebody chose, as long as it takes them.
    fn loaded(&self) -> Result<Plan> {
        let WatchSettings { behaviour, overrides, filters, .. } = &self.desk.settings;
        let mut chosen = self.asker.chosen.lock().unwrap_or_else(PoisonError::into_inner);
        let mut with = overrides.clone();
        with.set.retain(|pair| !chosen.keys().any(|name| pair.split('=').next().is_some_and(|key| key.trim() == name)));
        with.set.extend(chosen.iter().map(|(name, value)| format!("{name}={value}")));
        match Plan::load(behaviour, &with, filters) {
            Err(error) if error.code == "E-SET" && !chosen.is_empty() => {
                chosen.clear();
                Plan::load(behaviour, overrides, filters)
            }
            plan => plan,
        }
    }

    fn plan(&self, files: &Mutex<Files>) -> Result<Plan> {
        let plan = self.loaded()?;
        // A world that is made by rule is no file.
        let worlds = plan.worlds.layouts().iter().map(|layout| layout.source.path.clone());
        let worlds = worlds.filter(|path| path.exists());
        // A body that ships is no file.
        let body = plan.behaviour.body().map(|body| body.path.clone()).filter(|path| path.exists());
        files.lock().unwrap_or_else(PoisonError::into_inner).watch(worlds.chain(body))?;
        if !plan.learns() || !plan.behaviour.hands_over() {
            return Ok(plan);
        }
        files.lock().unwrap_or_else(PoisonError::into_inner).watch(policy_files(&plan))?;
        with_policies_or(plan, &*self.desk.settings.packed)
    }

    /// Says what is being done, or what is wrong with the script that was saved while it is done.
    fn say(&self, text: &str, error: Option<&Diagnostic>) {
        match error {
            Some(error) => self.desk.board.failed(error),
            None => self.desk.board.working(text),
        }
    }
}

/// Ends the running run and asks for the next one whenever a watched file has another content than before.
fn follow(seen: &Receiver<()>, files: &Mutex<Files>, asker: &Asker, stop: &AtomicBool) {
    let mut look_again = None;
    while !stop.load(Ordering::Relaxed) {
        match seen.recv_timeout(GLANCE) {
            Ok(()) => while seen.recv_timeout(QUIET).is_ok() {},
            Err(RecvTimeoutError::Timeout) if look_again.is_some_and(|due| Instant::now() >= due) => {}
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let found = files.lock().unwrap_or_else(PoisonError::into_inner).look();
        look_again = found.unfinished.then(|| Instant::now() + SETTLE);
        if found.saved {
            asker.ask(Why::Saved);
        }
    }
    asker.end_running();
}

/// The plan, going on from what the seeds of a session have learned in another world or on another body, if it can; with words
/// for the reader.
fn gone_on(plan: Plan, session: &Session, what: &str) -> Result<(Plan, String)> {
    let origins = session.origins(&plan)?;
    let Some(carried) = origins.first().map(|origin| origin.carried(&plan)) else { return Ok((plan, String::new())) };
    match plan.clone().going_on_from(origins) {
        Ok(plan) => Ok((plan, format!("{what} changed: {carried}; "))),
        Err(_) => Ok((plan, format!("{what} changed, so from nothing; "))),
    }
}
