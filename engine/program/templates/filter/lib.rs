//! @name@: marks where brightness changes. Change it into your own filter.

use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, and the one line that makes a library of it.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };
filter_api::export!(PLUGIN);

/// What `engine plugins` prints, and what scripts may set.
const DESCRIPTOR: Descriptor = Descriptor {
    name: "@name@",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT",
    purpose: "Marks the pixels that differ in brightness from the one to the left or the one above.",
    reads: &[Format::Grey, Format::Rgb],
    writes: Format::Mask,
    parameters: &[Parameter {
        name: "level",
        kind: ParameterKind::Whole,
        unit: "grey levels",
        min: 1.0,
        max: 255.0,
        default: 15.0,
        purpose: "By how much they must differ.",
    }],
};

/// The host passes one checked value for each parameter, in the order of the descriptor.
fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    Ok(Box::new(Steps { level: values[0] as u8 }))
}

struct Steps {
    level: u8,
}

impl Filter for Steps {
    /// The output is as large as the input; every byte of it must be written.
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        input.write_luma(output.pixels())?;
        let (width, level) = (input.width_px(), self.level);
        let pixels = output.pixels();
        // From the end to the start, so that the pixels to the left and above still hold their brightness.
        for index in (0..pixels.len()).rev() {
            let own = pixels[index];
            let left = if index % width > 0 { pixels[index - 1] } else { own };
            let above = if index >= width { pixels[index - width] } else { own };
            let differs = own.abs_diff(left) >= level || own.abs_diff(above) >= level;
            pixels[index] = if differs { 255 } else { 0 };
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_marked_if_it_differs_from_the_left_or_from_above() {
        let mut mask = [7; 6];
        let input = Frame::new(3, 2, Format::Grey, &[0, 14, 29, 0, 29, 29]).unwrap();
        let output = FrameMut::new(3, 2, Format::Mask, &mut mask).unwrap();
        create(&[15.0]).unwrap().process(input, output).unwrap();
        assert_eq!(mask, [0, 0, 255, 0, 255, 0]);
    }
}
