//! One way of perceiving: a filter chain, a grid over its mask, and a map from both to a state.

use crate::diagnostic::Result;
use crate::filter::Chain;
use crate::sensors::observation::Image;
use crate::state::{Grid, Percept, StateMap};

/// What turns an image into a state.
pub struct Eyes {
    pub(super) chain: Chain,
    pub(super) grid: Grid,
    pub(super) map: Box<dyn StateMap>,
}

impl Eyes {
    /// Eyes of a chain and a grid for images of the same size, and of the map that makes states of what they see.
    #[must_use]
    pub(super) fn new(chain: Chain, grid: Grid, map: Box<dyn StateMap>) -> Self {
        Self { chain, grid, map }
    }

    /// The state of an image.
    ///
    /// # Errors
    /// If a filter fails.
    pub(super) fn perceive(&mut self, image: &Image) -> Result<usize> {
        let mask = self.chain.apply(image)?;
        self.grid.encode(mask);
        Ok(self.map.encode(Percept { image, mask, grid: &self.grid }))
    }
}
