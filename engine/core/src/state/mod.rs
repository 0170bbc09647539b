//! What a robot perceives becomes one number: its state.
//!
//! [`StateMap`] is the door; [`GridMap`], the paper's grid, is what ships. This room sees images and masks, never a world,
//! a pose or a scan: the state cannot cheat.

mod column_memory;
mod composed;
mod grid;
mod grid_map;
mod line;
mod patch;

use crate::sensors::observation::Image;

pub use composed::{ComposedMap, DigitKind, StatePart};
pub use grid::{Grid, GridError, MAX_POOLED_STATES, MAX_STATES};
pub use grid_map::GridMap;
pub use line::{FloorLine, floor_line};
pub use patch::{Patch, PatchFinder};

/// What a state map may look at: the last image, what the filters left of it, and how that lies in the grid.
#[derive(Debug, Clone, Copy)]
pub struct Percept<'a> {
    /// The camera's image, in the format that the filters asked for.
    pub image: &'a Image,
    /// The mask: a byte for each pixel, 0 or 255, row-major.
    pub mask: &'a [u8],
    /// The grid over the mask, its cells counted.
    pub grid: &'a Grid,
    /// The grids of all views, that one first.
    pub grids: &'a [Grid],
    /// Further parts of the state that are numbers already, such as the stage.
    pub digits: &'a [usize],
}

/// One digit of a state's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digit {
    /// The part of the state that it belongs to: digits of one part are learned from together.
    pub part: usize,
    /// The column of a grid that it belongs to, from 0 on the left; 0 for a number that stands alone.
    pub column: usize,
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
///
/// A map of one's own takes the place of the grid's by `Cycle::with_map`:
///
/// ```
/// use engine::diagnostic::SourceText;
/// use engine::experiment::{Cycle, Overrides, Phase, Plan};
/// use engine::script::Behaviour;
/// use engine::state::{Described, Digit, Percept, StateMap};
///
/// /// On which side of the image the filters have left more.
/// struct Side;
///
/// impl StateMap for Side {
///     fn encode(&mut self, percept: Percept<'_>) -> usize {
///         let width = percept.image.width_px;
///         let left = |row: &[u8]| row[..width / 2].iter().filter(|pixel| **pixel != 0).count();
///         let right = |row: &[u8]| row[width / 2..].iter().filter(|pixel| **pixel != 0).count();
///         let rows = || percept.mask.chunks_exact(width);
///         usize::from(rows().map(right).sum::<usize>() > rows().map(left).sum())
///     }
///     fn states(&self) -> usize {
///         2
///     }
///     fn digits(&self) -> Vec<Digit> {
///         vec![Digit { part: 0, column: 0, values: 2 }]
///     }
///     fn describe(&self, state: usize) -> Described {
///         Described { text: ["left", "right"][state].to_owned(), cells: None }
///     }
///     fn mirrored(&self, state: usize) -> Option<usize> {
///         Some(1 - state)
///     }
///     fn to_table(&self) -> toml::Table {
///         toml::Table::new()
///     }
/// }
///
/// let script = "world(\"room\"); rule \"too close\" when laser.nearest <= 0.25 => -1 then recover;";
/// # let place = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/side.rhai");
/// # /*
/// let place = "scripts/side.rhai"; // worlds are looked for beside it
/// # */
/// let behaviour = Behaviour::parse("side", SourceText::new(place, script))?;
/// let plan = Plan::new(behaviour.into(), &Overrides::default())?;
/// let mut cycle = Cycle::with_map(&plan, Phase::Learning.robot(&plan, 1)?, Box::new(Side))?;
/// let step = cycle.step(0)?;
/// assert!(step.next_state < 2);
/// assert_eq!(plan.task(cycle.state_map(), 1)?.states, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
