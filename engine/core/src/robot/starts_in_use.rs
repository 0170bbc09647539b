//! Which of the starts that a script lists are in use: all of them, or more and more.

use crate::saved::{Passed, Passing, Unfit};

/// So many attempts must have been made from the starts in use before another one joins.
const ATTEMPTS: usize = 20;

/// The listed starts, by their index in the world.
#[derive(Debug, Clone)]
pub(super) struct StartsInUse {
    starts: Vec<usize>,
    in_use: usize,
    /// The share of good attempts at which the next start joins.
    widen: Option<f64>,
    /// How the last attempts went since a start joined.
    last: [bool; ATTEMPTS],
    attempts: usize,
}

impl StartsInUse {
    /// All of them; with a share at which the next joins, only the first.
    pub(super) fn new(starts: Vec<usize>, widen: Option<f64>) -> Self {
        let in_use = if widen.is_some() { 1.min(starts.len()) } else { starts.len() };
        Self { starts, in_use, widen, last: [false; ATTEMPTS], attempts: 0 }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.size(&mut self.in_use)?;
        by.all(&mut self.last, Passing::flag)?;
        by.size(&mut self.attempts)?;
        if self.in_use > self.starts.len() { Err(Unfit) } else { Ok(()) }
    }

    /// Those that are in use.
    pub(super) fn in_use(&self) -> &[usize] {
        &self.starts[..self.in_use]
    }

    /// Goes on from the same list in another world.
    pub(super) fn go_on_from(&mut self, other: &Self) {
        if self.widen.is_some() {
            self.in_use = other.in_use.min(self.starts.len());
            (self.last, self.attempts) = (other.last, other.attempts);
        }
    }

    /// Counts an attempt that began at a start, if that is one of those in use; perhaps the next one joins.
    pub(super) fn count(&mut self, start: Option<usize>, good: bool) {
        let Some(share) = self.widen.filter(|_| self.in_use < self.starts.len()) else { return };
        if !start.is_some_and(|start| self.in_use().contains(&start)) {
            return;
        }
        self.last[self.attempts % ATTEMPTS] = good;
        self.attempts += 1;
        let went_well = self.last.iter().filter(|good| **good).count();
        if self.attempts >= ATTEMPTS && went_well as f64 >= share * ATTEMPTS as f64 {
            (self.in_use, self.attempts) = (self.in_use + 1, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_start_joins_after_twenty_attempts_of_which_enough_were_good() {
        let mut starts = StartsInUse::new(vec![4, 2, 7], Some(0.8));
        (0..4).for_each(|_| starts.count(Some(4), false));
        (0..15).for_each(|_| starts.count(Some(4), true));
        assert_eq!(starts.in_use(), [4]);
        // The twentieth: 16 of 20 are good.
        starts.count(Some(4), true);
        assert_eq!(starts.in_use(), [4, 2]);
        // Attempts are counted anew, and only those that began at 4 or 2.
        (0..19).for_each(|_| starts.count(Some(2), true));
        (0..9).for_each(|_| starts.count(Some(7), true));
        starts.count(None, true);
        assert_eq!(starts.in_use(), [4, 2]);
        starts.count(Some(4), true);
        assert_eq!(starts.in_use(), [4, 2, 7]);
    }

    #[test]
    fn without_a_share_all_are_in_use_from_the_beginning() {
        let mut starts = StartsInUse::new(vec![0, 1], None);
        starts.count(Some(0), false);
        assert_eq!(starts.in_use(), [0, 1]);
    }
}
