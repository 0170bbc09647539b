//! One colour: a mask of the pixels whose hue and saturation match, however bright they are.
//!
//! The paper thresholds the red value alone, which fails as soon as the light changes. This filter compares *ratios* of
//! the channels, which a change of brightness leaves as they are: with `max` and `min` of a pixel's red, green and blue,
//! saturation is `(max - min) / max` and hue the usual angle on the colour circle (red 0°, green 120°, blue 240°). A
//! pixel matches where its saturation is at least `saturation`, its hue at most `width_deg` away from `hue_deg`, and it
//! is at least `dark` bright, since nearly black pixels have no reliable hue.
//!
//! All arithmetic is on whole numbers, so every machine marks the same pixels.

#![deny(unsafe_code)]

use dispatch::{Processor, compiled_for_each_processor};
use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

const DESCRIPTOR: Descriptor = Descriptor {
    name: "colour",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks the pixels of one colour, whatever their brightness (hue and saturation).",
    reads: &[Format::Rgb],
    writes: Format::Mask,
    parameters: &[
        Parameter {
            name: "hue_deg",
            kind: ParameterKind::Number,
            unit: "degrees",
            min: 0.0,
            max: 360.0,
            default: 0.0,
            purpose: "The hue to look for: red 0, yellow 60, green 120, blue 240.",
        },
        Parameter {
            name: "width_deg",
            kind: ParameterKind::Number,
            unit: "degrees",
            min: 1.0,
            max: 180.0,
            default: 25.0,
            purpose: "How far the hue may be off on either side.",
        },
        Parameter {
            name: "saturation",
            kind: ParameterKind::Number,
            unit: "share",
            min: 0.01,
            max: 1.0,
            default: 0.4,
            purpose: "How pure the colour must be; grey has 0.",
        },
        Parameter {
            name: "dark",
            kind: ParameterKind::Number,
            unit: "grey levels",
            min: 1.0,
            max: 255.0,
            default: 20.0,
            purpose: "Pixels whose brightest channel is below this are never marked.",
        },
    ],
};

/// Hue is counted in 1/256 of a sixth of the circle: 0 to 1535.
const CIRCLE: f32 = 6.0 * 256.0;

/// Whole numbers.
struct Colour {
    hue: f32,
    width: f32,
    /// Saturation in 1/256.
    saturation: f32,
    dark: f32,
    processor: Processor,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let (hue_deg, width_deg, saturation, dark) = match values {
        [hue_deg, width_deg, saturation, dark] => (hue_deg, width_deg, saturation, dark),
        _ => return Err(FilterError(format!("colour takes 4 parameters, not {}", values.len()))),
    };
    let steps = |degrees: f64| (degrees * f64::from(CIRCLE) / 360.0).round() as f32;
    Ok(Box::new(Colour {
        hue: steps(*hue_deg) % CIRCLE,
        width: steps(*width_deg),
        saturation: (saturation * 256.0).round() as f32,
        dark: dark.round() as f32,
        processor: Processor::best(),
    }))
}

impl Colour {
    /// Without a branch, so that many pixels are compared at once. Every number here is whole, and small enough to be
    /// exact; so is the quotient when cut off: it is at most 256, and if not whole, at least 1/255 away from a whole one.
    #[inline(always)]
    fn matches(&self, [red, green, blue]: [f32; 3]) -> bool {
        let greater = |a: f32, b: f32| if a > b { a } else { b };
        let max = greater(greater(red, green), blue);
        let spread = max + greater(greater(-red, -green), -blue);
        let (base, difference) = if max == red {
            (0.0, green - blue)
        } else if max == green {
            (512.0, blue - red)
        } else {
            (1024.0, red - green)
        };
        let hue = base + (difference * 256.0 / spread).trunc();
        let apart = (hue - self.hue).abs();
        let other_way = (CIRCLE - apart).abs();
        // Grey has no hue: it is no number, and near to nothing.
        let near = (apart <= self.width) | (other_way <= self.width);
        near & (max >= self.dark) & (spread * 256.0 >= self.saturation * max)
    }
}

compiled_for_each_processor! {
    /// Marks the pixels that match.
    fn mark<'a>(colour: &'a Colour, pixels: &'a [u8], out: &'a mut [u8]) {
        for (pixel, out) in pixels.chunks_exact(3).zip(out) {
            let matches = colour.matches([pixel[0], pixel[1], pixel[2]].map(f32::from));
            *out = if matches { 255 } else { 0 };
        }
    }
}

impl Filter for Colour {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if input.format() != Format::Rgb {
            return Err(FilterError("colour reads colour frames only".to_owned()));
        }
        mark(self.processor, self, input.pixels(), output.pixels());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(values: &[f64; 4], pixels: &[u8]) -> Vec<u8> {
        let count = pixels.len() / 3;
        let mut out = vec![7; count];
        let input = Frame::new(count, 1, Format::Rgb, pixels).unwrap();
        let output = FrameMut::new(count, 1, Format::Mask, &mut out).unwrap();
        create(values).unwrap().process(input, output).unwrap();
        out
    }

    const RED: [f64; 4] = [0.0, 25.0, 0.4, 20.0];

    #[test]
    fn red_is_found_at_full_half_and_a_fifth_of_the_light() {
        assert_eq!(mask(&RED, &[220, 40, 30, 110, 20, 15, 44, 8, 6]), [255, 255, 255]);
    }

    #[test]
    fn grey_orange_green_and_black_are_not_red() {
        assert_eq!(mask(&RED, &[200, 200, 200, 230, 140, 20, 20, 220, 30, 8, 0, 0]), [0, 0, 0, 0]);
    }

    #[test]
    fn hues_on_both_sides_of_zero_count_as_red() {
        // (200, 40, 0) has a hue of 12 degrees, (200, 0, 40) of 348.
        assert_eq!(mask(&RED, &[200, 40, 0, 200, 0, 40]), [255, 255]);
    }

    /// The definition in whole numbers.
    fn is_marked([hue, width, saturation, dark]: [i32; 4], [red, green, blue]: [i32; 3]) -> bool {
        let max = red.max(green).max(blue);
        let spread = max - red.min(green).min(blue);
        if max < dark || spread * 256 < saturation * max || spread == 0 {
            return false;
        }
        let found = if max == red {
            (green - blue) * 256 / spread
        } else if max == green {
            512 + (blue - red) * 256 / spread
        } else {
            1024 + (red - green) * 256 / spread
        };
        let apart = (found - hue).rem_euclid(1536);
        apart.min(1536 - apart) <= width
    }

    #[test]
    fn every_compilation_marks_the_pixels_of_the_definition() {
        let mut number = 1_u64;
        let mut next = |below: u64| {
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((number >> 33) % below) as i32
        };
        for _ in 0..300 {
            let [hue, width] = [next(1536), next(768)];
            let [saturation, dark] = [3 + next(254), 1 + next(100)];
            // Few different levels, so that many hues lie on the very edge.
            let levels = 2 + next(254) as u64;
            let pixels: Vec<u8> = (0..3 * 500).map(|_| next(levels) as u8).collect();
            let wanted: Vec<u8> = pixels
                .chunks_exact(3)
                .map(|pixel| [pixel[0], pixel[1], pixel[2]].map(i32::from))
                .map(|pixel| if is_marked([hue, width, saturation, dark], pixel) { 255 } else { 0 })
                .collect();
            let [hue, width, saturation, dark] = [hue, width, saturation, dark].map(|number| number as f32);
            for processor in Processor::all() {
                let mut out = vec![7; 500];
                mark(processor, &Colour { hue, width, saturation, dark, processor }, &pixels, &mut out);
                assert_eq!(out, wanted, "{}", processor.name());
            }
        }
    }

    #[test]
    fn another_hue_is_a_parameter() {
        let blue = [240.0, 20.0, 0.5, 20.0];
        assert_eq!(mask(&blue, &[10, 20, 200, 200, 10, 20]), [255, 0]);
    }
}
