//! One frame with what the filter, the grid and the state map made of it, for drawing.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Step};
use crate::robot::Robot;
use crate::sensors::observation::Image;

/// One frame with what was made of it.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// The camera image.
    pub image: Image,
    /// The mask.
    pub mask: Vec<u8>,
    /// Rows and columns of the grid.
    pub grid: (usize, usize),
    /// Share of foreground pixels of each cell.
    pub shares: Vec<f32>,
    /// Whether each cell is occupied by itself.
    pub occupied: Vec<bool>,
    /// The cells that the state stands for, filled columns included; as occupied if it stands for something else.
    pub filled: Vec<bool>,
    /// The state.
    pub state: usize,
}

impl Snapshot {
    /// The cells of the first view's grid for which the present state stands; those that are occupied by themselves if it stands
    /// for something else.
    #[must_use]
    pub fn filled<R: Robot>(cycle: &Cycle<R>) -> Vec<bool> {
        let grid = cycle.grid();
        let cells = cycle.state_map().describe(cycle.state()).cells;
        match cells.filter(|cells| (cells.rows, cells.columns) == grid.size()) {
            Some(cells) => cells.filled,
            None => grid.occupied().to_vec(),
        }
    }

    /// The present frame.
    #[must_use]
    pub fn of<R: Robot>(cycle: &Cycle<R>) -> Self {
        let grid = cycle.grid();
        let counts = grid.counts().iter().enumerate();
        Self {
            image: cycle.robot().photograph().unwrap_or_else(|| cycle.observation().image.clone()),
            mask: cycle.mask().to_vec(),
            shares: counts.map(|(cell, count)| *count as f32 / grid.area_px(cell) as f32).collect(),
            grid: grid.size(),
            occupied: grid.occupied().to_vec(),
            filled: Self::filled(cycle),
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
