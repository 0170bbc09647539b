//! The steps that are remembered: the latest so many, each with the return that followed it.

use crate::allowed::Allowed;

/// What flows back into a step from those after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Follows {
    /// The return of the next step.
    Next,
    /// The robot was put elsewhere: the value of the state in which it was.
    Value,
    /// Nothing: it ended there.
    Nothing,
}

impl Follows {
    pub(super) const ALL: [Self; 3] = [Self::Next, Self::Value, Self::Nothing];
}

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PastStep {
    /// The row of its state.
    pub row: u32,
    /// Its action.
    pub action: u32,
    /// The row of the state at its end.
    pub next_row: u32,
    /// What flows back into it.
    pub follows: Follows,
    /// Its reward, with what delayed rules built up or lost.
    pub reward: f64,
    /// The actions that were allowed at its end.
    pub next_allowed: Allowed,
    /// How much it counts.
    pub weight: f64,
    /// The return that followed it, as of the last time that it was renewed.
    pub gain: f64,
}

/// The latest steps; the oldest makes room for a new one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PastSteps {
    ring: Vec<PastStep>,
    most: usize,
    /// Where the oldest is once the ring is full.
    oldest: usize,
    /// How many were ever remembered.
    total: u64,
}

impl PastSteps {
    /// Room for `most` steps.
    #[must_use]
    pub(super) fn new(most: usize) -> Self {
        Self { ring: Vec::with_capacity(most), most, oldest: 0, total: 0 }
    }

    /// How many are remembered.
    #[must_use]
    pub(super) fn len(&self) -> usize {
        self.ring.len()
    }

    /// How many there is room for.
    #[must_use]
    pub(super) fn most(&self) -> usize {
        self.most
    }

    /// How many were ever remembered.
    #[must_use]
    pub(super) fn total(&self) -> u64 {
        self.total
    }

    /// Remembers one more; gives back the one that is forgotten for it.
    pub(super) fn push(&mut self, step: PastStep) -> Option<PastStep> {
        self.total += 1;
        if self.ring.len() < self.most {
            self.ring.push(step);
            return None;
        }
        let forgotten = std::mem::replace(&mut self.ring[self.oldest], step);
        self.oldest = (self.oldest + 1) % self.most;
        Some(forgotten)
    }

    /// Where the step stands that came `back` steps before the latest.
    fn place(&self, back: usize) -> usize {
        let newest = self.oldest + self.ring.len() - 1 - back;
        if newest >= self.ring.len() { newest - self.ring.len() } else { newest }
    }

    /// The step that came `back` steps before the latest; there must be one.
    #[must_use]
    pub(super) fn back(&self, back: usize) -> &PastStep {
        &self.ring[self.place(back)]
    }

    /// The step so many back, 0 the latest, to be changed.
    pub(super) fn back_mut(&mut self, back: usize) -> &mut PastStep {
        let place = self.place(back);
        &mut self.ring[place]
    }

    /// All of them, the latest first.
    pub(super) fn iter(&self) -> impl Iterator<Item = &PastStep> {
        (0..self.len()).map(|back| self.back(back))
    }

    /// Forgets them all, but not how many they were.
    pub(super) fn clear(&mut self) {
        self.ring.clear();
        self.oldest = 0;
    }

    /// Makes room for `most` steps; whether some were forgotten for it.
    pub(super) fn resize(&mut self, most: usize) -> bool {
        let kept: Vec<PastStep> = self.iter().take(most).copied().collect();
        let forgotten = kept.len() < self.len();
        *self = Self { total: self.total, ..Self::new(most) };
        self.ring.extend(kept.into_iter().rev());
        forgotten
    }

    /// Becomes what was saved: these steps, the oldest first, the last of so many.
    pub(super) fn restore(&mut self, steps: impl Iterator<Item = PastStep>, total: u64) {
        self.clear();
        self.ring.extend(steps.take(self.most));
        self.total = total;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(row: u32) -> PastStep {
        let follows = Follows::Next;
        PastStep {
            row,
            action: 0,
            next_row: 0,
            follows,
            reward: 0.0,
            next_allowed: Allowed::ALL,
            weight: 1.0,
            gain: 0.0,
        }
    }

    #[test]
    fn the_oldest_step_makes_room_for_the_fourth_of_three() {
        let mut past = PastSteps::new(3);
        let forgotten: Vec<_> = (0..5).map(|row| past.push(step(row)).map(|step| step.row)).collect();
        assert_eq!(forgotten, [None, None, None, Some(0), Some(1)]);
        assert_eq!(past.iter().map(|step| step.row).collect::<Vec<_>>(), [4, 3, 2]);
        assert_eq!((past.len(), past.total()), (3, 5));
        assert!(past.resize(2) && !past.resize(4));
        past.push(step(9));
        assert_eq!(past.iter().map(|step| step.row).collect::<Vec<_>>(), [9, 4, 3]);
    }
}
