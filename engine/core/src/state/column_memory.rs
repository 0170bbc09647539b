//! What a grid remembers of its columns: which are empty now and were not a while ago.

use crate::saved::{Passed, Passing};

/// When each column was last not empty.
#[derive(Debug, Clone)]
pub(super) struct ColumnMemory {
    remember_s: f64,
    /// For how many steps an empty column counts as gone.
    steps: u32,
    /// By column: steps since it was last not empty; the greatest number if it never was. None if nothing is remembered.
    steps_since: Vec<u32>,
}

impl ColumnMemory {
    /// A memory of so many columns; of none if it is off.
    pub(super) fn new(remember_s: f64, columns: usize) -> Self {
        let columns = if remember_s > 0.0 { columns } else { 0 };
        Self { remember_s, steps: 1, steps_since: vec![u32::MAX; columns] }
    }

    pub(super) fn is_on(&self) -> bool {
        !self.steps_since.is_empty()
    }

    /// A step takes so long, seconds.
    pub(super) fn set_period(&mut self, period_s: f64) {
        self.steps = (self.remember_s / period_s - 1e-9).ceil().max(1.0) as u32;
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.all(&mut self.steps_since, Passing::small)
    }

    pub(super) fn forget(&mut self) {
        self.steps_since.fill(u32::MAX);
    }

    /// The number of these heights, each a digit below `base`, with the greatest digit where a column is gone; takes note of them.
    pub(super) fn with_gone(&mut self, heights: usize, base: usize) -> usize {
        let (mut rest, mut place, mut added) = (heights, 1, 0);
        for since in &mut self.steps_since {
            let height = rest % base;
            *since = if height > 0 { 0 } else { since.saturating_add(1) };
            if height == 0 && *since <= self.steps {
                added += place * (base - 1);
            }
            (rest, place) = (rest / base, place * base);
        }
        heights + added
    }
}

#[cfg(test)]
mod tests {
    use super::super::Grid;
    use crate::settings::GridSettings;

    #[test]
    fn a_column_that_is_empty_and_was_not_is_gone_for_a_while() {
        let settings = GridSettings { rows: 3, columns: 2, occupied: 0.1, fill: true, remember_s: 1.0 };
        let mut grid = Grid::new(&settings, 4, 6).unwrap().with_period(0.5);
        assert_eq!(grid.states(), 25);
        let left = {
            let mut mask = [0; 24];
            mask[0] = 255;
            mask
        };
        // Height 1 of the left column, then gone (4) for 1 s, that is two steps, then empty.
        let seen: Vec<usize> = [&left, &[0; 24], &[0; 24], &[0; 24]].iter().map(|mask| grid.encode(*mask)).collect();
        assert_eq!(seen, [1, 4, 4, 0]);
        grid.encode(&left);
        grid.forget();
        assert_eq!(grid.encode(&[0; 24]), 0);
        // The mirror image of left gone, right height 2.
        assert_eq!(grid.mirrored(4 + 5 * 2), 2 + 5 * 4);
        assert_eq!(grid.cells(4 + 5 * 2), [false, true, false, true, false, false]);
    }

    #[test]
    fn only_columns_can_be_remembered() {
        let settings = GridSettings { rows: 3, columns: 2, occupied: 0.1, fill: false, remember_s: 1.0 };
        assert!(Grid::new(&settings, 4, 6).unwrap_err().0.contains("remember_s needs fill"));
    }
}
