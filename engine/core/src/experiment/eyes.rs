//! One way of perceiving: a filter chain and a grid over the camera's image.

use crate::diagnostic::Result;
use crate::filter::Chain;
use crate::sensors::observation::Image;
use crate::state::Grid;

/// What turns an image into a state.
pub struct Eyes {
    pub(super) chain: Chain,
    pub(super) grid: Grid,
}

impl Eyes {
    /// Eyes of a chain and a grid for images of the same size.
    #[must_use]
    pub fn new(chain: Chain, grid: Grid) -> Self {
        Self { chain, grid }
    }

    /// The state of an image.
    ///
    /// # Errors
    /// If a filter fails.
    pub(super) fn perceive(&mut self, image: &Image) -> Result<usize> {
        let mask = self.chain.apply(image)?;
        Ok(self.grid.encode(mask))
    }
}
