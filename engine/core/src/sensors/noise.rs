//! Sensor noise addressed by seed, frame and row, so that it depends on nothing that was drawn before.

use super::luma::weighted_noise;
use crate::random::{NORMAL_STARTS, normal_table};
use dispatch::{Processor, compiled_for_each_processor};

/// Where a run of draws starts in the table of normal draws.
pub(super) fn start(seed: u64, frame: u64, row: u64) -> usize {
    let hash = mixed(mixed(mixed(seed) ^ frame) ^ row);
    (hash % NORMAL_STARTS as u64) as usize
}

/// A step of SplitMix64 (Steele, Lea and Flood 2014).
pub(super) fn mixed(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Pixel noise in whole grey levels.
#[derive(Debug, Clone)]
pub(super) struct PixelNoise {
    seed: u64,
    /// Each draw is the sum of one entry of both; the second is empty while one byte holds every draw.
    levels: Vec<i8>,
    rest: Vec<i8>,
    /// What three draws from each place on add to the weighted sum of a pixel's channels, first of every third place,
    /// so that neighbours in a row are neighbours here. Empty for loud noise.
    weighted: [Vec<i16>; 3],
    most: u8,
}

impl PixelNoise {
    /// Noise with a deviation in grey levels; none if it is 0.
    pub(super) fn new(deviation: f64, seed: u64) -> Option<Self> {
        if deviation <= 0.0 {
            return None;
        }
        // Beyond a full byte nothing changes: the pixel is black or white.
        let draws: Vec<i16> = normal_table()
            .iter()
            .map(|draw| (f64::from(*draw) * deviation).round().clamp(-254.0, 254.0) as i16)
            .collect();
        let loud = draws.iter().any(|draw| draw.abs() > 127);
        let levels = draws.iter().map(|draw| if loud { draw / 2 } else { *draw } as i8).collect();
        let rest = if loud { draws.iter().map(|draw| (draw - draw / 2) as i8).collect() } else { Vec::new() };
        let most = draws.iter().map(|draw| draw.unsigned_abs() as u8).max().unwrap_or(0);
        let from =
            |first: usize| if loud { Vec::new() } else { draws[first..].chunks_exact(3).map(weighted_noise).collect() };
        Some(Self { seed, levels, rest, weighted: [from(0), from(1), from(2)], most })
    }

    /// The most that is added to a byte or taken from it.
    pub(super) fn most(&self) -> u8 {
        self.most
    }

    /// What the noise of one frame adds to the weighted sums of a row's pixels; nothing for loud noise.
    pub(super) fn of_row(&self, frame: u64, row: usize) -> &[i16] {
        let start = start(self.seed, frame, row as u64);
        self.weighted[start % 3].get(start / 3..).unwrap_or_default()
    }

    /// Adds the noise of one frame to its pixels, row by row, `row_bytes` each.
    pub(super) fn add(&self, processor: Processor, frame: u64, pixels: &mut [u8], row_bytes: usize) {
        for (row, bytes) in pixels.chunks_exact_mut(row_bytes).enumerate() {
            let start = start(self.seed, frame, row as u64);
            add_saturating(processor, bytes, &self.levels[start..]);
            if !self.rest.is_empty() {
                add_saturating(processor, bytes, &self.rest[start..]);
            }
        }
    }
}

compiled_for_each_processor! {
    /// Adds within 0 to 255. Flipping the top bit maps that range to -128 to 127, where the saturating sum is one
    /// instruction.
    fn add_saturating<'a>(bytes: &'a mut [u8], levels: &'a [i8]) {
        for (byte, level) in bytes.iter_mut().zip(levels) {
            *byte = ((*byte ^ 0x80) as i8).saturating_add(*level) as u8 ^ 0x80;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_stay_within_a_byte() {
        for processor in Processor::all() {
            let mut bytes = [0, 5, 128, 250, 255].repeat(20);
            add_saturating(processor, &mut bytes, &[-3, -3, -3, 9, 9].repeat(20));
            assert_eq!(bytes, [0, 2, 125, 255, 255].repeat(20), "{}", processor.name());
        }
    }

    #[test]
    fn loud_noise_is_not_cut_at_half_the_range() {
        let noise = PixelNoise::new(64.0, 1).unwrap();
        let mut pixels = vec![128; 3 * 1280 * 40];
        noise.add(Processor::best(), 0, &mut pixels, 3 * 1280);
        let dark = pixels.iter().filter(|pixel| **pixel == 0).count() as f64 / pixels.len() as f64;
        // P(draw < -127.5 / 64) of the normal distribution is 2.3 %.
        assert!((dark - 0.023).abs() < 0.004, "{dark}");
    }

    #[test]
    fn neighbouring_frames_rows_and_seeds_start_elsewhere() {
        assert_ne!(start(1, 2, 3), start(1, 2, 4));
        assert_ne!(start(1, 2, 3), start(1, 3, 3));
        assert_ne!(start(1, 2, 3), start(2, 2, 3));
    }
}
