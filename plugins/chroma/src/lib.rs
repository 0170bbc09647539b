//! Chroma: marks what has another colour than the floor right in front of the robot, however bright it is.
//!
//! The strip at the bottom middle of the frame is taken to be floor. The shares of red and of blue in its light are the floor's
//! colour; a pixel is marked where its own shares are further off, added up, than `tolerance`. A shadow changes the brightness
//! and not the shares, so that it is not marked; nor is anything grey on a grey floor.
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

/// Shares are counted in parts of this.
const WHOLE: i32 = 4096;

const DESCRIPTOR: Descriptor = Descriptor {
    name: "chroma",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks what has another colour than the floor right in front of the robot, however bright it is.",
    reads: &[Format::Rgb],
    writes: Format::Mask,
    parameters: &[
        Parameter {
            name: "height",
            kind: ParameterKind::Number,
            unit: "share of the height",
            min: 0.01,
            max: 1.0,
            default: 0.15,
            purpose: "The height of the strip that is taken to be floor, from the bottom.",
        },
        Parameter {
            name: "width",
            kind: ParameterKind::Number,
            unit: "share of the width",
            min: 0.01,
            max: 1.0,
            default: 0.5,
            purpose: "The width of the strip, in the middle.",
        },
        Parameter {
            name: "tolerance",
            kind: ParameterKind::Number,
            unit: "share of the light",
            min: 0.005,
            max: 1.0,
            default: 0.06,
            purpose: "How far the shares of red and blue may be off those of the strip, added up.",
        },
    ],
};

struct Chroma {
    height: f64,
    width: f64,
    tolerance: i32,
    processor: Processor,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let (height, width, tolerance) = match values {
        [height, width, tolerance] => (*height, *width, *tolerance),
        _ => return Err(FilterError(format!("chroma takes 3 parameters, not {}", values.len()))),
    };
    let tolerance = (tolerance * f64::from(WHOLE)).round() as i32;
    Ok(Box::new(Chroma { height, width, tolerance, processor: Processor::best() }))
}

/// A share of `length`, rounded, but at least 1.
fn part(share: f64, length: usize) -> usize {
    ((share * length as f64).round() as usize).clamp(1, length)
}

impl Chroma {
    /// The shares of red and blue in the strip, in parts of [`WHOLE`]; a third each if it is black.
    fn floor(&self, input: &Frame<'_>) -> [i32; 2] {
        let (rows, columns) = (part(self.height, input.height_px()), part(self.width, input.width_px()));
        let left = (input.width_px() - columns) / 2;
        let mut sums = [0_u64; 3];
        for row in input.pixels().chunks_exact(input.stride()).skip(input.height_px() - rows) {
            for pixel in row[3 * left..3 * (left + columns)].chunks_exact(3) {
                for (sum, value) in sums.iter_mut().zip(pixel) {
                    *sum += u64::from(*value);
                }
            }
        }
        let all: u64 = sums.iter().sum();
        let share = |sum: u64| (sum * WHOLE as u64 + all / 2).checked_div(all).map_or(WHOLE / 3, |share| share as i32);
        [share(sums[0]), share(sums[2])]
    }
}

impl Filter for Chroma {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if input.format() != Format::Rgb {
            return Err(FilterError("chroma reads colour frames".to_owned()));
        }
        if input.width_px() == 0 || input.height_px() == 0 {
            return Ok(());
        }
        let floor = self.floor(&input);
        mark(self.processor, input.pixels(), output.pixels(), floor, self.tolerance);
        Ok(())
    }
}

compiled_for_each_processor! {
    /// Compares shares without a division: both sides are multiplied by the pixel's own light, which is at most 765, so that
    /// nothing overflows.
    fn mark<'a>(pixels: &'a [u8], out: &'a mut [u8], floor: [i32; 2], tolerance: i32) {
        for (pixel, out) in pixels.chunks_exact(3).zip(out) {
            let [red, green, blue] = [pixel[0], pixel[1], pixel[2]].map(i32::from);
            let light = red + green + blue;
            let off = (WHOLE * red - floor[0] * light).abs() + (WHOLE * blue - floor[1] * light).abs();
            *out = if off > tolerance * light { 255 } else { 0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame two pixels wide, the lower half of which is the strip.
    fn mask(tolerance: f64, pixels: &[[u8; 3]]) -> Vec<u8> {
        let (mut out, height) = (vec![7; pixels.len()], pixels.len() / 2);
        let input = Frame::new(2, height, Format::Rgb, pixels.as_flattened()).unwrap();
        let output = FrameMut::new(2, height, Format::Mask, &mut out).unwrap();
        create(&[0.5, 1.0, tolerance]).unwrap().process(input, output).unwrap();
        out
    }

    #[test]
    fn a_shadow_is_floor_and_another_colour_is_not() {
        // The floor is 40 % red, 40 % green, 20 % blue. (44, 36, 20) is off by 4 % of red; (36, 36, 28) by 4 % and 8 %.
        let floor = [100, 100, 50];
        assert_eq!(mask(0.06, &[[50, 50, 25], [36, 36, 28], floor, floor]), [0, 255, 0, 0]);
        assert_eq!(mask(0.06, &[[44, 36, 20], [20, 20, 10], floor, floor]), [0; 4]);
        assert_eq!(mask(0.03, &[[44, 36, 20], [20, 20, 10], floor, floor]), [255, 0, 0, 0]);
    }

    #[test]
    fn black_has_no_colour_and_a_black_strip_is_grey() {
        assert_eq!(mask(0.06, &[[0; 3], [9, 9, 9], [90; 3], [90; 3]]), [0; 4]);
        assert_eq!(mask(0.06, &[[255, 0, 0], [77; 3], [0; 3], [0; 3]]), [255, 0, 0, 0]);
    }

    #[test]
    fn every_processor_marks_the_same_pixels() {
        let pixels: Vec<u8> = (0..3 * 77_u32).map(|index| (index * 89 % 251) as u8).collect();
        let of = |processor| {
            let mut out = [7; 77];
            mark(processor, &pixels, &mut out, [1400, 1300], 400);
            out
        };
        assert!(Processor::all().into_iter().all(|processor| of(processor) == of(Processor::PORTABLE)));
    }
}
