//! An engine without native filters: it refuses each of them, and never serves one.

use std::path::Path;

use crate::diagnostic::{Diagnostic, Result, printable};
use crate::filter::entry::Entry;
use crate::filter::trust::Trust;

/// Refuses a library.
///
/// # Errors
/// Always; how to build an engine that loads it.
pub(in crate::filter) fn open(path: &Path, _: &Trust, _: Option<&Path>) -> Result<Entry> {
    Err(refusal(path))
}

/// Refuses to be a worker.
///
/// # Errors
/// Always; how to build an engine that can be one.
pub fn serve(path: &Path, _: &Trust) -> Result<()> {
    Err(refusal(path))
}

fn refusal(path: &Path) -> Box<Diagnostic> {
    let shown = printable(&path.display().to_string());
    let message = format!("'{shown}' is a native filter, and this engine was built without native filters");
    let help = "build it with its feature native-filters, or ask the author for the filter in WebAssembly";
    Box::new(Diagnostic::new("E-NATIVE-BUILD", message).help(help))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_is_refused_whoever_allowed_it() {
        let error = open(Path::new("libink.so"), &Trust::default(), None).err().unwrap();
        assert_eq!((error.code, error.kind), ("E-NATIVE-BUILD", Kind::Usage));
        assert_eq!(serve(Path::new("libink.so"), &Trust::default()).err().unwrap().code, "E-NATIVE-BUILD");
    }
}
