//! The live page: learns again whenever the script, its world or its filters are saved, and shows the result in a browser,
//! and in the terminal if it is asked to.
//!
//! ```text
//!   files.rs (saves) --> relearn.rs, session.rs (all cores) --> board.rs (the last good run, the last error)
//!                                                                    ^ reads
//!   browser <--> request.rs, guard.rs, server.rs, answer.rs, events.rs +
//!   terminal <--> terminal/ (one thread) ----------------------------+
//! ```
//!
//! What learned is tested, then checked (`findings.rs`); policies that a script combines are only tested (`combined.rs`).
//!
//! Learning writes to the board and never waits for a reader. The server listens on loopback only; whoever asks must know
//! the token, and come from the page's own address.

mod answer;
mod board;
mod combined;
mod desk;
mod door;
mod events;
mod files;
mod findings;
mod guard;
mod relearn;
mod request;
mod server;
mod session;
#[cfg(feature = "tui")]
pub mod terminal;

pub use board::{Board, SavedRun, Shown, ShownRun, WatchedSeed};
pub use desk::{Finished, Packed, WatchSettings};
pub use relearn::{Asker, Relearner};
pub use server::{Address, listen};
