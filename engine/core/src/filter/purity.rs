//! The law's first clause, tried when a stranger's filter is loaded: the same frame gives the same output, whatever was
//! processed before.

use filter_api::{Format, Frame, FrameMut};

use super::entry::Entry;
use super::law::{broken, noise};
use crate::diagnostic::Result;

const WIDTH_PX: usize = 24;
const HEIGHT_PX: usize = 16;
/// One frame comes twice in a row, so that what flips with every frame shows, and the first comes again after all others.
const ORDER: [u32; 5] = [0, 1, 1, 2, 0];

/// Runs a filter with its parameters over a few frames of noise.
///
/// # Errors
/// If it fails on one of them, answers differently when a frame comes again, or writes something else than a mask.
pub(super) fn check_purity(entry: &Entry, values: &[f64], reads: Format) -> Result<()> {
    let writes = entry.descriptor.writes;
    let mut first: [Option<Vec<u8>>; 3] = [None, None, None];
    for round in 0..2 {
        let mut running = (entry.create)(values)?;
        for (index, frame) in ORDER.into_iter().enumerate() {
            let pixels = noise(frame, reads, WIDTH_PX * HEIGHT_PX);
            // What stood in the output before must not matter either.
            let before = (round * ORDER.len() + index) as u8;
            let mut out = vec![before; WIDTH_PX * HEIGHT_PX * writes.channels()];
            let input = Frame::new(WIDTH_PX, HEIGHT_PX, reads, &pixels);
            let (Ok(input), Ok(output)) = (input, FrameMut::new(WIDTH_PX, HEIGHT_PX, writes, &mut out)) else {
                return broken(entry, "the sizes of its frames are impossible");
            };
            running.process(input, output)?;
            if writes == Format::Mask && out.iter().any(|byte| !matches!(byte, 0 | 255)) {
                return broken(entry, "its mask holds bytes besides 0 and 255");
            }
            match &first[frame as usize] {
                Some(before) if *before != out => return broken(entry, "it answered one frame in two ways"),
                _ => first[frame as usize] = Some(out),
            }
        }
    }
    Ok(())
}
