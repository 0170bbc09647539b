//! What every request to the live page can reach.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::board::Board;
use super::guard::Guard;
use super::relearn::Asker;
use insight::page::Page;

/// A place among the connections, which travels with its connection.
pub(super) type Permit = Arc<OwnedSemaphorePermit>;

/// What every request can reach.
#[derive(Clone)]
pub(super) struct ServerState {
    pub board: Arc<Board>,
    pub asker: Asker,
    pub guard: Arc<Guard>,
    pub page: Arc<Page>,
    /// Moments are played one at a time, beside learning.
    pub player: Arc<Semaphore>,
}
