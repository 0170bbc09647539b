//! Brightness of pixels: whole numbers only, compiled for each processor.
//!
//! A weighted sum is 256 times a luma: `77 R + 150 G + 29 B`, as filters weigh colours.

use dispatch::compiled_for_each_processor;

/// The weighted sum of a colour.
pub(super) fn weight([red, green, blue]: [u8; 3]) -> u16 {
    u16::from(red) * 77 + u16::from(green) * 150 + u16::from(blue) * 29
}

/// What three noise levels add to a weighted sum.
pub(super) fn weighted_noise(levels: &[i16]) -> i16 {
    levels[0] * 77 + levels[1] * 150 + levels[2] * 29
}

compiled_for_each_processor! {
    /// Luma of RGB pixels.
    pub(super) fn of_colours<'a>(pixels: &'a [u8], luma: &'a mut [u8]) {
        for (pixel, luma) in pixels.chunks_exact(3).zip(luma) {
            *luma = (weight([pixel[0], pixel[1], pixel[2]]) >> 8) as u8;
        }
    }
}

compiled_for_each_processor! {
    /// Luma of weighted sums.
    pub(super) fn of_weights<'a>(weights: &'a [u16], luma: &'a mut [u8]) {
        for (luma, weight) in luma.iter_mut().zip(weights) {
            *luma = (weight >> 8) as u8;
        }
    }
}

compiled_for_each_processor! {
    /// Luma of weighted sums and the noise on them, where no byte of the colours behind them leaves its range.
    pub(super) fn of_noisy_weights<'a>(weights: &'a [u16], noise: &'a [i16], luma: &'a mut [u8]) {
        for ((luma, weight), noise) in luma.iter_mut().zip(weights).zip(noise) {
            *luma = (weight.wrapping_add_signed(*noise) >> 8) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Random, Stream};
    use dispatch::Processor;
    use filter_api::{Format, Frame};

    #[test]
    fn every_compilation_gives_the_luma_that_filters_see() {
        let mut random = Random::new(1, Stream::Test);
        for pixels in (1..200).chain([1280]) {
            let mut level = |low, high| random.between(low, high) as i16;
            let (plain, noise): (Vec<i16>, Vec<i16>) =
                (0..3 * pixels).map(|_| (level(9.0, 247.0), level(-9.0, 9.9))).unzip();
            let noisy: Vec<u8> = plain.iter().zip(&noise).map(|(plain, noise)| (plain + noise) as u8).collect();
            let mut wanted = vec![0; pixels];
            Frame::new(pixels, 1, Format::Rgb, &noisy).unwrap().write_luma(&mut wanted).unwrap();
            let colours =
                |bytes: &[u8]| -> Vec<u16> { bytes.chunks_exact(3).map(|c| weight([c[0], c[1], c[2]])).collect() };
            let plain: Vec<u8> = plain.iter().map(|level| *level as u8).collect();
            let noise: Vec<i16> = noise.chunks_exact(3).map(weighted_noise).collect();
            for processor in Processor::all() {
                let mut luma = vec![[7; 3]; pixels].concat();
                of_colours(processor, &noisy, &mut luma[..pixels]);
                of_weights(processor, &colours(&noisy), &mut luma[pixels..2 * pixels]);
                of_noisy_weights(processor, &colours(&plain), &noise, &mut luma[2 * pixels..]);
                assert_eq!(luma, wanted.repeat(3), "{}", processor.name());
            }
        }
    }
}
