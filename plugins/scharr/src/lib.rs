//! Scharr edges: as Sobel, with a kernel that weighs all directions more evenly.
//!
//! * Kernels: `gx = [-3 0 3; -10 0 10; -3 0 3]` and `gy` its transpose, on luma as sobel has it.
//! * Border rule: pixels outside the frame have the value of the nearest pixel inside.
//! * Norm: Euclidean. A pixel is an edge where `gx² + gy² >= threshold²`, so a step of one grey level has a norm of 16.
//!
//! All of it is whole-number arithmetic.

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
    name: "scharr",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks edges as sobel does, but weighs all directions more evenly (Scharr).",
    reads: &[Format::Grey, Format::Rgb],
    writes: Format::Mask,
    parameters: &[Parameter {
        name: "threshold",
        kind: ParameterKind::Number,
        unit: "norm of the gradient",
        min: 1.0,
        max: 5770.0,
        default: 240.0,
        purpose: "The norm from which a pixel is an edge; a step of one grey level has 16.",
    }],
};

struct Scharr {
    /// The square of the norm from which a pixel is an edge.
    least_square: i32,
    /// Brightness of a colour frame.
    luma: Vec<u8>,
    processor: Processor,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let threshold = match values {
        [threshold] => *threshold,
        _ => return Err(FilterError(format!("scharr takes 1 parameter, not {}", values.len()))),
    };
    // Gradients are whole numbers, so comparing with the next whole square is exact.
    let least_square = (threshold * threshold).ceil() as i32;
    Ok(Box::new(Scharr { least_square, luma: Vec::new(), processor: Processor::best() }))
}

impl Filter for Scharr {
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
                input.write_luma(&mut self.luma)?;
                &self.luma
            }
            Format::Mask | Format::Depth => return Err(FilterError("scharr reads colour or grey frames".to_owned())),
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
    fn a_vertical_step_of_15_levels_has_a_norm_of_240_on_both_sides() {
        let grey: Vec<u8> = [10, 10, 25, 25].repeat(4);
        assert_eq!(edges(4, 4, &grey, 240.0), [0, 255, 255, 0].repeat(4));
        assert_eq!(edges(4, 4, &grey, 240.1), [0; 16]);
    }

    #[test]
    fn a_diagonal_neighbour_has_less_weight_than_with_sobel() {
        // The corner neighbours of one pixel of 100 have gx = gy = ±300: a norm of 424.3; the others 1000.
        let mut grey = [0; 25];
        grey[12] = 100;
        let marked = |threshold| edges(5, 5, &grey, threshold).iter().filter(|pixel| **pixel == 255).count();
        assert_eq!((marked(424.0), marked(425.0), marked(1001.0)), (8, 4, 0));
    }

    #[test]
    fn the_border_repeats_the_nearest_pixel_so_a_flat_frame_has_no_edges() {
        assert_eq!(edges(5, 3, &[200; 15], 1.0), [0; 15]);
        assert_eq!(edges(1, 1, &[200], 1.0), [0]);
    }

    #[test]
    fn a_mask_is_refused() {
        let mut out = [0];
        let output = FrameMut::new(1, 1, Format::Mask, &mut out).unwrap();
        let input = Frame::new(1, 1, Format::Mask, &[0]).unwrap();
        assert!(create(&[240.0]).unwrap().process(input, output).is_err());
    }
}
