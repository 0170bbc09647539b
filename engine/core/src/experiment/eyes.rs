//! One way of perceiving: filter chains, a grid over the mask of each, and a map from all of them to a state.

use crate::diagnostic::Result;
use crate::filter::Chain;
use crate::sensors::observation::Image;
use crate::state::{Grid, Percept, StateMap};

/// What turns an image into a state.
pub struct Eyes {
    /// The chain of each view, at least one.
    pub(super) chains: Vec<Chain>,
    /// The grid of each view.
    pub(super) grids: Vec<Grid>,
    pub(super) map: Box<dyn StateMap>,
}

impl Eyes {
    /// Eyes of one view, a chain and a grid for images of the same size, and of the map that makes states of what they see.
    #[must_use]
    pub(super) fn new(chain: Chain, grid: Grid, map: Box<dyn StateMap>) -> Self {
        Self { chains: vec![chain], grids: vec![grid], map }
    }

    /// Looks at an image.
    ///
    /// # Errors
    /// If a filter fails.
    pub(super) fn look(&mut self, image: &Image) -> Result<()> {
        for (chain, grid) in self.chains.iter_mut().zip(&mut self.grids) {
            grid.encode(chain.apply(image)?);
        }
        Ok(())
    }

    /// The state of the image that was looked at last, with the other parts of a state.
    pub(super) fn state(&mut self, image: &Image, digits: &[usize]) -> usize {
        let (mask, grid) = (self.chains[0].mask(), &self.grids[0]);
        self.map.encode(Percept { image, mask, grid, grids: &self.grids, digits })
    }

    /// The first view's chain.
    pub(super) fn chain(&self) -> &Chain {
        &self.chains[0]
    }

    /// The first view's grid.
    pub(super) fn grid(&self) -> &Grid {
        &self.grids[0]
    }
}
