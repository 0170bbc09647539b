//! The WebSocket: whatever is new on the board goes out; what comes in is only checked for its size.

use std::sync::Arc;
use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::response::Response;

use super::board::Board;
use super::shared::{Permit, ServerState};

/// Longest message that a page may send, bytes; it has nothing to say.
const MOST_BYTES: usize = 4096;
/// How long a client may take to read a message.
const SEND_TIMEOUT: Duration = Duration::from_secs(10);

pub(super) async fn live(
    State(shared): State<ServerState>,
    Extension(permit): Extension<Permit>,
    upgrade: WebSocketUpgrade,
) -> Response {
    let upgrade = upgrade.max_message_size(MOST_BYTES).max_frame_size(MOST_BYTES);
    upgrade.on_upgrade(move |socket| async move {
        talk(socket, shared.board).await;
        drop(permit);
    })
}

/// A client that reads slowly misses what is replaced meanwhile; one that does not read at all is left.
async fn talk(mut socket: WebSocket, board: Arc<Board>) {
    let (mut news, mut sent) = (board.news(), 0);
    loop {
        for (number, text) in board.posted(sent).messages {
            sent = sent.max(number);
            let message = Message::Text((*text).into());
            match tokio::time::timeout(SEND_TIMEOUT, socket.send(message)).await {
                Ok(Ok(())) => {}
                _ => return,
            }
        }
        tokio::select! {
            changed = news.changed() => if changed.is_err() { return },
            heard = socket.recv() => match heard {
                Some(Ok(Message::Close(_))) | None => return,
                Some(Ok(_)) => {}
                Some(Err(_)) => return close(socket).await,
            },
        }
    }
}

/// The only mistake that a frame can make here is its size, or not being one.
async fn close(mut socket: WebSocket) {
    let frame = CloseFrame { code: close_code::SIZE, reason: "a message may have 4096 bytes".into() };
    let _ = tokio::time::timeout(SEND_TIMEOUT, socket.send(Message::Close(Some(frame)))).await;
}
