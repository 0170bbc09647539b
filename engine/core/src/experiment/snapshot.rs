//! One frame with what the filter, the grid and the state map made of it, for drawing.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Step};
use crate::robot::Robot;
use crate::sensors::observation::Image;
use crate::state::Grid;

/// One frame with what was made of it.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// The camera image.
    pub image: Image,
    /// What each view made of it, the first one first.
    pub views: Vec<SeenView>,
    /// The state.
    pub state: usize,
}

/// What one view made of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenView {
    /// What the script calls it, if it has a name.
    pub name: Option<String>,
    /// The mask: a byte for each pixel, 0 or 255.
    pub mask: Vec<u8>,
    /// Rows and columns of the grid.
    pub grid: (usize, usize),
    /// Share of foreground pixels of each cell.
    pub shares: Vec<f32>,
    /// Whether each cell is occupied by itself.
    pub occupied: Vec<bool>,
    /// Whether each cell counts as filled in the grid's number.
    pub filled: Vec<bool>,
    /// The number of this grid alone.
    pub number: usize,
}

impl SeenView {
    /// Of a mask that was just counted by a grid.
    #[must_use]
    pub fn of(name: Option<&str>, mask: &[u8], grid: &Grid) -> Self {
        let counts = grid.counts().iter().enumerate();
        Self {
            name: name.map(str::to_owned),
            mask: mask.to_vec(),
            grid: grid.size(),
            shares: counts.map(|(cell, count)| *count as f32 / grid.area_px(cell) as f32).collect(),
            occupied: grid.occupied().to_vec(),
            filled: grid.cells(grid.state()),
            number: grid.state(),
        }
    }
}

impl Snapshot {
    /// The present frame.
    #[must_use]
    pub fn of<R: Robot>(cycle: &Cycle<R>) -> Self {
        Self {
            image: cycle.robot().photograph().unwrap_or_else(|| cycle.observation().sight().clone()),
            views: cycle.views().collect(),
            state: cycle.state(),
        }
    }
}

/// Takes one frame after so many steps.
pub(super) struct Glimpse {
    left: u64,
    pub(super) taken: Option<Snapshot>,
}

impl Glimpse {
    pub(super) const fn after(steps: u64) -> Self {
        Self { left: steps, taken: None }
    }
}

impl<R: Robot> Observer<R> for Glimpse {
    fn stepped(&mut self, cycle: &Cycle<R>, _: &Step) -> ControlFlow<()> {
        if self.left > 0 {
            self.left -= 1;
            if self.left == 0 {
                self.taken = Some(Snapshot::of(cycle));
            }
        }
        ControlFlow::Continue(())
    }
}
