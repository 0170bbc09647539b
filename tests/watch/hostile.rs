use std::io::{Read, Write};
use std::net::TcpListener;

use super::served::{Served, message, status};

#[test]
fn another_name_in_the_host_is_refused() {
    let served = Served::new(&[]);
    let Served { port, token, .. } = &served;
    let ask = |hosts: &str| status(&served.answer(format!("GET /?token={token} HTTP/1.1\r\n{hosts}\r\n").as_bytes()));
    assert_eq!(ask(&format!("Host: 127.0.0.1:{port}\r\n")), 200);
    assert_eq!(ask(&format!("Host: localhost:{port}\r\n")), 200);
    assert_eq!(ask("Host: evil.com\r\n"), 403);
    assert_eq!(ask(&format!("Host: evil.com:{port}\r\n")), 403);
    assert_eq!(ask("Host: 127.0.0.1\r\n"), 403);
    assert_eq!(ask(""), 400);
    assert_eq!(ask(&format!("Host: 127.0.0.1:{port}\r\nHost: evil.com\r\n")), 400);
    assert_eq!(ask(&format!("Host: 127.0.0.1:{port}\r\nHost: 127.0.0.1:{port}\r\n")), 400);
    let absolute = format!("GET http://evil.com/?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    assert_eq!(status(&served.answer(absolute.as_bytes())), 403);
}

#[test]
fn another_page_reads_nothing() {
    let served = Served::new(&[]);
    let port = served.port;
    for path in ["/", "/live", "/track", "/frame"] {
        for origin in ["https://evil.com", "null", "http://127.0.0.1", "http://evil.com:80"] {
            assert_eq!(served.status("GET", path, &format!("Origin: {origin}\r\n")), 403, "{origin}");
        }
        let two = format!("Origin: http://127.0.0.1:{port}\r\nOrigin: null\r\n");
        assert_eq!(served.status("GET", path, &two), 403);
        // What is only embedded, as a picture or a script, comes without an Origin.
        for site in ["cross-site", "same-site"] {
            assert_eq!(served.status("GET", path, &format!("Sec-Fetch-Site: {site}\r\n")), 403, "{site}");
        }
    }
    for own in [format!("Origin: http://127.0.0.1:{port}\r\n"), "Sec-Fetch-Site: same-origin\r\n".to_owned()] {
        assert_eq!(served.status("GET", "/", &own), 200);
    }
    assert_eq!(served.status("GET", "/", "Sec-Fetch-Site: none\r\n"), 200, "an address that was typed");
    drop(served.events());
}

#[test]
fn without_the_token_of_this_run_nothing_is_told() {
    let (served, other) = (Served::new(&[]), Served::new(&[]));
    let port = served.port;
    let ask = |query: &str| {
        status(&served.answer(format!("GET /{query} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").as_bytes()))
    };
    assert_eq!(ask(""), 401);
    assert_eq!(ask("?token="), 401);
    assert_eq!(ask(&format!("?token={}", other.token)), 401);
    assert_eq!(ask(&format!("?token={}x", served.token)), 401);
    assert_eq!(ask(&format!("?token={}", &served.token[..31])), 401);
    assert_eq!(ask(&format!("?token={}", served.token)), 200);
    let live = format!("GET /live?token={} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n", other.token);
    assert_eq!(status(&served.answer(live.as_bytes())), 401);
}

#[test]
fn nothing_changes_by_get_or_from_another_page() {
    let served = Served::new(&[]);
    assert_eq!(served.status("GET", "/relearn", ""), 405);
    for kind in ["application/x-www-form-urlencoded", "text/plain", "application/json"] {
        let headers = format!("Origin: https://evil.com\r\nContent-Type: {kind}\r\nContent-Length: 0\r\n");
        assert_eq!(served.status("POST", "/relearn", &headers), 403);
    }
    assert_eq!(served.status("POST", "/relearn", "Content-Length: 0\r\n"), 403);
    let own = format!("Origin: http://127.0.0.1:{}\r\nContent-Length: 0\r\n", served.port);
    assert_eq!(served.status("DELETE", "/", &own), 405);
    assert_eq!(served.status("POST", "/relearn", &own), 202);
}

#[test]
fn no_path_leads_to_a_file() {
    let served = Served::new(&[]);
    for path in ["/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%2f..%2fetc/passwd", "/%00", "/run.toml", "//"] {
        assert_eq!(served.status("GET", path, ""), 404, "{path}");
    }
    assert_eq!(served.status("GET", "/a\0b", ""), 400);
}

#[test]
fn what_is_too_long_is_refused_before_it_is_read() {
    let served = Served::new(&[]);
    let own = format!("Origin: http://127.0.0.1:{}\r\n", served.port);
    assert_eq!(served.status("GET", "/", &format!("X: {}\r\n", "a".repeat(9000))), 431);
    assert_eq!(served.status("POST", "/relearn", &format!("{own}Content-Length: 1073741824\r\n")), 413);
    assert_eq!(served.status("POST", "/relearn", &format!("{own}Transfer-Encoding: chunked\r\n")), 413);
    assert_eq!(served.status("GET", "/", &"X: 1\r\n".repeat(65)), 431);
}

#[test]
fn who_talks_to_the_stream_of_events_is_left() {
    let served = Served::new(&[]);
    let mut events = served.events();
    events.get_mut().write_all(b"GET / HTTP/1.1\r\n").unwrap();
    // It ends, or the read would time out.
    let mut told = String::new();
    let end = events.read_to_string(&mut told);
    assert!(end.is_ok() || end.is_err_and(|error| error.kind() == std::io::ErrorKind::ConnectionReset), "{told}");
}

#[test]
fn who_closes_the_stream_of_events_gives_up_the_place() {
    let served = Served::new(&[]);
    let held: Vec<_> = (0..8).map(|_| served.events()).collect();
    assert_eq!(served.status("GET", "/", ""), 503);
    drop(held);
    let again = std::iter::repeat_with(|| served.status("GET", "/", "")).find(|status| *status != 503);
    assert_eq!(again, Some(200));
}

#[test]
fn a_request_that_never_ends_is_ended() {
    let served = Served::new(&[]);
    let mut stream = served.connect();
    stream.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
    let mut answer = String::new();
    drop(stream.read_to_string(&mut answer));
    assert_eq!(status(&answer), 408);
}

#[test]
fn connections_without_the_token_keep_nobody_out() {
    let served = Served::new(&[]);
    // Idle ones, ones that stop within a request, and ones that come again as soon as they are sent away.
    let mut held: Vec<_> = (0..40).map(|_| served.connect()).collect();
    for stream in held.iter_mut().take(20) {
        drop(stream.write_all(b"GET"));
    }
    let end = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..24 {
            scope.spawn(|| {
                while !end.load(std::sync::atomic::Ordering::Relaxed) {
                    if let Ok(mut stream) = std::net::TcpStream::connect(("127.0.0.1", served.port)) {
                        drop(stream.write_all(b"GET /"));
                        std::thread::sleep(std::time::Duration::from_millis(1));
                    }
                }
            });
        }
        let loads: Vec<u16> = (0..40).map(|_| served.status("GET", "/", "")).collect();
        end.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(loads.iter().all(|status| *status == 200), "{loads:?}");
    });
}

#[test]
fn the_page_may_be_opened_from_elsewhere_but_not_embedded() {
    let served = Served::new(&[]);
    let from = |mode: &str, dest: &str| {
        format!("Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: {mode}\r\nSec-Fetch-Dest: {dest}\r\n")
    };
    assert_eq!(served.status("GET", "/", &from("navigate", "document")), 200);
    for (mode, dest) in [("navigate", "iframe"), ("no-cors", "image"), ("no-cors", "script"), ("cors", "document")] {
        assert_eq!(served.status("GET", "/", &from(mode, dest)), 403, "{mode} {dest}");
    }
    assert_eq!(served.status("GET", "/frame", &from("navigate", "document")), 403);
    assert_eq!(served.status("POST", "/relearn", &from("navigate", "document")), 403);
}

#[test]
fn a_client_that_does_not_read_holds_nothing_up() {
    let served = Served::new(&[]);
    let _stalled: Vec<_> = (0..3).map(|_| served.events()).collect();
    let mut reader = served.events();
    for save in 1..=4 {
        message(&mut reader, |said| said["kind"] == "run" && said["save"] == save && said["done"] == true);
        let script = format!("// {save}\n{}", crate::support::SCRIPT);
        served.bench.write("short.rhai", script);
    }
}

#[test]
fn a_taken_port_leads_to_the_next() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let served = Served::new(&["--port", &port.to_string()]);
    assert!(served.port > port && served.port < port.saturating_add(20));
    assert_eq!(served.status("GET", "/", ""), 200);
}

#[test]
fn only_loopback_is_served() {
    let bench = crate::support::Bench::new();
    let told = bench.failure(&["watch", "short.rhai", "--web-bind", "0.0.0.0"]);
    assert!(told.starts_with("exit status 2"), "{told}");
    let served = Served::new(&[]);
    // Every other address of this computer, as far as there is one, is closed.
    for address in ["[::1]", "127.0.0.2"] {
        assert!(std::net::TcpStream::connect(format!("{address}:{}", served.port)).is_err());
    }
}

#[test]
fn the_page_cannot_be_framed_guessed_or_kept() {
    let served = Served::new(&[]);
    let Served { port, token, .. } = &served;
    let answer = served
        .answer(format!("GET /?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").as_bytes())
        .to_lowercase();
    let head = answer.split("\r\n\r\n").next().unwrap();
    for line in [
        "x-frame-options: deny",
        "frame-ancestors 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
        "default-src 'none'",
        "content-type: text/html; charset=utf-8",
    ] {
        assert!(head.contains(line), "{line} is missing in {head}");
    }
    assert!(!head.contains("access-control") && !answer.contains(token.as_str()));
}
