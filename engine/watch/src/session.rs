//! The seeds of a run that learn side by side: all are always as far as each other, so that a swap of the reward comes at
//! the same step for all of them.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::board::WatchedSeed;
use engine::diagnostic::{Diagnostic, Result, SourceText};
use engine::experiment::{
    Learned, Learning, Ledger, Leg, MOST_STEPS, Origin, Plan, RecordShape, WINDOW_STEPS, in_parallel, rejudge,
};
use engine::learner::Carry;
use insight::store::run_to_toml;

/// Room for the steps of all seeds, bytes; of longer runs the beginnings are kept.
pub(super) const MOST_LEDGER_BYTES: u64 = 512 << 20;
/// Windows that all seeds together learn before a save is looked for, about; one takes 3 ms of a core.
const WINDOWS_AT_ONCE: usize = 20;

/// One seed while it learns.
struct Pupil {
    learning: Learning,
    ledger: Arc<Ledger>,
}

/// Seeds that learn one plan.
pub(super) struct Session {
    plan: Plan,
    /// The seeds' numbers in `pupils`.
    numbers: Vec<u64>,
    pupils: Vec<Mutex<Pupil>>,
    threads: usize,
    /// Steps of each seed that are kept.
    room: u64,
    /// Whether every step must be kept.
    whole: bool,
    done: u64,
    /// How it came to be, for the reader.
    note: String,
    /// Whether what was learned until now was tested.
    tested: bool,
}

impl Session {
    /// Seeds that know nothing yet; if they are to be stored or to go on later, every step must find room.
    ///
    /// # Errors
    /// If the plan does not work, or is too long.
    pub(super) fn new(plan: Plan, seeds: &[u64], threads: usize, whole: bool, note: String) -> Result<Self> {
        // Both phases are kept, and what is shown beside what goes on.
        let bytes = 4 * seeds.len() as u64 * RecordShape::of(&plan).bytes() as u64;
        let room = (MOST_LEDGER_BYTES / bytes.max(1)).min(MOST_STEPS);
        let pupils = in_parallel(seeds, threads, |seed| {
            let ledger = Arc::new(Ledger::new(&plan, plan.settings.run.steps.min(room)));
            Ok(Mutex::new(Pupil { learning: Learning::new(&plan, seed)?, ledger }))
        })?;
        let numbers = (0..seeds.len() as u64).collect();
        let session = Self { plan, numbers, pupils, threads, room, whole, done: 0, note, tested: false };
        session.check_room()?;
        Ok(session)
    }

    /// What is learned, with all legs until now.
    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Steps that every seed has done.
    pub(super) fn done(&self) -> u64 {
        self.done
    }

    /// Steps of each phase that a seed may keep.
    pub(super) fn room(&self) -> u64 {
        self.room
    }

    /// Whether the last leg is learned to its end.
    pub(super) fn is_over(&self) -> bool {
        self.done >= self.plan.learning_steps()
    }

    /// How it came to be: words that end in "; ", or nothing.
    pub(super) fn note(&self) -> &str {
        &self.note
    }

    /// Whether nothing is left to do until the next save.
    pub(super) fn is_tested(&self) -> bool {
        self.tested
    }

    /// All was learned and tested.
    pub(super) fn end(&mut self) {
        self.tested = true;
    }

    /// Learns a little, all seeds equally.
    ///
    /// # Errors
    /// If a sensor, a filter or the script fails.
    pub(super) fn advance(&mut self) -> Result<()> {
        let windows = (WINDOWS_AT_ONCE / self.pupils.len().max(1)).max(1) as u64;
        let steps = (windows * WINDOW_STEPS).min(self.plan.learning_steps().saturating_sub(self.done));
        let never = AtomicBool::new(false);
        self.each(|pupil| {
            pupil.learning.run(steps, &never, &|_| (), Arc::make_mut(&mut pupil.ledger))?;
            Ok(())
        })?;
        self.done += steps;
        Ok(())
    }

    /// Goes on under the rules of another plan for its steps, all seeds from where they are. What is kept of what was learned,
    /// the one rule says: [`Plan::carries_to`].
    ///
    /// # Errors
    /// If there is no room for more steps, or the new script fails on what a robot sees; then the session cannot go on.
    pub(super) fn swap(&mut self, plan: Plan, carry: Carry) -> Result<()> {
        let carry = if carry == Carry::Keep { self.plan.carries_to(&plan) } else { carry };
        let plan = plan.sharing(&self.plan);
        let before = self.plan.clone();
        let mut legs = std::mem::take(&mut self.plan.earlier);
        let steps = self.done - legs.iter().map(|leg| leg.steps).sum::<u64>();
        legs.push(Leg { plan: self.plan.clone(), steps, then: carry });
        self.plan = plan.after(legs);
        self.tested = false;
        self.note = format!("reward swapped before step {}, table: {}; ", self.done, carry.name());
        self.check_room()?;
        let plan = &self.plan;
        self.each(|pupil| {
            let Pupil { learning, ledger } = pupil;
            let said = match carry {
                Carry::Rescore => rejudge(&before, learning.seed(), ledger, plan)?,
                _ => Vec::new(),
            };
            learning.swap_rejudged(plan, carry, &said, Arc::make_mut(ledger))
        })
    }

    /// What the seeds have learned until now, for a plan in another world or on another body to go on from; nothing if
    /// they have not begun.
    ///
    /// # Errors
    /// What failed while a seed learned.
    pub(super) fn origins(&self, next: &Plan) -> Result<Vec<Origin>> {
        let mut plan = self.plan.clone();
        plan.settings.run.steps = self.done - plan.earlier.iter().map(|leg| leg.steps).sum::<u64>();
        let carry = plan.carries_to(next);
        let seeds = if self.done == 0 { Vec::new() } else { self.seeds(true)? };
        let learned = seeds.iter().filter_map(|seed| Some((seed.seed, seed.learned.as_ref()?)));
        let origin = |(seed, learned): (u64, &Arc<Learned>)| {
            let source = SourceText::new("", run_to_toml(&plan, seed)?);
            Ok(Origin { plan: plan.clone(), seed, source, state_hash: learned.state_hash.clone(), carry })
        };
        learned.map(origin).collect()
    }

    /// The seeds as they are now, untested; `end` if the leg ends here.
    ///
    /// # Errors
    /// What failed while a seed learned.
    pub(super) fn seeds(&self, end: bool) -> Result<Vec<WatchedSeed>> {
        let seed = |pupil: &mut Pupil| {
            let learned = if end { pupil.learning.finish() } else { pupil.learning.snapshot() };
            if let Some(fault) = pupil.learning.fault() {
                return Err(Box::new(fault.clone()));
            }
            let (seed, learning) = (learned.seed, Arc::clone(&pupil.ledger));
            Ok(WatchedSeed {
                seed,
                learned: Some(Arc::new(learned)),
                learning,
                test: None,
                lines: None,
                tested: Ledger::off(),
            })
        };
        self.pupils.iter().map(|pupil| seed(&mut lock(pupil))).collect()
    }

    fn each(&self, job: impl Fn(&mut Pupil) -> Result<()> + Sync) -> Result<()> {
        in_parallel(&self.numbers, self.threads, |number| job(&mut lock(&self.pupils[number as usize]))).map(drop)
    }

    fn check_room(&self) -> Result<()> {
        let steps = self.plan.learning_steps().max(self.plan.settings.run.test_steps);
        if !self.whole || steps <= self.room {
            return Ok(());
        }
        let (seeds, room) = (self.pupils.len(), self.room);
        let message = format!("there is no room to keep {steps} steps of {seeds} seeds: at most {room} of each");
        Diagnostic::new("E-WATCH-ROOM", message)
            .help("watch fewer seeds (--seeds N) or fewer steps (--steps N); the next save learns from nothing")
            .fail()
    }
}

fn lock(pupil: &Mutex<Pupil>) -> MutexGuard<'_, Pupil> {
    // Whoever panicked here ended the program with it.
    pupil.lock().unwrap_or_else(PoisonError::into_inner)
}
