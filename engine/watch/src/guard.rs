//! Who may ask: everything that is checked before a request is answered. Loopback is no protection by itself, since any web
//! page in the user's browser can send requests to it.

use std::time::Duration;

use axum::http::{HeaderMap, Method, StatusCode, Uri, header};
use tokio::io::AsyncReadExt;

/// Longest line and headers of a request, bytes.
const MOST_HEAD_BYTES: usize = 8 * 1024;
/// Longest body, bytes; no request needs one.
const MOST_BODY_BYTES: u64 = 1024;
/// How long a request may take to arrive.
const HEAD_TIMEOUT: Duration = Duration::from_secs(10);

/// Why a request is refused.
pub(super) type Refusal = (StatusCode, &'static str);

/// What a request must bring.
#[derive(Debug, Clone)]
pub(super) struct Guard {
    token: String,
    hosts: [String; 2],
}

impl Guard {
    pub(super) fn new(token: String, port: u16) -> Self {
        Self { token, hosts: [format!("127.0.0.1:{port}"), format!("localhost:{port}")] }
    }

    /// Checks all but the path.
    pub(super) fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = only(headers, header::HOST).ok_or((StatusCode::BAD_REQUEST, "one Host header is needed"))?;
        // A name that an attacker points at 127.0.0.1 is still in this header.
        if uri.host().is_some() || !self.hosts.iter().any(|own| own == host) {
            return Err((StatusCode::FORBIDDEN, "this Host is not served here"));
        }
        self.check_body(headers)?;
        let upgrade = headers.contains_key(header::UPGRADE);
        let origin = only(headers, header::ORIGIN);
        let from_here = origin.is_some_and(|origin| self.hosts.iter().any(|own| origin == format!("http://{own}")));
        // Browsers send an Origin with every WebSocket and every request that can change something.
        let must_be_from_here = upgrade || method != Method::GET || headers.contains_key(header::ORIGIN);
        if must_be_from_here && !from_here {
            return Err((StatusCode::FORBIDDEN, "this Origin may not ask"));
        }
        if !self.knows_token(uri) {
            return Err((StatusCode::UNAUTHORIZED, "open the address that the program printed, with its token"));
        }
        Ok(())
    }

    fn check_body(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let too_long = (StatusCode::PAYLOAD_TOO_LARGE, "no request needs a body");
        if headers.contains_key(header::TRANSFER_ENCODING) {
            return Err(too_long);
        }
        match headers
            .get(header::CONTENT_LENGTH)
            .map(|length| length.to_str().ok().and_then(|text| text.parse::<u64>().ok()))
        {
            None => Ok(()),
            Some(Some(length)) if length <= MOST_BODY_BYTES => Ok(()),
            Some(_) => Err(too_long),
        }
    }

    /// Compares every byte, so that the time taken says nothing about where the first wrong one is.
    fn knows_token(&self, uri: &Uri) -> bool {
        let given = uri.query().unwrap_or("").split('&').find_map(|pair| pair.strip_prefix("token=")).unwrap_or("");
        let differs = given.bytes().zip(self.token.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b));
        given.len() == self.token.len() && differs == 0
    }
}

/// A header that must stand exactly once.
fn only(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?;
    if all.next().is_some() { None } else { first.to_str().ok() }
}

/// Reads a request's line and headers, which must be whole in time and not too long.
pub(super) async fn read_head(stream: &mut (impl AsyncReadExt + Unpin)) -> Result<Vec<u8>, Refusal> {
    let mut head = Vec::new();
    let read = async {
        let mut piece = [0; 2048];
        loop {
            match stream.read(&mut piece).await {
                Ok(0) | Err(_) => return Err((StatusCode::BAD_REQUEST, "the request ends too early")),
                Ok(count) => head.extend_from_slice(&piece[..count]),
            }
            if head.windows(4).take(MOST_HEAD_BYTES).any(|four| four == b"\r\n\r\n") {
                return Ok(());
            }
            if head.len() > MOST_HEAD_BYTES {
                return Err((StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, "the headers are longer than 8 KiB"));
            }
        }
    };
    match tokio::time::timeout(HEAD_TIMEOUT, read).await {
        Ok(Ok(())) => Ok(head),
        Ok(Err(refusal)) => Err(refusal),
        Err(_) => Err((StatusCode::REQUEST_TIMEOUT, "the request took longer than 10 seconds")),
    }
}
