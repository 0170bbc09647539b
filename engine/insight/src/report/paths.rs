//! Where the robots of many seeds drove: every path thin, one of them strong.

use super::axes::BELOW_PX;
use super::canvas::{Spot, Tint, units};
use super::picture::Picture;
use super::plan::WorldPlan;
use super::route;
use super::sheet::{BELOW_TITLE_PX, LegendEntry, MARGIN_PX, Sheet, VERMILION, legend, spot};
use super::trajectory::{FloorPlan, LEFT_PX};
use engine::diagnostic::Result;
use engine::experiment::Trail;

const WIDTH_PX: f64 = 1200.0;
const THIN: Tint = Tint::hex(0x57606a);

/// What the picture of paths shows.
#[derive(Debug, Clone, Copy)]
pub struct PathsData<'a> {
    /// The heading.
    pub title: &'a str,
    /// The world.
    pub world: &'a WorldPlan<'a>,
    /// The path of each seed.
    pub paths: &'a [&'a Trail],
    /// Which of them is strong, and its seed.
    pub strong: (usize, u64),
}

/// Draws the paths on one plan. 1200 pixels wide, as high as the world needs.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn paths(data: &PathsData<'_>) -> Result<Picture> {
    let floor = FloorPlan::around(data.world, data.paths.iter().flat_map(|path| route::points(path)));
    let room_px = WIDTH_PX - 2.0 * MARGIN_PX - LEFT_PX;
    let (width_px, height_px) = floor.fit(room_px, 760.0);
    let mut sheet = Sheet::new(WIDTH_PX, BELOW_TITLE_PX + height_px + BELOW_PX + 44.0, data.title);
    let min = spot(MARGIN_PX + LEFT_PX + (room_px - width_px) / 2.0, BELOW_TITLE_PX);
    let max = (min.0 + units(width_px), min.1 + units(height_px));
    let plot = floor.plot(&mut sheet, min, max, data.world.floor());
    data.world.draw(&mut sheet, &plot);
    let (strong, seed) = data.strong;
    for (_, path) in data.paths.iter().enumerate().filter(|(index, _)| *index != strong) {
        route::draw_thin(&mut sheet, &plot, path, THIN.thin(0.55));
    }
    if let Some(path) = data.paths.get(strong) {
        data.world.draw_movers(&mut sheet, &plot, &path.movers);
        route::draw_path(&mut sheet, &plot, path);
    }
    explain(&mut sheet, seed);
    let failures: usize = data.paths.iter().map(|path| path.failures.len()).sum();
    let count = data.paths.len();
    sheet.finish(&format!("Paths of {count} seeds in their tests, failures: {failures}; seed {seed} is drawn strong"))
}

fn explain(sheet: &mut Sheet, seed: u64) {
    let level = |from: Spot, to: Spot, y: i32| vec![(from.0, y), (to.0, y)];
    let middle = |from: Spot, to: Spot| ((from.0 + to.0) / 2, (from.1 + to.1) / 2);
    let strong = |sheet: &mut Sheet, from: Spot, to: Spot| {
        sheet.line(level(from, to, middle(from, to).1), 3.0, route::shade(0.7))
    };
    let thin = |sheet: &mut Sheet, from: Spot, to: Spot| sheet.line(level(from, to, middle(from, to).1), 1.0, THIN);
    let failure = |sheet: &mut Sheet, from: Spot, to: Spot| sheet.cross(middle(from, to), 5.0, VERMILION);
    let words = format!("seed {seed}, with the median failures");
    let entries = [
        LegendEntry { sign: &strong, words: &words },
        LegendEntry { sign: &thin, words: "the other seeds" },
        LegendEntry { sign: &failure, words: "failure" },
    ];
    legend(sheet, spot(WIDTH_PX - MARGIN_PX, sheet.height_px - 28.0), &entries);
}
