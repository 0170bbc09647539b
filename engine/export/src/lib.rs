//! A learned policy as source code for other programs: C99 and Python with numpy, with a kit that checks both.
//!
//! [`Model`] is what a port has to do, as numbers; `c_source` and `numpy_source` write it down; `conformance` plays the run's own
//! test again and keeps what the engine saw and chose. Nothing here drives a robot.

mod c_source;
mod conformance;
mod folder;
mod model;
mod names;
mod numpy_source;
mod readme;
mod stage;
mod text;

use engine::diagnostic::Result;
use engine::experiment::{Ledger, Plan};
use engine::learner::Policy;

pub use model::{Model, no_table};

/// The files of a port, by name, and how many frames its kit has.
#[derive(Debug, Clone)]
pub struct Port {
    /// Name and content of each file.
    pub files: Vec<(&'static str, Vec<u8>)>,
    /// Frames in `conformance.bin`.
    pub frames: usize,
}

/// Writes a learned policy down. `run` is the text of the `run.toml` that it belongs to, `test` the recorded steps of its test.
///
/// # Errors
/// `E-EXPORT` for what no port can do, and if the test cannot be played again.
pub fn port(plan: &Plan, policy: &Policy, seed: u64, test: &Ledger, run: &str) -> Result<Port> {
    let model = Model::new(plan, policy)?;
    let (kit, frames) = conformance::conformance(&model, plan, seed, test)?;
    let sources = c_source::c_sources(&model).into_iter().chain(numpy_source::numpy_sources(&model));
    let mut files: Vec<_> = sources.map(|(name, text)| (name, text.into_bytes())).collect();
    files.push(("README.md", readme::readme(&model, plan, policy, frames, run).into_bytes()));
    files.push(("conformance.bin", kit));
    Ok(Port { files, frames })
}
