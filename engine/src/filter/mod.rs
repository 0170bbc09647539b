//! SEE. The chain of filters that turns a camera image into a mask.
//!
//! Filters come from the registry: those linked in today; native libraries and WebAssembly modules enter beside them
//! through the same `Plugin`. This room never knows a world, a state or a script.

mod chain;
mod registry;

pub use chain::{Chain, ChainError};
pub use registry::{built_in, find};
