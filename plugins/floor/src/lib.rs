//! Floor: marks what does not look like the ground right in front of the robot.
//!
//! The strip at the bottom middle of the frame is taken to be floor. Of each channel its mean and deviation are computed
//! in this strip; a pixel is marked where any channel is more than `tolerance` deviations away from the mean. A deviation
//! counts as at least [`LEAST_DEVIATION`], so that a floor of one plain colour is recognised too. Nothing is remembered:
//! each frame is compared with its own strip. With `memory` it is another filter: see `memory`.
//!
//! All arithmetic is on whole numbers, so every machine marks the same pixels.

#![deny(unsafe_code)]

mod memory;

use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

/// The least deviation of a channel, grey levels.
pub const LEAST_DEVIATION: u64 = 2;

const DESCRIPTOR: Descriptor = Descriptor {
    name: "floor",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks what does not look like the floor right in front of the robot.",
    reads: &[Format::Rgb, Format::Grey],
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
            unit: "deviations",
            min: 0.5,
            max: 50.0,
            default: 4.0,
            purpose: "How far a channel may be off the mean of the strip.",
        },
        Parameter {
            name: "memory",
            kind: ParameterKind::Switch,
            unit: "on or off",
            min: 0.0,
            max: 1.0,
            default: 0.0,
            purpose: "Whether it learns which greys are floor from what the robot drives over.",
        },
        Parameter {
            name: "levels",
            kind: ParameterKind::Whole,
            unit: "grey levels",
            min: 0.0,
            max: 64.0,
            default: 6.0,
            purpose: "With `memory`: greys so near to one another are one grey.",
        },
        Parameter {
            name: "rare",
            kind: ParameterKind::Number,
            unit: "share of the floor",
            min: 0.0001,
            max: 0.5,
            default: 0.03,
            purpose: "With `memory`: a grey is floor if so much of the floor has it.",
        },
    ],
};

struct Floor {
    height: f64,
    width: f64,
    /// Tolerance in 1/256 of a deviation.
    tolerance: u64,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let (height, width, tolerance) = match values {
        [height, width, _, memory, levels, rare] if *memory != 0.0 => {
            return Ok(Box::new(memory::FloorMemory::new([*height, *width], *levels as usize, *rare)));
        }
        [height, width, tolerance, _, _, _] => (height, width, tolerance),
        _ => return Err(FilterError(format!("floor takes 6 parameters, not {}", values.len()))),
    };
    Ok(Box::new(Floor { height: *height, width: *width, tolerance: (tolerance * 256.0).round() as u64 }))
}

/// The values of one channel in the strip, added up.
#[derive(Debug, Clone, Copy, Default)]
struct Look {
    count: u64,
    sum: u64,
    squares: u64,
}

impl Look {
    fn add(&mut self, value: u8) {
        let value = u64::from(value);
        self.count += 1;
        self.sum += value;
        self.squares += value * value;
    }

    /// For each value of the channel whether it is too far off: 255 if so, 0 if not.
    fn foreign(&self, tolerance: u64) -> [u8; 256] {
        // Mean and variance times the count, so that nothing is divided and nothing rounded.
        let variance = u128::from(self.count) * u128::from(self.squares) - u128::from(self.sum) * u128::from(self.sum);
        let least = u128::from(self.count * LEAST_DEVIATION).pow(2);
        let limit = variance.max(least) * u128::from(tolerance).pow(2);
        let mut table = [0; 256];
        for (value, entry) in (0_u64..).zip(&mut table) {
            let apart = u128::from((value * self.count).abs_diff(self.sum));
            *entry = if (apart * 256).pow(2) > limit { 255 } else { 0 };
        }
        table
    }
}

/// A share of `length`, rounded, but at least 1.
fn part(share: f64, length: usize) -> usize {
    ((share * length as f64).round() as usize).clamp(1, length)
}

impl Floor {
    /// How the strip looks; a grey frame fills only the first channel.
    fn looks(&self, input: &Frame<'_>) -> [Look; 3] {
        let channels = input.format().channels();
        let rows = part(self.height, input.height_px());
        let columns = part(self.width, input.width_px());
        let left = (input.width_px() - columns) / 2;
        let mut looks = [Look::default(); 3];
        for row in input.pixels().chunks_exact(input.stride()).skip(input.height_px() - rows) {
            for pixel in row[left * channels..(left + columns) * channels].chunks_exact(channels) {
                for (look, value) in looks.iter_mut().zip(pixel) {
                    look.add(*value);
                }
            }
        }
        looks
    }
}

impl Filter for Floor {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if matches!(input.format(), Format::Mask | Format::Depth) {
            return Err(FilterError("floor reads colour or grey frames".to_owned()));
        }
        if input.width_px() == 0 || input.height_px() == 0 {
            return Ok(());
        }
        let [first, second, third] = self.looks(&input).map(|look| look.foreign(self.tolerance));
        if input.format() == Format::Grey {
            for (value, out) in input.pixels().iter().zip(output.pixels()) {
                *out = first[usize::from(*value)];
            }
        } else {
            for (pixel, out) in input.pixels().chunks_exact(3).zip(output.pixels()) {
                let foreign = |table: &[u8; 256], channel: usize| table[usize::from(pixel[channel])];
                *out = foreign(&first, 0) | foreign(&second, 1) | foreign(&third, 2);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(values: &[f64; 3], width: usize, height: usize, format: Format, pixels: &[u8]) -> Vec<u8> {
        let mut out = vec![7; width * height];
        let input = Frame::new(width, height, format, pixels).unwrap();
        let output = FrameMut::new(width, height, Format::Mask, &mut out).unwrap();
        let values = [&values[..], &[0.0, 6.0, 0.03]].concat();
        create(&values).unwrap().process(input, output).unwrap();
        out
    }

    #[test]
    fn a_plain_floor_has_a_deviation_of_2() {
        // Strip: the bottom row, all 100. Tolerance 3: up to 6 levels off is floor.
        let grey = [94, 106, 93, 107, 100, 100, 100, 100];
        assert_eq!(mask(&[0.5, 1.0, 3.0], 4, 2, Format::Grey, &grey), [0, 0, 255, 255, 0, 0, 0, 0]);
    }

    #[test]
    fn a_patterned_floor_has_the_deviation_of_its_pattern() {
        // Strip: 90, 110, 90, 110: mean 100, deviation 10. Tolerance 2: 80 to 120 is floor.
        let grey = [80, 120, 79, 121, 90, 110, 90, 110];
        assert_eq!(mask(&[0.5, 1.0, 2.0], 4, 2, Format::Grey, &grey), [0, 0, 255, 255, 0, 0, 0, 0]);
    }

    #[test]
    fn the_strip_is_the_bottom_middle() {
        // Half of the width: the two middle pixels of the bottom row.
        let grey = [9, 9, 9, 9, 9, 50, 50, 9];
        assert_eq!(mask(&[0.5, 0.5, 4.0], 4, 2, Format::Grey, &grey), [255, 255, 255, 255, 255, 0, 0, 255]);
    }

    #[test]
    fn one_channel_that_differs_is_enough() {
        let rgb = [100, 100, 140, 100, 100, 100, 140, 100, 100, 100, 140, 100];
        // The strip is the bottom row of a single column: its last pixel.
        let wanted = [255, 255, 255, 0];
        assert_eq!(mask(&[0.25, 1.0, 4.0], 1, 4, Format::Rgb, &rgb), wanted);
    }

    #[test]
    fn a_single_pixel_is_its_own_floor() {
        assert_eq!(mask(&[0.01, 0.01, 0.5], 1, 1, Format::Rgb, &[9, 200, 30]), [0]);
    }
}
