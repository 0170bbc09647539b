//! NAME. A filtered image becomes one of a few states.
//!
//! This room sees masks, never a world, a pose or a scan: the state cannot cheat.

mod grid;

pub use grid::{Grid, GridError, MAX_STATES};
