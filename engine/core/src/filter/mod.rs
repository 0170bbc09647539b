//! The chain of filters that turns a camera image into a mask.
//!
//! Filters come from a [`Catalogue`]: those linked in, native libraries that the user allowed, and sandboxed WebAssembly
//! modules, all by the contract of `plugins/filter-api`. This room never knows a world, a state or a script.

mod alike;
mod beginning;
mod catalogue;
mod chain;
mod condition;
mod conformance;
#[cfg(any(feature = "native-filters", feature = "wasm"))]
mod described;
mod entry;
mod kept;
mod law;
mod native;
mod purity;
mod running;
mod trust;
mod wasm;

pub use catalogue::{Catalogue, LINKED_IN, Sources, is_filter_file};
pub use chain::{Chain, ChainError};
pub use condition::{EXAMPLE, LANGUAGE};
pub use conformance::conformance;
pub use entry::{Entry, Form};
pub use kept::mount_of;
#[cfg(feature = "native-filters")]
pub use native::count_replies;
pub use native::serve;
pub use running::Running;
pub use trust::Trust;
