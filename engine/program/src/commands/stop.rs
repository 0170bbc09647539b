//! Ctrl-C, and the other signals that ask a command to end: the first one stops cleanly and keeps what was learned, the second
//! one leaves at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use engine::diagnostic::{Diagnostic, Result};
use signal_hook::consts::SIGINT;
use signal_hook::flag::{register, register_conditional_shutdown, register_usize};

/// The exit status after Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;
/// What is added to a signal's number in the exit status.
const BY_SIGNAL: u8 = 128;

/// A flag that is set by the first Ctrl-C.
pub(crate) fn on_ctrl_c() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    listen(SIGINT, &stop)?;
    Ok(stop)
}

/// Stopping by any signal that asks for it.
pub(crate) struct Stop {
    /// Set by the first one.
    pub(crate) flag: Arc<AtomicBool>,
    by: Arc<AtomicUsize>,
}

impl Stop {
    /// Listens for Ctrl-C, for SIGTERM, and for SIGHUP, which comes when a terminal is closed.
    pub(crate) fn on_signals() -> Result<Self> {
        let stop = Self { flag: Arc::default(), by: Arc::default() };
        for (signal, number) in SIGNALS {
            // First who it was: whoever sees the flag may ask.
            register_usize(*signal, Arc::clone(&stop.by), *number).map_err(|error| deaf(&error))?;
            listen(*signal, &stop.flag)?;
        }
        Ok(stop)
    }

    /// The exit status and the signal, in words, once there was one.
    pub(crate) fn status(&self) -> Option<(u8, &'static str)> {
        if !self.flag.load(Ordering::Relaxed) {
            return None;
        }
        Some(match self.by.load(Ordering::Relaxed) {
            1 => (BY_SIGNAL + 1, "SIGHUP"),
            15 => (BY_SIGNAL + 15, "SIGTERM"),
            _ => (INTERRUPTED, "Ctrl-C"),
        })
    }
}

#[cfg(unix)]
const SIGNALS: &[(i32, usize)] = &[(SIGINT, 2), (signal_hook::consts::SIGTERM, 15), (signal_hook::consts::SIGHUP, 1)];
#[cfg(not(unix))]
const SIGNALS: &[(i32, usize)] = &[(SIGINT, 2), (signal_hook::consts::SIGTERM, 15)];

fn listen(signal: i32, stop: &Arc<AtomicBool>) -> Result<()> {
    // In this order: the first one finds the flag unset, and sets it.
    let set = register_conditional_shutdown(signal, i32::from(BY_SIGNAL) + signal, Arc::clone(stop))
        .and_then(|_| register(signal, Arc::clone(stop)));
    set.map(drop).map_err(|error| deaf(&error))
}

fn deaf(error: &std::io::Error) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-SIGNAL", format!("cannot listen for Ctrl-C: {error}")))
}
