//! Relief: marks what does not lie on the ground.
//!
//! The camera's mount says how near flat ground is in each row of a depth image. A pixel is marked where it is more than
//! `tolerance` nearer than that, which is something that stands up, or more than `tolerance` further off, which is a drop. Where
//! the ground would be beyond `reach_m`, and above the horizon, nothing is marked. Nothing is remembered.
//!
//! The bounds of a row are rounded once, when the size of the frames is known; all else is comparisons of whole numbers.

#![deny(unsafe_code)]

use dispatch::{Processor, compiled_for_each_processor};
use filter_api::{
    Descriptor, Filter, FilterError, Format, Frame, FrameMut, Mount, NEARNESS_ONE, Parameter, ParameterKind, Plugin,
};

/// The filter, ready to be registered.
pub const PLUGIN: Plugin = Plugin { descriptor: &DESCRIPTOR, create };

// One library holds one filter, so the line is left out where several are linked together.
#[cfg(filter_library)]
filter_api::export!(PLUGIN);

const DESCRIPTOR: Descriptor = Descriptor {
    name: "relief",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks what does not lie on the ground: what stands up from it, and where it is missing.",
    reads: &[Format::Depth],
    writes: Format::Mask,
    parameters: &[
        Parameter {
            name: "tolerance",
            kind: ParameterKind::Number,
            unit: "share of the ground's nearness",
            min: 0.01,
            max: 0.5,
            default: 0.06,
            purpose: "How much nearer or further than the ground a pixel may be.",
        },
        Parameter {
            name: "reach_m",
            kind: ParameterKind::Number,
            unit: "metres",
            min: 0.1,
            max: 20.0,
            default: 6.7,
            purpose: "How far ahead of the lens the ground is looked at.",
        },
        Parameter {
            name: "holes",
            kind: ParameterKind::Switch,
            unit: "on or off",
            min: 0.0,
            max: 1.0,
            default: 0.0,
            purpose: "Whether a pixel at which nothing was measured is marked too.",
        },
    ],
};

/// The nearness at which a row is ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Bounds {
    low: u16,
    /// The highest less the lowest.
    width: u16,
}

/// Everything is ground: a row at which nothing is marked.
const ANYTHING: Bounds = Bounds { low: 0, width: u16::MAX };

struct Relief {
    tolerance: f64,
    least_nearness: f64,
    holes: bool,
    mount: Option<Mount>,
    /// The bounds of each row of frames of this height.
    rows: Vec<Bounds>,
    processor: Processor,
}

fn create(values: &[f64]) -> Result<Box<dyn Filter>, FilterError> {
    let (tolerance, reach_m, holes) = match values {
        [tolerance, reach_m, holes] => (*tolerance, *reach_m, *holes),
        _ => return Err(FilterError(format!("relief takes 3 parameters, not {}", values.len()))),
    };
    Ok(Box::new(Relief {
        tolerance,
        least_nearness: 1.0 / reach_m,
        holes: holes != 0.0,
        mount: None,
        rows: Vec::new(),
        processor: Processor::best(),
    }))
}

impl Relief {
    /// Where a row of a frame of this height is ground.
    fn bounds(&self, mount: &Mount, row: usize, height_px: usize) -> Bounds {
        let down = (row as f64 + 0.5 - 0.5 * height_px as f64) / mount.focal_px;
        let ground = (mount.tilt_sin + down * mount.tilt_cos) / mount.height_m;
        if ground <= self.least_nearness {
            return ANYTHING;
        }
        let bound = |share: f64| (ground * share * f64::from(NEARNESS_ONE)).round().min(f64::from(u16::MAX)) as u16;
        let (low, high) = (bound(1.0 - self.tolerance), bound(1.0 + self.tolerance));
        Bounds { low, width: high - low }
    }
}

impl Filter for Relief {
    fn mount(&mut self, mount: &Mount) -> Result<(), FilterError> {
        if mount.fisheye {
            return Err(FilterError("relief needs a pinhole lens, not a fisheye".to_owned()));
        }
        self.mount = Some(*mount);
        self.rows.clear();
        Ok(())
    }

    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if input.format() != Format::Depth {
            return Err(FilterError("relief reads depth frames".to_owned()));
        }
        let mount =
            self.mount.ok_or_else(|| FilterError("relief was not told how the camera is mounted".to_owned()))?;
        if input.width_px() == 0 || input.height_px() == 0 {
            return Ok(());
        }
        if self.rows.len() != input.height_px() {
            self.rows = (0..input.height_px()).map(|row| self.bounds(&mount, row, input.height_px())).collect();
        }
        mark(self.processor, input.pixels(), output.pixels(), &self.rows, self.holes);
        Ok(())
    }
}

compiled_for_each_processor! {
    /// Marks the pixels of each row outside of its bounds, as many rows as there are bounds, at least one.
    fn mark<'a>(pixels: &'a [u8], out: &'a mut [u8], rows: &'a [Bounds], holes: bool) {
        let width = out.len() / rows.len();
        let lines = pixels.chunks_exact(2 * width).zip(out.chunks_exact_mut(width));
        for ((pixels, out), bounds) in lines.zip(rows) {
            mark_row(pixels, out, *bounds, holes);
        }
    }
}

/// Marks a row; a pixel at which nothing was measured only if `holes` says so, and then only where there are bounds.
#[inline(always)]
fn mark_row(pixels: &[u8], out: &mut [u8], bounds: Bounds, holes: bool) {
    let Bounds { low, width } = bounds;
    let hole = if holes && bounds != ANYTHING { 255 } else { 0 };
    for (pixel, out) in pixels.chunks_exact(2).zip(out) {
        let nearness = u16::from_le_bytes([pixel[0], pixel[1]]);
        // Below the lowest it wraps round, and is greater than the width too.
        let marked = if nearness.wrapping_sub(low) > width { 255 } else { 0 };
        *out = if nearness == 0 { hole } else { marked };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One metre high, looking down so that sine and cosine are 0.6 and 0.8; the focal length is 4 pixels.
    const MOUNT: Mount =
        Mount { focal_px: 4.0, fisheye: false, forward_m: 0.0, height_m: 1.0, tilt_sin: 0.6, tilt_cos: 0.8 };

    fn mask(values: &[f64; 3], width: usize, nearness: &[u16]) -> Vec<u8> {
        let pixels: Vec<u8> = nearness.iter().flat_map(|nearness| nearness.to_le_bytes()).collect();
        let mut out = vec![7; nearness.len()];
        let height = nearness.len() / width;
        let mut filter = create(values).unwrap();
        filter.mount(&MOUNT).unwrap();
        let input = Frame::new(width, height, Format::Depth, &pixels).unwrap();
        filter.process(input, FrameMut::new(width, height, Format::Mask, &mut out).unwrap()).unwrap();
        out
    }

    #[test]
    fn what_is_off_the_ground_by_more_than_the_tolerance_is_marked() {
        // Rows half a pixel above and below the middle: ground at 0.6 -+ 0.8 * 0.5 / 4 = 0.5 and 0.7 1/m, which are 4096 and
        // 5734.4. A tenth less and more: 3686.4 to 4505.6, and 5160.96 to 6307.84, rounded.
        let above = [4096, 3686, 3685, 4506, 4507];
        let below = [5734, 5161, 5160, 6308, 6309];
        let wanted = [0, 0, 255, 0, 255].repeat(2);
        assert_eq!(mask(&[0.1, 6.7, 0.0], 5, &[above, below].concat()), wanted);
    }

    #[test]
    fn ground_out_of_reach_and_the_sky_are_never_marked() {
        // Eight rows: ground at 0.6 + 0.2 * (row - 3.5) = -0.1, 0.1, 0.3 ... 1/m. Up to 2.5 m is 0.4 1/m and more.
        let mask = mask(&[0.06, 2.5, 0.0], 1, &[65_535; 8]);
        assert_eq!(mask, [0, 0, 0, 255, 255, 255, 255, 255]);
    }

    #[test]
    fn a_pixel_without_a_reading_is_marked_only_if_asked_for() {
        assert_eq!(mask(&[0.06, 2.5, 0.0], 1, &[0; 8]), [0; 8]);
        assert_eq!(mask(&[0.06, 2.5, 1.0], 1, &[0; 8]), [0, 0, 0, 255, 255, 255, 255, 255]);
    }

    #[test]
    fn every_processor_marks_the_same_pixels() {
        let pixels: Vec<u8> = (0..2 * 77_u32).map(|index| (index * 89 % 251) as u8).collect();
        let of = |processor| {
            let mut out = [7; 77];
            mark(processor, &pixels, &mut out, &[Bounds { low: 9_000, width: 20_000 }], true);
            out
        };
        assert!(Processor::all().into_iter().all(|processor| of(processor) == of(Processor::PORTABLE)));
    }

    #[test]
    fn without_the_cameras_mount_there_is_no_ground() {
        let input = Frame::new(1, 1, Format::Depth, &[0, 0]).unwrap();
        let mut out = [7];
        let output = FrameMut::new(1, 1, Format::Mask, &mut out).unwrap();
        assert!(create(&[0.06, 6.7, 0.0]).unwrap().process(input, output).is_err());
        assert!(create(&[0.06, 6.7, 0.0]).unwrap().mount(&Mount { fisheye: true, ..MOUNT }).is_err());
    }
}
