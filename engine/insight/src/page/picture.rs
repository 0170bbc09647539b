//! Pictures small enough to stand in a page by the dozen, as `data:` addresses.

use filter_api::Format;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageResult};

use crate::markup::base64;
use engine::diagnostic::{Diagnostic, Result};

/// The quality of camera images: pixel noise would make them ten times as large without loss.
const QUALITY: u8 = 82;

/// A picture as a `data:` address: masks without loss (PNG), camera and grey images nearly so (JPEG).
///
/// # Errors
/// If the pixels do not fit the size.
pub(super) fn data_address(pixels: &[u8], size_px: (usize, usize), format: Format) -> Result<String> {
    let (width, height) = (size_px.0 as u32, size_px.1 as u32);
    if pixels.len() != size_px.0 * size_px.1 * format.channels() {
        return Err(failed("its pixels do not fit its size"));
    }
    let mut bytes = Vec::new();
    let (written, kind): (ImageResult<()>, &str) = match format {
        Format::Mask => (write_mask(pixels, (width, height), &mut bytes), "png"),
        Format::Grey => {
            let jpeg = JpegEncoder::new_with_quality(&mut bytes, QUALITY);
            (jpeg.write_image(pixels, width, height, ExtendedColorType::L8), "jpeg")
        }
        Format::Depth => {
            let (jpeg, greys) = (JpegEncoder::new_with_quality(&mut bytes, QUALITY), greys_of_depth(pixels));
            (jpeg.write_image(&greys, width, height, ExtendedColorType::L8), "jpeg")
        }
        Format::Rgb => {
            let jpeg = JpegEncoder::new_with_quality(&mut bytes, QUALITY);
            (jpeg.write_image(pixels, width, height, ExtendedColorType::Rgb8), "jpeg")
        }
    };
    written.map_err(|error| failed(&error.to_string()))?;
    Ok(format!("data:image/{kind};base64,{}", base64(&bytes)))
}

/// Nearness as brightness: white from half a metre on, black where nothing is seen.
fn greys_of_depth(pixels: &[u8]) -> Vec<u8> {
    pixels.as_chunks::<2>().0.iter().map(|pixel| pixel[1].saturating_mul(4)).collect()
}

/// A mask as the bytes of a PNG file.
///
/// # Errors
/// If the pixels do not fit the size.
pub fn mask_png(pixels: &[u8], size_px: (usize, usize)) -> Result<Vec<u8>> {
    if pixels.len() != size_px.0 * size_px.1 {
        return Err(failed("its pixels do not fit its size"));
    }
    let mut bytes = Vec::new();
    let written = write_mask(pixels, (size_px.0 as u32, size_px.1 as u32), &mut bytes);
    written.map_err(|error| failed(&error.to_string()))?;
    Ok(bytes)
}

fn write_mask(pixels: &[u8], (width, height): (u32, u32), bytes: &mut Vec<u8>) -> ImageResult<()> {
    let png = PngEncoder::new_with_quality(bytes, CompressionType::Default, FilterType::NoFilter);
    png.write_image(pixels, width, height, ExtendedColorType::L8)
}

fn failed(reason: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-PICTURE", format!("cannot draw a frame: {reason}")))
}
