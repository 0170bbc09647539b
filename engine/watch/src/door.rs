//! The door of the server: connections that have not shown the token yet. They share a few places of their own, and whoever
//! has waited longest makes room for the next one, so that nobody without the token can keep out who has it.

use std::collections::VecDeque;
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, PoisonError};

/// Connections that may stand at the door.
const MOST: usize = 32;

/// Connections at the door, the oldest first, by their numbers.
#[derive(Debug, Default)]
pub(super) struct Door {
    standing: Mutex<(u64, VecDeque<(u64, TcpStream)>)>,
}

impl Door {
    /// Takes a connection in; its number, and whether another one was closed for it.
    ///
    /// # Errors
    /// If the system has no more handles.
    pub(super) fn enter(&self, stream: &TcpStream) -> std::io::Result<(u64, bool)> {
        let handle = stream.try_clone()?;
        let mut standing = self.standing.lock().unwrap_or_else(PoisonError::into_inner);
        let (last, queue) = &mut *standing;
        let oldest = if queue.len() >= MOST { queue.pop_front() } else { None };
        if let Some((_, oldest)) = &oldest {
            // Its thread reads the end.
            let _ = oldest.shutdown(Shutdown::Both);
        }
        *last += 1;
        queue.push_back((*last, handle));
        Ok((*last, oldest.is_some()))
    }

    /// Forgets a connection: it has shown the token, or has ended.
    pub(super) fn leave(&self, number: u64) {
        let mut standing = self.standing.lock().unwrap_or_else(PoisonError::into_inner);
        standing.1.retain(|(other, _)| *other != number);
    }
}
