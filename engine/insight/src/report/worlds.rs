//! Where the robot drove in each of several worlds: a panel for each, each in its own scale.

use super::axes::BELOW_PX;
use super::canvas::units;
use super::picture::Picture;
use super::plan::WorldPlan;
use super::route;
use super::sheet::{BELOW_TITLE_PX, LABEL_PX, MARGIN_PX, Sheet, TEXT, centred, fitted, spot, words};
use super::trajectory::{FloorPlan, LEFT_PX, WIDTH_PX, explain};
use engine::diagnostic::Result;
use engine::experiment::Trail;

/// Above a panel: its name. Between two panels beside one another.
const NAME_PX: f64 = 30.0;
const GAP_PX: f64 = 24.0;
/// The most pixels that a world takes upwards.
const MOST_PX: f64 = 420.0;

/// One world of the picture.
#[derive(Debug, Clone)]
pub struct WorldPanel<'a> {
    /// The words above it.
    pub name: String,
    /// The world.
    pub world: WorldPlan<'a>,
    /// The path; nothing if the robot never was there.
    pub path: Option<&'a Trail>,
}

/// Draws a panel for each world, three beside one another, or two of up to four. 1400 pixels wide, as high as the worlds need.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn world_trajectories(title: &str, panels: &[WorldPanel<'_>]) -> Result<Picture> {
    let columns = if panels.len() <= 4 { 2 } else { 3 };
    let room_px = (WIDTH_PX - 2.0 * MARGIN_PX + GAP_PX) / columns as f64 - GAP_PX - LEFT_PX;
    let floors: Vec<FloorPlan> = panels.iter().map(floor).collect();
    let sizes: Vec<(f64, f64)> = floors.iter().map(|floor| floor.fit(room_px, MOST_PX)).collect();
    let row_px =
        |row: &[(f64, f64)]| NAME_PX + row.iter().fold(0.0, |most: f64, size| most.max(size.1)) + BELOW_PX + 12.0;
    let height_px: f64 = sizes.chunks(columns).map(row_px).sum();
    let mut sheet = Sheet::new(WIDTH_PX, BELOW_TITLE_PX + height_px + 44.0, title);
    let mut top_px = BELOW_TITLE_PX;
    for (row, sizes) in sizes.chunks(columns).enumerate() {
        for (column, (width_px, height_px)) in sizes.iter().enumerate() {
            let (panel, floor) = (&panels[row * columns + column], &floors[row * columns + column]);
            let left_px =
                MARGIN_PX + LEFT_PX + column as f64 * (room_px + LEFT_PX + GAP_PX) + (room_px - width_px) / 2.0;
            let min = spot(left_px, top_px + NAME_PX);
            let max = (min.0 + units(*width_px), min.1 + units(*height_px));
            let heading = centred(words(&panel.name, ((min.0 + max.0) / 2, min.1 - units(14.0)), LABEL_PX, TEXT));
            sheet.text(fitted(heading, units(room_px)));
            let plot = floor.plot(&mut sheet, min, max, panel.world.floor());
            panel.world.draw(&mut sheet, &plot);
            let Some(path) = panel.path else { continue };
            panel.world.draw_movers(&mut sheet, &plot, &path.movers);
            route::draw_path(&mut sheet, &plot, path);
            if let Some(last) = path.last {
                panel.world.draw_robot(&mut sheet, &plot, last);
            }
        }
        top_px += row_px(sizes);
    }
    let paths = || panels.iter().filter_map(|panel| panel.path);
    if let Some(first) = panels.first() {
        explain(&mut sheet, &first.world, paths().any(|path| !path.goals.is_empty()));
    }
    let shown: Vec<String> = panels
        .iter()
        .map(|panel| format!("{}, failures: {}", panel.name, panel.path.map_or(0, |path| path.failures.len())))
        .collect();
    sheet.finish(&format!("Paths of the robot in {} worlds: {}", panels.len(), shown.join("; ")))
}

fn floor(panel: &WorldPanel<'_>) -> FloorPlan {
    FloorPlan::around(&panel.world, panel.path.into_iter().flat_map(route::points))
}
