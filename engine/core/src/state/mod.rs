//! What a robot perceives becomes one number: its state.
//!
//! [`StateMap`] is the door; [`GridMap`], the paper's grid, is what ships. This room sees images and masks, never a world,
//! a pose or a scan: the state cannot cheat.

mod grid;
mod grid_map;

use crate::sensors::observation::Image;

pub use grid::{Grid, GridError, MAX_STATES};
pub use grid_map::GridMap;

/// What a state map may look at: the last image, what the filters left of it, and how that lies in the grid.
#[derive(Debug, Clone, Copy)]
pub struct Percept<'a> {
    /// The camera's image, in the format that the filters asked for.
    pub image: &'a Image,
    /// The mask: a byte for each pixel, 0 or 255, row-major.
    pub mask: &'a [u8],
    /// The grid over the mask, its cells counted.
    pub grid: &'a Grid,
}

/// One digit of a state's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digit {
    /// The part of the state that it belongs to: digits of one part are learned from together.
    pub part: usize,
    /// How many values it has.
    pub values: usize,
}

/// What a state stands for, for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Described {
    /// In words, such as `columns 1 0 2`.
    pub text: String,
    /// The cells that are filled, if the state is a pattern of cells.
    pub cells: Option<Cells>,
}

/// A pattern of cells over an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cells {
    /// Rows of cells.
    pub rows: usize,
    /// Columns of cells.
    pub columns: usize,
    /// Which are filled, row by row from the top left.
    pub filled: Vec<bool>,
}

/// How percepts become states.
pub trait StateMap: Send {
    /// The state of what is perceived now, below [`StateMap::states`].
    fn encode(&mut self, percept: Percept<'_>) -> usize;

    /// How many states there may be.
    fn states(&self) -> usize;

    /// The digits of a state's number, lowest first; the product of their values is [`StateMap::states`].
    fn digits(&self) -> Vec<Digit>;

    /// What a state stands for.
    fn describe(&self, state: usize) -> Described;

    /// The state of the mirror image, left for right; `None` if the map has no sides.
    fn mirrored(&self, state: usize) -> Option<usize>;

    /// All that is needed to make the map again, as `policy.toml` holds it.
    fn to_table(&self) -> toml::Table;
}
