//! Horizon: keeps the part of a mask where the ground is, and clears the rest.
//!
//! What is kept is a trapezium that ends at the bottom of the frame: nothing above a line, and below it a width that
//! grows linearly from the line to the full width at the bottom, as a straight road does in perspective. A pixel is kept
//! where its middle is inside.

#![deny(unsafe_code)]

use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

const DESCRIPTOR: Descriptor = Descriptor {
    name: "horizon",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Keeps of a mask only what is below a line, and narrower towards it if asked.",
    reads: &[Format::Mask],
    writes: Format::Mask,
    parameters: &[
        Parameter {
            name: "top",
            kind: ParameterKind::Number,
            unit: "share of the height",
            min: 0.0,
            max: 1.0,
            default: 0.33,
            purpose: "Where the line is; everything above is cleared.",
        },
        Parameter {
            name: "narrowing",
            kind: ParameterKind::Number,
            unit: "share of the width",
            min: 0.0,
            max: 1.0,
            default: 0.0,
            purpose: "How much of the width is cleared at the line, half on either side; nothing at the bottom.",
        },
    ],
};

struct Horizon {
    top: f64,
    narrowing: f64,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let (top, narrowing) = match values {
        [top, narrowing] => (top, narrowing),
        _ => return Err(FilterError(format!("horizon takes 2 parameters, not {}", values.len()))),
    };
    Ok(Box::new(Horizon { top: *top, narrowing: *narrowing }))
}

impl Horizon {
    /// How many pixels are cleared on either side of a row, at most half of them rounded up.
    fn cleared_px(&self, row: usize, width: usize, height: usize) -> usize {
        let line = self.top * height as f64;
        let middle = row as f64 + 0.5;
        if middle < line {
            return width - width / 2;
        }
        let above_bottom = (height as f64 - middle) / (height as f64 - line);
        let side = self.narrowing * above_bottom * width as f64 * 0.5;
        // Pixel x is left of the border where x + 0.5 < side.
        ((side - 0.5).ceil().max(0.0) as usize).min(width - width / 2)
    }
}

impl Filter for Horizon {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if input.format() != Format::Mask {
            return Err(FilterError("horizon reads a mask only".to_owned()));
        }
        let (width, height) = (input.width_px(), input.height_px());
        if width == 0 || height == 0 {
            return Ok(());
        }
        output.pixels().copy_from_slice(input.pixels());
        for (y, row) in output.pixels().chunks_exact_mut(width).enumerate() {
            let cleared = self.cleared_px(y, width, height);
            row[..cleared].fill(0);
            row[width - cleared..].fill(0);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is kept of a mask that is marked all over.
    fn kept(top: f64, narrowing: f64, width: usize, height: usize) -> Vec<u8> {
        let (all, mut out) = (vec![255; width * height], vec![7; width * height]);
        let input = Frame::new(width, height, Format::Mask, &all).unwrap();
        let output = FrameMut::new(width, height, Format::Mask, &mut out).unwrap();
        create(&[top, narrowing]).unwrap().process(input, output).unwrap();
        out
    }

    #[test]
    fn half_a_frame_is_cleared_from_the_top() {
        assert_eq!(kept(0.5, 0.0, 3, 4), [[0; 6], [255; 6]].concat());
    }

    #[test]
    fn a_row_is_kept_from_its_middle_on() {
        // The middles of the four rows are at 0.125, 0.375, 0.625 and 0.875.
        assert_eq!(kept(0.375, 0.0, 1, 4), [0, 255, 255, 255]);
        assert_eq!(kept(0.376, 0.0, 1, 4), [0, 0, 255, 255]);
    }

    #[test]
    fn the_ends_keep_everything_or_nothing() {
        assert_eq!(kept(0.0, 0.0, 3, 2), [255; 6]);
        assert_eq!(kept(1.0, 0.0, 3, 2), [0; 6]);
    }

    #[test]
    fn full_narrowing_keeps_a_triangle() {
        // Above the bottom by 7/8, 5/8, 3/8 and 1/8 of the height: borders at 3.5, 2.5, 1.5 and 0.5 pixels.
        let wanted = [
            0, 0, 0, 255, 255, 0, 0, 0, //
            0, 0, 255, 255, 255, 255, 0, 0, //
            0, 255, 255, 255, 255, 255, 255, 0, //
            255, 255, 255, 255, 255, 255, 255, 255,
        ];
        assert_eq!(kept(0.0, 1.0, 8, 4), wanted);
    }

    #[test]
    fn what_is_not_marked_stays_so() {
        let input = Frame::new(2, 1, Format::Mask, &[0, 255]).unwrap();
        let mut out = [7; 2];
        let output = FrameMut::new(2, 1, Format::Mask, &mut out).unwrap();
        create(&[0.0, 0.0]).unwrap().process(input, output).unwrap();
        assert_eq!(out, [0, 255]);
    }

    #[test]
    fn a_grey_frame_is_refused() {
        let input = Frame::new(1, 1, Format::Grey, &[0]).unwrap();
        let mut out = [0];
        let output = FrameMut::new(1, 1, Format::Mask, &mut out).unwrap();
        assert!(create(&[0.5, 0.0]).unwrap().process(input, output).is_err());
    }
}
