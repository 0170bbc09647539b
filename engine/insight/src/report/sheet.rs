//! The paper that every picture is drawn on: colours, sizes of text, and a few strokes.

use super::canvas::{Align, PictureCanvas, PictureMark, Spot, Text, Tint, units};
use super::picture::Picture;
use super::{glyphs, raster, vector};
use engine::diagnostic::Result;

pub(super) const PAPER: Tint = Tint::hex(0xffffff);
pub(super) const TEXT: Tint = Tint::hex(0x1f2328);
pub(super) const QUIET: Tint = Tint::hex(0x57606a);
pub(super) const GRID: Tint = Tint::hex(0xe7e9ec);
pub(super) const FRAME: Tint = Tint::hex(0x8c959f);
// From the palette of Okabe and Ito, which people with any colour vision can tell apart.
pub(super) const BLUE: Tint = Tint::hex(0x0072b2);
pub(super) const SKY: Tint = Tint::hex(0x56b4e9);
pub(super) const VERMILION: Tint = Tint::hex(0xd55e00);
pub(super) const GREEN: Tint = Tint::hex(0x009e73);

/// Em of a picture's title, pixels.
pub(super) const TITLE_PX: f64 = 22.0;
/// Em of the title of a panel or an axis, pixels.
pub(super) const LABEL_PX: f64 = 16.0;
/// Em of ticks and legends, pixels.
pub(super) const SMALL_PX: f64 = 14.5;
/// Empty border around a picture, pixels.
pub(super) const MARGIN_PX: f64 = 28.0;
/// Where the content below the title begins, pixels from the top.
pub(super) const BELOW_TITLE_PX: f64 = 68.0;

/// A place in pixels from the top left.
pub(super) fn spot(x_px: f64, y_px: f64) -> Spot {
    (units(x_px), units(y_px))
}

/// A picture in the making.
pub(super) struct Sheet {
    canvas: PictureCanvas,
    title: String,
    pub(super) height_px: f64,
}

impl Sheet {
    /// White paper with a title.
    pub(super) fn new(width_px: f64, height_px: f64, title: &str) -> Self {
        let canvas = PictureCanvas::new(width_px.ceil() as u32, height_px.ceil() as u32);
        let mut sheet = Self { canvas, title: title.to_owned(), height_px };
        sheet.rect(spot(0.0, 0.0), spot(width_px.ceil(), height_px.ceil()), PAPER);
        let mut text = words(title, spot(MARGIN_PX, MARGIN_PX), TITLE_PX, TEXT);
        (text.bold, text.across) = (true, Align::Start);
        sheet.text(fitted(text, units(width_px - 2.0 * MARGIN_PX)));
        sheet
    }

    /// The finished picture, with what it shows in words.
    pub(super) fn finish(self, shows: &str) -> Result<Picture> {
        Ok(Picture { svg: vector::svg(&self.canvas, &self.title, shows)?, png: raster::png(&self.canvas)? })
    }

    fn push(&mut self, mark: PictureMark) {
        self.canvas.marks.push(mark);
    }

    pub(super) fn rect(&mut self, min: Spot, max: Spot, ink: Tint) {
        self.push(PictureMark::Rect { min, max, ink });
    }

    /// The border of a rectangle, one pixel wide, on whole pixels.
    pub(super) fn border(&mut self, min: Spot, max: Spot, ink: Tint) {
        let corners = [min, (max.0, min.1), max, (min.0, max.1), min];
        for side in corners.windows(2) {
            self.line(side.to_vec(), 1.0, ink);
        }
    }

    pub(super) fn area(&mut self, points: Vec<Spot>, ink: Tint) {
        if points.len() > 2 {
            self.push(PictureMark::Area { points, ink });
        }
    }

    pub(super) fn line(&mut self, points: Vec<Spot>, width_px: f64, ink: Tint) {
        self.canvas.line(points, units(width_px), ink);
    }

    pub(super) fn disc(&mut self, centre: Spot, radius_px: f64, ink: Tint) {
        self.push(PictureMark::Disc { centre, radius: units(radius_px), ink });
    }

    /// A diagonal cross.
    pub(super) fn cross(&mut self, centre: Spot, reach_px: f64, ink: Tint) {
        let reach = units(reach_px);
        for side in [-1, 1] {
            let ends = [(centre.0 - reach, centre.1 - reach * side), (centre.0 + reach, centre.1 + reach * side)];
            self.line(ends.to_vec(), 2.25, ink);
        }
    }

    pub(super) fn text(&mut self, text: Text) {
        self.push(PictureMark::Text(text));
    }

    pub(super) fn image(&mut self, min: Spot, max: Spot, columns: usize, rows: usize, rgb: Vec<u8>) {
        self.push(PictureMark::Pixels { min, max, columns, rows, rgb });
    }
}

/// A line of text that starts at `at` and stands in the middle of its height.
pub(super) fn words(words: &str, at: Spot, em_px: f64, ink: Tint) -> Text {
    Text {
        words: words.to_owned(),
        at,
        em: units(em_px),
        bold: false,
        along: Align::Start,
        across: Align::Middle,
        upwards: false,
        ink,
    }
}

/// The text with its middle at its place.
pub(super) fn centred(text: Text) -> Text {
    Text { along: Align::Middle, ..text }
}

/// The text, cut with an ellipsis where it would be wider than `width` units.
pub(super) fn fitted(mut text: Text, width: i32) -> Text {
    if glyphs::width(&text.words, text.em, text.bold) <= width {
        return text;
    }
    while !text.words.is_empty() {
        text.words.pop();
        let cut = format!("{}…", text.words.trim_end());
        if glyphs::width(&cut, text.em, text.bold) <= width {
            text.words = cut;
            break;
        }
    }
    text
}

/// One entry of a legend: how its sign is drawn, and what it means.
pub(super) struct LegendEntry<'a> {
    pub(super) sign: &'a dyn Fn(&mut Sheet, Spot, Spot),
    pub(super) words: &'a str,
}

/// Draws entries in a row that ends at the right of `end`; a sign gets the box from its first to its second corner.
pub(super) fn legend(sheet: &mut Sheet, end: Spot, entries: &[LegendEntry<'_>]) {
    let (sign, gap, after) = (units(28.0), units(8.0), units(26.0));
    let mut right = end.0;
    for entry in entries.iter().rev() {
        let text = words(entry.words, (0, end.1), SMALL_PX, QUIET);
        let left = right - glyphs::width(&text.words, text.em, false);
        let half = units(7.0);
        let corner = left - gap - sign;
        (entry.sign)(sheet, (corner, end.1 - half), (corner + sign, end.1 + half));
        sheet.text(Text { at: (left, end.1), ..text });
        right = corner - after;
    }
}
