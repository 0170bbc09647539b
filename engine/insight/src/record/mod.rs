//! Recordings for the viewers that people have: a run as an MCAP file in Foxglove's schemas, which Rerun reads too.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/tf` | foxglove.FrameTransform | the robot in the world, its laser and its camera on it |
//! | `/world` | foxglove.SceneUpdate | walls and obstacles, once for each phase |
//! | `/scan` | foxglove.LaserScan | ranges of all beams, metres, in the laser's own frame |
//! | `/camera`, `/mask` | foxglove.CompressedImage | the camera's image and what the filters made of it, PNG, in the camera's own frame |
//! | `/calibration` | foxglove.CameraCalibration | the camera's lens, beside each image |
//! | `/prey` | foxglove.PoseInFrame | the prey, where there is one |
//! | `/step` | JSON | state, action, reward by rule, recovery |
//!
//! Time is the robot's: step times period, the test after learning. Everything is recovered by playing the ledger back.

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Ledger, Phase, Plan};

#[cfg(feature = "mcap")]
mod camera;
mod recording;
#[cfg(feature = "mcap")]
mod scene;
#[cfg(feature = "mcap")]
mod writer;

pub use recording::Recording;

/// Writes the phases of one seed, one after the other, with an image every `image_every` steps.
///
/// # Errors
/// If the file cannot be written, or a phase cannot be played.
#[cfg(feature = "mcap")]
pub fn record(plan: &Plan, seed: u64, phases: &[(Phase, &Ledger)], image_every: u64, path: &Path) -> Result<Recording> {
    writer::record(plan, seed, phases, image_every, path)
}

/// Checks that recording can begin: that this program can record, and that the folder is there.
///
/// # Errors
/// If it cannot; the help says what to do.
pub fn check_recording(path: &Path) -> Result<()> {
    if cfg!(not(feature = "mcap")) {
        let error = Diagnostic::new("E-RECORD-BUILD", "this engine was built without recording");
        return error.help("build it with: cargo build --release --features mcap").fail();
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.is_dir() {
        return Ok(());
    }
    let missing = std::io::Error::from(std::io::ErrorKind::NotFound);
    Err(Box::new(Diagnostic::disk("record into the folder", folder, &missing)))
}

/// Writes nothing: this program was built without recording.
///
/// # Errors
/// Always; the help says how to build the program with recording.
#[cfg(not(feature = "mcap"))]
pub fn record(_: &Plan, _: u64, _: &[(Phase, &Ledger)], _: u64, path: &Path) -> Result<Recording> {
    check_recording(path)?;
    Ok(Recording { steps: 0, images: 0, bytes: 0 })
}
