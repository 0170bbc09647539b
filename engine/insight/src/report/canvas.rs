//! A picture as a list of marks, in quarter pixels: what charts draw on and what both writers read.

/// Units of the canvas in one pixel, so that whole coordinates still place a line finely.
pub(super) const UNITS_PER_PX: i32 = 4;

/// A place on the canvas, units, from the top left.
pub(super) type Spot = (i32, i32);

/// A place in pixels, between whole ones too.
pub(super) type FineSpot = (f32, f32);

/// A place in pixels.
pub(super) fn fine((x, y): Spot) -> FineSpot {
    (x as f32 / UNITS_PER_PX as f32, y as f32 / UNITS_PER_PX as f32)
}

/// Canvas units of a length in pixels.
pub(super) fn units(px: f64) -> i32 {
    (px * f64::from(UNITS_PER_PX)).round() as i32
}

/// A colour and how much it covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tint {
    /// Red, green, blue.
    pub(super) rgb: [u8; 3],
    /// 0 is invisible, 1 covers.
    pub(super) alpha: f64,
}

impl Tint {
    /// A covering colour from 0xRRGGBB.
    pub(super) const fn hex(rgb: u32) -> Self {
        Self { rgb: [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8], alpha: 1.0 }
    }

    /// This colour, covering less.
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

/// Which part of a text lies at its place.
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
    pub(super) ink: Tint,
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
pub(super) enum PictureMark {
    /// A filled rectangle.
    Rect { min: Spot, max: Spot, ink: Tint },
    /// A filled polygon that does not cross itself.
    Area { points: Vec<Spot>, ink: Tint },
    /// A line with round joints.
    Line { points: Vec<Spot>, width: i32, ink: Tint },
    /// A filled circle.
    Disc { centre: Spot, radius: i32, ink: Tint },
    /// Words.
    Text(Text),
    /// An image of RGB pixels, enlarged without smoothing.
    Pixels { min: Spot, max: Spot, columns: usize, rows: usize, rgb: Vec<u8> },
}

/// All marks of a picture.
#[derive(Debug)]
pub(super) struct PictureCanvas {
    /// Pixels in a row.
    pub(super) width_px: u32,
    /// Rows of pixels.
    pub(super) height_px: u32,
    /// From the lowest to the topmost.
    pub(super) marks: Vec<PictureMark>,
}

impl PictureCanvas {
    /// An empty canvas.
    pub(super) fn new(width_px: u32, height_px: u32) -> Self {
        Self { width_px, height_px, marks: Vec::new() }
    }

    /// A line; an upright or level one becomes a rectangle on whole pixels, so that it is crisp.
    pub(super) fn line(&mut self, points: Vec<Spot>, width: i32, ink: Tint) {
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
            self.marks.push(PictureMark::Rect { min, max, ink });
        } else if points.len() > 1 {
            self.marks.push(PictureMark::Line { points, width, ink });
        }
    }
}
