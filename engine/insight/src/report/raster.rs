//! Paints a canvas as pixels, smoothed by the exact share of each pixel that a mark covers.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::canvas::{FineSpot, PictureCanvas, PictureMark, Tint, UNITS_PER_PX, fine};
use super::glyphs;
use super::picture::failed;
use engine::diagnostic::Result;

/// The canvas as a whole PNG file.
///
/// # Errors
/// If it cannot be encoded.
pub(super) fn png(canvas: &PictureCanvas) -> Result<Vec<u8>> {
    let mut raster = Raster::new(canvas.width_px as usize, canvas.height_px as usize);
    for mark in &canvas.marks {
        raster.paint(mark);
    }
    encode(&raster.rgb, canvas.width_px, canvas.height_px)
}

/// RGB pixels as a PNG file.
///
/// # Errors
/// If the pixels do not fit the size.
pub(super) fn encode(rgb: &[u8], width_px: u32, height_px: u32) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
        .write_image(rgb, width_px, height_px, ExtendedColorType::Rgb8)
        .map_err(|error| failed(&error.to_string()))?;
    Ok(bytes)
}

/// Pixels, and the coverage of the mark that is being painted.
struct Raster {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
    /// Zero outside the touched part of each row.
    cover: Vec<f32>,
    /// The touched columns of each row: first and one past the last.
    touched: Vec<(usize, usize)>,
}

impl Raster {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            rgb: vec![255; width * height * 3],
            cover: vec![0.0; width * height],
            touched: vec![(usize::MAX, 0); height],
        }
    }

    fn paint(&mut self, mark: &PictureMark) {
        match mark {
            PictureMark::Rect { min, max, ink } => {
                self.rect(fine(*min), fine(*max));
                self.blend(*ink);
            }
            PictureMark::Area { points, ink } => {
                self.outline(points.iter().copied().map(fine));
                self.sum_edges();
                self.blend(*ink);
            }
            PictureMark::Line { points, width, ink } => {
                let radius = *width as f32 / UNITS_PER_PX as f32 / 2.0;
                for pair in points.windows(2) {
                    self.segment(fine(pair[0]), fine(pair[1]), radius);
                }
                self.blend(*ink);
            }
            PictureMark::Disc { centre, radius, ink } => {
                self.segment(fine(*centre), fine(*centre), *radius as f32 / UNITS_PER_PX as f32);
                self.blend(*ink);
            }
            PictureMark::Text(text) => {
                for outline in glyphs::outlines(text) {
                    self.outline(outline.into_iter());
                }
                self.sum_edges();
                self.blend(text.ink);
            }
            PictureMark::Pixels { min, max, columns, rows, rgb } => {
                self.pixels(fine(*min), fine(*max), (*columns, *rows), rgb)
            }
        }
    }

    fn touch(&mut self, row: usize, from: usize, to: usize) {
        let touched = &mut self.touched[row];
        *touched = (touched.0.min(from), touched.1.max(to));
    }

    /// Whole pixels that a range of coordinates touches, cut to `limit`.
    fn span(low: f32, high: f32, limit: usize) -> (usize, usize) {
        (low.floor().clamp(0.0, limit as f32) as usize, high.ceil().clamp(0.0, limit as f32) as usize)
    }

    fn rect(&mut self, min: FineSpot, max: FineSpot) {
        let share = |cell: usize, low: f32, high: f32| (high.min(cell as f32 + 1.0) - low.max(cell as f32)).max(0.0);
        let (left, right) = Self::span(min.0, max.0, self.width);
        let (top, bottom) = Self::span(min.1, max.1, self.height);
        if left >= right {
            return;
        }
        for row in top..bottom {
            let down = share(row, min.1, max.1);
            self.touch(row, left, right);
            for (column, cover) in (left..right).zip(&mut self.cover[row * self.width + left..row * self.width + right])
            {
                *cover = down * share(column, min.0, max.0);
            }
        }
    }

    /// Adds the edges of a closed outline.
    fn outline(&mut self, corners: impl DoubleEndedIterator<Item = FineSpot> + Clone) {
        let last = corners.clone().next_back();
        for (from, to) in last.into_iter().chain(corners.clone()).zip(corners) {
            self.edge(from, to);
        }
    }

    /// Adds the signed change of covered area along one edge of a polygon, row by row.
    fn edge(&mut self, from: FineSpot, to: FineSpot) {
        if from.1 == to.1 {
            return;
        }
        let (sign, upper, lower) = if from.1 < to.1 { (1.0, from, to) } else { (-1.0, to, from) };
        let slope = (lower.0 - upper.0) / (lower.1 - upper.1);
        let limit = self.width as f32;
        let (top, bottom) = Self::span(upper.1, lower.1, self.height);
        for row in top..bottom {
            let y0 = upper.1.max(row as f32);
            let y1 = lower.1.min(row as f32 + 1.0);
            let (a, b) = (upper.0 + (y0 - upper.1) * slope, upper.0 + (y1 - upper.1) * slope);
            let (low, high) = (a.min(b).clamp(0.0, limit), a.max(b).clamp(0.0, limit));
            let height = sign * (y1 - y0);
            let first = low.floor() as usize;
            let last = (high.ceil() as usize).max(first + 1);
            // Share of the strip from the edge to the right border that lies left of column `x`, summed up to there.
            let before = |x: f32| {
                if x <= low {
                    0.0
                } else if x >= high {
                    x - (low + high) / 2.0
                } else {
                    (x - low) * (x - low) / (2.0 * (high - low))
                }
            };
            let mut done = 0.0;
            let mut last_share = 0.0;
            for column in first..=last {
                let share = before(column as f32 + 1.0) - done;
                done += share;
                if column < self.width {
                    self.cover[row * self.width + column] += height * (share - last_share);
                }
                last_share = share;
            }
            self.touch(row, first.min(self.width), (last + 1).min(self.width));
        }
    }

    /// Turns changes of area into coverage.
    fn sum_edges(&mut self) {
        for (row, &(from, to)) in self.touched.iter().enumerate() {
            let mut sum = 0.0;
            for cover in self.cover[row * self.width..(row + 1) * self.width].get_mut(from..to).unwrap_or_default() {
                sum += *cover;
                *cover = sum.abs();
            }
        }
    }

    /// Covers all within `radius` of a segment, with a border one pixel soft.
    fn segment(&mut self, from: FineSpot, to: FineSpot, radius: f32) {
        let reach = radius + 0.5;
        let along = (to.0 - from.0, to.1 - from.1);
        let length = along.0 * along.0 + along.1 * along.1;
        let (top, bottom) = Self::span(from.1.min(to.1) - reach, from.1.max(to.1) + reach, self.height);
        for row in top..bottom {
            let y = row as f32 + 0.5;
            // The part of the segment that is near enough to this row.
            let (low, high) = if along.1.abs() < 1e-3 {
                (0.0, 1.0)
            } else {
                let (a, b) = ((y - reach - from.1) / along.1, (y + reach - from.1) / along.1);
                (a.min(b).clamp(0.0, 1.0), a.max(b).clamp(0.0, 1.0))
            };
            let (a, b) = (from.0 + low * along.0, from.0 + high * along.0);
            let (left, right) = Self::span(a.min(b) - reach, a.max(b) + reach, self.width);
            if left >= right {
                continue;
            }
            self.touch(row, left, right);
            let covers = &mut self.cover[row * self.width + left..row * self.width + right];
            for (column, cover) in (left..right).zip(covers) {
                let (dx, dy) = (column as f32 + 0.5 - from.0, y - from.1);
                let share = if length > 0.0 { ((dx * along.0 + dy * along.1) / length).clamp(0.0, 1.0) } else { 0.0 };
                let (dx, dy) = (dx - share * along.0, dy - share * along.1);
                let near = (reach - (dx * dx + dy * dy).sqrt()).clamp(0.0, 1.0);
                *cover = cover.max(near);
            }
        }
    }

    fn pixels(&mut self, min: FineSpot, max: FineSpot, (columns, rows): (usize, usize), rgb: &[u8]) {
        let (left, right) = Self::span(min.0.round(), max.0.round(), self.width);
        let (top, bottom) = Self::span(min.1.round(), max.1.round(), self.height);
        let place = |at: usize, low: f32, high: f32, count: usize| {
            ((at as f32 + 0.5 - low) / (high - low) * count as f32).clamp(0.0, count as f32 - 1.0) as usize
        };
        for row in top..bottom {
            let source = place(row, min.1, max.1, rows) * columns;
            for column in left..right {
                let from = (source + place(column, min.0, max.0, columns)) * 3;
                let to = (row * self.width + column) * 3;
                self.rgb[to..to + 3].copy_from_slice(&rgb[from..from + 3]);
            }
        }
    }

    /// Lays the ink over the covered pixels and clears the coverage.
    fn blend(&mut self, ink: Tint) {
        for (row, touched) in self.touched.iter_mut().enumerate() {
            let (from, to) = std::mem::replace(touched, (usize::MAX, 0));
            for at in row * self.width + from.min(to)..row * self.width + to {
                let cover = std::mem::take(&mut self.cover[at]).min(1.0) * ink.alpha as f32;
                if cover > 0.0 {
                    for (channel, &colour) in self.rgb[at * 3..at * 3 + 3].iter_mut().zip(&ink.rgb) {
                        let old = f32::from(*channel);
                        *channel = (old + (f32::from(colour) - old) * cover + 0.5) as u8;
                    }
                }
            }
        }
    }
}
