//! A filter at work, whatever its form: the contract of filters with the engine's own errors.

use crate::diagnostic::{Diagnostic, Result, printable};
use filter_api::{Filter, FilterError, Frame, FrameMut, Mount, Moved};

/// A filter that was created with its parameters.
pub trait Running: Send {
    /// Fills `output` from `input`.
    ///
    /// # Errors
    /// If the filter refuses the frame, breaks down, or is stopped by a limit.
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<()>;

    /// Tells it how the camera is mounted: once, before the first frame.
    ///
    /// # Errors
    /// If it cannot work with this camera, breaks down, or is stopped by a limit.
    fn mount(&mut self, mount: &Mount) -> Result<()> {
        let _ = mount;
        Ok(())
    }

    /// Tells it how the robot moved since the last frame.
    ///
    /// # Errors
    /// If it breaks down, or is stopped by a limit.
    fn moved(&mut self, moved: &Moved) -> Result<()> {
        let _ = moved;
        Ok(())
    }

    /// How many bytes it keeps from frame to frame.
    fn keeps(&self) -> usize {
        0
    }

    /// Writes all that it keeps into so many bytes.
    ///
    /// # Errors
    /// As [`Running::moved`].
    fn save(&mut self, kept: &mut [u8]) -> Result<()> {
        let _ = kept;
        Ok(())
    }

    /// What it keeps, in words; nothing of a filter that comes from a file.
    fn words(&self) -> String {
        String::new()
    }

    /// Lets it go on from what another one kept.
    ///
    /// # Errors
    /// If these bytes are not what such a filter saves; else as [`Running::moved`].
    fn load(&mut self, kept: &[u8]) -> Result<()> {
        let _ = kept;
        Ok(())
    }
}

/// A filter of this program.
pub(super) struct Linked {
    pub(super) name: &'static str,
    pub(super) filter: Box<dyn Filter>,
}

impl Linked {
    fn told(&self, done: std::result::Result<(), FilterError>) -> Result<()> {
        done.map_err(|FilterError(words)| failed("E-FILTER", self.name, &words))
    }
}

impl Running for Linked {
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<()> {
        let done = self.filter.process(input, output);
        self.told(done)
    }

    fn mount(&mut self, mount: &Mount) -> Result<()> {
        let done = self.filter.mount(mount);
        self.told(done)
    }

    fn moved(&mut self, moved: &Moved) -> Result<()> {
        self.filter.moved(moved);
        Ok(())
    }

    fn keeps(&self) -> usize {
        self.filter.keeps()
    }

    fn save(&mut self, kept: &mut [u8]) -> Result<()> {
        self.filter.save(kept);
        Ok(())
    }

    fn words(&self) -> String {
        self.filter.words()
    }

    fn load(&mut self, kept: &[u8]) -> Result<()> {
        let done = self.filter.load(kept);
        self.told(done)
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

/// What is given to a filter is not what it keeps.
#[cfg(any(feature = "native-filters", feature = "wasm"))]
pub(super) fn wrong_length(name: &str, keeps: usize, found: usize) -> Box<Diagnostic> {
    failed("E-FILTER", name, &format!("it keeps {keeps} bytes, and is given {found}"))
}
