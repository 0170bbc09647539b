//! The folder of a test: its figures and its pictures.

use std::path::{Path, PathBuf};

use super::files::{create_folder, write_json};
use super::pictures::{draw_frame, draw_trails};
use crate::report::certainty_grid;
use engine::diagnostic::Result;
use engine::experiment::{CertaintyGrid, Plan, TestRun};

/// A folder for a test.
pub struct TestFolder {
    path: PathBuf,
}

impl TestFolder {
    /// Creates the folder.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn create(path: &Path) -> Result<Self> {
        create_folder(path)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Writes the figures and the pictures; the map is missing for a laser that looks down.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, plan: &Plan, tested: &TestRun, map: Option<&CertaintyGrid>) -> Result<()> {
        write_json(&self.path.join("test.json"), &tested.figures)?;
        let title = format!("{} in {}: test of the frozen policy", plan.behaviour.name(), plan.layout.name);
        draw_trails(&self.path, plan, &title, &[("first 800 steps", &tested.trail)])?;
        if let Some(map) = map {
            let title = format!("{} in {}: what the laser found", plan.behaviour.name(), plan.layout.name);
            let (columns, cell_m, origin_m) = (map.columns(), map.cell_m(), map.origin_m());
            certainty_grid(&title, &map.greys(), columns, cell_m, origin_m, &tested.trail)?
                .write(&self.path, "certainty-grid")?;
        }
        draw_frame(&self.path, plan, tested)
    }
}
