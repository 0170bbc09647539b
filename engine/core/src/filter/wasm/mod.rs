//! Filters in WebAssembly: sandboxed, with limits that are always on, and the same bytes on every machine.

use std::path::Path;

use super::entry::Entry;
use crate::diagnostic::{Diagnostic, Result, printable};

#[cfg(feature = "wasm")]
mod kept;
#[cfg(feature = "wasm")]
mod layout;
#[cfg(feature = "wasm")]
mod limits;
#[cfg(feature = "wasm")]
mod sandbox;

/// Compiles a module, without running any of it.
///
/// # Errors
/// If it is no module, is too large, wants more than a log, or does not keep the contract.
#[cfg(feature = "wasm")]
pub(super) fn open(path: &Path) -> Result<Entry> {
    let bytes = super::trust::read(path)?;
    check_form(path, &bytes)?;
    limits::check_limits(path, &bytes)?;
    sandbox::open(path, &bytes)
}

/// Refuses every module: this program was built without the sandbox.
///
/// # Errors
/// Always; how to build it with one.
#[cfg(not(feature = "wasm"))]
pub(super) fn open(path: &Path) -> Result<Entry> {
    check_form(path, &super::trust::read(path)?)?;
    let shown = printable(&path.display().to_string());
    let message = format!("'{shown}' is a WebAssembly filter, and this engine was built without WebAssembly");
    let help = "build it with: cargo build --release --features wasm";
    Diagnostic::new("E-WASM-BUILD", message).help(help).fail()
}

fn check_form(path: &Path, bytes: &[u8]) -> Result<()> {
    if bytes.starts_with(b"\0asm") {
        return Ok(());
    }
    let message = format!("'{}' is not a WebAssembly module", printable(&path.display().to_string()));
    let error = Diagnostic::new("E-WASM-FORM", message);
    if bytes.trim_ascii_start().starts_with(b"(module") {
        return error.help("it is the text form of one; turn it into a module with wat2wasm").fail();
    }
    error.help("build one: cargo build --release --target wasm32-unknown-unknown").fail()
}
