//! What native trees rely on: parts of what was calibrated, beams and cells that must exist.

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
    /// Grid cells that are named: row, column.
    pub cells: Vec<(i64, i64, Position)>,
}
