//! What the terminal shows and where its reader stands: run, seed, phase, step, panel. Drawing only reads it.

use std::sync::Arc;

use super::ink::TerminalInk;
use super::player::{Answer, Moment, Question, Traced};
use super::story::Story;
use super::traces::MeasureTraces;
use crate::{Shown, ShownRun, WatchedSeed};
use engine::experiment::{Ledger, Phase, Record};
use insight::page::Document;

/// How many times faster than the robot the steps go by, by digit.
pub(super) const SPEEDS: [u32; 9] = [1, 2, 5, 10, 25, 50, 100, 250, 1000];

/// A part of the screen that can have the whole of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Panel {
    /// The world from above.
    World,
    /// The learning curve.
    Curve,
    /// The rules over time.
    Rules,
    /// The shown step and its reasons.
    Step,
    /// What the lint found.
    Findings,
}

impl Panel {
    /// All of them, in the order of the key.
    pub(super) const ALL: [Self; 5] = [Self::World, Self::Curve, Self::Rules, Self::Step, Self::Findings];
}

/// The state of the screen.
pub struct View {
    pub(super) shown: Shown,
    pub(super) address: String,
    pub(super) ink: TerminalInk,
    pub(super) seed: usize,
    pub(super) phase: Phase,
    /// The phase that the reader chose; another one is shown while that has no steps.
    wanted: Phase,
    pub(super) step: usize,
    pub(super) speed: usize,
    pub(super) playing: bool,
    /// The panel that has the whole screen.
    pub(super) large: Option<Panel>,
    pub(super) help: bool,
    /// Lines that are scrolled away in a panel of text.
    pub(super) scroll: usize,
    pub(super) story: Story,
    answer: Option<Answer>,
    traced: Option<Traced>,
    /// The part of a step that has gone by while playing.
    share: f64,
    /// Whether the reader has chosen a step; until then it is the last one.
    moved: bool,
}

impl View {
    /// A screen before the first run; the page is at `address`.
    #[must_use]
    pub fn new(address: impl Into<String>, ink: TerminalInk) -> Self {
        Self {
            shown: Shown::default(),
            address: address.into(),
            ink,
            seed: 0,
            phase: Phase::Learning,
            wanted: Phase::Learning,
            step: 0,
            speed: 3,
            playing: false,
            large: None,
            help: false,
            scroll: 0,
            story: Story::default(),
            answer: None,
            traced: None,
            share: 0.0,
            moved: false,
        }
    }

    /// Shows what the board has now; seed, phase and step stay where they can.
    pub fn show(&mut self, shown: Shown) {
        let seed = self.seed_run().map(|seed| seed.seed);
        let same = |a: &ShownRun, b: &ShownRun| Arc::ptr_eq(&a.run, &b.run);
        let new_run = match (&self.shown.run, &shown.run) {
            (Some(old), Some(new)) => !same(old, new),
            (old, new) => old.is_some() != new.is_some(),
        };
        self.shown = shown;
        if new_run {
            let seeds = self.shown.run.iter().flat_map(|shown| &shown.run.seeds);
            self.seed = seeds.map(|seed| seed.seed).position(|now| Some(now) == seed).unwrap_or(0);
            self.choose(self.wanted);
        }
    }

    /// Keeps what was played again.
    pub fn take(&mut self, answer: Answer) {
        self.answer = Some(answer);
    }

    /// Keeps what the measures of a phase came to.
    pub fn take_traces(&mut self, traced: Traced) {
        self.traced = Some(traced);
    }

    /// What the measures of the shown phase came to, once that has come.
    pub(super) fn traces(&self) -> Option<&MeasureTraces> {
        let (of, traces) = self.traced.as_ref()?;
        Some(&**traces).filter(|_| self.here().is_some_and(|here| of.same_steps(&here)))
    }

    /// What has to be played again to show the step whole; nothing if it is known, or there is no run.
    #[must_use]
    pub fn question(&self) -> Option<Question> {
        let question = self.here()?;
        let known = self.answer.as_ref().is_some_and(|(of, _)| of.step == question.step && of.same_steps(&question));
        (!known && self.ledger().is_some_and(|ledger| !ledger.is_empty())).then_some(question)
    }

    /// The shown step as it was played again, once that has come.
    pub(super) fn moment(&self) -> Option<&Moment> {
        let (of, moment) = self.answer.as_ref()?;
        let here = self.here()?;
        moment.as_deref().filter(|_| of.step == here.step && of.same_steps(&here))
    }

    fn here(&self) -> Option<Question> {
        let run = Arc::clone(&self.shown.run.as_ref()?.run);
        Some(Question { run, seed: self.seed, phase: self.phase, step: self.step })
    }

    pub(super) fn document(&self) -> Option<&Document> {
        self.shown.run.as_ref().map(|shown| &*shown.document)
    }

    pub(super) fn seed_run(&self) -> Option<&WatchedSeed> {
        self.shown.run.as_ref()?.run.seeds.get(self.seed)
    }

    /// The steps that are shown.
    pub(super) fn ledger(&self) -> Option<&Ledger> {
        let seed = self.seed_run()?;
        Some(if self.phase == Phase::Learning { &seed.learning } else { &seed.tested })
    }

    pub(super) fn record(&self) -> Option<Record> {
        self.ledger()?.record(self.step)
    }

    /// Whether a rule fired in the shown step.
    pub(super) fn fired(&self, rule: usize) -> bool {
        self.ledger().is_some_and(|ledger| self.story.fired_at(ledger, self.step).any(|(fired, _)| fired == rule))
    }

    fn last_step(&self) -> usize {
        self.ledger().map_or(0, |ledger| ledger.len().saturating_sub(1))
    }

    /// Goes to a phase; to learning while there is no test.
    pub(super) fn choose(&mut self, phase: Phase) {
        let has = |ledger: &dyn Fn(&WatchedSeed) -> bool| self.seed_run().is_some_and(ledger);
        let (learned, tested) = (has(&|seed| !seed.learning.is_empty()), has(&|seed| !seed.tested.is_empty()));
        self.wanted = phase;
        // Combined policies are only tested.
        self.phase = match (learned, tested) {
            (_, false) => Phase::Learning,
            (false, true) => Phase::Test,
            (true, true) => phase,
        };
        self.story = match (&self.shown.run, self.seed_run()) {
            (Some(shown), Some(seed)) => Story::new(&shown.run.plan, &shown.document, seed, self.phase),
            _ => Story::default(),
        };
        self.step = if self.moved { self.step.min(self.last_step()) } else { self.last_step() };
        self.share = 0.0;
    }

    /// Goes so many seeds on.
    pub(super) fn next_seed(&mut self, by: isize) {
        let seeds = self.shown.run.as_ref().map_or(0, |shown| shown.run.seeds.len());
        if seeds > 0 {
            self.seed = (self.seed as isize + by).rem_euclid(seeds as isize) as usize;
            self.choose(self.wanted);
        }
    }

    /// Goes so many steps on, and stops playing.
    pub(super) fn move_by(&mut self, steps: isize) {
        self.go(self.step.saturating_add_signed(steps));
    }

    /// Goes to a step, and stops playing.
    pub(super) fn go(&mut self, step: usize) {
        (self.playing, self.moved, self.share) = (false, true, 0.0);
        self.step = step.min(self.last_step());
    }

    /// Goes to the next step at which a rule fired, or the one before.
    pub(super) fn go_to_mark(&mut self, forward: bool) {
        if let Some(step) = self.story.mark_beside(self.step, forward) {
            self.go(step);
        }
    }

    /// Plays, or stops; from the beginning if it stood at the end.
    pub(super) fn toggle(&mut self) {
        let playing = !self.playing;
        if playing && self.step >= self.last_step() {
            self.go(0);
        }
        self.moved = true;
        self.playing = playing && self.ledger().is_some_and(|ledger| !ledger.is_empty());
    }

    /// Lets so many seconds go by while playing; whether another step is shown now.
    pub fn advance(&mut self, elapsed_s: f64) -> bool {
        let Some(period_s) = self.document().map(|document| document.period_s).filter(|_| self.playing) else {
            return false;
        };
        let steps = self.share + elapsed_s / period_s * f64::from(SPEEDS[self.speed - 1]);
        self.share = steps.fract();
        self.step = (self.step + steps as usize).min(self.last_step());
        self.playing = self.step < self.last_step();
        steps >= 1.0
    }

    /// Whether steps go by.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Gives a panel the whole screen, or none.
    pub fn enlarge(&mut self, panel: Option<Panel>) {
        (self.large, self.scroll) = (panel, 0);
    }

    /// Gives the next panel the whole screen, or the one before; after the last one all are shown.
    pub(super) fn next_panel(&mut self, forward: bool) {
        let all = Panel::ALL;
        let at = self.large.and_then(|panel| all.iter().position(|one| *one == panel));
        self.enlarge(match (at, forward) {
            (None, true) => all.first().copied(),
            (None, false) => all.last().copied(),
            (Some(at), true) => all.get(at + 1).copied(),
            (Some(at), false) => at.checked_sub(1).map(|at| all[at]),
        });
    }
}
