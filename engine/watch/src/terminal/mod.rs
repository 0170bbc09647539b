//! The live page's content in the terminal: the same board, drawn as text by one thread of its own.
//!
//! ```text
//!   board.rs --> view.rs (what is shown, where the reader stands) <-- keys.rs
//!                  |     ^ scans and reasons of the shown step
//!                  v     +--- player.rs (one thread, plays steps again)
//!                screen.rs --> world.rs, curve.rs, rules.rs, step.rs, findings.rs, foot.rs --> tty.rs
//! ```
//!
//! Drawing is a pure function from a [`View`] to a buffer of characters ([`screen::draw_screen`]). Every text of a script or a world goes
//! through [`engine::diagnostic::printable`] before it is drawn. Learning never waits for the terminal.

mod chain;
mod curve;
mod dots;
mod findings;
mod foot;
mod ink;
mod keys;
mod lines;
mod player;
mod rules;
mod screen;
mod step;
mod story;
mod traces;
mod tty;
mod view;
mod words;
mod world;

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossterm::event::{self, Event};

pub use ink::TerminalInk;
pub use keys::Wish;
pub use player::{Moment, Question};
pub use screen::draw_screen;
pub use traces::MeasureTraces;
pub use view::{Panel, View};

use super::board::Board;
use super::relearn::Asker;
use engine::diagnostic::{Diagnostic, Result};
use player::Player;
use tty::Tty;

/// From one drawing to the next while playing.
const FRAME: Duration = Duration::from_millis(40);
/// How often the board is looked at while nothing else happens.
const GLANCE: Duration = Duration::from_millis(60);
/// How long a drawing waits for the laser's scan; it is drawn later if it takes longer.
const SCAN_WAIT: Duration = Duration::from_millis(12);

/// Refuses anything but a terminal, before anything is learned.
///
/// # Errors
/// If standard input or standard output is not a terminal.
pub fn require() -> Result<()> {
    let no_terminal = |name: &str| {
        let message = format!("--tui draws on a terminal, and {name} is none");
        let help = "start it in a terminal without pipes, or leave --tui out: the page is served either way";
        Box::new(Diagnostic::new("E-WATCH-TERMINAL", message).help(help))
    };
    if !std::io::stdin().is_terminal() {
        return Err(no_terminal("standard input"));
    }
    if std::io::stdout().is_terminal() { Ok(()) } else { Err(no_terminal("standard output")) }
}

/// Shows the board until a key ends it or `stop` is set; sets `stop` at its own end.
///
/// # Errors
/// If the terminal cannot be drawn on or read from; it is restored all the same.
pub fn show(board: &Board, asker: &Asker, address: &str, stop: &Arc<AtomicBool>) -> Result<()> {
    end_on_signals(stop);
    let result =
        Tty::open().map_err(|error| failed(&error)).and_then(|mut tty| follow(&mut tty, board, asker, address, stop));
    stop.store(true, Ordering::Relaxed);
    result
}

fn follow(tty: &mut Tty, board: &Board, asker: &Asker, address: &str, stop: &AtomicBool) -> Result<()> {
    let (mut view, player) = (View::new(address, TerminalInk::of_environment()), Player::start());
    let (mut last, mut stale) = (Instant::now(), true);
    while !stop.load(Ordering::Relaxed) {
        if let Some(shown) = board.shown(view.shown.number) {
            view.show(shown);
            stale = true;
        }
        let elapsed_s = last.elapsed().as_secs_f64().min(0.5);
        last = Instant::now();
        stale |= view.advance(elapsed_s);
        if let Some(answer) = player.answered() {
            view.take(answer);
            stale = true;
        }
        if let Some(traces) = player.traced() {
            view.take_traces(traces);
            stale = true;
        }
        if stale {
            if let Some(question) = view.question()
                && let Some(answer) = player.ask(question, SCAN_WAIT)
            {
                view.take(answer);
            }
            tty.draw(|area, buffer| draw_screen(&view, area, buffer)).map_err(|error| failed(&error))?;
            stale = false;
        }
        let wait = if view.is_playing() { FRAME.saturating_sub(last.elapsed()) } else { GLANCE };
        if !wait_for_key(wait) {
            return Err(failed(&std::io::Error::other("it was closed")));
        }
        // All that was typed meanwhile is one drawing.
        let mut more = event::poll(Duration::ZERO).map_err(|error| failed(&error))?;
        while more {
            stale = true;
            if let Event::Key(key) = event::read().map_err(|error| failed(&error))? {
                match view.key(key) {
                    Wish::Quit => return Ok(()),
                    Wish::Again => asker.again(),
                    Wish::Clear => tty.forget(),
                    Wish::Nothing => {}
                }
            }
            more = event::poll(Duration::ZERO).map_err(|error| failed(&error))?;
        }
    }
    Ok(())
}

/// Waits until a key is there or the time is over; false if the terminal is gone. Asked here, since the library that reads
/// the keys never comes back from a terminal that was closed.
#[cfg(unix)]
fn wait_for_key(wait: Duration) -> bool {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let keys = rustix::stdio::stdin();
    let mut keys = [PollFd::new(&keys, PollFlags::IN)];
    let wait = Timespec { tv_sec: wait.as_secs() as i64, tv_nsec: i64::from(wait.subsec_nanos()) };
    match poll(&mut keys, Some(&wait)) {
        Ok(_) => !keys[0].revents().intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL),
        // A signal, such as that of another size.
        Err(error) => error == rustix::io::Errno::INTR,
    }
}

#[cfg(not(unix))]
fn wait_for_key(wait: Duration) -> bool {
    // What is wrong with the terminal is said by whoever reads the key.
    let _ = event::poll(wait);
    true
}

/// Whoever ends the program from outside gets the terminal back too.
#[cfg(unix)]
fn end_on_signals(stop: &Arc<AtomicBool>) {
    use signal_hook::consts::{SIGHUP, SIGTERM};
    for signal in [SIGTERM, SIGHUP] {
        // Without it such a signal ends the program as it always did.
        let _ = signal_hook::flag::register(signal, Arc::clone(stop));
    }
}

#[cfg(not(unix))]
fn end_on_signals(_: &Arc<AtomicBool>) {}

fn failed(error: &std::io::Error) -> Box<Diagnostic> {
    let message = format!("cannot draw on the terminal: {error}");
    Box::new(Diagnostic::new("E-WATCH-SCREEN", message).help("leave --tui out, and open the page in a browser"))
}
