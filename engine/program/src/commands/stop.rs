//! Ctrl-C: the first one stops cleanly and keeps what was learned, the second one leaves at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use engine::diagnostic::{Diagnostic, Result};

/// The exit status after Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// A flag that is set by the first Ctrl-C.
pub(crate) fn on_ctrl_c() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let set = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    match set {
        Ok(()) => Ok(stop),
        Err(error) => Diagnostic::new("E-SIGNAL", format!("cannot listen for Ctrl-C: {error}")).fail(),
    }
}
