//! The inner loops: whole numbers only, compiled for each processor.

use dispatch::{Processor, compiled_for_each_processor};

/// The greatest square of a norm that fits 16 bits as the sum of squares that are cut off there.
const MOST_SHORT: i32 = 255 * 255;

compiled_for_each_processor! {
    /// Luma of RGB pixels.
    pub(crate) fn luma_of_colour<'a>(pixels: &'a [u8], luma: &'a mut [u8]) {
        for (pixel, luma) in pixels.chunks_exact(3).zip(luma) {
            let weighted = u16::from(pixel[0]) * 77 + u16::from(pixel[1]) * 150 + u16::from(pixel[2]) * 29;
            *luma = (weighted >> 8) as u8;
        }
    }
}

/// Marks the pixels of a grey frame, at least one, whose squared gradient reaches `least_square`.
pub(crate) fn mark_edges(processor: Processor, luma: &[u8], width: usize, least_square: i32, out: &mut [u8]) {
    let height = luma.len() / width;
    let row = |y: usize| &luma[y * width..(y + 1) * width];
    // Rows between the first and the last are one long row: only at its ends has a pixel strangers for neighbours.
    let inner = height.saturating_sub(2) * width;
    if inner > 0 {
        let rows = [&luma[..inner], &luma[width..width + inner], &luma[2 * width..]];
        mark_row(processor, rows, least_square, &mut out[width..width + inner]);
    }
    mark_row(processor, [row(0), row(0), row(1.min(height - 1))], least_square, &mut out[..width]);
    let last = height - 1;
    mark_row(processor, [row(last.max(1) - 1), row(last), row(last)], least_square, &mut out[last * width..]);
    mark_column(luma, width, [0, 1.min(width - 1)], least_square, out);
    mark_column(luma, width, [width - 1, width.max(2) - 2], least_square, out);
}

/// The column `end`, whose neighbours are itself and the column `beside`.
fn mark_column(luma: &[u8], width: usize, [end, beside]: [usize; 2], least_square: i32, out: &mut [u8]) {
    // What a row adds to the gradients of the rows around it.
    let part = |row: &[u8]| {
        let (end, beside) = (i32::from(row[end]), i32::from(row[beside]));
        (beside - end, 3 * end + beside)
    };
    let mut above = part(luma);
    let mut here = above;
    let mut rows = luma.chunks_exact(width);
    rows.next();
    for out in out.chunks_exact_mut(width) {
        let below = rows.next().map_or(here, part);
        let (gx, gy) = (above.0 + 2 * here.0 + below.0, below.1 - above.1);
        out[end] = if gx * gx + gy * gy >= least_square { 255 } else { 0 };
        (above, here) = (here, below);
    }
}

/// All pixels of a row but its ends.
fn mark_row(processor: Processor, rows: [&[u8]; 3], least_square: i32, out: &mut [u8]) {
    if let (true, Ok(short)) = (least_square <= MOST_SHORT, u16::try_from(least_square)) {
        mark_row_short(processor, rows, short, out);
    } else {
        mark_row_long(processor, rows, least_square, out);
    }
}

/// Calls `mark` with both gradients of every pixel of a row but its ends.
#[inline(always)]
fn for_each_gradient([top, middle, bottom]: [&[u8]; 3], out: &mut [u8], mark: impl Fn(i16, i16) -> u8) {
    if out.len() < 2 {
        return;
    }
    let inner = out.len() - 2;
    // Slices of one known length let the compiler drop the bounds checks and use vectors.
    let (tl, tc, tr) = (&top[..inner], &top[1..=inner], &top[2..inner + 2]);
    let (ml, mr) = (&middle[..inner], &middle[2..inner + 2]);
    let (bl, bc, br) = (&bottom[..inner], &bottom[1..=inner], &bottom[2..inner + 2]);
    let out = &mut out[1..=inner];
    for x in 0..inner {
        let at = |row: &[u8]| i16::from(row[x]);
        let gx = (at(tr) - at(tl)) + 2 * (at(mr) - at(ml)) + (at(br) - at(bl));
        let gy = (at(bl) - at(tl)) + 2 * (at(bc) - at(tc)) + (at(br) - at(tr));
        out[x] = mark(gx, gy);
    }
}

compiled_for_each_processor! {
    /// Thresholds up to 255: a gradient that is cut off there reaches every one of them by itself.
    fn mark_row_short<'a>(rows: [&'a [u8]; 3], least_square: u16, out: &'a mut [u8]) {
        for_each_gradient(rows, out, |gx, gy| {
            let (gx, gy) = (gx.unsigned_abs().min(255), gy.unsigned_abs().min(255));
            if (gx * gx).saturating_add(gy * gy) >= least_square { 255 } else { 0 }
        });
    }
}

compiled_for_each_processor! {
    /// Any threshold.
    fn mark_row_long<'a>(rows: [&'a [u8]; 3], least_square: i32, out: &'a mut [u8]) {
        for_each_gradient(rows, out, |gx, gy| {
            let square = i32::from(gx) * i32::from(gx) + i32::from(gy) * i32::from(gy);
            if square >= least_square { 255 } else { 0 }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that look random (Knuth's MMIX generator).
    struct Numbers(u64);

    impl Numbers {
        fn byte(&mut self) -> u8 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 56) as u8
        }

        /// Noise, or mostly flat with a few steps.
        fn bytes(&mut self, length: usize) -> Vec<u8> {
            let flat = self.byte().is_multiple_of(2);
            let mut last = self.byte();
            let mut next = || {
                if !flat || self.byte() < 20 {
                    last = self.byte();
                }
                last
            };
            (0..length).map(|_| next()).collect()
        }
    }

    fn mark_one(rows: [&[u8]; 3], [left, middle, right]: [usize; 3], least_square: i32) -> u8 {
        let at = |row: usize, column: usize| i32::from(rows[row][column]);
        let gx = at(0, right) - at(0, left) + 2 * (at(1, right) - at(1, left)) + at(2, right) - at(2, left);
        let gy = at(2, left) - at(0, left) + 2 * (at(2, middle) - at(0, middle)) + at(2, right) - at(0, right);
        if gx * gx + gy * gy >= least_square { 255 } else { 0 }
    }

    /// The definition, pixel by pixel.
    fn expected(luma: &[u8], width: usize, least_square: i32) -> Vec<u8> {
        let height = luma.len() / width;
        let row = |y: usize| &luma[y * width..(y + 1) * width];
        let mark = |place: usize| {
            let (x, y) = (place % width, place / width);
            let rows = [row(y.max(1) - 1), row(y), row((y + 1).min(height - 1))];
            mark_one(rows, [x.max(1) - 1, x, (x + 1).min(width - 1)], least_square)
        };
        (0..luma.len()).map(mark).collect()
    }

    #[test]
    fn every_compilation_marks_the_pixels_of_the_definition() {
        let mut numbers = Numbers(1);
        for round in 0..600 {
            let (width, height) = match round % 3 {
                0 => (1 + usize::from(numbers.byte() % 5), 1 + usize::from(numbers.byte() % 5)),
                1 => (1 + usize::from(numbers.byte()), 1 + usize::from(numbers.byte() % 7)),
                _ => (60 + usize::from(numbers.byte() % 10), 30),
            };
            let luma = numbers.bytes(width * height);
            let threshold = [1, 60, 180, 255, 256, 400, 1443][round % 7];
            let least_square = threshold * threshold + i32::from(numbers.byte() % 2);
            let wanted = expected(&luma, width, least_square);
            for processor in Processor::all() {
                let mut out = vec![7; luma.len()];
                mark_edges(processor, &luma, width, least_square, &mut out);
                assert!(out == wanted, "{width}x{height}, {least_square}, {}", processor.name());
            }
        }
    }

    #[test]
    fn every_compilation_weighs_colours_alike() {
        let mut numbers = Numbers(2);
        for pixels in 0..300 {
            let colours = numbers.bytes(3 * pixels);
            let weigh = |colour: &[u8]| {
                ((u32::from(colour[0]) * 77 + u32::from(colour[1]) * 150 + u32::from(colour[2]) * 29) / 256) as u8
            };
            let wanted: Vec<u8> = colours.chunks_exact(3).map(weigh).collect();
            for processor in Processor::all() {
                let mut luma = vec![7; pixels];
                luma_of_colour(processor, &colours, &mut luma);
                assert_eq!(luma, wanted, "{}", processor.name());
            }
        }
    }
}
