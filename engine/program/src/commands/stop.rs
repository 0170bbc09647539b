//! Ctrl-C: the first one stops cleanly and keeps what was learned, the second one leaves at once.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::{Diagnostic, Result};
use signal_hook::consts::SIGINT;
use signal_hook::flag::{register, register_conditional_shutdown};

/// The exit status after Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// A flag that is set by the first Ctrl-C.
pub(crate) fn on_ctrl_c() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    // In this order: the first Ctrl-C finds the flag unset, and sets it.
    let set = register_conditional_shutdown(SIGINT, i32::from(INTERRUPTED), Arc::clone(&stop))
        .and_then(|_| register(SIGINT, Arc::clone(&stop)));
    match set {
        Ok(_) => Ok(stop),
        Err(error) => Diagnostic::new("E-SIGNAL", format!("cannot listen for Ctrl-C: {error}")).fail(),
    }
}
