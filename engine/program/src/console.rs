//! What a person or a program reads: results on standard output, everything else on standard error. Here is the border that
//! strangers' text passes: nothing that controls a terminal leaves as it is.

use std::io::{ErrorKind, IsTerminal, Write};
use std::time::Duration;

use engine::diagnostic::{Diagnostic, for_json, for_terminal};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Why a command could not go on.
#[derive(Debug)]
pub(crate) enum ConsoleError {
    /// An error for the user.
    Failed(Box<Diagnostic>),
    /// Nobody reads standard output any more.
    Closed,
}

impl From<Box<Diagnostic>> for ConsoleError {
    fn from(error: Box<Diagnostic>) -> Self {
        Self::Failed(error)
    }
}

impl From<std::io::Error> for ConsoleError {
    fn from(error: std::io::Error) -> Self {
        if error.kind() == ErrorKind::BrokenPipe {
            return Self::Closed;
        }
        let message = format!("cannot write to standard output: {error}");
        Self::Failed(Box::new(Diagnostic::new("E-IO", message).help("make room, or write somewhere else")))
    }
}

/// Standard output and standard error.
pub(crate) struct Console {
    json: bool,
    out: std::io::BufWriter<std::io::Stdout>,
}

impl Console {
    pub(crate) fn new(json: bool) -> Self {
        Self { json, out: std::io::BufWriter::new(std::io::stdout()) }
    }

    /// A line of the result for a person; nothing under `--json`.
    pub(crate) fn line(&mut self, text: &str) -> Result<(), ConsoleError> {
        if !self.json {
            writeln!(self.out, "{}", for_terminal(text))?;
        }
        Ok(())
    }

    /// The whole result for a program; nothing without `--json`.
    pub(crate) fn json(&mut self, value: &impl serde::Serialize) -> Result<(), ConsoleError> {
        if self.json {
            let document = serde_json::to_string_pretty(value).map_err(std::io::Error::from)?;
            writeln!(self.out, "{}", for_json(&document))?;
        }
        Ok(())
    }

    /// Text as it is, with or without `--json`.
    pub(crate) fn raw(&mut self, text: &str) -> Result<(), ConsoleError> {
        self.out.write_all(text.as_bytes())?;
        Ok(())
    }

    /// Writes out what is still in memory.
    pub(crate) fn finish(&mut self) -> Result<(), ConsoleError> {
        Ok(self.out.flush()?)
    }

    /// A note on standard error.
    pub(crate) fn note(&self, text: &str) {
        // Nothing can be told to anyone if standard error is gone.
        let _ = writeln!(std::io::stderr(), "{}", for_terminal(text));
    }

    /// An error on standard error: for a person, or as one JSON object.
    pub(crate) fn error(&mut self, error: &Diagnostic, colour: bool) {
        let _ = self.out.flush();
        let colour = colour && std::env::var_os("NO_COLOR").is_none() && std::env::var("TERM").as_deref() != Ok("dumb");
        let text = if self.json { for_json(&error.to_json().to_string()).into_owned() } else { error.render(colour) };
        self.note(text.trim_end());
    }

    /// A progress bar on a terminal, nothing elsewhere.
    pub(crate) fn bar(&self, steps: u64) -> ProgressBar {
        self.bar_of("learning", steps)
    }

    /// A progress bar of something else than learning.
    pub(crate) fn bar_of(&self, what: &str, steps: u64) -> ProgressBar {
        if !std::io::stderr().is_terminal() {
            return ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        }
        let bar = ProgressBar::new(steps);
        let style = ProgressStyle::with_template(&format!("{what} {{wide_bar}} {{pos}}/{{len}} steps {{msg:30}}"));
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }
}
