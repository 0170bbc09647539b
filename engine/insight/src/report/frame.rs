//! One image seen through the pipeline: the image, what each filter made of it, the grid and its state.

use super::canvas::{Spot, Tint, units};
use super::picture::{Picture, failed};
use super::sheet::{
    BELOW_TITLE_PX, BLUE, FRAME, LABEL_PX, MARGIN_PX, PAPER, QUIET, SKY, SMALL_PX, Sheet, TEXT, centred, spot, words,
};
use engine::diagnostic::Result;
use engine::experiment::{SeenView, Snapshot};
use engine::sensors::observation::Image;
use filter_api::Format;

const GAP_PX: f64 = 28.0;
/// The least distance from one panel to the next, which the words around a panel need.
const LEAST_APART_PX: f64 = 344.0;
/// Room for one panel, pixels; a larger image is thinned out.
const ROOM_PX: usize = 640;

/// What the frame picture shows.
#[derive(Debug, Clone, Copy)]
pub struct FrameData<'a> {
    /// The heading.
    pub title: &'a str,
    /// Pixels in a row of every panel.
    pub width_px: usize,
    /// Rows of pixels of every panel.
    pub height_px: usize,
    /// The pictures before the grid, left to right: at least one.
    pub panels: &'a [FramePanel<'a>],
    /// The grids after them; none if nobody reads what the camera sees.
    pub views: &'a [SeenView],
    /// The state's number.
    pub state: usize,
}

/// Draws a frame that a test kept: the camera's image, the mask, the grid.
///
/// # Errors
/// As [`frame()`].
pub fn snapshot_frame(title: &str, snapshot: &Snapshot) -> Result<Picture> {
    let Snapshot { image, views, state } = snapshot;
    let masks = views.iter().map(|view| FramePanel::mask(view.name.as_deref().unwrap_or("filtered"), &view.mask));
    let panels: Vec<FramePanel<'_>> = [FramePanel::image("camera", image)].into_iter().chain(masks).collect();
    let (width_px, height_px) = (image.width_px, image.height_px);
    frame(&FrameData { title, width_px, height_px, panels: &panels, views, state: *state })
}

/// One picture of the frame.
#[derive(Debug, Clone, Copy)]
pub struct FramePanel<'a> {
    /// The words above it.
    pub name: &'a str,
    /// What one pixel holds.
    pub format: Format,
    /// Row by row from the top left, as many as the frame says.
    pub pixels: &'a [u8],
}

impl<'a> FramePanel<'a> {
    /// A colour image under a name.
    #[must_use]
    pub fn image(name: &'a str, image: &'a Image) -> Self {
        Self { name, format: image.format, pixels: &image.pixels }
    }

    /// The mask that a chain of filters made, 0 or 255.
    #[must_use]
    pub fn mask(name: &'a str, pixels: &'a [u8]) -> Self {
        Self { name, format: Format::Mask, pixels }
    }

    /// What is written below it.
    fn caption(&self, width: usize, height: usize) -> String {
        match self.format {
            Format::Rgb => format!("{width} × {height} pixels"),
            Format::Grey => "grey levels".to_owned(),
            Format::Depth => "bright is near".to_owned(),
            Format::Mask => {
                let set = self.pixels.iter().filter(|pixel| **pixel > 0).count();
                format!("{:.1} % foreground", set as f64 / self.pixels.len() as f64 * 100.0)
            }
        }
    }

    fn colour(&self, pixel: usize) -> [u8; 3] {
        match self.format {
            Format::Rgb => [self.pixels[3 * pixel], self.pixels[3 * pixel + 1], self.pixels[3 * pixel + 2]],
            // White from half a metre on.
            Format::Depth => [self.pixels[2 * pixel + 1].saturating_mul(4); 3],
            Format::Grey | Format::Mask => [self.pixels[pixel]; 3],
        }
    }
}

/// Draws the panels and the grid side by side, pixels enlarged by a whole factor.
///
/// # Errors
/// If the parts do not fit each other, or the picture cannot be encoded.
pub fn frame(data: &FrameData<'_>) -> Result<Picture> {
    check_parts(data)?;
    let (width, height) = (data.width_px, data.height_px);
    let keep = width.max(height).div_ceil(ROOM_PX);
    let (columns, rows) = (width.div_ceil(keep), height.div_ceil(keep));
    let zoom = (400 / columns).min(480 / rows).max(1);
    let (panel_width, panel_height) = ((columns * zoom) as f64, (rows * zoom) as f64);
    let apart = (panel_width + GAP_PX).max(LEAST_APART_PX);
    let top = BELOW_TITLE_PX + 30.0;
    let panels = data.panels.len();
    let panels_width = (panels + data.views.len()) as f64 * apart - GAP_PX;
    // One panel alone leaves room for the title too.
    let sheet_width = 2.0 * MARGIN_PX + panels_width.max(2.0 * LEAST_APART_PX);
    let mut sheet = Sheet::new(sheet_width, top + panel_height + 74.0, data.title);
    let panel = |index: usize| {
        let left = MARGIN_PX + index as f64 * apart + ((apart - GAP_PX - panel_width) / 2.0).floor();
        let min = spot(left, top);
        (min, (min.0 + units(panel_width), min.1 + units(panel_height)))
    };
    for (index, shown) in data.panels.iter().enumerate() {
        let (min, max) = panel(index);
        let unread = if data.views.is_empty() { ", which the script does not read" } else { "" };
        title(&mut sheet, min, max, shown.name, &format!("{}{unread}", shown.caption(width, height)));
        let rgb = thinned(rows, columns, |row, column| shown.colour(row * keep * width + column * keep));
        sheet.image(min, max, columns, rows, rgb);
        sheet.border(min, max, FRAME);
    }
    for (index, view) in data.views.iter().enumerate() {
        let (min, max) = panel(panels + index);
        let (rows, columns) = view.grid;
        let above = match &view.name {
            None => format!("grid {rows} × {columns}: state {}", data.state),
            Some(name) => format!("{name}, grid {rows} × {columns}: number {}", view.number),
        };
        title(&mut sheet, min, max, &above, &digits(view));
        grid(&mut sheet, min, max, view);
    }
    let names: Vec<&str> = data.panels.iter().map(|panel| panel.name).collect();
    let read = if data.views.is_empty() { "which the script does not read," } else { "and the grid" };
    sheet.finish(&format!("What the robot sees: {}, {read} in state {}", names.join(", "), data.state))
}

fn check_parts(data: &FrameData<'_>) -> Result<()> {
    let (width, height) = (data.width_px, data.height_px);
    let fits = |panel: &FramePanel<'_>| panel.pixels.len() == width * height * panel.format.channels();
    if width * height == 0 || data.panels.is_empty() || !data.panels.iter().all(fits) {
        return Err(failed("a panel does not have the size of the frame"));
    }
    let whole = |view: &SeenView| {
        let cells = view.grid.0 * view.grid.1;
        cells > 0 && [view.shares.len(), view.occupied.len(), view.filled.len()] == [cells; 3]
    };
    if !data.views.iter().all(whole) {
        return Err(failed("the grid does not have rows times columns cells"));
    }
    Ok(())
}

fn thinned(rows: usize, columns: usize, pixel: impl Fn(usize, usize) -> [u8; 3]) -> Vec<u8> {
    let pixel = &pixel;
    (0..rows).flat_map(|row| (0..columns).flat_map(move |column| pixel(row, column))).collect()
}

fn title(sheet: &mut Sheet, min: Spot, max: Spot, name: &str, below: &str) {
    let middle = (min.0 + max.0) / 2;
    sheet.text(centred(words(name, (middle, min.1 - units(18.0)), LABEL_PX, TEXT)));
    sheet.text(centred(words(below, (middle, max.1 + units(24.0)), SMALL_PX, QUIET)));
}

/// What the state counts under the column rule.
fn digits(view: &SeenView) -> String {
    let (rows, columns) = view.grid;
    let filled = |column: usize| (0..rows).filter(|row| view.filled[row * columns + column]).count();
    let counts: Vec<String> = (0..columns).map(|column| filled(column).to_string()).collect();
    format!("filled cells in each column: {}", counts.join(" "))
}

fn grid(sheet: &mut Sheet, min: Spot, max: Spot, view: &SeenView) {
    let (rows, columns) = view.grid;
    let along = |index: usize, count: usize, low: i32, high: i32| low + (high - low) * index as i32 / count as i32;
    let x = |column: usize| along(column, columns, min.0, max.0);
    let y = |row: usize| along(row, rows, min.1, max.1);
    let small = (x(1) - x(0)).min(2 * (y(1) - y(0))) < units(52.0);
    for row in 0..rows {
        for column in 0..columns {
            let cell = row * columns + column;
            let (from, to) = ((x(column), y(row)), (x(column + 1), y(row + 1)));
            let ink = cell_fill(sheet, from, to, view.occupied[cell], view.filled[cell]);
            if !small {
                let share = format!("{:.1} %", view.shares[cell] * 100.0);
                let middle = ((from.0 + to.0) / 2, (from.1 + to.1) / 2);
                sheet.text(centred(words(&share, middle, LABEL_PX, ink)));
            }
            sheet.border(from, to, FRAME);
        }
    }
}

/// Fills a cell and gives the colour for words on it.
fn cell_fill(sheet: &mut Sheet, from: Spot, to: Spot, occupied: bool, filled: bool) -> Tint {
    if occupied {
        sheet.rect(from, to, BLUE);
        PAPER
    } else if filled {
        sheet.rect(from, to, SKY.towards(PAPER, 0.72));
        hatch(sheet, from, to, SKY.towards(PAPER, 0.3));
        TEXT
    } else {
        sheet.rect(from, to, PAPER);
        QUIET
    }
}

/// Slanted lines within a rectangle.
fn hatch(sheet: &mut Sheet, from: Spot, to: Spot, ink: Tint) {
    let (width, height) = (to.0 - from.0, to.1 - from.1);
    let mut start = units(10.0);
    while start < width + height {
        let (low, high) = ((start - height).max(0), start.min(width));
        sheet.line(vec![(from.0 + low, from.1 + start - low), (from.0 + high, from.1 + start - high)], 1.25, ink);
        start += units(12.0);
    }
}
