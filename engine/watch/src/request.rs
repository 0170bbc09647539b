//! One request: read whole or not at all, within a time and a size.

use std::io::Read;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use super::answer::{HttpStatus, Refusal};

/// Longest line and headers of a request, bytes.
const MOST_HEAD_BYTES: usize = 8 * 1024;
/// Most headers; browsers send about 15.
const MOST_HEADERS: usize = 64;
/// How long a request may take to arrive.
const HEAD_TIMEOUT: Duration = Duration::from_secs(1);

/// A request's line and headers; no request here needs a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct HttpRequest {
    pub method: String,
    /// As it was sent: with a scheme and a host if it was sent to a proxy.
    pub path: String,
    /// What follows the `?`.
    pub query: String,
    /// Names in lower case; each as often as it was sent.
    pub headers: Vec<(String, Vec<u8>)>,
}

impl HttpRequest {
    /// Reads from a client up to the empty line after the headers.
    ///
    /// # Errors
    /// What the client is told if that line does not come, comes too late, or what is before it is no request.
    pub(super) fn read(stream: &mut TcpStream) -> Result<Self, Refusal> {
        let (deadline, mut head, mut piece) = (Instant::now() + HEAD_TIMEOUT, Vec::new(), [0; 2048]);
        loop {
            let left = deadline.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
            let late = || Refusal(HttpStatus::REQUEST_TIMEOUT, "the request took longer than a second");
            stream.set_read_timeout(Some(left)).map_err(|_| late())?;
            match stream.read(&mut piece) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(_) if Instant::now() >= deadline => return Err(late()),
                Ok(0) | Err(_) => return Err(Refusal(HttpStatus::BAD_REQUEST, "the request ends too early")),
                Ok(count) => head.extend_from_slice(&piece[..count]),
            }
            if let Some(end) = head.windows(4).take(MOST_HEAD_BYTES).position(|four| four == b"\r\n\r\n") {
                return Self::parse(&head[..end + 4]);
            }
            if head.len() > MOST_HEAD_BYTES {
                return Err(Refusal(HttpStatus::HEADERS_TOO_LARGE, "the headers are longer than 8 KiB"));
            }
            if Instant::now() >= deadline {
                return Err(late());
            }
        }
    }

    fn parse(head: &[u8]) -> Result<Self, Refusal> {
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut parsed = httparse::Request::new(&mut headers);
        let no_request = Refusal(HttpStatus::BAD_REQUEST, "this is no HTTP request");
        match parsed.parse(head) {
            Ok(httparse::Status::Complete(_)) => {}
            Err(httparse::Error::TooManyHeaders) => {
                return Err(Refusal(HttpStatus::HEADERS_TOO_LARGE, "there are more than 64 headers"));
            }
            _ => return Err(no_request),
        }
        let (Some(method), Some(target)) = (parsed.method, parsed.path) else { return Err(no_request) };
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let headers = parsed.headers.iter().map(|header| (header.name.to_ascii_lowercase(), header.value.to_vec()));
        Ok(Self {
            method: method.to_owned(),
            path: path.to_owned(),
            query: query.to_owned(),
            headers: headers.collect(),
        })
    }

    /// The values of all headers with a name in lower case.
    pub(super) fn all(&self, name: &str) -> impl Iterator<Item = &[u8]> {
        self.headers.iter().filter(move |(own, _)| own == name).map(|(_, value)| value.as_slice())
    }

    /// A header that must stand exactly once.
    pub(super) fn only(&self, name: &str) -> Option<&str> {
        let mut all = self.all(name);
        let first = all.next()?;
        if all.next().is_some() { None } else { std::str::from_utf8(first).ok() }
    }

    /// The first value of a name in the query, as it was sent: what is asked here are numbers, words and hex digits, which no
    /// browser escapes.
    pub(super) fn asked(&self, name: &str) -> Option<&str> {
        self.query
            .split('&')
            .find_map(|pair| pair.split_once('=').filter(|(own, _)| *own == name))
            .map(|(_, value)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_its_line_and_its_headers() {
        let request =
            HttpRequest::parse(b"GET /frame?save=2&seed=7 HTTP/1.1\r\nHost: here\r\nX: 1\r\nx: 2\r\n\r\n").unwrap();
        assert_eq!((request.method.as_str(), request.path.as_str()), ("GET", "/frame"));
        assert_eq!((request.asked("save"), request.asked("seed"), request.asked("step")), (Some("2"), Some("7"), None));
        assert_eq!((request.only("host"), request.only("x"), request.all("x").count()), (Some("here"), None, 2));
    }

    #[test]
    fn what_is_no_request_is_refused() {
        for head in [
            &b"\r\n\r\n"[..],
            b"GET / HTTP/9.9\r\n\r\n",
            b"GET /a\0b HTTP/1.1\r\n\r\n",
            b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
        ] {
            assert_eq!(HttpRequest::parse(head).unwrap_err().0, HttpStatus::BAD_REQUEST, "{head:?}");
        }
        let many = format!("GET / HTTP/1.1\r\n{}\r\n", "X: 1\r\n".repeat(65));
        assert_eq!(HttpRequest::parse(many.as_bytes()).unwrap_err().0, HttpStatus::HEADERS_TOO_LARGE);
    }
}
