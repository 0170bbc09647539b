//! What the page and the terminal are told: the last good run, the error after it, what is being done. Written by the one
//! thread that learns, read by the server and the terminal; nobody waits for a reader.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use engine::diagnostic::{Diagnostic, Result, Severity};
use engine::experiment::{Learned, Ledger, Plan};
use engine::verdict::{BaseLines, TestFigures};
use insight::lint::Report;
use insight::page::{CheckView, Document, FindingView, SeedData, SeedView};
use serde::Serialize;

/// One seed of a run.
#[derive(Debug)]
pub struct WatchedSeed {
    /// Its number.
    pub seed: u64,
    /// What it learned; nothing of a behaviour that combines policies.
    pub learned: Option<Arc<Learned>>,
    /// Steps of learning.
    pub learning: Arc<Ledger>,
    /// The test's figures, once it is done.
    pub test: Option<TestFigures>,
    /// What it is held against.
    pub lines: Option<BaseLines>,
    /// Steps of the test.
    pub tested: Ledger,
}

impl WatchedSeed {
    /// The curve of learning; none of what combines.
    #[must_use]
    pub fn curve(&self) -> Vec<f64> {
        self.learned.as_ref().map_or_else(Vec::new, |learned| learned.tally.curve())
    }

    /// The seed as the page's room reads it.
    #[must_use]
    pub fn data(&self) -> SeedData<'_> {
        let learned = self.learned.as_deref();
        SeedData {
            seed: self.seed,
            tally: learned.map(|learned| &learned.tally),
            policy: learned.map(|learned| &learned.policy),
            test: self.test.as_ref(),
            lines: self.lines.as_ref(),
            learning: &self.learning,
            tested: &self.tested,
        }
    }
}

/// A run that can be asked for its moments.
pub struct SavedRun {
    /// The number of the save, from 1.
    pub save: u64,
    /// The plan.
    pub plan: Plan,
    /// The seeds.
    pub seeds: Vec<WatchedSeed>,
}

/// What one message to the page holds.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Message<'a> {
    Working { text: &'a str },
    Failed { text: String, blocks: Vec<String>, summary: Option<String>, error: serde_json::Value },
    Run { save: u64, done: bool, text: &'a str, document: &'a Document, before: Option<&'a Before> },
    Checked { save: u64, findings: &'a [FindingView], checked: &'a CheckView },
    Unchecked { save: u64, text: String },
}

/// What the page draws behind a new run: the run of the save before.
#[derive(Debug, Clone, Serialize)]
struct Before {
    seeds: Vec<SeedView>,
}

/// What a reader inside this program is shown; cheap to copy.
#[derive(Clone, Default)]
pub struct Shown {
    /// Grows with everything that is new.
    pub number: u64,
    /// The last good run.
    pub run: Option<ShownRun>,
    /// What is being done, or how the last run went.
    pub text: Arc<str>,
    /// Whether something is being learned or tested now.
    pub busy: bool,
    /// What is wrong with the last save, if it could not be learned.
    pub error: Option<Arc<Diagnostic>>,
}

/// A run with what is drawn beside it.
#[derive(Clone)]
pub struct ShownRun {
    /// The run.
    pub run: Arc<SavedRun>,
    /// The plan's side of its document: world, rules, findings; no seeds.
    pub document: Arc<Document>,
    /// The curves of the save before, one for each seed.
    pub before: Option<Arc<[Vec<f64>]>>,
}

/// The messages that a page which comes now must get, oldest first; each with its number.
#[derive(Debug, Clone, Default)]
pub(super) struct Posted {
    pub messages: Vec<(u64, Arc<str>)>,
}

#[derive(Default)]
struct Written {
    number: u64,
    run: Option<(u64, Arc<str>)>,
    checked: Option<(u64, Arc<str>)>,
    last: Option<(u64, Arc<str>)>,
    saved: Option<Arc<SavedRun>>,
    shown: Option<(u64, Before)>,
    before: Option<Before>,
    told: Shown,
}

impl Written {
    fn tell(&mut self, run: &Arc<SavedRun>, done: bool, text: &str, document: &Document) {
        let document = Arc::new(Document { seeds: Vec::new(), ..document.clone() });
        let before = self.before.as_ref().map(|before| before.seeds.iter().map(|seed| seed.curve.clone()).collect());
        let run = ShownRun { run: Arc::clone(run), document, before };
        self.told = Shown { number: 0, run: Some(run), text: text.into(), busy: !done, error: None };
    }
}

/// The board.
#[derive(Default)]
pub struct Board {
    written: Mutex<Written>,
    news: Condvar,
}

impl Board {
    /// Says what is being done.
    pub fn working(&self, text: &str) {
        self.post(&Message::Working { text }, |told| (told.text, told.busy) = (text.into(), true));
    }

    /// Everything, if anything is newer than number `after`.
    #[must_use]
    pub fn shown(&self, after: u64) -> Option<Shown> {
        let written = self.lock();
        (written.number > after).then(|| Shown { number: written.number, ..written.told.clone() })
    }

    /// Says that a save could not be used, with each mistake as a block of text; the last good run stays.
    pub fn failed(&self, error: &Diagnostic) {
        let message = Message::Failed {
            text: error.render(false),
            blocks: error.all().map(|one| one.render_as(Severity::Error, false)).collect(),
            summary: error.summary(),
            error: error.to_json(),
        };
        self.post(&message, |told| (told.error, told.busy) = (Some(Arc::new(error.clone())), false));
    }

    /// Shows a run; `done` if its test is over too.
    ///
    /// # Errors
    /// If the document cannot be written as JSON.
    pub fn run(&self, run: &Arc<SavedRun>, done: bool, text: &str, document: &Document) -> Result<()> {
        let views = |document: &Document| Before {
            seeds: document
                .seeds
                .iter()
                .map(|seed| SeedView { learning: None, tested: None, ..seed.clone() })
                .collect(),
        };
        let mut written = self.lock();
        match written.shown.take() {
            Some((save, shown)) if save != run.save => written.before = Some(shown),
            _ => {}
        }
        written.shown = Some((run.save, views(document)));
        written.tell(run, done, text, document);
        let before = written.before.as_ref();
        let text = encode(&Message::Run { save: run.save, done, text, document, before })?;
        written.number += 1;
        written.run = Some((written.number, text));
        (written.checked, written.last) = (None, None);
        written.saved = Some(Arc::clone(run));
        drop(written);
        self.news.notify_all();
        Ok(())
    }

    /// Says what a check of the shown run found.
    pub(super) fn checked(&self, run: &SavedRun, report: &Report) {
        let findings: Vec<FindingView> = report.findings.iter().map(FindingView::from).collect();
        let checked = CheckView::from(report);
        if let Some(told) = self.lock().told.run.as_mut().filter(|told| told.run.save == run.save) {
            let document = (*told.document).clone();
            told.document =
                Arc::new(Document { findings: findings.clone(), checked: Some(checked.clone()), ..document });
        }
        self.post_check(&Message::Checked { save: run.save, findings: &findings, checked: &checked });
    }

    /// Says that the check of the shown run ended early.
    pub(super) fn unchecked(&self, run: &SavedRun, fault: &Diagnostic) {
        self.post_check(&Message::Unchecked { save: run.save, text: fault.message.clone() });
    }

    fn post_check(&self, message: &Message<'_>) {
        let Ok(text) = encode(message) else { return };
        let mut written = self.lock();
        written.number += 1;
        written.checked = Some((written.number, text));
        drop(written);
        self.news.notify_all();
    }

    /// The run that is shown, if its save has this number.
    pub(super) fn saved(&self, save: u64) -> Option<Arc<SavedRun>> {
        self.lock().saved.clone().filter(|run| run.save == save)
    }

    /// What a page that knows all up to number `after` must get; waits for it, but not longer than `most`.
    pub(super) fn posted(&self, after: u64, most: Duration) -> Posted {
        let waited = self.news.wait_timeout_while(self.lock(), most, |written| written.number <= after);
        let (written, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let all = [&written.run, &written.checked, &written.last].into_iter().flatten();
        Posted { messages: all.filter(|(number, _)| *number > after).cloned().collect() }
    }

    fn post(&self, message: &Message<'_>, tell: impl FnOnce(&mut Shown)) {
        let Ok(text) = encode(message) else { return };
        let mut written = self.lock();
        tell(&mut written.told);
        written.number += 1;
        written.last = Some((written.number, text));
        drop(written);
        self.news.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Written> {
        // Whoever panicked while writing left whole fields behind.
        self.written.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn encode(message: &Message<'_>) -> Result<Arc<str>> {
    let text = serde_json::to_string(message)
        .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("cannot write a message: {error}"))))?;
    Ok(text.into())
}
