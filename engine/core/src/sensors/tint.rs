//! Exposure and white balance that wander slowly over the images of a run.

use super::noise;
use crate::random::normal_table;
use crate::settings::CameraSettings;
use dispatch::{Processor, compiled_for_each_processor};

/// Images from one drawn value to the next; between them the drift goes evenly.
const IMAGES: u64 = 40;
/// Deviations of what lies evenly between two independent draws, averaged over the way, are less than 1 by the root of 2 / 3.
const SPREAD: f64 = 1.224_744_871_391_589;
/// A factor of 1.
const ONE: u16 = 256;

/// How the brightness of whole images, and of red against blue, wanders.
#[derive(Debug, Clone)]
pub(super) struct Drift {
    seed: u64,
    exposure: f64,
    white_balance: f64,
}

impl Drift {
    /// A drift by a camera's settings; nothing if they ask for none.
    pub(super) fn new(settings: &CameraSettings, seed: u64) -> Option<Self> {
        let (exposure, white_balance) = (settings.exposure_drift, settings.white_balance_drift);
        (exposure > 0.0 || white_balance > 0.0).then_some(Self { seed, exposure, white_balance })
    }

    /// Multiplies the channels of an image with this number.
    pub(super) fn tint(&self, processor: Processor, frame: u64, pixels: &mut [u8]) {
        multiply(processor, pixels, self.factors(frame));
    }

    /// What red, green and blue are multiplied with, in 256ths.
    fn factors(&self, frame: u64) -> [u16; 3] {
        let exposure = 1.0 + self.exposure * self.wander(frame, 0);
        let balance = self.white_balance * self.wander(frame, 1);
        [1.0 + balance, 1.0, 1.0 - balance]
            .map(|share| (f64::from(ONE) * exposure * share).round().clamp(25.0, 2560.0) as u16)
    }

    /// A value with mean 0 and deviation 1 over the images of a run, addressed by the image's number.
    fn wander(&self, frame: u64, which: u64) -> f64 {
        let knot = |number: u64| {
            // Above all rows of pixel noise.
            f64::from(normal_table()[noise::start(self.seed, number, u64::MAX - which)])
        };
        let (number, share) = (frame / IMAGES, (frame % IMAGES) as f64 / IMAGES as f64);
        SPREAD * (knot(number) * (1.0 - share) + knot(number + 1) * share)
    }
}

compiled_for_each_processor! {
    /// Multiplies red, green and blue with 256ths, within 0 to 255.
    fn multiply<'a>(pixels: &'a mut [u8], factors: [u16; 3]) {
        // Sixteen pixels at once, so that every byte has its own factor.
        let mut each = [0_u16; 48];
        for (factor, value) in each.iter_mut().zip(factors.iter().cycle()) {
            *factor = *value;
        }
        for chunk in pixels.chunks_mut(48) {
            for (byte, factor) in chunk.iter_mut().zip(&each) {
                let product = (u32::from(*byte) * u32::from(*factor) + 128) >> 8;
                *byte = product.min(255) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    fn drift(exposure_drift: f64, white_balance_drift: f64) -> Option<Drift> {
        let settings = CameraSettings { exposure_drift, white_balance_drift, ..Settings::default().camera };
        Drift::new(&settings, 7)
    }

    #[test]
    fn a_camera_that_asks_for_no_drift_has_none() {
        assert!(drift(0.0, 0.0).is_none());
    }

    #[test]
    fn brightness_wanders_slowly_about_its_own_with_the_deviation_that_was_asked_for() {
        let drift = drift(0.1, 0.0).unwrap();
        let greens: Vec<f64> = (0..40_000).map(|frame| f64::from(drift.factors(frame)[1]) / 256.0).collect();
        let mean = greens.iter().sum::<f64>() / 40_000.0;
        let deviation = (greens.iter().map(|green| (green - mean).powi(2)).sum::<f64>() / 40_000.0).sqrt();
        // A thousand independent draws: 0.1 within a tenth, the mean within four times 0.1 / 31.
        assert!((mean - 1.0).abs() < 0.013 && (deviation - 0.1).abs() < 0.01, "{mean} {deviation}");
        // From one image to the next never more than a fortieth of the way between two draws, which are within 9 deviations.
        assert!(greens.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.1 * 9.0 / 40.0 + 1.0 / 256.0));
    }

    #[test]
    fn white_balance_moves_red_and_blue_apart_and_leaves_green() {
        let drift = drift(0.0, 0.2).unwrap();
        for frame in [3, 500, 9_999] {
            let [red, green, blue] = drift.factors(frame).map(i32::from);
            assert!(green == 256 && (red + blue - 512).abs() <= 1, "{red} {blue}");
        }
    }

    #[test]
    fn every_compilation_multiplies_alike_and_stops_at_white() {
        for processor in Processor::all() {
            let mut pixels = [100, 100, 200].repeat(33);
            multiply(processor, &mut pixels, [128, 256, 400]);
            // 200 x 400 / 256 is 312.5: white.
            assert_eq!(pixels, [50, 100, 255].repeat(33), "{}", processor.name());
        }
    }
}
