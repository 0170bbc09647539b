//! Brightness: a mask of the pixels that are at least as bright as a threshold, or of all the others.
//!
//! Luma of a colour pixel: `(77 R + 150 G + 29 B) / 256`, rounded down (ITU-R BT.601 weights in 8 bits).

#![deny(unsafe_code)]

use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

const DESCRIPTOR: Descriptor = Descriptor {
    name: "threshold",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks the pixels that are bright enough, or with `invert` those that are not.",
    reads: &[Format::Grey, Format::Rgb],
    writes: Format::Mask,
    parameters: &[
        Parameter {
            name: "threshold",
            kind: ParameterKind::Number,
            unit: "grey levels",
            min: 0.0,
            max: 255.0,
            default: 128.0,
            purpose: "The brightness from which a pixel is marked.",
        },
        Parameter {
            name: "invert",
            kind: ParameterKind::Switch,
            unit: "on or off",
            min: 0.0,
            max: 1.0,
            default: 0.0,
            purpose: "1 marks the pixels below the threshold instead.",
        },
    ],
};

struct Threshold {
    least: u8,
    bright: u8,
    dark: u8,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let (threshold, invert) = match values {
        [threshold, invert] => (threshold, invert),
        _ => return Err(FilterError(format!("threshold takes 2 parameters, not {}", values.len()))),
    };
    // Luma is a whole number, so comparing with the next whole number is exact.
    let least = threshold.ceil() as u8;
    if *invert == 0.0 {
        Ok(Box::new(Threshold { least, bright: 255, dark: 0 }))
    } else if *invert == 1.0 {
        Ok(Box::new(Threshold { least, bright: 0, dark: 255 }))
    } else {
        Err(FilterError(format!("'invert' of filter 'threshold' must be 0 or 1, not {invert}")))
    }
}

impl Filter for Threshold {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if matches!(input.format(), Format::Mask | Format::Depth) {
            return Err(FilterError("threshold reads colour or grey frames".to_owned()));
        }
        input.write_luma(output.pixels())?;
        // Copies, which the loop cannot change: so it becomes vector code.
        let Self { least, bright, dark } = *self;
        for pixel in output.pixels() {
            *pixel = if *pixel >= least { bright } else { dark };
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(values: &[f64; 2], format: Format, pixels: &[u8]) -> Vec<u8> {
        let count = pixels.len() / format.channels();
        let mut out = vec![7; count];
        let input = Frame::new(count, 1, format, pixels).unwrap();
        let output = FrameMut::new(count, 1, Format::Mask, &mut out).unwrap();
        create(values).unwrap().process(input, output).unwrap();
        out
    }

    #[test]
    fn a_pixel_as_bright_as_the_threshold_is_marked() {
        assert_eq!(mask(&[100.0, 0.0], Format::Grey, &[99, 100, 101]), [0, 255, 255]);
        assert_eq!(mask(&[99.5, 0.0], Format::Grey, &[99, 100, 101]), [0, 255, 255]);
    }

    #[test]
    fn invert_marks_the_others() {
        assert_eq!(mask(&[100.0, 1.0], Format::Grey, &[99, 100, 101]), [255, 0, 0]);
    }

    #[test]
    fn colour_is_weighted_by_luma() {
        // Pure red 200 has luma 77 * 200 / 256 = 60, pure green 150 * 200 / 256 = 117.
        assert_eq!(mask(&[61.0, 0.0], Format::Rgb, &[200, 0, 0, 0, 200, 0]), [0, 255]);
        assert_eq!(mask(&[60.0, 0.0], Format::Rgb, &[200, 0, 0, 0, 200, 0]), [255, 255]);
    }

    #[test]
    fn the_ends_mark_everything_or_only_white() {
        assert_eq!(mask(&[0.0, 0.0], Format::Grey, &[0, 254, 255]), [255, 255, 255]);
        assert_eq!(mask(&[255.0, 0.0], Format::Grey, &[0, 254, 255]), [0, 0, 255]);
    }

    #[test]
    fn half_an_inversion_is_refused() {
        let error = create(&[100.0, 0.5]).err().unwrap();
        assert_eq!(error.0, "'invert' of filter 'threshold' must be 0 or 1, not 0.5");
    }
}
