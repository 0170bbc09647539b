//! After the test of a save: what is wrong with the behaviour, and what its reward can be had for. Everything that the
//! page waits for is on it by then; a newer save ends this too.

use std::sync::atomic::AtomicBool;

use super::board::{Board, SavedRun};
use insight::lint;

/// Checks a run that is on the board, and says there what was found.
pub(super) fn tell(board: &Board, run: &SavedRun, threads: usize, stop: &AtomicBool) {
    match lint::check_behaviour_until(&run.plan, threads, stop) {
        Ok(Some(report)) => board.checked(run, &report),
        Ok(None) => {}
        // What learned and was tested without a fault fails here only on a limit: worth a word, not an error of the save.
        Err(fault) => board.unchecked(run, &fault),
    }
}
