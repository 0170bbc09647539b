//! What is new on the board, as Server-Sent Events (HTML standard, section 9.2): the server only tells, so a page needs no more
//! than an answer that goes on.

use std::io::{ErrorKind, Result};
use std::net::TcpStream;
use std::time::Duration;

use super::answer::{HttpStatus, head, send};
use super::board::Board;

/// How often a quiet client is looked at: one that has gone leaves its place to the next.
const LOOK: Duration = Duration::from_millis(500);

/// Tells a client all that is news to it, until it goes. One that reads slowly misses what is replaced meanwhile.
///
/// # Errors
/// If the client has gone, does not read, or has something to say.
pub(super) fn tell(stream: &mut TcpStream, board: &Board, policy: &str) -> Result<()> {
    send(stream, head(HttpStatus::OK, "text/event-stream", policy, None).as_bytes())?;
    // A read is only a look whether the client is there.
    stream.set_read_timeout(Some(Duration::from_millis(1)))?;
    let mut sent = 0;
    loop {
        for (number, text) in board.posted(sent, LOOK).messages {
            sent = sent.max(number);
            // JSON as it is written here has no line breaks, which would end the message.
            send(stream, format!("data: {text}\n\n").as_bytes())?;
        }
        match stream.peek(&mut [0]) {
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {}
            Err(error) => return Err(error),
            Ok(_) => return Err(ErrorKind::ConnectionAborted.into()),
        }
    }
}
