//! Letters: DejaVu Sans, built in, so that text looks and measures the same on every machine.

use std::convert::Infallible;
use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, FontTransform, register_font};

use super::canvas::{Align, Text, UNITS_PER_PX};

/// The family as SVG names it: ours, then what a viewer without it may take.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Ascent plus descent of DejaVu Sans in em; the rasterizer's size is this height.
const HEIGHT_EM: f64 = 1.164;

/// The registered font. `em` in canvas units.
pub(super) fn font(em: i32, bold: bool) -> FontDesc<'static> {
    static REGISTERED: OnceLock<()> = OnceLock::new();
    REGISTERED.get_or_init(|| {
        // A font that cannot be read shows as missing text in every test; there is no better place to report it.
        drop(register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular()));
        drop(register_font(FAMILY, FontStyle::Bold, dejavu::sans::bold()));
    });
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    FontDesc::new(FontFamily::Name(FAMILY), f64::from(em), style)
}

/// Width of the words, canvas units.
pub(super) fn width(words: &str, em: i32, bold: bool) -> i32 {
    let font = font(em, bold).resize(f64::from(em) * HEIGHT_EM);
    font.layout_box(words).map_or(0, |(min, max)| max.0 - min.0)
}

/// Calls `cover` with a pixel and the share of it that the text covers, several times for a pixel.
pub(super) fn draw(text: &Text, mut cover: impl FnMut(i32, i32, f32)) {
    let size = f64::from(text.em) * HEIGHT_EM;
    let font = font(text.em, text.bold).resize(size);
    let length = width(&text.words, text.em, text.bold);
    let back = match text.along {
        Align::Start => 0,
        Align::Middle => length / 2,
        Align::End => length,
    };
    // The rasterizer puts the baseline half its size below the place it is given.
    let down = text.baseline() - (size as f32 / 2.0) as i32;
    let turn = if text.upwards { FontTransform::Rotate270 } else { FontTransform::None };
    let share = 1.0 / (UNITS_PER_PX * UNITS_PER_PX) as f32;
    let drawn = font.draw(&text.words, (0, 0), |x, y, covered| {
        let (x, y) = turn.transform(x - back, y + down);
        cover((text.at.0 + x).div_euclid(UNITS_PER_PX), (text.at.1 + y).div_euclid(UNITS_PER_PX), covered * share);
        Ok::<(), Infallible>(())
    });
    // Text without a font is left out; the tests look for its pixels.
    drop(drawn);
}
