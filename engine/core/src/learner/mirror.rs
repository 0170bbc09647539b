//! Mirrored learning: what is learned on the left holds on the right.
//!
//! In a symmetric task every step teaches twice. The step (s, a, r, s') is learned, and then its mirror image
//! (m(s), m(a), r, m(s')), where m reverses the columns of the grid and the turn of the action. Both images have traces
//! of their own and share one table. Martin Zinkevich and Tucker Balch (ICML 2001) prove that the optimal values of a
//! symmetric Markov decision process are themselves symmetric.

use super::QTable;
use super::backup::{Backup, Lesson};
use crate::allowed::Allowed;
use crate::geometry::Twist;
use crate::saved::{Loading, Saving, Unfit};

/// Which state and which action is the mirror image of each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mirror {
    states: Vec<usize>,
    actions: Vec<usize>,
}

impl Mirror {
    /// A mirror for these actions; `states` holds the mirror image of each state.
    ///
    /// # Errors
    /// With the number of the first action whose opposite turn is not among `actions`.
    pub fn new(states: Vec<usize>, actions: &[Twist]) -> Result<Self, usize> {
        let image = |(index, action): (usize, &Twist)| {
            let opposite = Twist::new(action.linear_m_per_s, -action.angular_rad_per_s);
            actions.iter().position(|other| *other == opposite).ok_or(index)
        };
        let actions = actions.iter().enumerate().map(image).collect::<Result<_, _>>()?;
        Ok(Self { states, actions })
    }

    /// The mirror image of a state.
    #[must_use]
    pub fn state(&self, state: usize) -> usize {
        self.states[state]
    }

    /// The mirror image of an action.
    pub(super) fn action(&self, action: usize) -> usize {
        self.actions[action]
    }

    /// The mirror images of the actions that are allowed.
    fn allowed(&self, allowed: Allowed) -> Allowed {
        if allowed.is_all() {
            return allowed;
        }
        let images = self.actions.iter().enumerate().filter(|(action, _)| allowed.contains(*action));
        images.fold(Allowed::NONE, |all, (_, image)| all.with(*image))
    }

    fn lesson(&self, lesson: &Lesson) -> Lesson {
        Lesson {
            state: self.states[lesson.state],
            action: self.actions[lesson.action],
            next_state: self.states[lesson.next_state],
            next_allowed: self.allowed(lesson.next_allowed),
            ..*lesson
        }
    }
}

/// Learns every step and its mirror image.
pub(super) struct Mirrored {
    pub(super) mirror: Mirror,
    pub(super) own: Box<dyn Backup>,
    pub(super) image: Box<dyn Backup>,
}

impl Backup for Mirrored {
    fn learn(&mut self, table: &mut QTable, lesson: &Lesson) {
        self.own.learn(table, lesson);
        let image = self.mirror.lesson(lesson);
        // Straight ahead in a symmetric view is its own image: learned twice, it would take twice the step size.
        if image != *lesson {
            self.image.learn(table, &image);
        }
    }

    fn forget(&mut self, table: &mut QTable) {
        self.own.forget(table);
        self.image.forget(table);
    }

    fn save(&self, to: &mut Saving) {
        self.own.save(to);
        self.image.save(to);
    }

    fn load(&mut self, from: &mut Loading<'_>, table: &QTable) -> Result<(), Unfit> {
        self.own.load(from, table)?;
        self.image.load(from, table)
    }
}

#[cfg(test)]
mod tests {
    use super::super::ttd::Ttd;
    use super::*;
    use crate::settings::Settings;

    /// Two states that mirror each other, one that is its own image; left, straight, right.
    fn mirror() -> Mirror {
        let actions = [Twist::new(0.2, 0.4), Twist::new(0.2, 0.0), Twist::new(0.2, -0.4)];
        Mirror::new(vec![1, 0, 2], &actions).unwrap()
    }

    fn mirrored() -> Mirrored {
        let settings = Settings::default().learner;
        let one = || Box::new(Ttd::new(&settings));
        Mirrored { mirror: mirror(), own: one(), image: one() }
    }

    fn step(state: usize, action: usize, next_state: usize) -> Lesson {
        Lesson { state, action, reward: -1.0, next_state, terminal: false, next_allowed: Allowed::ALL }
    }

    #[test]
    fn turns_change_sides_and_straight_ahead_stays() {
        assert_eq!(mirror().actions, [2, 1, 0]);
        assert_eq!(mirror().lesson(&step(0, 0, 2)), step(1, 2, 2));
    }

    #[test]
    fn an_action_without_its_opposite_is_named() {
        let actions = [Twist::new(0.2, 0.0), Twist::new(0.2, 0.4), Twist::new(0.4, -0.4)];
        assert_eq!(Mirror::new(vec![0], &actions), Err(1));
    }

    #[test]
    fn a_step_on_the_left_teaches_the_right_the_same() {
        let mut table = QTable::new(3, 3, || 0.0);
        mirrored().learn(&mut table, &step(0, 0, 2));
        // 0.2 * (-1 + 0.99 * 0 - 0) for both images, and nothing else.
        assert_eq!((table.value(0, 0), table.value(1, 2)), (-0.2, -0.2));
        assert_eq!(table.values().iter().filter(|value| **value != 0.0).count(), 2);
    }

    #[test]
    fn a_step_that_is_its_own_image_is_learned_once() {
        let mut table = QTable::new(3, 3, || 0.0);
        mirrored().learn(&mut table, &step(2, 1, 2));
        assert_eq!(table.value(2, 1), -0.2);
    }

    #[test]
    fn each_image_has_its_own_traces() {
        let mut table = QTable::new(3, 3, || 0.0);
        let mut mirrored = mirrored();
        mirrored.learn(&mut table, &Lesson { reward: 0.0, ..step(0, 0, 2) });
        mirrored.learn(&mut table, &step(2, 0, 2));
        // The second error, -1, reaches the first step of each image by a trace of 0.99 * 0.9. The image comes second:
        // nothing changes its error, since state 2 still has actions that are worth 0.
        assert!((table.value(0, 0) - -0.2 * 0.891).abs() < 1e-12);
        assert!((table.value(1, 2) - -0.2 * 0.891).abs() < 1e-12);
    }

    #[test]
    fn what_is_allowed_on_the_left_is_allowed_on_the_right() {
        let lesson = Lesson { next_allowed: Allowed::NONE.with(0).with(1), ..step(0, 0, 1) };
        assert_eq!(mirror().lesson(&lesson).next_allowed, Allowed::NONE.with(1).with(2));
        assert_eq!(mirror().lesson(&step(0, 0, 1)).next_allowed, Allowed::ALL);
    }
}
