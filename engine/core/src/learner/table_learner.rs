//! A learner that keeps a table of values: every way of learning that the paper's is compared with.

use super::backup::{Backup, Lesson};
use super::mirror::Mirrored;
use super::replay::Replay;
use super::{Carry, Learner, Mirror, Policy, QTable, Softmax, Task, Transition};
use super::{sarsa_lambda, ttd, ttd_cichosz};
use crate::allowed::Allowed;
use crate::outcome::Ending;
use crate::random::Random;
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::{LearnerKind, LearnerSettings};

/// A table of values, how actions are drawn from it, and what a step changes in it.
pub struct TableLearner {
    table: QTable,
    softmax: Softmax,
    backup: Box<dyn Backup>,
    mirror: Option<Mirror>,
    failure_is_terminal: bool,
    random: Random,
}

impl TableLearner {
    /// A learner that knows nothing yet: first values uniform in the settings' range. With a mirror, it learns the mirror
    /// image of every step too, and a visit of a state is one of its image as well.
    #[must_use]
    pub(super) fn new(settings: &LearnerSettings, task: Task) -> Self {
        let Task { states, actions, mirror, mut random, .. } = task;
        let table = first_table(settings, states, actions.len(), &mut random);
        let softmax = Softmax::new(settings, actions.len());
        let failure_is_terminal = settings.failure_is_terminal;
        Self { table, softmax, backup: backup(settings, mirror.as_ref()), mirror, failure_is_terminal, random }
    }

    /// This learner with another stream of random numbers.
    pub(super) fn with_random(self, random: Random) -> Self {
        Self { random, ..self }
    }

    fn count_visit(&mut self, state: usize) -> u64 {
        let visits = self.table.visit(state);
        if let Some(image) = self.mirror.as_ref().map(|mirror| mirror.state(state)).filter(|image| *image != state) {
            self.table.visit(image);
        }
        visits
    }
}

impl Learner for TableLearner {
    /// By softmax at the state's temperature.
    fn choose(&mut self, state: usize, allowed: Allowed) -> (usize, bool) {
        let visits = self.count_visit(state);
        let action = self.softmax.choose(self.table.row(state), allowed, visits, &mut self.random);
        (action, self.table.best_among(state, allowed).0 != action)
    }

    fn visit(&mut self, state: usize) {
        self.count_visit(state);
    }

    fn learn(&mut self, transition: &Transition) {
        let Transition { state, action, reward, next_state, ending, next_allowed, .. } = *transition;
        let terminal = self.failure_is_terminal && ending.is_some_and(Ending::is_terminal);
        self.backup.learn(&mut self.table, &Lesson { state, action, reward, next_state, terminal, next_allowed });
    }

    fn forget(&mut self) {
        self.backup.forget(&mut self.table);
    }

    fn swap(&mut self, settings: &LearnerSettings, mirror: Option<Mirror>, carry: Carry) {
        self.forget();
        let (states, actions) = (self.table.states(), self.table.actions());
        match carry {
            Carry::Keep | Carry::Rescore => {}
            Carry::Decay => self.table.halve(settings.cooling_visits),
            Carry::Reset => self.table = first_table(settings, states, actions, &mut self.random),
        }
        self.softmax = Softmax::new(settings, actions);
        self.backup = backup(settings, mirror.as_ref());
        self.mirror = mirror;
        self.failure_is_terminal = settings.failure_is_terminal;
    }

    /// The visited states only.
    fn policy(&self) -> Policy {
        Policy::from_table(&self.table)
    }

    fn numbers(&self, each: &mut dyn FnMut(f64)) {
        self.table.values().iter().for_each(|value| each(*value));
    }

    fn save(&self, to: &mut Saving) {
        to.numbers(self.table.values());
        to.wholes(self.table.visits());
        to.random(&self.random);
        self.backup.save(to);
    }

    fn load(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit> {
        let (values, visits) = self.table.parts_mut();
        from.numbers(values)?;
        from.wholes(visits)?;
        from.random(&mut self.random)?;
        self.backup.load(from, &self.table)
    }
}

fn first_table(settings: &LearnerSettings, states: usize, actions: usize, random: &mut Random) -> QTable {
    let (low, high) = (settings.initial_low, settings.initial_high.max(settings.initial_low));
    QTable::new(states, actions, || random.between(low, high))
}

/// The way of learning that the settings name, with its replay and its mirror.
fn backup(settings: &LearnerSettings, mirror: Option<&Mirror>) -> Box<dyn Backup> {
    let one = || -> Box<dyn Backup> {
        let online = online(settings);
        if settings.replay == 0 { online } else { Box::new(Replay::new(settings, online)) }
    };
    match mirror {
        Some(mirror) => Box::new(Mirrored { mirror: mirror.clone(), own: one(), image: one() }),
        None => one(),
    }
}

fn online(settings: &LearnerSettings) -> Box<dyn Backup> {
    match settings.kind {
        // What remembers its steps has no table: settings that name it make no table learner.
        LearnerKind::Ttd | LearnerKind::Memory => Box::new(ttd::Ttd::new(settings)),
        LearnerKind::Q => Box::new(ttd::Ttd::one_step(settings)),
        LearnerKind::SarsaLambda => Box::new(sarsa_lambda::SarsaLambda::new(settings)),
        LearnerKind::TtdCichosz => Box::new(ttd_cichosz::TtdCichosz::new(settings)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Twist;
    use crate::random::Stream;
    use crate::settings::Settings;

    const TABLES: &[LearnerKind] =
        &[LearnerKind::Ttd, LearnerKind::TtdCichosz, LearnerKind::Q, LearnerKind::SarsaLambda];

    fn task(states: usize, actions: usize, seed: u64) -> Task {
        Task::plain(states, vec![Twist::default(); actions], Random::new(seed, Stream::Learner))
    }

    fn step(state: usize, action: usize, reward: f64, next_state: usize) -> Transition {
        Transition {
            state,
            action,
            reward,
            next_state,
            ending: None,
            potential: 0.0,
            next_potential: 0.0,
            next_allowed: Allowed::ALL,
        }
    }

    /// A walk of five states: action 0 goes left, action 1 right. Arriving at the right end pays 1 and starts again in
    /// the middle. Always going right is optimal, with V = 0.9^2 / (1 - 0.9^3) in the middle for a discount of 0.9.
    struct Walk {
        state: usize,
    }

    impl Walk {
        fn settings(kind: LearnerKind) -> LearnerSettings {
            LearnerSettings {
                kind,
                discount: 0.9,
                initial_low: 0.0,
                initial_high: 0.0,
                temperature: 0.5,
                temperature_end: 0.05,
                ..Settings::default().learner
            }
        }

        fn go(&mut self, learner: &mut TableLearner, steps: usize) {
            for _ in 0..steps {
                let state = self.state;
                let (action, _) = learner.choose(state, Allowed::ALL);
                let next_state = if action == 1 { (state + 1).min(4) } else { state.saturating_sub(1) };
                let arrived = next_state == 4;
                self.state = if arrived { 2 } else { next_state };
                learner.learn(&step(state, action, f64::from(u8::from(arrived)), self.state));
            }
        }
    }

    #[test]
    fn every_way_of_learning_finds_the_known_optimum() {
        for kind in TABLES {
            let mut learner = TableLearner::new(&Walk::settings(*kind), task(5, 2, 3));
            Walk { state: 2 }.go(&mut learner, 20_000);
            let greedy: Vec<usize> = (0..4).map(|state| learner.table.best_among(state, Allowed::ALL).0).collect();
            assert_eq!(greedy, [1, 1, 1, 1], "{kind:?}");
        }
    }

    #[test]
    fn a_learner_that_was_saved_learns_on_as_if_nothing_had_happened() {
        for (kind, replay, mirrored) in
            TABLES.iter().flat_map(|kind| [(*kind, 0, false), (*kind, 2, false), (*kind, 2, true)])
        {
            let settings = LearnerSettings { replay, ..Walk::settings(kind) };
            let mirror = mirrored.then(|| {
                let actions = [Twist::new(0.2, 0.4), Twist::new(0.2, -0.4)];
                Mirror::new(vec![4, 3, 2, 1, 0], &actions).unwrap()
            });
            let made = |seed| TableLearner::new(&settings, Task { mirror: mirror.clone(), ..task(5, 2, seed) });
            let (mut learner, mut walk) = (made(3), Walk { state: 2 });
            walk.go(&mut learner, 333);
            let mut saving = Saving::default();
            learner.save(&mut saving);
            let bytes = saving.into_bytes();
            // The stream's key is the seed's; all else comes from the bytes.
            let mut again = made(3);
            again.load(&mut Loading::new(&bytes)).unwrap();
            Walk { state: walk.state }.go(&mut again, 200);
            walk.go(&mut learner, 200);
            assert_eq!(again.table, learner.table, "{kind:?}, replay {replay}, mirrored {mirrored}");
            assert!(made(3).load(&mut Loading::new(&bytes[..bytes.len() - 8])).is_err());
            assert!(TableLearner::new(&settings, task(6, 2, 3)).load(&mut Loading::new(&bytes)).is_err());
        }
    }

    #[test]
    fn a_mirrored_learner_counts_each_visit_on_both_sides_but_the_middle_once() {
        let settings = Settings::default().learner;
        let actions = [Twist::new(0.2, 0.4), Twist::new(0.2, -0.4)];
        let mirror = Some(Mirror::new(vec![1, 0, 2], &actions).unwrap());
        let mut learner = TableLearner::new(&settings, Task { mirror, ..task(3, 2, 1) });
        learner.choose(0, Allowed::ALL);
        learner.choose(2, Allowed::ALL);
        assert_eq!(learner.table.visits(), [1, 1, 1]);
    }

    #[test]
    fn a_table_is_kept_halved_or_drawn_anew_under_another_reward() {
        let mut settings = Settings::default().learner;
        settings.cooling_visits = 10;
        let learned = || {
            let mut learner = TableLearner::new(&settings, task(2, 2, 1));
            for _ in 0..30 {
                learner.visit(1);
            }
            let wanted = [0.0, -0.25, 1.5, 3.0];
            for (index, value) in wanted.into_iter().enumerate() {
                let now = learner.table.value(index / 2, index % 2);
                learner.table.add(index / 2, index % 2, value - now);
            }
            learner
        };
        let after = |carry| {
            let mut learner = learned();
            learner.swap(&settings, None, carry);
            learner.table
        };
        assert_eq!(after(Carry::Keep), learned().table);
        let decayed = after(Carry::Decay);
        let wanted = [0.0, -0.125, 0.75, 1.5];
        assert!(decayed.values().iter().zip(wanted).all(|(value, wanted)| (value - wanted).abs() < 1e-12));
        assert_eq!(decayed.visits(), [0, 5]);
        let reset = after(Carry::Reset);
        let range = settings.initial_low..=settings.initial_high;
        assert!(reset.values().iter().all(|value| range.contains(value)));
        assert_eq!(reset.visits(), [0, 0]);
    }

    #[test]
    fn q_learning_finds_the_known_values() {
        let settings = LearnerSettings { kind: LearnerKind::Q, discount: 0.9, ..Settings::default().learner };
        let mut learner = TableLearner::new(&settings, task(3, 1, 1));
        // A ring of three states that pays 1 at the end: V(0) = 0.81 / (1 - 0.729).
        for index in 0..6_000 {
            let (state, next_state) = (index % 3, (index + 1) % 3);
            learner.learn(&step(state, 0, f64::from(u8::from(state == 2)), next_state));
        }
        let wanted = 0.81 / (1.0 - 0.729);
        assert!((learner.table.row(0)[0] - wanted).abs() < 1e-9);
    }
}
