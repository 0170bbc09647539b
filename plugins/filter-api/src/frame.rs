//! Borrowed frames: what a filter reads and writes.

use crate::FilterError;

/// What one pixel holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Three bytes: red, green, blue.
    Rgb,
    /// One byte of brightness.
    Grey,
    /// One byte, 0 or 255.
    Mask,
    /// Two bytes, the lower one first: nearness, one over the distance ahead of the lens, in 1/[`NEARNESS_ONE`] 1/m; 0 where
    /// nothing was measured.
    Depth,
}

/// The nearness of what is 1 m ahead of the lens, in a depth frame.
pub const NEARNESS_ONE: u16 = 8192;

impl Format {
    /// Bytes for each pixel.
    #[must_use]
    pub const fn channels(self) -> usize {
        match self {
            Self::Rgb => 3,
            Self::Grey | Self::Mask => 1,
            Self::Depth => 2,
        }
    }

    /// Its bit in the C contract.
    #[must_use]
    pub const fn bit(self) -> u32 {
        match self {
            Self::Rgb => 1,
            Self::Grey => 2,
            Self::Mask => 4,
            Self::Depth => 16,
        }
    }

    /// The format of a bit, if there is one.
    #[must_use]
    pub const fn from_bit(bit: u32) -> Option<Self> {
        match bit {
            1 => Some(Self::Rgb),
            2 => Some(Self::Grey),
            4 => Some(Self::Mask),
            16 => Some(Self::Depth),
            _ => None,
        }
    }
}

/// One picture to read: row-major, top row first, no padding.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    width_px: usize,
    height_px: usize,
    format: Format,
    pixels: &'a [u8],
}

impl<'a> Frame<'a> {
    /// A view of `pixels`.
    ///
    /// # Errors
    /// If `pixels` is not exactly `width_px * height_px * format.channels()` long.
    pub fn new(width_px: usize, height_px: usize, format: Format, pixels: &'a [u8]) -> Result<Self, FilterError> {
        check_length(width_px, height_px, format, pixels.len())?;
        Ok(Self { width_px, height_px, format, pixels })
    }

    /// Pixels in a row.
    #[must_use]
    pub const fn width_px(&self) -> usize {
        self.width_px
    }

    /// Rows.
    #[must_use]
    pub const fn height_px(&self) -> usize {
        self.height_px
    }

    /// What one pixel holds.
    #[must_use]
    pub const fn format(&self) -> Format {
        self.format
    }

    /// All bytes, `stride()` for each row.
    #[must_use]
    pub const fn pixels(&self) -> &'a [u8] {
        self.pixels
    }

    /// Writes the brightness of each pixel into `luma`: of colour `(77 R + 150 G + 29 B) / 256`, rounded down (ITU-R
    /// BT.601 weights in 8 bits); of grey and masks the byte itself.
    ///
    /// # Errors
    /// If `luma` has not one byte for each pixel, or this is a depth frame.
    pub fn write_luma(&self, luma: &mut [u8]) -> Result<(), FilterError> {
        check_length(self.width_px, self.height_px, Format::Grey, luma.len())?;
        if self.format == Format::Depth {
            return Err(FilterError("a depth frame has no brightness".to_owned()));
        }
        if self.format != Format::Rgb {
            luma.copy_from_slice(self.pixels);
            return Ok(());
        }
        for (pixel, luma) in self.pixels.chunks_exact(3).zip(luma) {
            let weighted = u16::from(pixel[0]) * 77 + u16::from(pixel[1]) * 150 + u16::from(pixel[2]) * 29;
            *luma = (weighted >> 8) as u8;
        }
        Ok(())
    }

    /// The nearness of each pixel of a depth frame, in 1/[`NEARNESS_ONE`] 1/m, row after row.
    pub fn nearness(&self) -> impl Iterator<Item = u16> + 'a {
        self.pixels.chunks_exact(2).map(|pixel| u16::from_le_bytes([pixel[0], pixel[1]]))
    }

    /// Bytes from one row to the next: width times channels.
    #[must_use]
    pub const fn stride(&self) -> usize {
        self.width_px * self.format.channels()
    }
}

/// One picture to fill, laid out as [`Frame`].
#[derive(Debug)]
pub struct FrameMut<'a> {
    width_px: usize,
    height_px: usize,
    format: Format,
    pixels: &'a mut [u8],
}

impl<'a> FrameMut<'a> {
    /// A view of `pixels` to fill.
    ///
    /// # Errors
    /// If `pixels` is not exactly `width_px * height_px * format.channels()` long.
    pub fn new(width_px: usize, height_px: usize, format: Format, pixels: &'a mut [u8]) -> Result<Self, FilterError> {
        check_length(width_px, height_px, format, pixels.len())?;
        Ok(Self { width_px, height_px, format, pixels })
    }

    /// Pixels in a row.
    #[must_use]
    pub const fn width_px(&self) -> usize {
        self.width_px
    }

    /// Rows.
    #[must_use]
    pub const fn height_px(&self) -> usize {
        self.height_px
    }

    /// What one pixel holds.
    #[must_use]
    pub const fn format(&self) -> Format {
        self.format
    }

    /// All bytes, row after row.
    #[must_use]
    pub fn pixels(&mut self) -> &mut [u8] {
        self.pixels
    }

    /// Checks that `input` and this frame have the same size.
    ///
    /// # Errors
    /// If they have not, with both sizes.
    pub fn check_same_size(&self, input: &Frame<'_>) -> Result<(), FilterError> {
        if (self.width_px, self.height_px) == (input.width_px, input.height_px) {
            return Ok(());
        }
        Err(FilterError(format!(
            "the output is {}x{} pixels, the input {}x{}",
            self.width_px, self.height_px, input.width_px, input.height_px
        )))
    }
}

fn check_length(width_px: usize, height_px: usize, format: Format, length: usize) -> Result<(), FilterError> {
    let wanted = width_px.checked_mul(height_px).and_then(|pixels| pixels.checked_mul(format.channels()));
    if wanted == Some(length) {
        return Ok(());
    }
    Err(FilterError(format!("{length} bytes do not make a frame of {width_px}x{height_px} pixels ({format:?})")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_luma_of_colour_is_weighted_and_that_of_grey_is_the_byte() {
        let mut luma = [0; 2];
        // 150 * 40 / 256 = 23.4; white: 256 * 255 / 256.
        Frame::new(2, 1, Format::Rgb, &[0, 40, 0, 255, 255, 255]).unwrap().write_luma(&mut luma).unwrap();
        assert_eq!(luma, [23, 255]);
        Frame::new(2, 1, Format::Grey, &[9, 200]).unwrap().write_luma(&mut luma).unwrap();
        assert_eq!(luma, [9, 200]);
        assert!(Frame::new(1, 1, Format::Grey, &[9]).unwrap().write_luma(&mut luma).is_err());
    }

    #[test]
    fn nearness_has_two_bytes_the_lower_one_first_and_no_brightness() {
        // 2 m and 0.5 m ahead, and nothing.
        let frame = Frame::new(3, 1, Format::Depth, &[0, 16, 0, 64, 0, 0]).unwrap();
        assert_eq!(frame.nearness().collect::<Vec<_>>(), [NEARNESS_ONE / 2, NEARNESS_ONE * 2, 0]);
        assert!(frame.write_luma(&mut [0; 3]).is_err());
    }
}
