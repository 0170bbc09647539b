//! Everything that a reward may read: measurements of one step, never the truth.

use super::odometry::Odometry;
use super::view_facts::ViewFacts;
use crate::settings::ScanFan;

/// The measurements that rules and `fn reward(facts)` read, refilled in every step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
    /// Laser ranges, metres, beam 0 rightmost.
    pub ranges_m: Vec<f32>,
    /// What each view sees, the first one first.
    pub views: Vec<ViewFacts>,
    /// The state that the grid was coded into.
    pub state: usize,
    /// Index of the action that was carried out.
    pub action: usize,
    /// Commanded forward speed, m/s.
    pub action_linear_m_per_s: f64,
    /// Commanded turning speed, rad/s, anticlockwise positive.
    pub action_angular_rad_per_s: f64,
    /// Whether the body touched something.
    pub contact: bool,
    /// Whether the robot fell off an edge.
    pub fallen: bool,
    /// Measured forward speed, m/s.
    pub linear_m_per_s: f64,
    /// Measured turning speed, rad/s.
    pub angular_rad_per_s: f64,
    /// Steps since learning or the test began.
    pub step: u64,
    /// Steps since the last recovery or the start.
    pub since_recovery: u64,
    /// The laser's least and greatest range, metres.
    pub laser_range_m: (f64, f64),
    /// The colours of the ground under the middle, left and right sensor: red, green, blue.
    pub ground: [[u8; 3]; 3],
    /// How far the laser looks from the first beam to the last, degrees.
    pub laser_view_deg: f64,
    /// Time since the attempt began, seconds; worked out by the judge, as is all that follows.
    pub attempt_s: f64,
    /// What the wheels counted since the attempt began.
    pub odometry: Odometry,
    /// The stage, from 0, the steps since it was entered, and what the wheels had counted then.
    pub stage: StageFacts,
}

/// `facts.action` where none has been carried out yet: read as -1.
pub const NO_ACTION: usize = usize::MAX;

/// The stage of a behaviour, as rules read it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageFacts {
    /// Its number, from 0.
    pub index: usize,
    /// Steps since it was entered.
    pub steps: u64,
    /// Time since it was entered, seconds.
    pub seconds: f64,
    /// Way since then, counted by the wheels, metres.
    pub distance_m: f64,
    /// Turn since then, degrees, positive to the left.
    pub turned_deg: f64,
}

impl Facts {
    /// The range of one beam, metres; 0 if there is no such beam.
    #[must_use]
    pub(super) fn beam_m(&self, beam: usize) -> f64 {
        self.ranges_m.get(beam).map_or(0.0, |&range| decimal(range))
    }

    /// The ranges of the beams `from` to `to`, both included, metres; empty if there are no such beams.
    #[must_use]
    pub(super) fn sector_m(&self, from: usize, to: usize) -> &[f32] {
        self.ranges_m.get(from..=to).unwrap_or_default()
    }

    /// Where the beams look.
    fn fan(&self) -> ScanFan {
        ScanFan { beams: self.ranges_m.len(), view_deg: self.laser_view_deg }
    }

    /// The beam whose bearing is nearest to this one, the right one of two; the outermost for a bearing beyond it.
    #[must_use]
    pub(super) fn beam_at(&self, bearing_deg: f64) -> usize {
        self.fan().nearest(bearing_deg)
    }

    /// The beams whose bearings lie between two, both included; nothing if there are none.
    #[must_use]
    pub(super) fn beams_between(&self, from_deg: f64, to_deg: f64) -> (usize, usize) {
        self.fan().between(from_deg, to_deg)
    }

    /// Whether a beam met anything nearer than the greatest range.
    #[must_use]
    pub(super) fn hit(&self, beam: usize) -> bool {
        self.ranges_m.get(beam).is_some_and(|range| decimal(*range) < self.laser_range_m.1)
    }

    /// The beam towards a bearing; of two that are equally near that with the lesser range, the right one of equals.
    #[must_use]
    pub(super) fn beam_towards(&self, bearing_deg: f64) -> usize {
        let (right, left) = self.fan().neighbours(bearing_deg);
        if self.ranges_m.get(left) < self.ranges_m.get(right) { left } else { right }
    }

    /// The beam with the least range, the rightmost of equals.
    #[must_use]
    pub(crate) fn nearest_beam(&self) -> usize {
        let least = least(&self.ranges_m);
        self.ranges_m.iter().position(|&range| range == least).unwrap_or(0)
    }

    /// What a view sees; nothing for a view that there is not.
    #[must_use]
    pub(super) fn view(&self, view: usize) -> &ViewFacts {
        static NOTHING: ViewFacts = ViewFacts::NOTHING;
        self.views.get(view).unwrap_or(&NOTHING)
    }
}

/// The decimal number that a sensor's single-precision number stands for, to a millionth.
///
/// 0.2 in single precision is a little more than 0.2 in double precision: without this, a beam at a laser's least range of
/// 0.2 m would not be `<= 0.2`.
#[must_use]
pub(crate) fn decimal(measured: f32) -> f64 {
    // Adding and taking away 1.5 * 2^52 rounds to a whole number, several times faster than `round`.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    (f64::from(measured) * 1e6 + ROUND - ROUND) / 1e6
}

/// The least of some ranges, metres; infinite if there are none.
#[must_use]
pub(crate) fn least(ranges_m: &[f32]) -> f32 {
    fold(ranges_m, f32::INFINITY, |a, b| if b < a { b } else { a })
}

/// The greatest of some ranges, metres; minus infinity if there are none.
#[must_use]
pub(crate) fn greatest(ranges_m: &[f32]) -> f32 {
    fold(ranges_m, f32::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

/// Their mean, metres; not a number if there are none.
#[must_use]
pub(crate) fn mean(ranges_m: &[f32]) -> f64 {
    ranges_m.iter().copied().map(f64::from).sum::<f64>() / ranges_m.len() as f64
}

/// How many of them are less than `limit_m`.
#[must_use]
pub(crate) fn count_below(ranges_m: &[f32], limit_m: f64) -> usize {
    ranges_m.iter().filter(|&&range| decimal(range) < limit_m).count()
}

/// How far the worst of them lies beyond its expected range, metres.
#[must_use]
pub(crate) fn excess(ranges_m: &[f32], expected_m: &[f64]) -> f64 {
    let differences = ranges_m.iter().zip(expected_m).map(|(&range, expected)| decimal(range) - expected);
    differences.fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

// Eight running values instead of one: the compiler makes vector instructions of them. The order of the comparisons does
// not change the result, because ranges are never NaN.
fn fold(values: &[f32], start: f32, choose: impl Fn(f32, f32) -> f32) -> f32 {
    const LANES: usize = 8;
    let mut lanes = [start; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for lane in 0..LANES {
            lanes[lane] = choose(lanes[lane], chunk[lane]);
        }
    }
    let first = lanes.into_iter().fold(start, &choose);
    rest.iter().copied().fold(first, choose)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(ranges_m: &[f32]) -> Facts {
        Facts { ranges_m: ranges_m.to_vec(), ..Facts::default() }
    }

    #[test]
    fn the_nearest_beam_is_the_rightmost_of_equals() {
        assert_eq!(scan(&[3.0, 1.0, 2.0, 1.0]).nearest_beam(), 1);
    }

    #[test]
    fn a_beam_at_two_tenths_reads_as_two_tenths() {
        assert_eq!(scan(&[0.2]).beam_m(0), 0.2);
        assert_eq!(scan(&[8.192]).beam_m(0), 8.192);
    }

    #[test]
    fn least_and_greatest_look_at_every_value() {
        for at in 0..37 {
            let mut ranges = vec![2.0; 37];
            ranges[at] = 1.0;
            assert_eq!((least(&ranges), greatest(&ranges)), (1.0, 2.0));
            ranges[at] = 3.0;
            assert_eq!((least(&ranges), greatest(&ranges)), (2.0, 3.0));
        }
    }

    #[test]
    fn the_excess_is_the_greatest_one() {
        assert_eq!(excess(&[1.0, 2.5, 1.0], &[1.0, 2.0, 3.0]), 0.5);
    }
}
