//! What one view sees: its grid, the largest patch of its mask, and the line that this shows.

use super::facts::decimal;

/// What one view sees. Whatever is not seen reads as the farthest value, never as 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewFacts {
    /// Share of foreground pixels of the filtered image for each grid cell, row by row from the top left, 0 to 1.
    pub cells: Vec<f32>,
    /// The pixels of each cell.
    pub areas_px: Vec<u32>,
    /// Rows and columns of the grid.
    pub grid: (usize, usize),
    /// The number of the grid alone.
    pub index: usize,
    /// Whether any cell of the grid is occupied.
    pub seen: bool,
    /// Share of foreground pixels of the whole filtered image, 0 to 1.
    pub coverage: f64,
    /// The largest patch of the mask.
    pub patch: PatchFacts,
    /// The line that it shows.
    pub line: LineFacts,
}

/// Where the largest patch of a mask lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatchFacts {
    /// Its share of the image, 0 to 1; 0 if none is seen.
    pub size: f64,
    /// The bearing of its centre, degrees, positive to the left; 180 if none is seen.
    pub bearing_deg: f64,
    /// The elevation of its centre above the horizon, degrees; 90 if none is seen.
    pub elevation_deg: f64,
    /// Where its centre lies across the image: 1 at the left edge, 0 in the middle, -1 at the right; 2 if none is seen.
    pub offset: f64,
    /// The bearing of its leftmost place at the height of its centre, degrees; 180 if none is seen.
    pub left_deg: f64,
    /// The bearing of its rightmost place at the height of its centre, degrees; 180 if none is seen.
    pub right_deg: f64,
    /// Distance from the robot's centre to its lowest place on flat floor, metres; 100 if none is seen there.
    pub floor_m: f64,
}

/// The line on the floor that a patch shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineFacts {
    /// Whether there is one.
    pub seen: bool,
    /// How far left of the robot's centre it passes, metres; 100 if there is none.
    pub offset_m: f64,
    /// Where it leads, degrees, positive to the left; 180 if there is none.
    pub heading_deg: f64,
}

impl PatchFacts {
    /// No patch.
    pub const NOTHING: Self = Self {
        size: 0.0,
        bearing_deg: 180.0,
        elevation_deg: 90.0,
        offset: 2.0,
        left_deg: 180.0,
        right_deg: 180.0,
        floor_m: 100.0,
    };
}

impl LineFacts {
    /// No line.
    pub const NOTHING: Self = Self { seen: false, offset_m: 100.0, heading_deg: 180.0 };
}

impl ViewFacts {
    /// A view that sees nothing.
    pub(super) const NOTHING: Self = Self {
        cells: Vec::new(),
        areas_px: Vec::new(),
        grid: (0, 0),
        index: 0,
        seen: false,
        coverage: 0.0,
        patch: PatchFacts::NOTHING,
        line: LineFacts::NOTHING,
    };

    /// The share of foreground pixels of one grid cell, 0 to 1; 0 if there is no such cell.
    #[must_use]
    pub(super) fn cell(&self, row: usize, column: usize) -> f64 {
        let inside = column < self.grid.1;
        self.cells.get(row * self.grid.1 + column).filter(|_| inside).map_or(0.0, |&share| decimal(share))
    }

    /// The share of foreground pixels of neighbouring rows, both included, 0 to 1; 0 if there are none.
    #[must_use]
    pub(crate) fn rows(&self, from: usize, to: usize) -> f64 {
        self.share((from, to), (0, self.grid.1.saturating_sub(1)))
    }

    /// The share of foreground pixels of neighbouring columns, both included, 0 to 1; 0 if there are none.
    #[must_use]
    pub(crate) fn columns(&self, from: usize, to: usize) -> f64 {
        self.share((0, self.grid.0.saturating_sub(1)), (from, to))
    }

    fn share(&self, rows: (usize, usize), columns: (usize, usize)) -> f64 {
        let (mut foreground, mut all) = (0.0, 0.0);
        for row in rows.0..=rows.1.min(self.grid.0.saturating_sub(1)) {
            for column in columns.0..=columns.1.min(self.grid.1.saturating_sub(1)) {
                let cell = row * self.grid.1 + column;
                let area = f64::from(self.areas_px.get(cell).copied().unwrap_or(0));
                foreground += area * f64::from(self.cells.get(cell).copied().unwrap_or(0.0));
                all += area;
            }
        }
        if all > 0.0 { decimal((foreground / all) as f32) } else { 0.0 }
    }
}

impl Default for ViewFacts {
    fn default() -> Self {
        Self::NOTHING
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_weigh_their_cells_by_their_pixels() {
        let view = ViewFacts {
            grid: (2, 2),
            cells: vec![0.5, 1.0, 0.0, 0.25],
            areas_px: vec![4, 2, 4, 2],
            ..ViewFacts::default()
        };
        // 2 + 2 of 6 pixels; 0 + 0.5 of 6; 2 of 8; 2.5 of 4.
        let rounded = |share: f64| (share * 1e6).round() / 1e6;
        assert_eq!((rounded(view.rows(0, 0)), rounded(view.rows(1, 1))), (0.666_667, 0.083_333));
        assert_eq!((view.columns(0, 0), view.columns(1, 1), view.rows(0, 1)), (0.25, 0.625, 0.375));
        assert_eq!(ViewFacts::default().rows(0, 3), 0.0);
    }

    #[test]
    fn a_cell_outside_the_grid_is_empty() {
        let view = ViewFacts { cells: vec![0.5; 9], grid: (3, 3), ..ViewFacts::default() };
        assert_eq!((view.cell(2, 2), view.cell(0, 3), view.cell(3, 0)), (0.5, 0.0, 0.0));
    }
}
