use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::support::Bench;

/// A running `engine watch`, ended with the test.
pub(crate) struct Served {
    child: Child,
    pub(crate) bench: Bench,
    pub(crate) port: u16,
    pub(crate) token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

impl Served {
    pub(crate) fn new(more: &[&str]) -> Self {
        Self::of(Bench::new(), "short.rhai", more)
    }

    /// A behaviour of a bench.
    pub(crate) fn of(bench: Bench, script: &str, more: &[&str]) -> Self {
        let mut arguments = vec!["watch", script, "--seeds", "2", "--no-open"];
        arguments.extend(if more.is_empty() { &["--port", "0"] } else { more });
        let mut child = bench.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let (before, token) = line.trim().split_once("/?token=").unwrap();
        let port = before.rsplit(':').next().unwrap().parse().unwrap();
        Self { child, bench, port, token: token.to_owned() }
    }

    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    /// The whole answer to some bytes.
    pub(crate) fn answer(&self, request: &[u8]) -> String {
        let mut stream = self.connect();
        stream.write_all(request).unwrap();
        let mut answer = Vec::new();
        // A server that refuses may close before all is read.
        drop(stream.read_to_end(&mut answer));
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// The status of a request with the right host and token, and these headers besides.
    pub(crate) fn status(&self, method: &str, path: &str, headers: &str) -> u16 {
        let Self { port, token, .. } = self;
        status(&self.answer(
            format!("{method} {path}?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{headers}\r\n").as_bytes(),
        ))
    }

    /// The stream of events, as the page opens it.
    pub(crate) fn events(&self) -> BufReader<TcpStream> {
        let Self { port, token, .. } = self;
        let mut stream = self.connect();
        let request = format!("GET /live?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut events = BufReader::new(stream);
        let mut head = String::new();
        while !head.ends_with("\r\n\r\n") {
            assert!(events.read_line(&mut head).unwrap() > 0, "{head}");
        }
        assert!(status(&head) == 200 && head.contains("content-type: text/event-stream\r\n"), "{head}");
        events
    }
}

pub(crate) fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0)
}

/// The next message of some kind: `run`, `failed`, `working`.
pub(crate) fn message(
    events: &mut BufReader<TcpStream>,
    wanted: impl Fn(&serde_json::Value) -> bool,
) -> serde_json::Value {
    loop {
        let (mut line, mut end) = (String::new(), String::new());
        events.read_line(&mut line).unwrap();
        events.read_line(&mut end).unwrap();
        assert_eq!(end, "\n", "a message is one line of data: {line}");
        let message = serde_json::from_str(line.strip_prefix("data: ").unwrap()).unwrap();
        if wanted(&message) {
            return message;
        }
    }
}
