//! Who may ask: everything that is checked before a request is answered. Loopback is no protection by itself, since any web
//! page in the user's browser can send requests to it.

use super::answer::{HttpStatus, Refusal};
use super::request::HttpRequest;

/// Longest body, bytes; no request needs one.
const MOST_BODY_BYTES: u64 = 1024;

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
    pub(super) fn admit(&self, request: &HttpRequest) -> Result<(), Refusal> {
        let host = request.only("host").ok_or(Refusal(HttpStatus::BAD_REQUEST, "one Host header is needed"))?;
        // A name that an attacker points at 127.0.0.1 is still in this header.
        if !request.path.starts_with('/') || !self.hosts.iter().any(|own| own == host) {
            return Err(Refusal(HttpStatus::FORBIDDEN, "this Host is not served here"));
        }
        if has_long_body(request) {
            return Err(Refusal(HttpStatus::CONTENT_TOO_LARGE, "no request needs a body"));
        }
        // Browsers send an Origin with every request that can change something, and with what another page reads.
        if (request.method != "GET" || request.all("origin").next().is_some()) && !self.is_from_here(request) {
            return Err(Refusal(HttpStatus::FORBIDDEN, "this Origin may not ask"));
        }
        // What another page only embeds comes without an Origin, but says so here.
        let embedded = request.all("sec-fetch-site").any(|site| site != b"same-origin" && site != b"none");
        if embedded && !is_opened(request) {
            return Err(Refusal(HttpStatus::FORBIDDEN, "another page may not ask"));
        }
        if !self.knows(request.asked("token").unwrap_or("")) {
            return Err(Refusal(HttpStatus::UNAUTHORIZED, "open the address that the program printed, with its token"));
        }
        Ok(())
    }

    fn is_from_here(&self, request: &HttpRequest) -> bool {
        let origin = request.only("origin").and_then(|origin| origin.strip_prefix("http://"));
        origin.is_some_and(|origin| self.hosts.iter().any(|own| own == origin))
    }

    /// Compares every byte, so that the time taken says nothing about where the first wrong one is.
    fn knows(&self, given: &str) -> bool {
        let differs = given.bytes().zip(self.token.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b));
        given.len() == self.token.len() && differs == 0
    }
}

/// Whether the page itself is opened in a window of its own, as from the file through which the browser is started.
fn is_opened(request: &HttpRequest) -> bool {
    let says = |name: &str, value: &str| request.only(name) == Some(value);
    (request.method.as_str(), request.path.as_str()) == ("GET", "/")
        && says("sec-fetch-mode", "navigate")
        && says("sec-fetch-dest", "document")
}

/// Whether a body comes that nobody would read, or one whose length is not known before.
fn has_long_body(request: &HttpRequest) -> bool {
    let length = |value: &[u8]| std::str::from_utf8(value).ok()?.parse::<u64>().ok();
    request.all("transfer-encoding").next().is_some()
        || request.all("content-length").any(|value| length(value).is_none_or(|length| length > MOST_BODY_BYTES))
}
