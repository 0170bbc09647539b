//! The inner loop: whole numbers only, compiled for each processor.

use dispatch::{Processor, compiled_for_each_processor};

/// Marks the pixels of a grey frame, at least one, whose squared gradient reaches `least_square`.
pub(crate) fn mark_edges(processor: Processor, luma: &[u8], width: usize, least_square: i32, out: &mut [u8]) {
    let height = luma.len() / width;
    let row = |y: usize| &luma[y * width..(y + 1) * width];
    for (y, out) in out.chunks_exact_mut(width).enumerate() {
        let rows = [row(y.max(1) - 1), row(y), row((y + 1).min(height - 1))];
        mark_inner(processor, rows, least_square, out);
        for x in [0, width - 1] {
            let columns = [x.max(1) - 1, x, (x + 1).min(width - 1)];
            out[x] = mark(rows.map(|row| columns.map(|column| row[column])), least_square);
        }
    }
}

compiled_for_each_processor! {
    /// All pixels of a row but its ends.
    fn mark_inner<'a>(rows: [&'a [u8]; 3], least_square: i32, out: &'a mut [u8]) {
        if out.len() < 3 {
            return;
        }
        let inner = out.len() - 2;
        // Slices of one known length let the compiler drop the bounds checks and use vectors.
        let [top, middle, bottom] = rows.map(|row| [&row[..inner], &row[1..=inner], &row[2..inner + 2]]);
        let out = &mut out[1..=inner];
        for x in 0..inner {
            let at = |row: [&[u8]; 3]| [row[0][x], row[1][x], row[2][x]];
            out[x] = mark([at(top), at(middle), at(bottom)], least_square);
        }
    }
}

/// The mark of a pixel among its neighbours. A gradient is at most 16 * 255, so neither norm nor gradient overflows.
#[inline(always)]
fn mark([top, middle, bottom]: [[u8; 3]; 3], least_square: i32) -> u8 {
    let rise = |from: u8, to: u8| i16::from(to) - i16::from(from);
    let gx = 3 * rise(top[0], top[2]) + 10 * rise(middle[0], middle[2]) + 3 * rise(bottom[0], bottom[2]);
    let gy = 3 * rise(top[0], bottom[0]) + 10 * rise(top[1], bottom[1]) + 3 * rise(top[2], bottom[2]);
    let square = i32::from(gx) * i32::from(gx) + i32::from(gy) * i32::from(gy);
    if square >= least_square { 255 } else { 0 }
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

        /// Noise, the range of which is another one each time.
        fn bytes(&mut self, length: usize) -> Vec<u8> {
            let most = self.byte();
            (0..length).map(|_| (u16::from(self.byte()) * u16::from(most) / 255) as u8).collect()
        }
    }

    const ACROSS: [[i64; 3]; 3] = [[-3, 0, 3], [-10, 0, 10], [-3, 0, 3]];
    const DOWN: [[i64; 3]; 3] = [[-3, -10, -3], [0, 0, 0], [3, 10, 3]];

    /// The definition: a frame correlated with a matrix, the nearest pixel standing for one outside.
    fn gradient(luma: &[u8], width: usize, weights: [[i64; 3]; 3]) -> Vec<i64> {
        let height = luma.len() / width;
        let near = |at: usize, shift: usize, length: usize| (at + shift).max(1).min(length) - 1;
        let one = |place: usize| -> i64 {
            let each = (0..9).map(|index| (index / 3, index % 3));
            each.map(|(down, across)| {
                let (x, y) = (near(place % width, across, width), near(place / width, down, height));
                weights[down][across] * i64::from(luma[y * width + x])
            })
            .sum()
        };
        (0..luma.len()).map(one).collect()
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
            let threshold = [1, 90, 240, 700, 1600, 3000, 5770][round % 7];
            let least_square = threshold * threshold + i32::from(numbers.byte() % 2);
            let both = gradient(&luma, width, ACROSS).into_iter().zip(gradient(&luma, width, DOWN));
            let wanted: Vec<u8> =
                both.map(|(gx, gy)| if gx * gx + gy * gy >= i64::from(least_square) { 255 } else { 0 }).collect();
            for processor in Processor::all() {
                let mut out = vec![7; luma.len()];
                mark_edges(processor, &luma, width, least_square, &mut out);
                assert!(out == wanted, "{width}x{height}, {least_square}, {}", processor.name());
            }
        }
    }
}
