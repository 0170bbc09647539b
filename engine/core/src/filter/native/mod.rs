//! Filters in native libraries: loaded into this process, or each in a process of its own, which a crash ends instead.
//!
//! Without the cargo feature `native-filters` every library is refused.

#[cfg(feature = "native-filters")]
mod guarded;
#[cfg(feature = "native-filters")]
mod library;
#[cfg(feature = "native-filters")]
mod loaded;
#[cfg(feature = "native-filters")]
mod rounding;
#[cfg(feature = "native-filters")]
mod wire;
#[cfg(feature = "native-filters")]
mod wire_told;
#[cfg(feature = "native-filters")]
mod worker;

#[cfg(not(feature = "native-filters"))]
mod without;

#[cfg(feature = "native-filters")]
pub use wire::count_replies;
#[cfg(not(feature = "native-filters"))]
pub(super) use without::open;
#[cfg(not(feature = "native-filters"))]
pub use without::serve;
#[cfg(feature = "native-filters")]
pub use worker::serve;

#[cfg(feature = "native-filters")]
use {super::entry::Entry, super::trust::Trust, crate::diagnostic::Result, std::path::Path};

/// Opens a library that the user allowed; in workers that `program` starts, if there is one.
///
/// # Errors
/// If it is not allowed, is not a filter, or breaks down while it is loaded.
#[cfg(feature = "native-filters")]
pub(super) fn open(path: &Path, trust: &Trust, program: Option<&Path>) -> Result<Entry> {
    match program {
        Some(program) => worker::open(path, trust, program),
        None => loaded::open(path, trust),
    }
}
