//! How a step grows with boxes, states, pixels and threads.

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::Plan;
use insight::report::{GrowthGroup, growth};

use super::clock::{stages, step_us};
use super::workload::{with_boxes, with_settings};

const BOXES: [usize; 3] = [50, 500, 5_000];
/// Rows and columns; with column fill they make 64, 625 and 6,561 states.
const GRIDS: [[u64; 2]; 3] = [[3, 3], [4, 4], [8, 4]];
const IMAGES: [[u64; 2]; 4] = [[80, 60], [160, 120], [320, 240], [640, 480]];

/// One workload.
#[derive(serde::Serialize)]
pub(super) struct GrowthRow {
    pub(super) what: &'static str,
    pub(super) amount: String,
    /// Microseconds of a whole step; with several threads, of all their steps together.
    pub(super) step_us: f64,
    /// How many times the first row of its kind.
    pub(super) ratio: f64,
    pub(super) camera_us: Option<f64>,
    pub(super) laser_us: Option<f64>,
}

/// Measures every workload.
///
/// # Errors
/// If the behaviour cannot be run with one of them.
pub(super) fn measure(plan: &Plan) -> Result<Vec<GrowthRow>> {
    let boxes = |count: &usize| Ok((count.to_string(), with_boxes(plan, *count)?));
    let states = |[rows, columns]: &[u64; 2]| {
        let plan = with_settings(plan, &[("grid.rows", *rows), ("grid.columns", *columns)])?;
        Ok((plan.grid()?.states().to_string(), plan))
    };
    let image = |[width, height]: &[u64; 2]| {
        let plan = with_settings(plan, &[("camera.width_px", *width), ("camera.height_px", *height)])?;
        Ok((format!("{width}x{height}"), plan))
    };
    let mut rows = kind("boxes, nearly all out of sight", BOXES.iter().map(boxes).collect::<Result<_>>()?)?;
    rows.extend(kind("states of the grid", GRIDS.iter().map(states).collect::<Result<_>>()?)?);
    rows.extend(kind("pixels of the image", IMAGES.iter().map(image).collect::<Result<_>>()?)?);
    rows.extend(threads(plan)?);
    Ok(rows)
}

/// Draws the rows into a folder, which is made if need be.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn draw_growth(behaviour: &str, rows: &[GrowthRow], folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| Diagnostic::disk("create", folder, &error))?;
    let kinds: Vec<&[GrowthRow]> = rows.chunk_by(|a, b| a.what == b.what).collect();
    let bars: Vec<Vec<(&str, f64)>> =
        kinds.iter().map(|rows| rows.iter().map(|row| (row.amount.as_str(), row.step_us)).collect()).collect();
    let groups: Vec<GrowthGroup<'_>> =
        kinds.iter().zip(&bars).map(|(rows, bars)| GrowthGroup { what: rows[0].what, bars }).collect();
    growth(&format!("A step of '{behaviour}' as its world and its image grow"), &groups)?.write(folder, "growth")
}

fn kind(what: &'static str, plans: Vec<(String, Plan)>) -> Result<Vec<GrowthRow>> {
    let times = step_us(&plans.iter().map(|(_, plan)| (plan, 1)).collect::<Vec<_>>())?;
    let mut rows = Vec::with_capacity(plans.len());
    for ((amount, plan), time) in plans.into_iter().zip(&times) {
        let stages = stages(&plan, plan.settings.run.steps)?;
        let us = |name: &str| stages.iter().find(|stage| stage.name == name).map(|stage| stage.us);
        let (camera_us, laser_us) = (us("camera"), us("laser"));
        rows.push(GrowthRow { what, amount, step_us: *time, ratio: time / times[0], camera_us, laser_us });
    }
    Ok(rows)
}

fn threads(plan: &Plan) -> Result<Vec<GrowthRow>> {
    let counts = if super::cores() == 1 { vec![1] } else { vec![1, 2] };
    let times = step_us(&counts.iter().map(|count| (plan, *count)).collect::<Vec<_>>())?;
    let row = |(count, time): (&usize, &f64)| {
        let step_us = time / *count as f64;
        let (what, amount) = ("threads", count.to_string());
        GrowthRow { what, amount, step_us, ratio: step_us / times[0], camera_us: None, laser_us: None }
    };
    Ok(counts.iter().zip(&times).map(row).collect())
}
