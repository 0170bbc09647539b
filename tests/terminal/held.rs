use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use crate::support::{Bench, SCRIPT};

/// How long a change may take to be seen before the test fails.
const PATIENCE: Duration = Duration::from_secs(120);
const SIZE: (usize, usize) = (100, 30);

/// A terminal that knows what a screen of characters needs: places, clearing, text.
struct Terminal {
    cells: Vec<Vec<char>>,
    at: (usize, usize),
    bytes: Vec<u8>,
    /// Bytes that are no whole character yet, or no whole command.
    rest: Vec<u8>,
}

impl Terminal {
    fn new() -> Self {
        Self { cells: vec![vec![' '; SIZE.0]; SIZE.1], at: (0, 0), bytes: Vec::new(), rest: Vec::new() }
    }

    fn feed(&mut self, bytes: &[u8]) {
        self.bytes.extend(bytes);
        self.rest.extend(bytes);
        let rest = std::mem::take(&mut self.rest);
        let whole = match std::str::from_utf8(&rest) {
            Ok(text) => text.len(),
            Err(error) => error.valid_up_to(),
        };
        let text = std::str::from_utf8(&rest[..whole]).unwrap();
        let mut left = text;
        while let Some(c) = left.chars().next() {
            if let Some(after) = left.strip_prefix("\u{1b}[") {
                let Some(end) = after.find(|c: char| c.is_ascii_alphabetic()) else { break };
                self.command(&after[..end], after.as_bytes()[end]);
                left = &after[end + 1..];
                continue;
            }
            if c == '\u{1b}' {
                if left.len() < 2 {
                    break;
                }
                left = &left[1..];
            } else if !c.is_control() {
                self.put(c);
            }
            left = &left[c.len_utf8().min(left.len())..];
        }
        self.rest = [left.as_bytes(), &rest[whole..]].concat();
    }

    fn put(&mut self, c: char) {
        let (x, y) = self.at;
        if let Some(cell) = self.cells.get_mut(y).and_then(|row| row.get_mut(x)) {
            *cell = c;
        }
        self.at.0 += 1;
    }

    fn command(&mut self, numbers: &str, command: u8) {
        let number = |index| numbers.split(';').nth(index).and_then(|text| text.parse::<usize>().ok()).unwrap_or(1);
        match command {
            b'H' => self.at = (number(1) - 1, number(0) - 1),
            // The other screen begins empty.
            b'h' if numbers == "?1049" => self.cells = vec![vec![' '; SIZE.0]; SIZE.1],
            b'J' => self.cells = vec![vec![' '; SIZE.0]; SIZE.1],
            _ => {}
        }
    }

    fn text(&self) -> String {
        self.cells.iter().map(|row| row.iter().collect::<String>() + "\n").collect()
    }
}

/// The program in a terminal of its own; nothing where there is no `script` of util-linux to make one.
struct Held {
    child: Child,
    output: Receiver<Vec<u8>>,
    terminal: Terminal,
}

impl Drop for Held {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

impl Held {
    fn new(bench: &Bench, shell: &str) -> Option<Self> {
        let version = Command::new("script").arg("--version").output();
        if !version.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("util-linux")) {
            println!("skipped: no program 'script' of util-linux makes a pseudo terminal here");
            return None;
        }
        let engine = env!("CARGO_BIN_EXE_engine");
        let command =
            format!("stty rows {} cols {}; {}", SIZE.1, SIZE.0, shell.replace("ENGINE", &format!("'{engine}'")));
        let mut child = Command::new("script")
            .args(["-qfec", &command, "/dev/null"])
            .current_dir(bench.path())
            .envs([("TERM", "xterm-256color"), ("SHELL", "/bin/sh")])
            .env("ENGINE_CONFIG_DIR", bench.path().join(".config"))
            .env("ENGINE_DATA_DIR", bench.path().join(".data"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdout = child.stdout.take().unwrap();
        let (sender, output) = channel();
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = stdout.read(&mut bytes) {
                if sender.send(bytes[..count].to_vec()).is_err() {
                    return;
                }
            }
        });
        Some(Self { child, output, terminal: Terminal::new() })
    }

    fn until(&mut self, what: &str, seen: impl Fn(&str) -> bool) {
        loop {
            let text = self.terminal.text();
            if seen(&text) {
                return;
            }
            match self.output.recv_timeout(PATIENCE) {
                Ok(bytes) => self.terminal.feed(&bytes),
                Err(error) => panic!("{what}: {error}\n{text}\n{}", String::from_utf8_lossy(&self.terminal.bytes)),
            }
        }
    }

    /// Until all of these words are on the screen.
    fn until_all(&mut self, words: &str) {
        self.until(words, |text| words.split(',').all(|word| text.contains(word)));
    }

    fn type_(&mut self, keys: &str) {
        self.child.stdin.as_mut().unwrap().write_all(keys.as_bytes()).unwrap();
    }

    /// Exit status, and all that was ever written to the terminal.
    fn end(mut self) -> (Option<i32>, String) {
        while let Ok(bytes) = self.output.recv_timeout(PATIENCE) {
            self.terminal.feed(&bytes);
        }
        (self.child.wait().unwrap().code(), String::from_utf8_lossy(&self.terminal.bytes).into_owned())
    }
}

const WATCH: &str = "ENGINE watch short.rhai --seeds 2 --steps 800 --tui --no-open --port 0";

#[track_caller]
fn given_back(written: &str) {
    let (taken, back) = (written.rfind("\u{1b}[?1049h").unwrap(), written.rfind("\u{1b}[?1049l").unwrap());
    assert!(taken < back && back < written.rfind("\u{1b}[?25h").unwrap(), "the screen or the cursor is not given back");
}

#[test]
fn saves_are_seen_in_a_real_terminal_which_is_given_back() {
    let bench = Bench::new();
    let shell = format!("stty -g; {WATCH}; status=$?; stty -g; exit $status");
    let Some(mut held) = Held::new(&bench, &shell) else { return };
    held.until_all(
        "save 1,tested,Learning curve,median ,World,too close,step 799 of 800,http://127.0.0.1:,? help,q quit",
    );
    // Steps are played again for their facts.
    held.type_("\t\t\t\t");
    held.until("the step alone", |text| text.contains("laser.nearest = ") && !text.contains("Learning curve"));
    held.type_("\t\t");
    held.until_all("Learning curve");
    held.type_("t");
    held.until_all("test, step 399 of 400");
    bench.write("short.rhai", SCRIPT.replace("<= 0.25", "<= 0.4"));
    held.until_all("save 2,tested,before");
    bench.write("short.rhai", SCRIPT.replace("laser.nearest", "laser.nearst"));
    held.until_all(
        "did you mean 'nearest'?,^^^^^^,short.rhai:3:,E-SCRIPT-FACT,the last good run stays on screen,Learning curve",
    );
    bench.write("short.rhai", SCRIPT);
    held.until("the mended save", |text| text.contains("save 4") && !text.contains("cannot be learned"));
    held.type_("r");
    held.until_all("save 5");
    held.type_("q");
    let (status, written) = held.end();
    assert_eq!(status, Some(0), "{written}");
    given_back(&written);
    // The settings of the terminal, before and after.
    let settings: Vec<&str> = written.lines().map(str::trim).filter(|line| line.matches(':').count() > 20).collect();
    let clean = |line: &str| line.rsplit(['\u{1b}', 'h', 'l', ' ']).next().unwrap_or_default().to_owned();
    assert_eq!(settings.len(), 2, "{settings:?}");
    assert_eq!(clean(settings[0]), clean(settings[1]));
}

#[test]
fn who_is_ended_from_outside_gives_the_terminal_back_too() {
    let bench = Bench::new();
    let Some(mut held) = Held::new(&bench, &format!("echo $$ > pid; exec {WATCH}")) else { return };
    held.until_all("save 1");
    assert!(Command::new("kill").args(["-TERM", bench.read("pid").trim()]).status().unwrap().success());
    let (status, written) = held.end();
    assert_eq!(status, Some(0), "{written}");
    given_back(&written);
}

#[test]
fn whose_terminal_is_closed_ends_too() {
    let bench = Bench::new();
    let Some(mut held) = Held::new(&bench, &format!("exec {WATCH}")) else { return };
    held.until_all("save 1,http://127.0.0.1:");
    let text = held.terminal.text();
    let port: String = text.split("127.0.0.1:").nth(1).unwrap().chars().take_while(char::is_ascii_digit).collect();
    let address = format!("127.0.0.1:{port}");
    assert!(std::net::TcpStream::connect(&address).is_ok());
    // The terminal goes with the program that made it; nobody says good bye.
    held.child.kill().unwrap();
    let ends = || {
        (0..1200).any(|_| {
            std::thread::sleep(Duration::from_millis(100));
            std::net::TcpStream::connect(&address).is_err()
        })
    };
    assert!(ends(), "the program goes on without its terminal");
}

#[test]
fn what_is_no_terminal_is_refused() {
    let bench = Bench::new();
    insta::assert_snapshot!(bench.failure(&["watch", "short.rhai", "--tui"]));
}
