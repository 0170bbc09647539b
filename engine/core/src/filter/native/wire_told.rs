//! The fields of requests that tell an isolated filter more than frames.

use std::io::{Error, ErrorKind, Read, Result, Write};

use filter_api::{Mount, Moved};

use super::wire::{read_array, read_number};

/// The most bytes that are loaded at once.
const LONGEST_KEPT_BYTES: usize = 1 << 20;

pub(super) fn write_mount(to: &mut impl Write, request: u8, mount: &Mount) -> Result<()> {
    let Mount { focal_px, fisheye, forward_m, height_m, tilt_sin, tilt_cos } = *mount;
    to.write_all(&[request])?;
    write_numbers(to, &[focal_px, forward_m, height_m, tilt_sin, tilt_cos])?;
    to.write_all(&[fisheye.into()])
}

pub(super) fn read_mount(from: &mut impl Read) -> Result<Mount> {
    let [focal_px, forward_m, height_m, tilt_sin, tilt_cos] = read_numbers(from)?;
    Ok(Mount { focal_px, fisheye: read_flag(from)?, forward_m, height_m, tilt_sin, tilt_cos })
}

pub(super) fn write_moved(to: &mut impl Write, request: u8, moved: &Moved) -> Result<()> {
    to.write_all(&[request])?;
    write_numbers(to, &[moved.driven_m, moved.turned_rad])?;
    to.write_all(&[moved.jumped.into()])
}

pub(super) fn read_moved(from: &mut impl Read) -> Result<Moved> {
    let [driven_m, turned_rad] = read_numbers(from)?;
    Ok(Moved { driven_m, turned_rad, jumped: read_flag(from)? })
}

/// What a filter is to go on from.
pub(super) fn read_kept(from: &mut impl Read) -> Result<Vec<u8>> {
    let bytes = read_number(from)?;
    if bytes > LONGEST_KEPT_BYTES {
        return Err(Error::new(ErrorKind::InvalidData, "more than a filter may keep"));
    }
    let mut kept = vec![0; bytes];
    from.read_exact(&mut kept)?;
    Ok(kept)
}

fn write_numbers(to: &mut impl Write, numbers: &[f64]) -> Result<()> {
    numbers.iter().try_for_each(|number| to.write_all(&number.to_le_bytes()))
}

fn read_numbers<const COUNT: usize>(from: &mut impl Read) -> Result<[f64; COUNT]> {
    let mut numbers = [0.0; COUNT];
    for number in &mut numbers {
        *number = f64::from_le_bytes(read_array(from)?);
    }
    Ok(numbers)
}

fn read_flag(from: &mut impl Read) -> Result<bool> {
    Ok(read_array::<1>(from)? != [0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_filter_is_told_is_read_as_it_was_written() {
        let mount =
            Mount { focal_px: 95.5, fisheye: true, forward_m: 0.1, height_m: 0.8, tilt_sin: 0.6, tilt_cos: 0.8 };
        let moved = Moved { driven_m: 0.15, turned_rad: -0.2, jumped: true };
        let mut bytes = Vec::new();
        write_mount(&mut bytes, 3, &mount).unwrap();
        let first = bytes.len();
        write_moved(&mut bytes, 4, &moved).unwrap();
        assert_eq!(read_mount(&mut &bytes[1..]).unwrap(), mount);
        assert_eq!(read_moved(&mut &bytes[first + 1..]).unwrap(), moved);
    }
}
