//! The folder of a test: its figures and its pictures.

use std::path::{Path, PathBuf};

use super::files::{create_folder, write_json};
use super::pictures::{draw_frame, draw_trails, draw_worlds};
use crate::report::certainty_grid;
use crate::store::RUN_FILE;
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{CertaintyGrid, Plan, TestRun};

const TEST_FILE: &str = "test.json";

/// A folder for a test.
pub struct TestFolder {
    path: PathBuf,
}

impl TestFolder {
    /// Creates the folder.
    ///
    /// # Errors
    /// If it cannot be made; `E-RUN-TAKEN` if it holds a run, whose pictures would be replaced, or without `force` a test.
    pub fn create(path: &Path, force: bool) -> Result<Self> {
        let shown = printable(&path.display().to_string());
        let taken = |message: String| Diagnostic::new("E-RUN-TAKEN", message);
        if path.join(RUN_FILE).exists() {
            let error = taken(format!("'{shown}' holds a run, whose pictures the test would replace"));
            return error.help("name another folder with --out").fail();
        }
        if !force && path.join(TEST_FILE).exists() {
            let error = taken(format!("'{shown}' holds another test"));
            return error.help("name another folder with --out, or replace that test with --force").fail();
        }
        create_folder(path)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Writes the figures and the pictures; the map is missing for a laser that looks down.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, plan: &Plan, tested: &TestRun, map: Option<&CertaintyGrid>) -> Result<()> {
        write_json(&self.path.join(TEST_FILE), &tested.figures)?;
        let title = format!("{} in {}: test of the frozen policy", plan.behaviour.name(), plan.worlds.title());
        if plan.worlds.further().is_empty() {
            draw_trails(&self.path, plan, &title, &[("first 800 steps", &tested.trail)])?;
        } else {
            draw_worlds(&self.path, plan, &format!("{title}: the first 800 steps in each world"), &tested.trail)?;
        }
        if let Some(map) = map {
            let title = format!("{} in {}: what the laser found", plan.behaviour.name(), plan.worlds.title());
            let (columns, cell_m, origin_m) = (map.columns(), map.cell_m(), map.origin_m());
            certainty_grid(&title, &map.greys(), columns, cell_m, origin_m, &tested.trail)?
                .write(&self.path, "certainty-grid")?;
        }
        draw_frame(&self.path, plan, tested)
    }
}
