//! Canny edges: thin lines along the strongest gradient, followed as long as they stay strong enough.
//!
//! The work is done by `imageproc::edges::canny`: a Gaussian blur with a deviation of 1.4 pixels, the Sobel gradient
//! (kernels as in `gx = [-1 0 1; -2 0 2; -1 0 1]`, Euclidean norm), only its local maxima, and hysteresis. Pixels on the
//! border of the frame are never marked. Lines are followed to all neighbours but those straight above and above on the
//! right (as imageproc 0.27 does it), so a line that grows weak is followed down the frame rather than up.
//!
//! Two clauses of the contract it cannot keep: it allocates its intermediate images for each frame, and its blur and
//! norm take `exp`, `hypot` and `atan2` from the platform, so that two platforms may differ in a pixel.

#![forbid(unsafe_code)]

use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, Plugin};
use image::GrayImage;

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

const DESCRIPTOR: Descriptor = Descriptor {
    name: "canny",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks edges as thin connected lines (Canny).",
    reads: &[Format::Rgb, Format::Grey],
    writes: Format::Mask,
    parameters: &[
        Parameter {
            name: "low",
            unit: "norm of the gradient",
            min: 1.0,
            max: 1140.0,
            default: 30.0,
            purpose: "The norm down to which a line is followed.",
        },
        Parameter {
            name: "high",
            unit: "norm of the gradient",
            min: 1.0,
            max: 1140.0,
            default: 60.0,
            purpose: "The norm from which a line begins; not below `low`.",
        },
    ],
};

struct Canny {
    low: f32,
    high: f32,
    luma: GrayImage,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let [low, high] = values else {
        return Err(FilterError(format!("canny takes 2 parameters, not {}", values.len())));
    };
    if low > high {
        return Err(FilterError(format!("'low' of filter 'canny' is {low}, above 'high', which is {high}")));
    }
    Ok(Box::new(Canny { low: *low as f32, high: *high as f32, luma: GrayImage::new(0, 0) }))
}

impl Filter for Canny {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if input.format() == Format::Mask {
            return Err(FilterError("canny reads colour or grey frames, not a mask".to_owned()));
        }
        let (Ok(width), Ok(height)) = (u32::try_from(input.width_px()), u32::try_from(input.height_px())) else {
            return Err(FilterError("canny cannot read a frame as large as this".to_owned()));
        };
        if width < 3 || height < 3 {
            // All pixels are on the border.
            output.pixels().fill(0);
            return Ok(());
        }
        if self.luma.dimensions() != (width, height) {
            self.luma = GrayImage::new(width, height);
        }
        input.write_luma(&mut self.luma)?;
        let edges = imageproc::edges::canny(&self.luma, self.low, self.high);
        output.pixels().copy_from_slice(&edges);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(low: f64, high: f64, width: usize, height: usize, grey: &[u8]) -> Vec<u8> {
        let mut out = vec![7; width * height];
        let input = Frame::new(width, height, Format::Grey, grey).unwrap();
        let output = FrameMut::new(width, height, Format::Mask, &mut out).unwrap();
        create(&[low, high]).unwrap().process(input, output).unwrap();
        out
    }

    /// A frame of 12 columns whose right half is `step` brighter.
    fn step(height: usize, step: u8) -> Vec<u8> {
        [[50; 6], [50 + step; 6]].concat().repeat(height)
    }

    /// The marked columns of a row of a frame of 12 columns.
    fn marked(mask: &[u8], row: usize) -> Vec<usize> {
        (0..12).filter(|x| mask[row * 12 + x] == 255).collect()
    }

    #[test]
    fn a_vertical_step_becomes_a_line_at_the_step_without_the_border_rows() {
        let mask = edges(30.0, 60.0, 12, 9, &step(9, 100));
        assert!(marked(&mask, 0).is_empty() && marked(&mask, 8).is_empty());
        for row in 1..8 {
            // Blurred, the step is equally steep on both sides of its middle, up to rounding.
            let columns = marked(&mask, row);
            assert!(!columns.is_empty() && columns.iter().all(|x| [5, 6].contains(x)), "{columns:?}");
        }
    }

    #[test]
    fn a_weak_line_counts_only_where_it_continues_a_strong_one() {
        // The blurred step rises by about step / (1.4 sqrt(2 pi)) = 0.28 step for each pixel: with 4 (one kernel) times
        // two such pixels a norm of 2.2 step or so: 220 for 100 levels, 440 for 200.
        assert!(edges(100.0, 350.0, 12, 9, &step(9, 100)).iter().all(|pixel| *pixel == 0));
        let mask = edges(100.0, 350.0, 12, 18, &[step(9, 200), step(9, 100)].concat());
        assert!(!marked(&mask, 2).is_empty() && !marked(&mask, 15).is_empty());
    }

    #[test]
    fn a_flat_frame_and_frames_without_an_inside_have_no_edges() {
        assert_eq!(edges(1.0, 1.0, 5, 4, &[200; 20]), [0; 20]);
        assert_eq!(edges(1.0, 1.0, 2, 2, &[0, 255, 255, 0]), [0; 4]);
    }

    #[test]
    fn low_above_high_is_refused() {
        let error = create(&[90.0, 60.0]).err().unwrap();
        assert_eq!(error.0, "'low' of filter 'canny' is 90, above 'high', which is 60");
    }
}
