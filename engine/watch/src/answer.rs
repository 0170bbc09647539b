//! What is sent back: a status, the headers that every answer has, a body.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// How long a client may take to read an answer, or one message of a stream.
const READ_TIMEOUT: Duration = Duration::from_secs(30);
/// How long the rest of what a client sent is read: with bytes left over, the system would throw our answer away.
const LINGER: Duration = Duration::from_millis(100);

/// A status of HTTP with its name (RFC 9110, section 15).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct HttpStatus(u16, &'static str);

impl HttpStatus {
    pub(super) const OK: Self = Self(200, "OK");
    pub(super) const ACCEPTED: Self = Self(202, "Accepted");
    pub(super) const BAD_REQUEST: Self = Self(400, "Bad HttpRequest");
    pub(super) const UNAUTHORIZED: Self = Self(401, "Unauthorized");
    pub(super) const FORBIDDEN: Self = Self(403, "Forbidden");
    pub(super) const NOT_FOUND: Self = Self(404, "Not Found");
    pub(super) const METHOD_NOT_ALLOWED: Self = Self(405, "Method Not Allowed");
    pub(super) const REQUEST_TIMEOUT: Self = Self(408, "Request Timeout");
    pub(super) const CONTENT_TOO_LARGE: Self = Self(413, "Content Too Large");
    pub(super) const HEADERS_TOO_LARGE: Self = Self(431, "Request Header Fields Too Large");
    pub(super) const INTERNAL_SERVER_ERROR: Self = Self(500, "Internal Server Error");
    pub(super) const SERVICE_UNAVAILABLE: Self = Self(503, "Service Unavailable");
}

/// Why a request is refused: its status, and a sentence for whoever reads it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Refusal(pub HttpStatus, pub &'static str);

/// What a request is answered with.
pub(super) struct HttpAnswer {
    status: HttpStatus,
    kind: &'static str,
    body: Vec<u8>,
}

impl HttpAnswer {
    pub(super) fn new(status: HttpStatus, kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status, kind, body: body.into() }
    }

    /// A status with a sentence, or just the status.
    pub(super) fn text(status: HttpStatus, text: &str) -> Self {
        let body = if text.is_empty() { String::new() } else { format!("{text}\n") };
        Self::new(status, "text/plain; charset=utf-8", body)
    }

    /// Line, headers and body; `policy` says what the page may run and load.
    pub(super) fn bytes(&self, policy: &str) -> Vec<u8> {
        let mut bytes = head(self.status, self.kind, policy, Some(self.body.len())).into_bytes();
        bytes.extend_from_slice(&self.body);
        bytes
    }
}

impl From<Refusal> for HttpAnswer {
    fn from(Refusal(status, why): Refusal) -> Self {
        Self::text(status, why)
    }
}

/// Line and headers of an answer; without a length it lasts until one side closes.
pub(super) fn head(HttpStatus(number, name): HttpStatus, kind: &str, policy: &str, length: Option<usize>) -> String {
    let length = length.map_or(String::new(), |length| format!("content-length: {length}\r\n"));
    format!(
        "HTTP/1.1 {number} {name}\r\n\
         content-type: {kind}\r\n\
         {length}\
         connection: close\r\n\
         cache-control: no-store\r\n\
         content-security-policy: {policy}; frame-ancestors 'none'\r\n\
         cross-origin-opener-policy: same-origin\r\n\
         cross-origin-resource-policy: same-origin\r\n\
         referrer-policy: no-referrer\r\n\
         x-content-type-options: nosniff\r\n\
         x-frame-options: DENY\r\n\
         \r\n"
    )
}

/// Sends everything, or gives up on a client that takes too long to read it.
pub(super) fn send(stream: &mut TcpStream, mut bytes: &[u8]) -> std::io::Result<()> {
    let deadline = Instant::now() + READ_TIMEOUT;
    while !bytes.is_empty() {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_write_timeout(Some(left))?;
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if matches!(error.kind(), ErrorKind::Interrupted | ErrorKind::WouldBlock) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Ends a connection so that the client still gets what was sent.
pub(super) fn close(stream: &mut TcpStream) {
    let deadline = Instant::now() + LINGER;
    let (mut rest, mut open) = ([0; 4096], stream.shutdown(Shutdown::Write).is_ok());
    while open {
        let left = deadline.saturating_duration_since(Instant::now());
        open = !left.is_zero()
            && stream.set_read_timeout(Some(left)).is_ok()
            && stream.read(&mut rest).is_ok_and(|count| count > 0);
    }
}
