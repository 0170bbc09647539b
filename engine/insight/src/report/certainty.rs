//! A certainty grid, the map of what the robot's sensors found, with the robot's path over it.

use super::axes::BELOW_PX;
use super::canvas::{Tint, units};
use super::picture::{Picture, failed};
use super::route;
use super::sheet::{BELOW_TITLE_PX, FRAME, MARGIN_PX, Sheet, spot};
use super::trajectory::{FloorPlan, LEFT_PX};
use engine::diagnostic::Result;
use engine::experiment::Trail;

const WIDTH_PX: f64 = 1200.0;
/// Where the grid does not reach.
const FLOOR: Tint = Tint::hex(0xf6f7f8);

/// Draws grey cells of `cell_m` metres, row 0 at the least y, from `origin` (metres, the least x and y) on.
///
/// # Errors
/// If the cells do not fill whole rows, a size is not positive, or the picture cannot be encoded.
pub fn certainty_grid(
    title: &str,
    cells: &[u8],
    width: usize,
    cell_m: f64,
    origin: [f64; 2],
    path: &Trail,
) -> Result<Picture> {
    let sized = cell_m.is_finite() && cell_m > 0.0 && origin.iter().all(|at| at.is_finite());
    if width == 0 || cells.is_empty() || !cells.len().is_multiple_of(width) || !sized {
        return Err(failed("the certainty grid does not have whole rows of cells with a positive size"));
    }
    let height = cells.len() / width;
    let [x_m, y_m] = origin;
    let end = [x_m + width as f64 * cell_m, y_m + height as f64 * cell_m];
    let floor = FloorPlan::showing((x_m, end[0]), (y_m, end[1]));
    let room_px = WIDTH_PX - 2.0 * MARGIN_PX - LEFT_PX;
    let (width_px, height_px) = floor.fit(room_px, 720.0);
    let mut sheet = Sheet::new(WIDTH_PX, BELOW_TITLE_PX + height_px + BELOW_PX + MARGIN_PX / 2.0, title);
    let min = spot(MARGIN_PX + LEFT_PX + (room_px - width_px) / 2.0, BELOW_TITLE_PX);
    let max = (min.0 + units(width_px), min.1 + units(height_px));
    let plot = floor.plot(&mut sheet, min, max, FLOOR);
    let rgb = cells.chunks(width).rev().flatten().flat_map(|grey| [*grey; 3]).collect();
    let (min, max) = (plot.at(x_m, end[1]), plot.at(end[0], y_m));
    sheet.image(min, max, width, height, rgb);
    sheet.border(min, max, FRAME);
    route::draw_path(&mut sheet, &plot, path);
    sheet.finish(&format!(
        "What the laser found, light free, dark occupied, grey unknown; path of the robot over {} steps",
        path.steps()
    ))
}
