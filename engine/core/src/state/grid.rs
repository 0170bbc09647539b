//! The grid code of the paper, section 4.1.1: cells that hold enough foreground, coded into one number.
//!
//! ```text
//!   +---+---+---+   row 0: top of the image, far away
//!   | 0 | 1 | 2 |   cells are numbered row by row
//!   +---+---+---+
//!   | 3 | 4 | 5 |   with column fill, an occupied cell fills those above it, so a column has
//!   +---+---+---+   rows + 1 heights: 0 free, 1 only the top row, 3 down to the bottom row
//!   | 6 | 7 | 8 |
//!   +---+---+---+   state = h(left) + 4 h(middle) + 16 h(right), 64 states
//! ```
//!
//! A grid that remembers has one more height, rows + 1: *gone*, of a column that is empty now and was not a while ago.

use super::column_memory::ColumnMemory;
use crate::saved::{Passed, Passing};
use crate::settings::GridSettings;
use dispatch::{Processor, compiled_for_each_processor};

/// The most states that a grid may have.
pub const MAX_STATES: usize = 1 << 19;
/// The most states that there may be where only those that are met have rows: as many as a record of a step can tell apart.
pub const MAX_POOLED_STATES: usize = u32::MAX as usize;

/// Codes masks of one size.
#[derive(Debug, Clone)]
pub struct Grid {
    rows: usize,
    columns: usize,
    fill: bool,
    /// Values of a digit: heights of a column, or 2.
    base: usize,
    memory: ColumnMemory,
    width_px: usize,
    /// First pixel row of each grid row, and the image's height.
    row_edges: Vec<usize>,
    /// First pixel column of each grid column, and the image's width.
    column_edges: Vec<usize>,
    /// Foreground pixels from which each cell is occupied.
    least: Vec<u32>,
    counts: Vec<u32>,
    occupied: Vec<bool>,
    states: usize,
    /// The state of the last mask.
    state: usize,
    /// Set pixels of each pixel column, of some rows.
    sums: Vec<u8>,
    processor: Processor,
}

/// Why a grid cannot be: too many states, or more cells than pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridError(pub String);

impl Grid {
    /// A grid over masks of `width_px` times `height_px`.
    ///
    /// # Errors
    /// If it would have more than [`MAX_STATES`] states, or a cell without pixels.
    pub fn new(settings: &GridSettings, width_px: usize, height_px: usize) -> Result<Self, GridError> {
        let (rows, columns) = (settings.rows as usize, settings.columns as usize);
        let remembers = settings.remember_s > 0.0;
        if remembers && !settings.fill {
            return Err(GridError("a grid without fill has no columns to remember: remember_s needs fill".to_owned()));
        }
        let heights = rows + 1 + usize::from(remembers);
        let (base, digits) = if settings.fill { (heights, columns) } else { (2, rows * columns) };
        let states = u32::try_from(digits).ok().and_then(|digits| base.checked_pow(digits));
        let Some(states) = states.filter(|states| *states <= MAX_STATES) else {
            return Err(GridError(format!(
                "a grid of {rows}x{columns} has {base}^{digits} states, more than the limit of {MAX_STATES}"
            )));
        };
        if columns > width_px || rows > height_px {
            return Err(GridError(format!(
                "a grid of {rows}x{columns} does not fit an image of {width_px}x{height_px} pixels"
            )));
        }
        let edges = |cells: usize, pixels: usize| (0..=cells).map(|cell| cell * pixels / cells).collect::<Vec<_>>();
        let (row_edges, column_edges) = (edges(rows, height_px), edges(columns, width_px));
        let areas = row_edges
            .windows(2)
            .flat_map(|row| column_edges.windows(2).map(|column| (row[1] - row[0]) * (column[1] - column[0])));
        let least = areas.map(|area| ((area as f64 * settings.occupied).ceil() as u32).max(1)).collect();
        Ok(Self {
            rows,
            columns,
            fill: settings.fill,
            base,
            memory: ColumnMemory::new(settings.remember_s, columns),
            width_px,
            row_edges,
            column_edges,
            least,
            counts: vec![0; rows * columns],
            occupied: vec![false; rows * columns],
            states,
            state: 0,
            sums: vec![0; width_px],
            processor: Processor::best(),
        })
    }

    /// How many states there are.
    #[must_use]
    pub const fn states(&self) -> usize {
        self.states
    }

    /// Rows and columns.
    #[must_use]
    pub const fn size(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// The state of a mask (row-major, 0 or 255), from 0 to `states() - 1`.
    pub fn encode(&mut self, mask: &[u8]) -> usize {
        self.count(mask);
        for ((occupied, count), least) in self.occupied.iter_mut().zip(&self.counts).zip(&self.least) {
            *occupied = count >= least;
        }
        self.state = self.memory.with_gone(self.code(), self.base);
        self.state
    }

    /// This grid where a step takes so long, which says for how many steps it remembers.
    #[must_use]
    pub(crate) fn with_period(mut self, period_s: f64) -> Self {
        self.memory.set_period(period_s);
        self
    }

    /// Whether it remembers anything.
    pub(crate) fn remembers(&self) -> bool {
        self.memory.is_on()
    }

    /// What goes on from mask to mask.
    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.size(&mut self.state)?;
        self.memory.pass(by)
    }

    /// The robot was put somewhere: nothing was there a while ago.
    pub(crate) fn forget(&mut self) {
        self.memory.forget();
    }

    /// The state of the last mask.
    #[must_use]
    pub const fn state(&self) -> usize {
        self.state
    }

    fn code(&self) -> usize {
        if !self.fill {
            return self.occupied.iter().rev().fold(0, |state, occupied| 2 * state + usize::from(*occupied));
        }
        let height = |column: usize| {
            (0..self.rows).rev().find(|row| self.occupied[row * self.columns + column]).map_or(0, |row| row + 1)
        };
        (0..self.columns).rev().fold(0, |state, column| self.base * state + height(column))
    }

    fn count(&mut self, mask: &[u8]) {
        self.counts.fill(0);
        for (row, edges) in self.row_edges.windows(2).enumerate() {
            let counts = &mut self.counts[row * self.columns..(row + 1) * self.columns];
            let band = &mask[edges[0] * self.width_px..edges[1] * self.width_px];
            // A sum of up to 255 pixels fits a byte.
            for part in band.chunks(255 * self.width_px) {
                add_rows(self.processor, part, &mut self.sums);
                for (count, edges) in counts.iter_mut().zip(self.column_edges.windows(2)) {
                    *count += self.sums[edges[0]..edges[1]].iter().map(|sum| u32::from(*sum)).sum::<u32>();
                }
            }
        }
    }

    /// Foreground pixels of each cell, row by row, of the last mask.
    #[must_use]
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Whether each cell of the last mask is occupied by itself, row by row.
    #[must_use]
    pub fn occupied(&self) -> &[bool] {
        &self.occupied
    }

    /// Pixels of a cell.
    #[must_use]
    pub fn area_px(&self, cell: usize) -> usize {
        let (row, column) = (cell / self.columns, cell % self.columns);
        (self.row_edges[row + 1] - self.row_edges[row]) * (self.column_edges[column + 1] - self.column_edges[column])
    }

    /// The state of the mirror image, left for right.
    #[must_use]
    pub(super) fn mirrored(&self, state: usize) -> usize {
        let base = self.base;
        let digits = if self.fill { 1 } else { self.rows };
        let line = base.pow(self.columns as u32);
        let reversed = |line: usize| {
            let digit = |column: usize| line / base.pow(column as u32) % base;
            (0..self.columns).fold(0, |image, column| base * image + digit(column))
        };
        (0..digits).rev().fold(0, |image, row| line * image + reversed(state / line.pow(row as u32) % line))
    }

    /// The cells that a state stands for, row by row, filled columns included.
    #[must_use]
    pub fn cells(&self, state: usize) -> Vec<bool> {
        let mut cells = vec![false; self.rows * self.columns];
        let mut rest = state;
        if self.fill {
            for column in 0..self.columns {
                // What is gone fills nothing.
                let height = Some(rest % self.base).filter(|height| *height <= self.rows);
                for row in 0..height.unwrap_or(0) {
                    cells[row * self.columns + column] = true;
                }
                rest /= self.base;
            }
        } else {
            for cell in &mut cells {
                *cell = rest % 2 == 1;
                rest /= 2;
            }
        }
        cells
    }
}

compiled_for_each_processor! {
    /// Counts the set pixels of each column over at most 255 rows, each as wide as `sums`.
    fn add_rows<'a>(rows: &'a [u8], sums: &'a mut [u8]) {
        sums.fill(0);
        let width = sums.len();
        let fours = rows.chunks_exact(4 * width);
        let rest = fours.remainder();
        for four in fours {
            let (upper, lower) = four.split_at(2 * width);
            let ((first, second), (third, fourth)) = (upper.split_at(width), lower.split_at(width));
            let pixels = first.iter().zip(second).zip(third.iter().zip(fourth));
            for (sum, ((first, second), (third, fourth))) in sums.iter_mut().zip(pixels) {
                *sum += (first & 1) + (second & 1) + (third & 1) + (fourth & 1);
            }
        }
        for row in rest.chunks_exact(width) {
            for (sum, pixel) in sums.iter_mut().zip(row) {
                *sum += pixel & 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(rows: u64, columns: u64, fill: bool) -> Grid {
        Grid::new(&GridSettings { rows, columns, occupied: 0.25, fill, remember_s: 0.0 }, 6, 6).unwrap()
    }

    fn mask(cells: &[(usize, usize)]) -> Vec<u8> {
        let mut mask = vec![0; 36];
        for (row, column) in cells {
            mask[row * 12 + column * 2] = 255;
        }
        mask
    }

    #[test]
    fn the_paper_s_grid_has_64_states() {
        let mut grid = grid(3, 3, true);
        assert_eq!(grid.states(), 64);
        assert_eq!(grid.encode(&mask(&[])), 0);
        // Left column down to the middle row: 2; right column only the top row: 1 * 16.
        assert_eq!(grid.encode(&mask(&[(1, 0), (0, 2)])), 2 + 16);
        assert_eq!(grid.encode(&mask(&[(2, 0), (2, 1), (2, 2)])), 63);
    }

    #[test]
    fn an_occupied_cell_fills_those_above_it() {
        let mut grid = grid(3, 3, true);
        let state = grid.encode(&mask(&[(1, 1)]));
        assert_eq!(state, 2 * 4);
        assert_eq!(grid.occupied().iter().filter(|occupied| **occupied).count(), 1);
        let cells = grid.cells(state);
        assert!(cells[1] && cells[4] && !cells[7]);
    }

    #[test]
    fn without_fill_every_cell_is_one_bit() {
        let mut grid = grid(3, 3, false);
        assert_eq!(grid.states(), 512);
        assert_eq!(grid.encode(&mask(&[(0, 0), (2, 2)])), 1 + 256);
        assert!(grid.cells(257)[0] && grid.cells(257)[8] && !grid.cells(257)[4]);
    }

    #[test]
    fn a_cell_is_occupied_from_its_share_of_pixels_on() {
        // A cell has 4 pixels: a share of 0.25 is one pixel, of 0.26 two.
        let settings = GridSettings { rows: 3, columns: 3, occupied: 0.26, fill: true, remember_s: 0.0 };
        let mut grid = Grid::new(&settings, 6, 6).unwrap();
        assert_eq!(grid.encode(&mask(&[(0, 0)])), 0);
        let mut two = mask(&[(0, 0)]);
        two[1] = 255;
        assert_eq!(grid.encode(&two), 1);
    }

    #[test]
    fn every_state_stands_for_cells_that_code_into_it() {
        let mut grid = grid(3, 2, true);
        for state in 0..grid.states() {
            let mut mask = vec![0; 36];
            for (cell, _) in grid.cells(state).iter().enumerate().filter(|(_, set)| **set) {
                mask[cell / 2 * 12 + cell % 2 * 3] = 255;
                mask[cell / 2 * 12 + cell % 2 * 3 + 1] = 255;
            }
            assert_eq!(grid.encode(&mask), state);
        }
    }

    #[test]
    fn a_mirrored_state_stands_for_the_cells_with_columns_reversed() {
        for grid in [grid(3, 3, true), grid(2, 3, false), grid(3, 2, false)] {
            let columns = grid.columns;
            for state in 0..grid.states() {
                let (cells, image) = (grid.cells(state), grid.cells(grid.mirrored(state)));
                let reversed: Vec<bool> =
                    cells.chunks(columns).flat_map(|row| row.iter().rev().copied().collect::<Vec<_>>()).collect();
                assert_eq!(image, reversed);
            }
        }
    }

    #[test]
    fn sizes_that_do_not_divide_share_the_pixels_out() {
        let grid =
            Grid::new(&GridSettings { rows: 3, columns: 3, occupied: 0.1, fill: true, remember_s: 0.0 }, 7, 5).unwrap();
        assert_eq!((0..9).map(|cell| grid.area_px(cell)).sum::<usize>(), 35);
    }

    #[test]
    fn every_compilation_counts_the_set_pixels_of_each_column() {
        let mut random = crate::random::Random::new(1, crate::random::Stream::Test);
        for width in 1..150 {
            let rows = 1 + random.below(255) as usize;
            let mask: Vec<u8> = (0..width * rows).map(|_| if random.below(5) == 0 { 0 } else { 255 }).collect();
            let set = |column: usize| mask.chunks_exact(width).filter(|row| row[column] == 255).count() as u8;
            let wanted: Vec<u8> = (0..width).map(set).collect();
            for processor in Processor::all() {
                let mut sums = vec![9; width];
                add_rows(processor, &mask, &mut sums);
                assert_eq!(sums, wanted, "{}", processor.name());
            }
        }
    }

    #[test]
    fn cells_of_more_than_255_rows_are_counted_in_full() {
        let mut grid =
            Grid::new(&GridSettings { rows: 1, columns: 2, occupied: 0.1, fill: true, remember_s: 0.0 }, 3, 600)
                .unwrap();
        grid.encode(&[255, 255, 0].repeat(600));
        assert_eq!(grid.counts(), [600, 600]);
    }

    #[test]
    fn too_many_states_are_refused_before_memory_is_taken() {
        let large = GridSettings { rows: 16, columns: 16, occupied: 0.1, fill: false, remember_s: 0.0 };
        assert!(Grid::new(&large, 160, 120).unwrap_err().0.contains("2^256 states"));
        let eight_by_four = GridSettings { rows: 4, columns: 8, occupied: 0.1, fill: true, remember_s: 0.0 };
        assert_eq!(Grid::new(&eight_by_four, 160, 120).unwrap().states(), 390_625);
    }
}
