//! Sobel edges: a mask of the pixels where brightness changes fast.
//!
//! * Luma of a colour pixel: `(77 R + 150 G + 29 B) / 256`, rounded down (ITU-R BT.601 weights in 8 bits).
//! * Border rule: pixels outside the frame have the value of the nearest pixel inside.
//! * Norm: Euclidean. A pixel is an edge where `gx² + gy² >= threshold²`, with the kernels
//!   `gx = [-1 0 1; -2 0 2; -1 0 1]` and `gy` its transpose, so a step of 1 grey level has a norm of 4.

#![deny(unsafe_code)]

mod kernel;

use dispatch::Processor;
use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

const DESCRIPTOR: Descriptor = Descriptor {
    name: "sobel",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks edges: pixels where brightness changes fast (Sobel, Euclidean norm).",
    reads: &[Format::Grey, Format::Rgb],
    writes: Format::Mask,
    parameters: &[Parameter {
        name: "threshold",
        kind: ParameterKind::Number,
        unit: "norm of the gradient",
        min: 1.0,
        max: 1443.0,
        default: 60.0,
        purpose: "The norm from which a pixel is an edge; a step of one grey level has 4.",
    }],
};

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let threshold = values.first().copied().unwrap_or(60.0);
    // Gradients are whole numbers, so comparing with the next whole square is exact.
    let least_square = (threshold * threshold).ceil() as i32;
    Ok(Box::new(Sobel { least_square, luma: Vec::new(), processor: Processor::best() }))
}

struct Sobel {
    /// The square of the norm from which a pixel is an edge.
    least_square: i32,
    /// Brightness of a colour frame.
    luma: Vec<u8>,
    processor: Processor,
}

impl Filter for Sobel {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        let (width, height) = (input.width_px(), input.height_px());
        if width == 0 || height == 0 {
            return Ok(());
        }
        let luma = match input.format() {
            Format::Grey => input.pixels(),
            Format::Rgb => {
                self.luma.resize(width * height, 0);
                kernel::luma_of_colour(self.processor, input.pixels(), &mut self.luma);
                &self.luma
            }
            Format::Mask | Format::Depth => return Err(FilterError("sobel reads colour or grey frames".to_owned())),
        };
        kernel::mark_edges(self.processor, luma, width, self.least_square, output.pixels());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(width: usize, height: usize, grey: &[u8], threshold: f64) -> Vec<u8> {
        let mut out = vec![7; width * height];
        let input = Frame::new(width, height, Format::Grey, grey).unwrap();
        let output = FrameMut::new(width, height, Format::Mask, &mut out).unwrap();
        create(&[threshold]).unwrap().process(input, output).unwrap();
        out
    }

    #[test]
    fn a_vertical_step_of_15_levels_has_a_norm_of_60_on_both_sides() {
        let row = [10, 10, 25, 25];
        let grey: Vec<u8> = row.iter().copied().cycle().take(16).collect();
        assert_eq!(edges(4, 4, &grey, 60.0), [0, 255, 255, 0].repeat(4));
        assert_eq!(edges(4, 4, &grey, 60.1), [0; 16]);
    }

    #[test]
    fn one_bright_pixel_marks_its_neighbours_and_not_itself() {
        let mut grey = [0; 25];
        grey[12] = 100;
        let mut wanted = [0; 25];
        for index in [6, 7, 8, 11, 13, 16, 17, 18] {
            wanted[index] = 255;
        }
        // The corner neighbours have gx = gy = ±100: a norm of 141.4; the others 200.
        assert_eq!(edges(5, 5, &grey, 141.0), wanted);
    }

    #[test]
    fn the_border_repeats_the_nearest_pixel_so_a_flat_frame_has_no_edges() {
        assert_eq!(edges(5, 3, &[200; 15], 1.0), [0; 15]);
        assert_eq!(edges(1, 1, &[200], 1.0), [0]);
    }

    #[test]
    fn colour_is_weighted_by_luma() {
        // Pure green 40 has luma 150 * 40 / 256 = 23; a step of 23 levels has a norm of 92.
        let row = [0, 0, 0, 0, 40, 0];
        let mut out = [0; 2];
        let input = Frame::new(2, 1, Format::Rgb, &row).unwrap();
        let run = |threshold: f64, out: &mut [u8; 2]| {
            let output = FrameMut::new(2, 1, Format::Mask, out).unwrap();
            create(&[threshold]).unwrap().process(input, output).unwrap();
        };
        run(92.0, &mut out);
        assert_eq!(out, [255, 255]);
        run(92.1, &mut out);
        assert_eq!(out, [0, 0]);
    }

    #[test]
    fn a_mask_is_refused() {
        let input = Frame::new(1, 1, Format::Mask, &[0]).unwrap();
        let mut out = [0];
        let output = FrameMut::new(1, 1, Format::Mask, &mut out).unwrap();
        assert!(create(&[60.0]).unwrap().process(input, output).is_err());
    }
}
