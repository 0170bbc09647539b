//! The law's first clause, tried when a stranger's filter is loaded: the same frame gives the same output, whatever was
//! processed before.

use filter_api::{Format, Frame, FrameMut};

use super::catalogue::{Entry, Form};
use crate::diagnostic::{Diagnostic, Kind, Result};

const WIDTH_PX: usize = 24;
const HEIGHT_PX: usize = 16;
/// The first frame comes again after the others, and a fresh instance sees it too.
const ORDER: [u32; 5] = [0, 1, 2, 1, 0];

/// Runs a filter with its parameters over a few frames of noise.
///
/// # Errors
/// If it fails on one of them, answers differently when a frame comes again, or writes a mask that is none.
pub(super) fn check(entry: &Entry, values: &[f64], reads: Format) -> Result<()> {
    let descriptor = entry.descriptor;
    let wrong = |what: &str| -> Result<()> {
        let code = if entry.form == Form::Wasm { "E-WASM-STATE" } else { "E-NATIVE-STATE" };
        let message = format!("filter '{}' breaks the law of filters: {what}", descriptor.name);
        let help = "tell its author: the same frame and parameters must give the same output";
        Diagnostic::new(Kind::Limit, code, message).help(help).into()
    };
    let mut first: [Option<Vec<u8>>; 3] = [None, None, None];
    for _ in 0..2 {
        let mut running = (entry.create)(values)?;
        for frame in ORDER {
            let pixels = noise(frame, reads);
            // What stood in the output before must not matter either.
            let mut out = vec![frame as u8; WIDTH_PX * HEIGHT_PX * descriptor.writes.channels()];
            let (Ok(input), Ok(output)) = (
                Frame::new(WIDTH_PX, HEIGHT_PX, reads, &pixels),
                FrameMut::new(WIDTH_PX, HEIGHT_PX, descriptor.writes, &mut out),
            ) else {
                return Ok(());
            };
            running.process(input, output)?;
            if descriptor.writes == Format::Mask && out.iter().any(|byte| !matches!(byte, 0 | 255)) {
                return wrong("its mask holds bytes besides 0 and 255");
            }
            match &first[frame as usize] {
                Some(before) if *before != out => return wrong("it answered one frame in two ways"),
                _ => first[frame as usize] = Some(out),
            }
        }
    }
    Ok(())
}

/// A frame of noise, the same on every machine: the multiplication hash of Knuth, volume 3, section 6.4.
fn noise(frame: u32, format: Format) -> Vec<u8> {
    let length = WIDTH_PX * HEIGHT_PX * format.channels();
    let byte = |index: usize| ((index as u32 + 1).wrapping_mul(2_654_435_761).wrapping_add(frame << 24) >> 24) as u8;
    let bytes = (0..length).map(byte);
    if format == Format::Mask { bytes.map(|byte| if byte < 128 { 0 } else { 255 }).collect() } else { bytes.collect() }
}
