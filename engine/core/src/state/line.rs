//! The line that a patch shows: the middles of its rows, put onto the floor and fitted.

use super::Patch;
use crate::geometry::Point2;

/// Points are taken this far ahead of the robot's centre, metres.
const AHEAD_M: (f64, f64) = (0.1, 3.0);
/// A line needs so many points, over so much way ahead, metres.
const LEAST_POINTS: u32 = 3;
const LEAST_LENGTH_M: f64 = 0.1;

/// y = offset + slope x on the floor, in the robot's axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorLine {
    /// How far left of the robot's centre it passes, metres.
    pub offset_m: f64,
    /// Where it leads: left for each metre ahead.
    pub slope: f64,
}

/// The line through the middles between the leftmost and the rightmost foreground pixel of each row of a patch; `floor_m` puts a
/// place of the image onto the floor. Nothing if too little of it is seen.
#[must_use]
pub fn floor_line(
    mask: &[u8],
    width_px: usize,
    patch: &Patch,
    floor_m: impl Fn(f64, f64) -> Option<Point2>,
) -> Option<FloorLine> {
    let (left, right) = (patch.columns.0 as usize, patch.columns.1 as usize);
    let (mut count, mut x, mut y, mut xx, mut xy) = (0_u32, 0.0, 0.0, 0.0, 0.0);
    let mut ends = (f64::INFINITY, f64::NEG_INFINITY);
    for row in patch.rows.0..=patch.rows.1 {
        let pixels = mask.get(row as usize * width_px..)?.get(left..=right)?;
        let (Some(first), Some(last)) =
            (pixels.iter().position(|pixel| *pixel != 0), pixels.iter().rposition(|pixel| *pixel != 0))
        else {
            continue;
        };
        let middle = left as f64 + 0.5 * (first + last + 1) as f64;
        let Some(at) = floor_m(middle, f64::from(row) + 0.5) else { continue };
        if !(AHEAD_M.0..=AHEAD_M.1).contains(&at.x) {
            continue;
        }
        count += 1;
        (x, y, xx, xy) = (x + at.x, y + at.y, xx + at.x * at.x, xy + at.x * at.y);
        ends = (ends.0.min(at.x), ends.1.max(at.x));
    }
    if count < LEAST_POINTS || ends.1 - ends.0 < LEAST_LENGTH_M {
        return None;
    }
    let n = f64::from(count);
    let slope = (n * xy - x * y) / (n * xx - x * x);
    Some(FloorLine { offset_m: (y - slope * x) / n, slope })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::PatchFinder;

    #[test]
    fn a_line_is_fitted_through_the_middles_of_the_rows() {
        // Row r shows the floor at 1 - 0.2 r metres ahead, column c at (2 - c) / 10 metres to the left.
        let rows = ["...##", "..##.", ".##..", "##..."];
        let mask: Vec<u8> = rows.concat().bytes().map(|c| if c == b'#' { 255 } else { 0 }).collect();
        let patch = PatchFinder::new(5, 4).find(&mask, 5);
        let floor = |x: f64, y: f64| Some(Point2::new(1.0 - 0.2 * (y - 0.5), (2.0 - x) / 10.0));
        let line = floor_line(&mask, 5, &patch, floor).unwrap();
        // The middles are columns 4, 3, 2, 1 at 1.0, 0.8, 0.6, 0.4 m: each 0.2 m nearer lies 0.1 m farther left.
        assert!((line.slope + 0.5).abs() < 1e-12 && (line.offset_m - 0.3).abs() < 1e-12, "{line:?}");
        assert_eq!(floor_line(&mask, 5, &patch, |_, _| None), None);
    }
}
