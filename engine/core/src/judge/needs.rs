//! What native trees rely on: parts of what was calibrated, beams and cells that must exist.

use super::compiled::Look;
use rhai::Position;

/// How a rule reads `calibrated`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlotUse {
    pub slot: usize,
    /// For an array, how many numbers it must hold.
    pub length: Option<usize>,
    pub position: Position,
}

/// What native trees rely on, gathered over all rules.
#[derive(Debug, Default)]
pub(crate) struct Needs {
    /// Keys of `calibrated` that are read; the empty key is the whole.
    pub slots: Vec<String>,
    pub slot_uses: Vec<SlotUse>,
    /// Beams that are named.
    pub beams: Vec<(i64, Position)>,
    /// Bearings of the laser that are named, degrees.
    pub bearings: Vec<(f64, Position)>,
    /// Stages that are named.
    pub stages: Vec<(String, Position)>,
    /// What is read of the views besides their grids, by their numbers.
    pub looks: Vec<Look>,
    /// Grid cells that are named.
    pub cells: Vec<CellNamed>,
}

/// A row, a column, or both, of a view's grid, as a script names them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellNamed {
    pub view: usize,
    pub row: Option<i64>,
    pub column: Option<i64>,
    pub position: Position,
}
