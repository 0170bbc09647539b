//! Photographs: PNG and JPEG files from any camera, cropped and scaled to what the robot's camera would deliver.

use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use image::imageops::{FilterType, crop_imm, resize};
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, RgbImage};

use super::observation::Image;
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use filter_api::Format;

/// The largest file that is read, bytes.
const MAX_FILE_BYTES: u64 = 64 << 20;
/// The largest photograph that is decoded, pixels.
const MAX_PIXELS: u64 = 50_000_000;
/// The largest progressive JPEG, pixels: its decoder keeps six bytes more for each.
const MAX_PROGRESSIVE_PIXELS: u64 = 16_000_000;
/// Most bytes of the decoded pixels, with those in eight bits for a colour that are made of them.
const MAX_DECODED_BYTES: u64 = 3 * MAX_PIXELS;
/// Memory that a decoder may take besides the pixels: for its tables, a colour profile, texts.
const MAX_DECODER_BYTES: u64 = 16 << 20;
/// Endings of the files that are taken from a folder.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The files that `paths` stand for: a file itself, or the PNG and JPEG files of a folder, sorted by name.
///
/// # Errors
/// `E-IMAGE-FILE` if a path is missing, or a folder cannot be read or holds no such file.
pub fn photograph_files(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            files.extend(folder(path)?);
        } else if std::fs::metadata(path).is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound) {
            return missing(path).fail();
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn folder(path: &Path) -> Result<Vec<PathBuf>> {
    let files = names(path).map_err(|error| unreadable(path, &error))?;
    if files.is_empty() {
        let message = format!("the folder '{}' holds no PNG or JPEG file", shown(path));
        return Diagnostic::new("E-IMAGE-FILE", message)
            .help("files must end in .png, .jpg or .jpeg; folders within it are not searched")
            .fail();
    }
    Ok(files)
}

/// The photographs of a folder, sorted.
fn names(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        if ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && !path.is_dir() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn missing(path: &Path) -> Diagnostic {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = names(parent).unwrap_or_default();
    let beside: Vec<String> =
        beside.iter().filter_map(|file| Some(file.file_name()?.to_string_lossy().into_owned())).collect();
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    let help = match nearest_name(&wanted, beside.iter().map(String::as_str)) {
        Some(near) => format!("did you mean '{}'?", shown(&path.with_file_name(near))),
        None => "give a PNG or JPEG file, or a folder of them".to_owned(),
    };
    let message = format!("there is no image '{}'", shown(path));
    Diagnostic::new("E-IMAGE-FILE", message).help(help)
}

/// Reads a PNG or JPEG file as an image of `width_px` times `height_px`: turned upright as its EXIF data say, cropped
/// around its middle to that shape, then scaled so that each pixel averages the area around it. A photograph of
/// exactly that size keeps its pixels. Transparency is ignored.
///
/// # Errors
/// `E-IMAGE-FILE` if it cannot be read, is damaged or ends too early; `E-IMAGE-FORMAT` if it is neither PNG nor JPEG;
/// `E-IMAGE-LIMIT` above 64 MiB or 50 megapixels, before anything is decoded.
pub fn load_photograph(path: &Path, width_px: usize, height_px: usize) -> Result<Image> {
    Ok(scaled(&decoded(path)?.into_rgb8(), width_px, height_px))
}

/// As [`load_photograph`], of the bytes of a file that is called so.
///
/// # Errors
/// Those of [`load_photograph`].
pub fn photograph_of(path: &Path, bytes: &[u8], width_px: usize, height_px: usize) -> Result<Image> {
    Ok(scaled(&decode(path, bytes)?.into_rgb8(), width_px, height_px))
}

/// The pixels of a file, turned upright.
pub(super) fn decoded(path: &Path) -> Result<DynamicImage> {
    let bytes = read(path)?;
    decode(path, &bytes)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let metadata = std::fs::metadata(path).map_err(|error| unreadable(path, &error))?;
    if !metadata.is_file() {
        let message = format!("'{}' is not an ordinary file", shown(path));
        return Diagnostic::new("E-IMAGE-FILE", message).fail();
    }
    let mut bytes = Vec::new();
    // The file may have grown since its length was asked for.
    let file = std::fs::File::open(path).map_err(|error| unreadable(path, &error))?;
    if metadata.len() <= MAX_FILE_BYTES {
        file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| unreadable(path, &error))?;
    }
    if metadata.len().max(bytes.len() as u64) > MAX_FILE_BYTES {
        return too_large(path, &format!("{} MiB", metadata.len().div_ceil(1 << 20))).fail();
    }
    Ok(bytes)
}

fn decode(path: &Path, bytes: &[u8]) -> Result<DynamicImage> {
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| unreadable(path, &error))?;
    let format = match reader.format() {
        Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        other => return foreign(path, bytes, other).fail(),
    };
    let name = if format == ImageFormat::Png { "PNG" } else { "JPEG" };
    let failed = |error: ImageError| match error {
        ImageError::Limits(_) => Box::new(too_large(path, "more memory than a photograph needs")),
        _ => Box::new(damaged(path, name)),
    };
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return too_large(path, &format!("{width}x{height} pixels")).fail();
    }
    check_decoded(path, bytes, &decoder)?;
    // The decoder fills what is missing with grey and says nothing.
    if width == 0 || height == 0 || (format == ImageFormat::Jpeg && !jpeg_ends(bytes)) {
        return damaged(path, name).fail();
    }
    let orientation = decoder.orientation().map_err(failed)?;
    let mut image = DynamicImage::from_decoder(decoder).map_err(failed)?;
    image.apply_orientation(orientation);
    Ok(image)
}

/// Whether the pixels fit into memory: files with few pixels may have many bytes for each.
fn check_decoded(path: &Path, bytes: &[u8], decoder: &impl ImageDecoder) -> Result<()> {
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    let eight_bits = if decoder.color_type() == ColorType::Rgb8 { 0 } else { 3 * pixels };
    let decoded = decoder.total_bytes().saturating_add(eight_bits);
    if decoded > MAX_DECODED_BYTES {
        let found = format!(
            "{} MB once it is decoded, where {} MB are allowed",
            decoded / 1_000_000,
            MAX_DECODED_BYTES / 1_000_000
        );
        return too_large(path, &found).fail();
    }
    if pixels > MAX_PROGRESSIVE_PIXELS && is_progressive(bytes) {
        let found = format!("a progressive JPEG of {width}x{height} pixels, of which 16 megapixels are allowed");
        return too_large(path, &found).fail();
    }
    Ok(())
}

/// Whether the first frame of a JPEG file is coded in several passes; false for anything else.
fn is_progressive(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let [0xff, marker, rest @ ..] = &bytes[at.min(bytes.len())..] {
        match (marker, rest) {
            (0xc2 | 0xc6 | 0xca | 0xce, _) => return true,
            (0xc0 | 0xc1 | 0xd9 | 0xda, _) => return false,
            (0xff, _) => at += 1,
            (0x01 | 0xd0..=0xd7, _) => at += 2,
            (_, [high, low, ..]) => at += 2 + usize::from(u16::from_be_bytes([*high, *low])),
            _ => return false,
        }
    }
    false
}

/// Whether a JPEG file has its end marker; a thumbnail inside it has one too, so segments are walked.
fn jpeg_ends(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let [0xff, marker, rest @ ..] = &bytes[at.min(bytes.len())..] {
        match (marker, rest) {
            (0xd9, _) => return true,
            (0xff, _) => at += 1,
            (0x01 | 0xd0..=0xd7, _) => at += 2,
            (_, [high, low, ..]) => at += 2 + usize::from(u16::from_be_bytes([*high, *low])),
            _ => return false,
        }
        if *marker == 0xda {
            // Coded pixels, up to the next marker that is neither a stuffed byte nor a restart.
            let coded = bytes.get(at..).unwrap_or_default();
            let next = coded.windows(2).position(|two| two[0] == 0xff && !matches!(two[1], 0 | 0xd0..=0xd7));
            at = next.map_or(bytes.len(), |next| at + next);
        }
    }
    false
}

fn scaled(photograph: &RgbImage, width_px: usize, height_px: usize) -> Image {
    let [left, top, across, down] = shape([photograph.width(), photograph.height()], [width_px, height_px]);
    let cut = crop_imm(photograph, left, top, across, down);
    let pixels = resize(&*cut, width_px as u32, height_px as u32, FilterType::Triangle).into_raw();
    Image { width_px, height_px, format: Format::Rgb, pixels }
}

/// The middle of an image that has the shape of a wanted size: left, top, width, height.
pub(super) fn shape([width, height]: [u32; 2], wanted: [usize; 2]) -> [u32; 4] {
    let ([width, height], [wanted_width, wanted_height]) =
        ([width, height].map(u64::from), wanted.map(|size| size as u64));
    let wide = width * wanted_height > height * wanted_width;
    let (across, down) = if wide {
        ((height * wanted_width / wanted_height).max(1), height)
    } else {
        (width, (width * wanted_height / wanted_width).max(1))
    };
    [(width - across) / 2, (height - down) / 2, across, down].map(|size| size as u32)
}

pub(super) fn shown(path: &Path) -> String {
    printable(&path.display().to_string())
}

fn unreadable(path: &Path, error: &std::io::Error) -> Box<Diagnostic> {
    let mut diagnostic = Diagnostic::disk("read", path, error);
    diagnostic.code = "E-IMAGE-FILE";
    Box::new(diagnostic)
}

fn damaged(path: &Path, format: &str) -> Diagnostic {
    let message = format!("'{}' begins as a {format} image, but is damaged or ends too early", shown(path));
    Diagnostic::new("E-IMAGE-FILE", message).help("copy it from the camera again, or leave it out")
}

fn too_large(path: &Path, found: &str) -> Diagnostic {
    let message = format!(
        "'{}' is too large: {found}, at most {} MiB and {} megapixels",
        shown(path),
        MAX_FILE_BYTES >> 20,
        MAX_PIXELS / 1_000_000
    );
    Diagnostic::new("E-IMAGE-LIMIT", message).help("make it smaller first")
}

fn foreign(path: &Path, bytes: &[u8], format: Option<ImageFormat>) -> Diagnostic {
    let what = match format {
        Some(format) => format!("is a {} image", format!("{format:?}").to_uppercase()),
        None if bytes.is_empty() => "is empty".to_owned(),
        None if std::str::from_utf8(bytes).is_ok() => "is text".to_owned(),
        None => "is no image".to_owned(),
    };
    let message = format!("'{}' {what}, not PNG or JPEG", shown(path));
    Diagnostic::new("E-IMAGE-FORMAT", message).help("save the photograph as PNG or JPEG")
}
