//! Which actions may be taken: what a script's guards leave.

use crate::saved::{Passed, Passing};

/// A set of actions; a script has at most 64.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Allowed(u64);

impl Default for Allowed {
    fn default() -> Self {
        Self::ALL
    }
}

impl Allowed {
    /// Every action.
    pub const ALL: Self = Self(u64::MAX);
    /// None.
    pub const NONE: Self = Self(0);

    /// Those whose bit is set, the first action the lowest.
    #[must_use]
    pub const fn of_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// A bit for each action.
    #[must_use]
    pub const fn bits(self) -> u64 {
        self.0
    }

    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.whole(&mut self.0)
    }

    /// Whether nothing is taken away.
    #[must_use]
    pub const fn is_all(self) -> bool {
        self.0 == u64::MAX
    }

    /// Whether an action may be taken.
    #[must_use]
    pub const fn contains(self, action: usize) -> bool {
        action < 64 && self.0 & (1 << action) != 0
    }

    /// This set and one more action.
    #[must_use]
    pub const fn with(self, action: usize) -> Self {
        Self(self.0 | 1 << (action % 64))
    }

    /// This set without those of another.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// How many of the first `actions` may be taken.
    #[must_use]
    pub fn count(self, actions: usize) -> usize {
        (0..actions).filter(|action| self.contains(*action)).count()
    }

    /// The action that stands at a place, from 0, among those that may be taken.
    #[must_use]
    pub fn nth(self, place: usize) -> Option<usize> {
        (0..64).filter(|action| self.contains(*action)).nth(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_is_what_is_in_it() {
        let some = Allowed::NONE.with(1).with(3).with(63);
        assert_eq!((some.contains(1), some.contains(2), some.contains(64), some.is_all()), (true, false, false, false));
        assert_eq!((some.count(4), some.nth(0), some.nth(2), some.nth(3)), (2, Some(1), Some(63), None));
        let rest = Allowed::ALL.without(some);
        assert!(!rest.contains(63) && rest.contains(0) && Allowed::of_bits(rest.bits()) == rest);
    }
}
