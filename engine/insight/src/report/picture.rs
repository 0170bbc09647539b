//! A finished picture, and the error of one that could not be made.

use std::path::Path;

use crate::disk::write_atomic;
use engine::diagnostic::{Diagnostic, Result};

/// One picture in two forms.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// A whole SVG document.
    pub svg: String,
    /// A whole PNG file of the same picture.
    pub png: Vec<u8>,
}

impl Picture {
    /// Writes `stem.svg` and `stem.png` into an existing folder; a reader never sees half a file.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path, stem: &str) -> Result<()> {
        write_atomic(&folder.join(format!("{stem}.svg")), self.svg.as_bytes())?;
        write_atomic(&folder.join(format!("{stem}.png")), &self.png)
    }
}

/// A picture that could not be made, and why.
pub(super) fn failed(reason: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-PICTURE", format!("cannot draw the picture: {reason}")))
}
