//! The law's first clause, tried when a stranger's filter is loaded: the same frame gives the same output, whatever was
//! processed before; or, of a filter that keeps something, the same sequence does, from the beginning or from what was kept.

use filter_api::{Format, Frame, FrameMut};

use super::entry::Entry;
use super::law::{TRIAL_MOUNT, broken, noise, trial_moved};
use super::running::Running;
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
    let mut kept = None;
    for round in 0..2 {
        let mut running = (entry.create)(values)?;
        running.mount(&TRIAL_MOUNT)?;
        if running.keeps() > 0 {
            let all = sequence(entry, running.as_mut(), reads, 0, None)?;
            match kept.replace(all) {
                Some(before) if kept.as_ref() != Some(&before) => {
                    return broken(entry, "it answered one sequence in two ways");
                }
                _ => {}
            }
            if round == 1 {
                return check_kept(entry, values, reads);
            }
            continue;
        }
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

/// What it makes of frame after frame from number `from` on; `middle` is what it keeps after the third.
fn sequence(
    entry: &Entry,
    running: &mut dyn Running,
    reads: Format,
    from: usize,
    mut middle: Option<&mut Vec<u8>>,
) -> Result<Vec<Vec<u8>>> {
    let writes = entry.descriptor.writes;
    let mut all = Vec::new();
    for (index, frame) in ORDER.into_iter().enumerate().skip(from) {
        if let (3, Some(kept)) = (index, middle.as_deref_mut()) {
            kept.resize(running.keeps(), 0);
            running.save(kept)?;
        }
        let pixels = noise(frame, reads, WIDTH_PX * HEIGHT_PX);
        let mut out = vec![index as u8; WIDTH_PX * HEIGHT_PX * writes.channels()];
        let input = Frame::new(WIDTH_PX, HEIGHT_PX, reads, &pixels);
        let (Ok(input), Ok(output)) = (input, FrameMut::new(WIDTH_PX, HEIGHT_PX, writes, &mut out)) else {
            return broken(entry, "the sizes of its frames are impossible");
        };
        running.moved(&trial_moved(index))?;
        running.process(input, output)?;
        if writes == Format::Mask && out.iter().any(|byte| !matches!(byte, 0 | 255)) {
            return broken(entry, "its mask holds bytes besides 0 and 255");
        }
        all.push(out);
    }
    Ok(all)
}

/// Whoever loads what another one kept goes on as that one does.
pub(super) fn check_kept(entry: &Entry, values: &[f64], reads: Format) -> Result<()> {
    let make = || -> Result<Box<dyn Running>> {
        let mut running = (entry.create)(values)?;
        running.mount(&TRIAL_MOUNT)?;
        Ok(running)
    };
    let (mut first, mut second, mut kept) = (make()?, make()?, Vec::new());
    let whole = sequence(entry, first.as_mut(), reads, 0, Some(&mut kept))?;
    second.load(&kept)?;
    if sequence(entry, second.as_mut(), reads, 3, None)? != whole[3..] {
        return broken(entry, "it goes on in another way from what it kept");
    }
    Ok(())
}
