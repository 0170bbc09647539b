//! Plays recorded steps again on a thread of its own, for what is not recorded: whole scans, cells, reasons. The drawing
//! thread asks for the step that it shows; only the last question is answered.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::traces::{MeasureTraces, Tracer};
use crate::SavedRun;
use engine::experiment::{Ledger, Phase, Playback, StepReasons};
use insight::page::recall_of;

/// A newer question is looked for after so many steps.
const GLANCE_STEPS: usize = 200;

/// Which step is meant.
#[derive(Clone)]
pub struct Question {
    /// The run.
    pub run: Arc<SavedRun>,
    /// Index of the seed in the run.
    pub seed: usize,
    /// The phase.
    pub phase: Phase,
    /// The step.
    pub step: usize,
}

/// One step as it was.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Every range of the laser at the end of the step, metres.
    pub ranges_m: Vec<f32>,
    /// Why it was rewarded.
    pub reasons: StepReasons,
    /// What the script's measures came to, in their order.
    pub measures: Vec<f64>,
}

/// An answer with its question.
pub(super) type Answer = (Question, Option<Arc<Moment>>);
/// The measures of a phase, with a question about it.
pub(super) type Traced = (Question, Arc<MeasureTraces>);

#[derive(Default)]
struct PlayerDesk {
    asked: Option<Question>,
    answered: Option<Answer>,
    traced: Option<Traced>,
    over: bool,
}

/// Answers until it is dropped.
#[derive(Default)]
pub(super) struct Player {
    desk: Arc<(Mutex<PlayerDesk>, Condvar)>,
}

impl Question {
    /// The steps of its phase.
    #[must_use]
    pub fn ledger(&self) -> Option<&Ledger> {
        let seed = self.run.seeds.get(self.seed)?;
        Some(if self.phase == Phase::Learning { &seed.learning } else { &seed.tested })
    }

    pub(super) fn same_steps(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.run, &other.run) && (self.seed, self.phase) == (other.seed, other.phase)
    }
}

impl Player {
    /// A player on a thread of its own.
    pub(super) fn start() -> Self {
        let player = Self::default();
        let desk = Arc::clone(&player.desk);
        std::thread::spawn(move || {
            let mut question = next(&desk);
            while let Some(first) = question {
                question = play(&first, &desk);
            }
        });
        player
    }

    /// Asks, and waits a moment: near steps are played at once.
    pub(super) fn ask(&self, question: Question, wait: Duration) -> Option<Answer> {
        let (desk, changed) = &*self.desk;
        let mut desk = lock(desk);
        (desk.asked, desk.answered) = (Some(question), None);
        changed.notify_all();
        let waited = changed.wait_timeout_while(desk, wait, |desk| desk.answered.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.answered.take()
    }

    /// The measures of a phase, once they have been played.
    pub(super) fn traced(&self) -> Option<Traced> {
        lock(&self.desk.0).traced.take()
    }

    /// An answer that came later.
    pub(super) fn answered(&self) -> Option<Answer> {
        lock(&self.desk.0).answered.take()
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        lock(&self.desk.0).over = true;
        self.desk.1.notify_all();
    }
}

fn lock(desk: &Mutex<PlayerDesk>) -> MutexGuard<'_, PlayerDesk> {
    desk.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The next question; none at the end.
fn next((desk, changed): &(Mutex<PlayerDesk>, Condvar)) -> Option<Question> {
    let waited = changed.wait_while(lock(desk), |desk| desk.asked.is_none() && !desk.over);
    let mut desk = waited.unwrap_or_else(PoisonError::into_inner);
    if desk.over { None } else { desk.asked.take() }
}

/// Answers questions about one phase; the first one about another comes back.
fn play(first: &Question, desk: &(Mutex<PlayerDesk>, Condvar)) -> Option<Question> {
    let (plan, mut question) = (&first.run.plan, first.clone());
    let (Some(seed), Some(ledger)) = (first.run.seeds.get(first.seed), first.ledger()) else { return next(desk) };
    let playback = Playback::new(plan, seed.seed, first.phase, ledger);
    let mut playback = playback.and_then(|playback| match first.phase {
        Phase::Learning => playback.recalling(),
        Phase::Test => Ok(playback.with_recall(recall_of(plan, seed.seed, &seed.learning)?)),
    });
    let newer = || {
        let desk = lock(&desk.0);
        desk.over || desk.asked.is_some()
    };
    let measures = plan.behaviour.measures().next().is_some();
    let mut tracer = measures.then(|| Tracer::new(plan, seed.seed, first.phase, ledger).ok()).flatten();
    loop {
        let found = playback.as_mut().map_or(Some(None), |playback| moment(playback, &question, ledger, newer));
        if let Some(found) = found {
            lock(&desk.0).answered = Some((question, found.map(Arc::new)));
            desk.1.notify_all();
        }
        // What cannot be played has no traces.
        match tracer.as_mut().map(|tracer| tracer.go_on(newer)) {
            Some(Ok(None)) | None => {}
            Some(traces) => {
                tracer = None;
                lock(&desk.0).traced = traces.ok().flatten().map(|traces| (first.clone(), Arc::new(traces)));
            }
        }
        question = next(desk)?;
        if !question.same_steps(first) {
            return Some(question);
        }
    }
}

/// One step; nothing where a newer question came on the way to it, or nothing in it where it cannot be played.
fn moment(
    playback: &mut Playback<'_>,
    question: &Question,
    ledger: &Ledger,
    newer: impl Fn() -> bool,
) -> Option<Option<Moment>> {
    if question.step >= ledger.len() {
        return Some(None);
    }
    loop {
        let from = if playback.done() > question.step { 0 } else { playback.done() };
        let until = (from + GLANCE_STEPS).min(question.step);
        if playback.seek(until).is_err() {
            return Some(None);
        }
        if until == question.step {
            break;
        }
        if newer() {
            return None;
        }
    }
    let reasons = StepReasons::of_next(playback).ok().flatten();
    Some(reasons.map(|reasons| {
        let cycle = playback.cycle();
        Moment { ranges_m: cycle.observation().scan.ranges_m.clone(), reasons, measures: cycle.measures().collect() }
    }))
}
