//! The server: loopback only, few connections, a thread and one request for each.

use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::answer::{HttpAnswer, HttpStatus, Refusal, close, send};
use super::board::{Board, SavedRun};
use super::door::Door;
use super::events;
use super::guard::Guard;
use super::relearn::Asker;
use super::request::HttpRequest;
use engine::diagnostic::{Diagnostic, Result};
use engine::digest::hex;
use engine::experiment::Phase;
use insight::page::{Document, Page, Shot, page, shot_of};

/// The most connections at a time of those who have the token.
const MOST_CONNECTIONS: usize = 8;
/// Ports that are tried, from the first on.
const PORTS: u16 = 20;
/// Who was refused has to wait: a flood of requests cannot take the processor from learning.
const REFUSED_WAIT: Duration = Duration::from_millis(100);
/// How long nobody is let in after somebody was sent away.
const TURNED_AWAY_WAIT: Duration = Duration::from_millis(5);

/// Where the page is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address {
    /// The port.
    pub port: u16,
    /// The whole address, with the token.
    pub url: String,
}

/// What every request can reach.
struct Server {
    board: Arc<Board>,
    asker: Asker,
    guard: Guard,
    door: Door,
    /// Whoever holds a copy has a place.
    places: Arc<()>,
    page: Page,
    /// Moments are played one at a time, beside learning.
    player: Mutex<()>,
}

/// Begins to serve the page on a thread of its own, until the program ends.
///
/// # Errors
/// If no port from `port` on is free, or the system gives no randomness for the token.
pub fn listen(board: Arc<Board>, asker: Asker, port: u16) -> Result<Address> {
    let limit = |code, message: String| Box::new(Diagnostic::new(code, message));
    let mut ports = port..=port.saturating_add(PORTS - 1);
    let listener = ports.find_map(|port| TcpListener::bind((Ipv4Addr::LOCALHOST, port)).ok());
    let bound = listener.and_then(|listener| Some((listener.local_addr().ok()?.port(), listener)));
    let Some((port, listener)) = bound else {
        let message = format!("ports {port} to {} are all taken", port.saturating_add(PORTS - 1));
        return Err(Box::new(limit("E-WATCH-PORT", message).help("name another one: --port 9000")));
    };
    let mut random = [0; 16];
    getrandom::fill(&mut random).map_err(|error| limit("E-WATCH-SERVER", format!("cannot make a token: {error}")))?;
    let token = hex(&random);
    let url = format!("http://127.0.0.1:{port}/?token={token}");
    let (guard, page) = (Guard::new(token, port), page(None)?);
    let server =
        Server { board, asker, guard, door: Door::default(), places: Arc::default(), page, player: Mutex::default() };
    let thread = std::thread::Builder::new().name("server".into()).spawn(move || accept(&listener, &Arc::new(server)));
    thread.map_err(|error| limit("E-WATCH-SERVER", format!("cannot start the server: {error}")))?;
    Ok(Address { port, url })
}

fn accept(listener: &TcpListener, server: &Arc<Server>) {
    loop {
        let entered =
            listener.accept().and_then(|(stream, _)| server.door.enter(&stream).map(|entered| (stream, entered)));
        let Ok((mut stream, (number, crowded))) = entered else {
            std::thread::sleep(REFUSED_WAIT);
            continue;
        };
        let own = Arc::clone(server);
        let started = std::thread::Builder::new().spawn(move || {
            connection(&mut stream, number, &own);
            own.door.leave(number);
        });
        // Without a thread nobody answers, and the connection closes.
        if started.is_err() {
            server.door.leave(number);
        }
        // A flood of strangers takes little of the processor.
        if crowded {
            std::thread::sleep(TURNED_AWAY_WAIT);
        }
    }
}

/// One request for each connection, so that each is checked from its first byte.
fn connection(stream: &mut TcpStream, number: u64, server: &Server) {
    let _ = stream.set_nodelay(true);
    let admitted = HttpRequest::read(stream).and_then(|request| server.guard.admit(&request).map(|()| request));
    let answer = match admitted {
        Ok(request) => {
            server.door.leave(number);
            let place = Arc::clone(&server.places);
            // One copy is the server's own.
            let full = Arc::strong_count(&place) > MOST_CONNECTIONS + 1;
            match (request.method.as_str(), request.path.as_str()) {
                _ if full => HttpAnswer::text(HttpStatus::SERVICE_UNAVAILABLE, "too many connections"),
                ("GET", "/live") => return drop(events::tell(stream, &server.board, &server.page.policy)),
                _ => server.answer(&request),
            }
        }
        Err(refusal) => {
            std::thread::sleep(REFUSED_WAIT);
            refusal.into()
        }
    };
    if send(stream, &answer.bytes(&server.page.policy)).is_ok() {
        close(stream);
    }
}

impl Server {
    fn answer(&self, request: &HttpRequest) -> HttpAnswer {
        match (request.method.as_str(), request.path.as_str()) {
            ("GET", "/") => HttpAnswer::new(HttpStatus::OK, "text/html; charset=utf-8", self.page.html.as_bytes()),
            ("GET", "/track") => self.track(request).unwrap_or_else(HttpAnswer::from),
            ("GET", "/frame") => self.frame(request).unwrap_or_else(HttpAnswer::from),
            ("POST", "/relearn") => {
                self.asker.again();
                HttpAnswer::text(HttpStatus::ACCEPTED, "")
            }
            ("POST", "/param") => self.set_param(request).unwrap_or_else(HttpAnswer::from),
            (_, "/" | "/live" | "/track" | "/frame" | "/relearn" | "/param") => {
                HttpAnswer::text(HttpStatus::METHOD_NOT_ALLOWED, "this is asked in another way")
            }
            _ => HttpAnswer::text(HttpStatus::NOT_FOUND, "there is nothing here"),
        }
    }

    /// Another value of one of the parameters of the script that is shown.
    fn set_param(&self, request: &HttpRequest) -> std::result::Result<HttpAnswer, Refusal> {
        let wrong = Refusal(HttpStatus::BAD_REQUEST, "there is no such parameter, or the value is out of its range");
        let Some(run) = self.board.saved(number(request, "save")?) else { return Err(NOT_SHOWN) };
        let (name, value) = (request.asked("name").ok_or(wrong)?, request.asked("value").ok_or(wrong)?);
        let value: f64 = value.parse().map_err(|_| wrong)?;
        let param = run.plan.behaviour.params().iter().find(|param| param.name == name).ok_or(wrong)?;
        param.check(value).map_err(|_| wrong)?;
        self.asker.set(name, value);
        Ok(HttpAnswer::text(HttpStatus::ACCEPTED, ""))
    }

    /// The steps of one seed.
    fn track(&self, request: &HttpRequest) -> std::result::Result<HttpAnswer, Refusal> {
        let (save, seed) = (number(request, "save")?, number(request, "seed")?);
        let Some(run) = self.board.saved(save) else { return Err(NOT_SHOWN) };
        let Some(seed) = run.seeds.iter().find(|one| one.seed == seed) else { return Err(NOT_SHOWN) };
        self.played(|| Document::tracks_of(&run.plan, &seed.data()))
    }

    /// One moment in pictures.
    fn frame(&self, request: &HttpRequest) -> std::result::Result<HttpAnswer, Refusal> {
        let (save, seed, step) = (number(request, "save")?, number(request, "seed")?, number(request, "step")?);
        let step = usize::try_from(step).map_err(|_| NOT_SHOWN)?;
        let Some(run) = self.board.saved(save) else { return Err(NOT_SHOWN) };
        self.played(|| shot(&run, seed, request.asked("phase")?, step))
    }

    /// Answers with what a job finds, one job at a time.
    fn played<T: serde::Serialize>(
        &self,
        job: impl FnOnce() -> Option<Result<T>>,
    ) -> std::result::Result<HttpAnswer, Refusal> {
        let turn = self.player.lock().unwrap_or_else(PoisonError::into_inner);
        let found = job();
        drop(turn);
        match found.ok_or(NOT_SHOWN)?.map(|found| serde_json::to_vec(&found)) {
            Ok(Ok(json)) => Ok(HttpAnswer::new(HttpStatus::OK, "application/json", json)),
            Ok(Err(_)) => Err(Refusal(HttpStatus::INTERNAL_SERVER_ERROR, "this moment cannot be written as JSON")),
            Err(error) => Ok(HttpAnswer::text(HttpStatus::INTERNAL_SERVER_ERROR, &error.to_string())),
        }
    }
}

const NOT_SHOWN: Refusal = Refusal(HttpStatus::NOT_FOUND, "this is not shown any more");

fn number(request: &HttpRequest, name: &str) -> std::result::Result<u64, Refusal> {
    let wrong = Refusal(HttpStatus::BAD_REQUEST, "a number is missing in the address");
    request.asked(name).and_then(|text| text.parse().ok()).ok_or(wrong)
}

fn shot(run: &SavedRun, seed: u64, phase: &str, step: usize) -> Option<Result<Shot>> {
    let watched = run.seeds.iter().find(|one| one.seed == seed)?;
    let phase = match phase {
        "learning" => Phase::Learning,
        "test" => Phase::Test,
        _ => return None,
    };
    shot_of(&run.plan, seed, [&watched.learning, &watched.tested], phase, step).transpose()
}
