//! The law of filters, tried at length: what every filter in every form must pass.

use filter_api::{Format, Frame, FrameMut, Parameter};

use super::entry::Entry;
use super::law::{TRIAL_MOUNT, broken, noise};
use super::purity::check_kept;
use super::running::Running;
use crate::diagnostic::Result;

/// Width and height in pixels, with the smallest there are, single rows and columns, odd and even.
const SIZES: [(usize, usize); 10] =
    [(1, 1), (1, 2), (2, 1), (7, 1), (1, 7), (2, 2), (3, 3), (5, 4), (16, 12), (33, 17)];

/// Runs a filter over frames of noise, of every format that it reads and many sizes, with its defaults, each parameter at
/// both of its ends, and all at their ends together. Returns how many frames it saw.
///
/// # Errors
/// If it refuses its defaults or the ends of its ranges, fails on a frame, leaves a byte unwritten, remembers another frame,
/// or writes something else than a mask.
pub fn conformance(entry: &Entry) -> Result<u64> {
    let all = settings(entry.descriptor.parameters);
    let mut frames = 0;
    for (index, values) in all.iter().enumerate() {
        // Values may be in range and yet not go together, but never the defaults, nor all at their least or greatest.
        let must = index == 0 || index + 2 >= all.len();
        match (entry.create)(values) {
            Ok(used) => frames += check_instance(entry, values, used)?,
            Err(error) if must => return Err(error),
            Err(_) => {}
        }
    }
    Ok(frames)
}

/// One set of values: an instance that has seen other frames answers as a fresh one does.
fn check_instance(entry: &Entry, values: &[f64], mut used: Box<dyn Running>) -> Result<u64> {
    let mut frames = 0;
    used.mount(&TRIAL_MOUNT)?;
    let keeps = used.keeps() > 0;
    for format in entry.descriptor.reads {
        if keeps {
            check_kept(entry, values, *format)?;
            frames += 8;
        }
        for (index, size) in SIZES.into_iter().enumerate() {
            let pixels = noise(index as u32, *format, size.0 * size.1);
            let mut fresh = (entry.create)(values)?;
            fresh.mount(&TRIAL_MOUNT)?;
            if keeps {
                // What it kept belongs to other frames.
                used = (entry.create)(values)?;
                used.mount(&TRIAL_MOUNT)?;
            }
            let wanted = output(entry, fresh.as_mut(), *format, size, &pixels, 7)?;
            let place = format!("{values:?} on {format:?} of {}x{} pixels", size.0, size.1);
            for before in if keeps { &[99][..] } else { &[7, 99] } {
                let before = *before;
                if output(entry, used.as_mut(), *format, size, &pixels, before)? != wanted {
                    return broken(
                        entry,
                        &format!("with {place} it leaves bytes unwritten or remembers another frame"),
                    );
                }
            }
            if entry.descriptor.writes == Format::Mask && wanted.iter().any(|byte| !matches!(byte, 0 | 255)) {
                return broken(entry, &format!("with {place} its mask holds bytes besides 0 and 255"));
            }
            frames += 3;
        }
    }
    if entry.descriptor.reads.starts_with(&[Format::Grey]) && entry.descriptor.reads.contains(&Format::Rgb) {
        frames += check_brightness(entry, values)?;
    }
    Ok(frames)
}

/// A filter that likes grey best must see nothing of colour but its brightness, since hosts pass either.
fn check_brightness(entry: &Entry, values: &[f64]) -> Result<u64> {
    let mut filter = (entry.create)(values)?;
    filter.mount(&TRIAL_MOUNT)?;
    if filter.keeps() > 0 {
        return Ok(0);
    }
    for (index, size) in SIZES.into_iter().enumerate() {
        let colours = noise(index as u32, Format::Rgb, size.0 * size.1);
        let mut luma = vec![0; size.0 * size.1];
        let whole = Frame::new(size.0, size.1, Format::Rgb, &colours).and_then(|frame| frame.write_luma(&mut luma));
        let of_colours = output(entry, filter.as_mut(), Format::Rgb, size, &colours, 7)?;
        let of_grey = output(entry, filter.as_mut(), Format::Grey, size, &luma, 7)?;
        if whole.is_err() || of_colours != of_grey {
            return broken(entry, "it says that it likes grey best, but sees more of a colour than its brightness");
        }
    }
    Ok(2 * SIZES.len() as u64)
}

/// What a filter makes of a frame, in a buffer full of `before`.
fn output(
    entry: &Entry,
    filter: &mut dyn Running,
    format: Format,
    (width, height): (usize, usize),
    pixels: &[u8],
    before: u8,
) -> Result<Vec<u8>> {
    let writes = entry.descriptor.writes;
    let mut out = vec![before; width * height * writes.channels()];
    let (Ok(input), Ok(to)) =
        (Frame::new(width, height, format, pixels), FrameMut::new(width, height, writes, &mut out))
    else {
        return broken(entry, "the sizes of its frames are impossible");
    };
    filter.process(input, to)?;
    Ok(out)
}

/// Defaults; every parameter alone at its least and greatest value; all at their least; all at their greatest.
fn settings(parameters: &[Parameter]) -> Vec<Vec<f64>> {
    let default: Vec<f64> = parameters.iter().map(|parameter| parameter.default).collect();
    let alone = parameters.iter().enumerate().flat_map(|(index, parameter)| {
        [parameter.min, parameter.max].map(|end| {
            let mut values = default.clone();
            values[index] = end;
            values
        })
    });
    let least = parameters.iter().map(|parameter| parameter.min).collect();
    let greatest = parameters.iter().map(|parameter| parameter.max).collect();
    std::iter::once(default.clone()).chain(alone).chain([least, greatest]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::Catalogue;

    #[test]
    fn every_linked_in_filter_keeps_the_law() {
        let filters = Catalogue::linked_in();
        for (name, _, _) in filters.list() {
            // Defaults and the ends of all ranges at least, in one format and ten sizes, three frames each.
            assert!(conformance(&filters.find(name).unwrap()).unwrap() >= 90, "{name}");
        }
    }
}
