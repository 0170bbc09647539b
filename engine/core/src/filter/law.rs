//! What trials of the law of filters share: the frames, and the error for a clause that is broken.

use filter_api::{Format, Mount, Moved};

use super::entry::{Entry, Form};
use crate::diagnostic::{Diagnostic, Result};

/// A frame of noise, the same on every machine: the multiplication hash of Knuth, volume 3, section 6.4.
pub(super) fn noise(frame: u32, format: Format, pixels: usize) -> Vec<u8> {
    let seed = (frame + 1).wrapping_mul(0x9e37_79b9);
    let byte = |index: usize| {
        let hash = (index as u32 ^ seed).wrapping_mul(2_654_435_761);
        ((hash ^ (hash >> 15)).wrapping_mul(2_246_822_519) >> 24) as u8
    };
    let bytes = (0..pixels * format.channels()).map(byte);
    if format == Format::Mask { bytes.map(|byte| if byte < 128 { 0 } else { 255 }).collect() } else { bytes.collect() }
}

/// The camera of trials: 90 degrees wide on 24 pixels, 1 m high, tilted so that sine and cosine are 0.6 and 0.8.
pub(super) const TRIAL_MOUNT: Mount =
    Mount { focal_px: 12.0, fisheye: false, forward_m: 0.0, height_m: 1.0, tilt_sin: 0.6, tilt_cos: 0.8 };

/// How the robot of trials moved before a frame: put down before the first, and 30 cm on before each other.
pub(super) fn trial_moved(frame: usize) -> Moved {
    let jumped = frame == 0;
    Moved { driven_m: if jumped { 0.0 } else { 0.3 }, turned_rad: 0.0, jumped }
}

/// A clause of the law is broken.
pub(super) fn broken<T>(entry: &Entry, what: &str) -> Result<T> {
    let code = match entry.form {
        Form::LinkedIn | Form::Native => "E-NATIVE-STATE",
        Form::Wasm => "E-WASM-STATE",
    };
    let message = format!("filter '{}' breaks the law of filters: {what}", entry.descriptor.name);
    let help = "tell its author: the same frame and parameters must give the same output, every byte of it";
    Diagnostic::new(code, message).help(help).fail()
}
