//! A filter at work, whatever its form: the contract of filters with the engine's own errors.

use crate::diagnostic::{Diagnostic, Result, printable};
use filter_api::{Filter, FilterError, Frame, FrameMut};

/// A filter that was created with its parameters.
pub trait Running: Send {
    /// Fills `output` from `input`.
    ///
    /// # Errors
    /// If the filter refuses the frame, breaks down, or is stopped by a limit.
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<()>;
}

/// A filter of this program.
pub(super) struct Linked {
    pub(super) name: &'static str,
    pub(super) filter: Box<dyn Filter>,
}

impl Running for Linked {
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<()> {
        self.filter.process(input, output).map_err(|FilterError(words)| failed("E-FILTER", self.name, &words))
    }
}

/// Why a running filter gave no frame.
pub(super) fn failed(code: &'static str, name: &str, words: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new(code, format!("filter '{name}' failed: {}", printable(words))))
}

/// Why a filter could not be created: a mistake in its parameters, so far as anyone can tell.
pub(super) fn refused(words: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-FILTER-SETTING", printable(words)))
}
