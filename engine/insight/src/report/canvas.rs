//! A picture as a list of marks, in quarter pixels: what charts draw on and what both writers read.

use std::convert::Infallible;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontStyle,
    FontTransform,
};

use super::glyphs;

/// Units of the canvas in one pixel, so that whole coordinates still place a line finely.
pub(super) const UNITS_PER_PX: i32 = 4;

/// A place on the canvas, units, from the top left.
pub(super) type Spot = (i32, i32);

/// Canvas units of a length in pixels.
pub(super) fn units(px: f64) -> i32 {
    (px * f64::from(UNITS_PER_PX)).round() as i32
}

/// A colour and how much it covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ink {
    /// Red, green, blue.
    pub(super) rgb: [u8; 3],
    /// 0 is invisible, 1 covers.
    pub(super) alpha: f64,
}

impl Ink {
    /// A covering colour from 0xRRGGBB.
    pub(super) const fn hex(rgb: u32) -> Self {
        Self { rgb: [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8], alpha: 1.0 }
    }

    /// The same colour, thinner.
    pub(super) const fn thin(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }

    /// The covering colour on the way to another one: 0 is this, 1 the other.
    pub(super) fn towards(self, other: Self, share: f64) -> Self {
        let mix = |from: u8, to: u8| (f64::from(from) + (f64::from(to) - f64::from(from)) * share).round() as u8;
        let rgb = [0, 1, 2].map(|channel| mix(self.rgb[channel], other.rgb[channel]));
        Self { rgb, alpha: 1.0 }
    }
}

impl From<BackendColor> for Ink {
    fn from(colour: BackendColor) -> Self {
        let (red, green, blue) = colour.rgb;
        Self { rgb: [red, green, blue], alpha: colour.alpha }
    }
}

/// Where a text's place lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Align {
    /// At its left or top.
    Start,
    /// In its middle.
    Middle,
    /// At its right or bottom.
    End,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    /// The words.
    pub(super) words: String,
    /// Its place.
    pub(super) at: Spot,
    /// Size of the em square, units.
    pub(super) em: i32,
    /// Heavy letters.
    pub(super) bold: bool,
    /// Where `at` is along the words.
    pub(super) along: Align,
    /// Where `at` is in their height.
    pub(super) across: Align,
    /// Read from bottom to top.
    pub(super) upwards: bool,
    /// Its colour.
    pub(super) ink: Ink,
}

impl Text {
    /// From `at` down to the line that the letters stand on, units.
    pub(super) fn baseline(&self) -> i32 {
        // The capitals of DejaVu Sans are 0.73 em high, its tails reach 0.24 em down.
        let share = match self.across {
            Align::Start => 0.76,
            Align::Middle => 0.365,
            Align::End => -0.24,
        };
        (f64::from(self.em) * share).round() as i32
    }
}

/// One thing on the canvas; later ones cover earlier ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mark {
    /// A filled rectangle.
    Rect { min: Spot, max: Spot, ink: Ink },
    /// A filled polygon that does not cross itself.
    Area { points: Vec<Spot>, ink: Ink },
    /// A line with round joints.
    Line { points: Vec<Spot>, width: i32, ink: Ink },
    /// A filled circle.
    Disc { centre: Spot, radius: i32, ink: Ink },
    /// Words.
    Text(Text),
    /// An image of RGB pixels, enlarged without smoothing.
    Pixels { min: Spot, max: Spot, columns: usize, rows: usize, rgb: Vec<u8> },
}

/// All marks of a picture.
#[derive(Debug)]
pub(super) struct Canvas {
    /// Pixels in a row.
    pub(super) width_px: u32,
    /// Rows of pixels.
    pub(super) height_px: u32,
    /// From the lowest to the topmost.
    pub(super) marks: Vec<Mark>,
}

impl Canvas {
    /// An empty canvas.
    pub(super) fn new(width_px: u32, height_px: u32) -> Self {
        Self { width_px, height_px, marks: Vec::new() }
    }

    /// A line; an upright or level one becomes a rectangle on whole pixels, so that it is crisp.
    pub(super) fn line(&mut self, points: Vec<Spot>, width: i32, ink: Ink) {
        if let [from, to] = points[..]
            && (from.0 == to.0) != (from.1 == to.1)
        {
            let snapped =
                |centre: i32| (f64::from(centre - width / 2) / f64::from(UNITS_PER_PX)).round() as i32 * UNITS_PER_PX;
            let (min, max) = if from.0 == to.0 {
                let left = snapped(from.0);
                ((left, from.1.min(to.1)), (left + width, from.1.max(to.1)))
            } else {
                let top = snapped(from.1);
                ((from.0.min(to.0), top), (from.0.max(to.0), top + width))
            };
            self.marks.push(Mark::Rect { min, max, ink });
        } else if points.len() > 1 {
            self.marks.push(Mark::Line { points, width, ink });
        }
    }
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Canvas {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.width_px * UNITS_PER_PX as u32, self.height_px * UNITS_PER_PX as u32)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Drawn {
        self.marks.push(Mark::Rect { min: at, max: (at.0 + 1, at.1 + 1), ink: colour.into() });
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(&mut self, min: BackendCoord, max: BackendCoord, style: &S, fill: bool) -> Drawn {
        if fill {
            self.marks.push(Mark::Rect { min, max, ink: style.color().into() });
            return Ok(());
        }
        self.draw_path([min, (max.0, min.1), max, (min.0, max.1), min], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        let ink = Ink::from(style.color());
        if ink.alpha > 0.0 {
            self.line(path.into_iter().collect(), style.stroke_width() as i32, ink);
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, style: &S, _fill: bool) -> Drawn {
        self.marks.push(Mark::Disc { centre, radius: radius as i32, ink: style.color().into() });
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        self.marks.push(Mark::Area { points: path.into_iter().collect(), ink: style.color().into() });
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, words: &str, style: &S, at: BackendCoord) -> Drawn {
        let along = match style.anchor().h_pos {
            HPos::Left => Align::Start,
            HPos::Center => Align::Middle,
            HPos::Right => Align::End,
        };
        let across = match style.anchor().v_pos {
            VPos::Top => Align::Start,
            VPos::Center => Align::Middle,
            VPos::Bottom => Align::End,
        };
        self.marks.push(Mark::Text(Text {
            words: words.to_owned(),
            at,
            em: style.size().round() as i32,
            bold: matches!(style.style(), FontStyle::Bold),
            along,
            across,
            upwards: matches!(style.transform(), FontTransform::Rotate270),
            ink: style.color().into(),
        }));
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        words: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let em = style.size().round() as i32;
        let width = glyphs::width(words, em, matches!(style.style(), FontStyle::Bold));
        Ok((width.max(0) as u32, em.max(0) as u32))
    }
}
