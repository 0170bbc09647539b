//! What colours are painted on: colour pixels, or weighted sums of colours that become brightness.
//!
//! A stretch may be painted too long, since what follows is painted afterwards; so every write has a fixed length.

use super::pattern::BATCH;
use super::texture::{LEVELS, Looks, PATTERN_PX, Shades, TextureLook};
use std::ops::Range;

/// Something to paint on, pixels numbered row by row.
pub(super) trait PixelCanvas {
    /// Paints pixels in the plain colour of a look, and perhaps some after them.
    fn fill(&mut self, look: &TextureLook, pixels: Range<usize>);

    /// Paints `count` pixels from number `first` on, each in a colour of the look's palette, and perhaps some after them.
    fn spots(&mut self, looks: &Looks, look: &TextureLook, first: usize, count: usize, indices: &[u8; BATCH]);

    /// Paints such pixels in colours of a look that shadows fall on: how many eighths of the sun are hidden
    /// from each, and its place in the look's palette.
    fn shaded(&mut self, shades: &Shades, first: usize, count: usize, hidden: &[u8; BATCH], indices: &[u8; BATCH]);
}

/// Three bytes for each pixel.
pub(super) struct Colours<'a>(pub(super) &'a mut [u8]);

impl PixelCanvas for Colours<'_> {
    #[inline(always)]
    fn fill(&mut self, look: &TextureLook, pixels: Range<usize>) {
        write_over(self.0, &look.pattern, 3 * pixels.start..3 * pixels.end);
    }

    #[inline(always)]
    fn spots(&mut self, looks: &Looks, look: &TextureLook, first: usize, count: usize, indices: &[u8; BATCH]) {
        let palette = looks.palette(look);
        for (place, &index) in indices[..count].iter().enumerate() {
            let byte = (first + place) * 3;
            let colour = palette[usize::from(index)];
            if let Some(pixel) = self.0.get_mut(byte..byte + 4) {
                pixel.copy_from_slice(&colour);
            } else if let Some(pixel) = self.0.get_mut(byte..byte + 3) {
                pixel.copy_from_slice(&colour[..3]);
            }
        }
    }

    #[inline(always)]
    fn shaded(&mut self, shades: &Shades, first: usize, count: usize, hidden: &[u8; BATCH], indices: &[u8; BATCH]) {
        let [least, step] = shades.offsets;
        let pixels = self.0[3 * first..].chunks_exact_mut(3);
        for ((pixel, hidden), index) in pixels.zip(&hidden[..count]).zip(indices) {
            let colour = shades.colours[usize::from(*hidden).min(LEVELS - 1)];
            let by = least + step * i16::from(*index);
            for (channel, level) in pixel.iter_mut().zip(colour) {
                *channel = (i16::from(level) + by).clamp(0, 255) as u8;
            }
        }
    }
}

/// For each pixel the weighted sum of its channels, 256 times its luma.
pub(super) struct Weights<'a>(pub(super) &'a mut [u16]);

impl PixelCanvas for Weights<'_> {
    #[inline(always)]
    fn fill(&mut self, look: &TextureLook, pixels: Range<usize>) {
        write_over(self.0, &[look.weight; 2 * PATTERN_PX], pixels);
    }

    #[inline(always)]
    fn spots(&mut self, _: &Looks, look: &TextureLook, first: usize, count: usize, indices: &[u8; BATCH]) {
        let [start, step] = look.weights;
        for (pixel, index) in self.0[first..first + count].iter_mut().zip(indices) {
            *pixel = start.wrapping_add(step.wrapping_mul(u16::from(*index)));
        }
    }

    #[inline(always)]
    fn shaded(&mut self, shades: &Shades, first: usize, count: usize, hidden: &[u8; BATCH], indices: &[u8; BATCH]) {
        let [least, step] = shades.offsets;
        let mut weights = [0; BATCH];
        for ((weight, hidden), index) in weights.iter_mut().zip(hidden).zip(indices) {
            // A grey level more in every channel is 256 more.
            let by = least.wrapping_add(step.wrapping_mul(i16::from(*index))).wrapping_shl(8);
            *weight = shades.weights[usize::from(*hidden).min(LEVELS - 1)].wrapping_add_signed(by);
        }
        self.write(first, count, &weights);
    }
}

impl Weights<'_> {
    #[inline(always)]
    fn write(&mut self, first: usize, count: usize, weights: &[u16; BATCH]) {
        if let Some(pixels) = self.0.get_mut(first..first + BATCH) {
            pixels.copy_from_slice(weights);
        } else {
            self.0[first..first + count].copy_from_slice(&weights[..count]);
        }
    }
}

/// Repeats `pattern` until `range` is covered, and beyond it where the memory has room.
#[inline(always)]
fn write_over<T: Copy, const LENGTH: usize>(memory: &mut [T], pattern: &[T; LENGTH], range: Range<usize>) {
    let wanted = range.len().div_ceil(LENGTH);
    let (parts, rest) = memory[range.start..].as_chunks_mut();
    let whole = wanted.min(parts.len());
    for part in &mut parts[..whole] {
        *part = *pattern;
    }
    if whole < wanted {
        rest.copy_from_slice(&pattern[..rest.len()]);
    }
}
