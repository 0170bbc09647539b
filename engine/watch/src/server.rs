//! The server: one thread, loopback only, few connections, one request for each.

use std::io::Cursor;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Query, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Router};
use hyper_util::rt::TokioIo;
use hyper_util::service::TowerToHyperService;
use serde::Deserialize;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

use super::board::{Board, SavedRun};
use super::guard::{Guard, Refusal, read_head};
use super::relearn::Asker;
use super::shared::{Permit, ServerState};
use super::socket;
use engine::diagnostic::{Diagnostic, Result};
use engine::digest::hex;
use engine::experiment::Phase;
use insight::page::{Document, Shot, page, shot_of};

/// The most connections at a time.
const MOST_CONNECTIONS: usize = 8;
/// Ports that are tried, from the first on.
const PORTS: u16 = 20;
/// How long an answer may take to be read.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(30);
/// Who was refused has to wait: a flood of requests cannot take the processor from learning.
const REFUSED_WAIT: Duration = Duration::from_millis(100);
/// The answer to whoever comes while all places are taken.
const TURNED_AWAY_WAIT: Duration = Duration::from_millis(5);

/// Where the page is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address {
    /// The port.
    pub port: u16,
    /// The whole address, with the token.
    pub url: String,
}

/// Begins to serve the page on a thread of its own, until the program ends.
///
/// # Errors
/// If no port from `port` on is free, or the system gives no randomness for the token.
pub fn listen(board: Arc<Board>, asker: Asker, port: u16) -> Result<Address> {
    let limit = |code, message: String| Box::new(Diagnostic::new(code, message));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().max_blocking_threads(2).build();
    let runtime = runtime.map_err(|error| limit("E-WATCH-SERVER", format!("cannot start the server: {error}")))?;
    let mut ports = port..=port.saturating_add(PORTS - 1);
    let listener = ports.find_map(|port| runtime.block_on(TcpListener::bind((Ipv4Addr::LOCALHOST, port))).ok());
    let bound = listener.and_then(|listener| Some((listener.local_addr().ok()?.port(), listener)));
    let Some((port, listener)) = bound else {
        let message = format!("ports {port} to {} are all taken", port.saturating_add(PORTS - 1));
        return Err(Box::new(limit("E-WATCH-PORT", message).help("name another one: --port 9000")));
    };
    let mut random = [0; 16];
    getrandom::fill(&mut random).map_err(|error| limit("E-WATCH-SERVER", format!("cannot make a token: {error}")))?;
    let token = hex(&random);
    let url = format!("http://127.0.0.1:{port}/?token={token}");
    let guard = Arc::new(Guard::new(token, port));
    let shared = ServerState { board, asker, guard, page: Arc::new(page(None)?), player: Arc::new(Semaphore::new(1)) };
    std::thread::spawn(move || runtime.block_on(accept(listener, router(shared))));
    Ok(Address { port, url })
}

fn router(shared: ServerState) -> Router {
    Router::new()
        .route("/", get(index))
        .route("/live", get(socket::live))
        .route("/frame", get(frame))
        .route("/track", get(track))
        .route("/relearn", post(relearn))
        .layer(from_fn_with_state(shared.clone(), guarded))
        .with_state(shared)
}

async fn accept(listener: TcpListener, router: Router) {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(REFUSED_WAIT).await;
            continue;
        };
        match Arc::clone(&places).try_acquire_owned() {
            Ok(permit) => drop(tokio::spawn(connection(stream, router.clone(), Arc::new(permit)))),
            Err(_) => {
                // What the kernel takes at once is enough; nobody waits for this client.
                let answer = raw((StatusCode::SERVICE_UNAVAILABLE, "too many connections"));
                let _ = stream.try_write(answer.as_bytes());
                tokio::time::sleep(TURNED_AWAY_WAIT).await;
            }
        }
    }
}

async fn connection(mut stream: TcpStream, router: Router, permit: Permit) {
    let _ = stream.set_nodelay(true);
    let head = match read_head(&mut stream).await {
        Ok(head) => head,
        Err(refusal) => {
            tokio::time::sleep(REFUSED_WAIT).await;
            let _ = tokio::time::timeout(ANSWER_TIMEOUT, stream.write_all(raw(refusal).as_bytes())).await;
            let _ = stream.shutdown().await;
            // The rest of what the client sent is read, or the system would throw our answer away with it.
            let mut rest = [0; 4096];
            let drain = async { while stream.read(&mut rest).await.is_ok_and(|count| count > 0) {} };
            let _ = tokio::time::timeout(REFUSED_WAIT, drain).await;
            return;
        }
    };
    let (read, write) = stream.into_split();
    let stream = TokioIo::new(tokio::io::join(Cursor::new(head).chain(read), write));
    let service = TowerToHyperService::new(router.layer(Extension(permit)));
    let mut http = hyper::server::conn::http1::Builder::new();
    // One request for each connection, so that each is checked from its first byte.
    let served = http.keep_alive(false).serve_connection(stream, service).with_upgrades();
    let _ = tokio::time::timeout(ANSWER_TIMEOUT, served).await;
}

/// A refusal before there is a request to answer.
fn raw((status, why): Refusal) -> String {
    format!(
        "HTTP/1.1 {status}\r\ncontent-type: text/plain; charset=utf-8\r\ncontent-length: {}\r\nconnection: close\r\n\r\n{why}\n",
        why.len() + 1
    )
}

async fn guarded(State(shared): State<ServerState>, request: Request, next: Next) -> Response {
    let mut response = match shared.guard.check(request.method(), request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => {
            tokio::time::sleep(REFUSED_WAIT).await;
            refusal.into_response()
        }
    };
    let policy = format!("{}; frame-ancestors 'none'", shared.page.policy);
    let headers = response.headers_mut();
    for (name, value) in [
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (header::HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if let Ok(policy) = HeaderValue::from_str(&policy) {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

async fn index(State(shared): State<ServerState>) -> Response {
    ([(header::CONTENT_TYPE, "text/html; charset=utf-8")], shared.page.html.clone()).into_response()
}

async fn relearn(State(shared): State<ServerState>) -> StatusCode {
    shared.asker.again();
    StatusCode::ACCEPTED
}

#[derive(Deserialize)]
struct TrackQuestion {
    save: u64,
    seed: u64,
}

#[derive(Deserialize)]
struct FrameQuestion {
    save: u64,
    seed: u64,
    phase: String,
    step: usize,
}

async fn track(
    State(shared): State<ServerState>,
    Query(TrackQuestion { save, seed }): Query<TrackQuestion>,
) -> Response {
    let Some(run) = shared.board.saved(save) else { return StatusCode::NOT_FOUND.into_response() };
    played(&shared, move || {
        Document::tracks_of(&run.plan, &run.seeds.iter().find(|one| one.learned.seed == seed)?.data())
    })
    .await
}

async fn frame(State(shared): State<ServerState>, Query(question): Query<FrameQuestion>) -> Response {
    let Some(run) = shared.board.saved(question.save) else { return StatusCode::NOT_FOUND.into_response() };
    played(&shared, move || shot(&run, &question)).await
}

fn shot(run: &SavedRun, question: &FrameQuestion) -> Option<Result<Shot>> {
    let seed = run.seeds.iter().find(|one| one.learned.seed == question.seed)?;
    let (phase, ledger) = match question.phase.as_str() {
        "learning" => (Phase::Learning, &*seed.learning),
        "test" => (Phase::Test, &seed.tested),
        _ => return None,
    };
    shot_of(&run.plan, question.seed, phase, ledger, question.step).transpose()
}

/// Answers with what a job on another thread found.
async fn played<T: serde::Serialize + Send + 'static>(
    shared: &ServerState,
    job: impl FnOnce() -> Option<Result<T>> + Send + 'static,
) -> Response {
    let Ok(_turn) = shared.player.acquire().await else { return StatusCode::SERVICE_UNAVAILABLE.into_response() };
    let found = tokio::task::spawn_blocking(move || job().map(|found| found.map(|found| serde_json::to_vec(&found))));
    match found.await {
        Ok(Some(Ok(Ok(json)))) => ([(header::CONTENT_TYPE, "application/json")], json).into_response(),
        Ok(None) => StatusCode::NOT_FOUND.into_response(),
        Ok(Some(Err(error))) => (StatusCode::INTERNAL_SERVER_ERROR, error.to_string()).into_response(),
        _ => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
