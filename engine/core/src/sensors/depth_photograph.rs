//! Depth images from a real camera: PNG files of 16 bits that hold millimetres, as most depth cameras write them.

use std::path::Path;

use image::{DynamicImage, ImageBuffer, Luma};

use super::observation::Image;
use super::photograph::{decoded, shape, shown};
use crate::diagnostic::{Diagnostic, Result};
use filter_api::{Format, NEARNESS_ONE};

/// Reads a PNG file of one channel of 16 bits, each pixel the distance ahead of the lens in millimetres and 0 where nothing
/// was measured: cropped around its middle to the shape of `width_px` times `height_px`, then each pixel that of the file which lies
/// there, since a mean of two depths is a place where nothing is.
///
/// # Errors
/// Those of [`super::load_photograph`], and `E-IMAGE-FORMAT` if the file holds no depth.
pub fn load_depth(path: &Path, width_px: usize, height_px: usize) -> Result<Image> {
    let DynamicImage::ImageLuma16(depths) = decoded(path)? else {
        let message = format!("'{}' holds colours or 8 bits, and the filter reads depth", shown(path));
        let help =
            "give depth images: PNG files with one channel of 16 bits, in millimetres, 0 where nothing was measured";
        return Diagnostic::new("E-IMAGE-FORMAT", message).help(help).fail();
    };
    Ok(nearness(&depths, width_px, height_px))
}

fn nearness(depths: &ImageBuffer<Luma<u16>, Vec<u16>>, width_px: usize, height_px: usize) -> Image {
    let [left, top, across, down] = shape([depths.width(), depths.height()], [width_px, height_px]);
    let mut image = Image::of(Format::Depth, width_px, height_px);
    let at =
        |index: usize, pixels: usize, of: u32| ((2 * index as u64 + 1) * u64::from(of) / (2 * pixels as u64)) as u32;
    for (index, pixel) in image.pixels.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        let (x, y) = (at(index % width_px, width_px, across), at(index / width_px, height_px, down));
        let Luma([depth_mm]) = *depths.get_pixel(left + x, top + y);
        let near = match depth_mm {
            0 => 0.0,
            depth_mm => (f64::from(NEARNESS_ONE) * 1000.0 / f64::from(depth_mm)).round().min(f64::from(u16::MAX)),
        };
        *pixel = (near as u16).to_le_bytes();
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millimetres_become_nearness_and_holes_stay_holes() {
        // 2 m, 1 m, nothing, 0.1 m (81920 in 1/8192 1/m is more than 16 bits hold): the middle of a wide image, each pixel of two.
        let row = [9, 9, 2000, 2000, 1000, 1000, 0, 0, 100, 100, 9, 9];
        let depths = ImageBuffer::from_raw(12, 2, [row, row].concat()).unwrap();
        let image = nearness(&depths, 4, 1);
        let read: Vec<u16> = image.pixels.chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
        assert_eq!((image.format, read), (Format::Depth, vec![4096, 8192, 0, u16::MAX]));
    }
}
