//! What a run leaves for people: pictures, tables, and files that are never half written.
//!
//! Every picture is laid out once on a list of marks and then written twice: as SVG text and as PNG bytes.

use engine::diagnostic::{Diagnostic, Result};

mod atomic;
mod axes;
mod canvas;
mod certainty;
mod csv;
mod curve;
mod disagreements;
mod frame;
mod glyphs;
mod growth;
mod plan;
mod policy;
mod policy_diff;
mod raster;
mod route;
mod sheet;
mod trajectory;
mod vector;

pub use atomic::write_atomic;
pub use certainty::certainty_grid;
pub use csv::{CurveRow, curve_csv};
pub use curve::{CurveData, learning_curve};
pub use disagreements::disagreements_csv;
pub use frame::{FrameData, FramePanel, frame, snapshot_frame};
pub use growth::{GrowthGroup, growth};
pub(crate) use plan::holds;
pub use policy::{PolicyData, PolicyState, policy};
pub use policy_diff::{PolicyDiffData, StateChange, policy_diff};
pub use trajectory::{TrajectoryData, trajectories};
pub(crate) use vector::base64;

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
    pub fn write(&self, folder: &std::path::Path, stem: &str) -> Result<()> {
        write_atomic(&folder.join(format!("{stem}.svg")), self.svg.as_bytes())?;
        write_atomic(&folder.join(format!("{stem}.png")), &self.png)
    }
}

/// A picture that could not be made, and why.
fn failed(reason: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-PICTURE", format!("cannot draw the picture: {reason}")))
}

#[cfg(test)]
mod tests;
