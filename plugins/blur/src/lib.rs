//! Blur: each pixel becomes the binomially weighted mean brightness around it.
//!
//! * Luma of a colour pixel: `(77 R + 150 G + 29 B) / 256`, rounded down (ITU-R BT.601 weights in 8 bits).
//! * Weights: with radius `r`, row `2r` of Pascal's triangle in both directions, such as `[1 2 1]` for 1 and
//!   `[1 4 6 4 1]` for 2: close to a Gaussian with a deviation of `sqrt(r / 2)` pixels.
//! * Border rule: pixels outside the frame have the value of the nearest pixel inside.
//!
//! All arithmetic is on whole numbers and rounds once, to the nearest, half up.

#![deny(unsafe_code)]

use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind, Plugin};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

const DESCRIPTOR: Descriptor = Descriptor {
    name: "blur",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Smooths brightness, so that noise and fine texture vanish (binomial weights).",
    reads: &[Format::Grey, Format::Rgb],
    writes: Format::Grey,
    parameters: &[Parameter {
        name: "radius_px",
        kind: ParameterKind::Whole,
        unit: "pixels",
        min: 0.0,
        max: 10.0,
        default: 1.0,
        purpose: "How far the mean reaches on every side; 0 only turns colour into grey.",
    }],
};

struct Blur {
    radius: usize,
    /// `2 * radius + 1` weights with a sum of `2 ^ (2 * radius)`.
    weights: Vec<u32>,
    luma: Vec<u8>,
    /// One row of luma with `radius` pixels of border on either side.
    padded: Vec<u8>,
    /// Weighted sums along the rows.
    sums: Vec<u32>,
    /// Weighted sums along the columns, for one row.
    totals: Vec<u64>,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let radius_px = match values {
        [radius_px] => radius_px,
        _ => return Err(FilterError(format!("blur takes 1 parameter, not {}", values.len()))),
    };
    if radius_px.fract() != 0.0 {
        return Err(FilterError(format!("'radius_px' of filter 'blur' must be a whole number, not {radius_px}")));
    }
    let radius = *radius_px as usize;
    Ok(Box::new(Blur {
        radius,
        weights: pascal_row(2 * radius),
        luma: Vec::new(),
        padded: Vec::new(),
        sums: Vec::new(),
        totals: Vec::new(),
    }))
}

/// Row `n` of Pascal's triangle: `n + 1` numbers with a sum of `2 ^ n`.
fn pascal_row(n: usize) -> Vec<u32> {
    let mut row = vec![0; n + 1];
    row[0] = 1;
    for _ in 0..n {
        for index in (1..=n).rev() {
            row[index] += row[index - 1];
        }
    }
    row
}

impl Filter for Blur {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if matches!(input.format(), Format::Mask | Format::Depth) {
            return Err(FilterError("blur reads colour or grey frames".to_owned()));
        }
        let (width, height) = (input.width_px(), input.height_px());
        if width == 0 || height == 0 {
            return Ok(());
        }
        self.luma.resize(width * height, 0);
        input.write_luma(&mut self.luma)?;
        self.add_along_rows(width);
        self.add_along_columns(width, height, output.pixels());
        Ok(())
    }
}

impl Blur {
    fn add_along_rows(&mut self, width: usize) {
        let radius = self.radius;
        self.padded.resize(width + 2 * radius, 0);
        self.sums.resize(self.luma.len(), 0);
        self.sums.fill(0);
        for (luma, sums) in self.luma.chunks_exact(width).zip(self.sums.chunks_exact_mut(width)) {
            self.padded[..radius].fill(luma[0]);
            self.padded[radius..radius + width].copy_from_slice(luma);
            self.padded[radius + width..].fill(luma[width - 1]);
            for (shift, weight) in self.weights.iter().enumerate() {
                for (sum, luma) in sums.iter_mut().zip(&self.padded[shift..]) {
                    *sum += weight * u32::from(*luma);
                }
            }
        }
    }

    fn add_along_columns(&mut self, width: usize, height: usize, out: &mut [u8]) {
        let bits = 4 * self.radius;
        self.totals.resize(width, 0);
        for (y, out) in out.chunks_exact_mut(width).enumerate() {
            self.totals.fill((1 << bits) >> 1);
            for (shift, weight) in self.weights.iter().enumerate() {
                let row = (y + shift).saturating_sub(self.radius).min(height - 1);
                for (total, sum) in self.totals.iter_mut().zip(&self.sums[row * width..][..width]) {
                    *total += u64::from(*weight) * u64::from(*sum);
                }
            }
            for (out, total) in out.iter_mut().zip(&self.totals) {
                *out = (total >> bits) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blurred(radius_px: f64, width: usize, height: usize, format: Format, pixels: &[u8]) -> Vec<u8> {
        let mut out = vec![7; width * height];
        let input = Frame::new(width, height, format, pixels).unwrap();
        let output = FrameMut::new(width, height, Format::Grey, &mut out).unwrap();
        create(&[radius_px]).unwrap().process(input, output).unwrap();
        out
    }

    #[test]
    fn one_bright_pixel_is_spread_by_1_2_1_in_both_directions() {
        let mut grey = [0; 25];
        grey[12] = 160;
        let wanted = [
            0, 0, 0, 0, 0, //
            0, 10, 20, 10, 0, //
            0, 20, 40, 20, 0, //
            0, 10, 20, 10, 0, //
            0, 0, 0, 0, 0,
        ];
        assert_eq!(blurred(1.0, 5, 5, Format::Grey, &grey), wanted);
    }

    #[test]
    fn the_border_repeats_the_nearest_pixel_and_halves_round_up() {
        // (3 * 0 + 10) / 4 = 2.5; (3 * 10 + 0) / 4 = 7.5.
        assert_eq!(blurred(1.0, 2, 1, Format::Grey, &[0, 10]), [3, 8]);
        assert_eq!(blurred(1.0, 1, 2, Format::Grey, &[0, 10]), [3, 8]);
    }

    #[test]
    fn radius_2_weighs_by_1_4_6_4_1() {
        assert_eq!(blurred(2.0, 5, 1, Format::Grey, &[0, 0, 160, 0, 0]), [10, 40, 60, 40, 10]);
    }

    #[test]
    fn a_white_frame_stays_white_at_the_greatest_radius() {
        assert_eq!(blurred(10.0, 3, 2, Format::Grey, &[255; 6]), [255; 6]);
    }

    #[test]
    fn radius_0_is_luma() {
        // 77 * 100 / 256 = 30.1; 150 * 100 / 256 = 58.6; 29 * 100 / 256 = 11.3.
        assert_eq!(blurred(0.0, 3, 1, Format::Rgb, &[100, 0, 0, 0, 100, 0, 0, 0, 100]), [30, 58, 11]);
    }

    #[test]
    fn half_a_pixel_is_refused() {
        let error = create(&[1.5]).err().unwrap();
        assert_eq!(error.0, "'radius_px' of filter 'blur' must be a whole number, not 1.5");
    }
}
