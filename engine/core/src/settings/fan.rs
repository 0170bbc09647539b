//! Where the beams of a laser look.

/// Bearings that differ by less are the same, whatever rounding makes of them; in beams and in degrees.
const NEAR: f64 = 1e-9;

/// Beams side by side, equally far apart: beam 0 looks farthest to the right, the others follow anticlockwise.
///
/// With `n` beams over `F` degrees, beam `i` looks at `-F/2 + i F/(n - 1)` degrees from straight ahead, positive to the
/// left; over a whole circle at `-180 + i 360/n`, so that no two look the same way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanFan {
    /// How many beams there are.
    pub beams: usize,
    /// From the first beam to the last, degrees; 360 for a whole circle.
    pub view_deg: f64,
}

impl ScanFan {
    /// Whether it looks all round.
    #[must_use]
    pub fn is_whole(self) -> bool {
        self.view_deg >= 360.0
    }

    fn gaps(self) -> f64 {
        if self.is_whole() { self.beams.max(1) as f64 } else { (self.beams.max(2) - 1) as f64 }
    }

    /// Where a beam looks, degrees from straight ahead, positive to the left.
    #[must_use]
    pub fn bearing_deg(self, beam: usize) -> f64 {
        self.view_deg * beam as f64 / self.gaps() - 0.5 * self.view_deg
    }

    /// Where a beam looks, radians from straight ahead, positive to the left.
    #[must_use]
    pub fn bearing_rad(self, beam: usize) -> f64 {
        self.view_deg.to_radians() * (beam as f64 / self.gaps() - 0.5)
    }

    /// From one beam to the next, radians.
    #[must_use]
    pub fn apart_rad(self) -> f64 {
        self.view_deg.to_radians() / self.gaps()
    }

    /// Whether a bearing lies in the field of view, degrees.
    #[must_use]
    pub(crate) fn sees(self, bearing_deg: f64) -> bool {
        bearing_deg.abs() <= 0.5 * self.view_deg + NEAR
    }

    /// A bearing in beams, with a fraction.
    fn position(self, bearing_deg: f64) -> f64 {
        (bearing_deg / self.view_deg.max(NEAR) + 0.5) * self.gaps()
    }

    fn number(self, position: f64) -> usize {
        let beam = position.clamp(0.0, self.gaps()) as usize;
        // Straight behind is where the circle closes.
        if self.is_whole() { beam % self.beams.max(1) } else { beam.min(self.beams.saturating_sub(1)) }
    }

    /// The beam whose bearing is nearest to this one, the right one of two; the outermost for a bearing out of view.
    #[must_use]
    pub(crate) fn nearest(self, bearing_deg: f64) -> usize {
        self.number((self.position(bearing_deg) - NEAR).round())
    }

    /// The two beams that are nearest to a bearing, the right one first; twice the same unless both are equally near.
    #[must_use]
    pub(crate) fn neighbours(self, bearing_deg: f64) -> (usize, usize) {
        let position = self.position(bearing_deg);
        (self.number((position - NEAR).round()), self.number((position + NEAR).round()))
    }

    /// The beams whose bearings lie between two, both included, first and last; the first is the greater if there are none.
    #[must_use]
    pub(crate) fn between(self, from_deg: f64, to_deg: f64) -> (usize, usize) {
        let last = self.beams.saturating_sub(1) as f64;
        let from = (self.position(from_deg) - NEAR).ceil().max(0.0);
        let to = (self.position(to_deg) + NEAR).floor().min(last);
        if from > to { (1, 0) } else { (from as usize, to as usize) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outermost_beams_look_along_the_edges_of_the_view() {
        let fan = ScanFan { beams: 271, view_deg: 270.0 };
        assert_eq!((fan.bearing_deg(0), fan.bearing_deg(135), fan.bearing_deg(270)), (-135.0, 0.0, 135.0));
        assert_eq!((fan.nearest(90.0), fan.nearest(-90.0)), (225, 45));
        assert_eq!(fan.between(-135.0, -130.0), (0, 5));
        assert!(fan.sees(135.0) && !fan.sees(135.5));
    }

    #[test]
    fn a_whole_circle_has_no_beam_twice() {
        let fan = ScanFan { beams: 360, view_deg: 360.0 };
        assert_eq!((fan.bearing_deg(0), fan.bearing_deg(180), fan.bearing_deg(359)), (-180.0, 0.0, 179.0));
        assert_eq!((fan.nearest(90.0), fan.nearest(180.0), fan.nearest(179.8)), (270, 0, 0));
        assert_eq!(fan.between(170.0, 180.0), (350, 359));
    }

    #[test]
    fn half_a_circle_is_pi_to_the_last_bit() {
        let fan = ScanFan { beams: 181, view_deg: 180.0 };
        let pi = std::f64::consts::PI;
        assert!((0..181).all(|beam| fan.bearing_rad(beam) == pi * (beam as f64 / 180.0 - 0.5)));
        assert_eq!(fan.apart_rad(), pi / 180.0);
    }

    #[test]
    fn a_bearing_between_two_beams_has_two_neighbours() {
        let fan = ScanFan { beams: 4, view_deg: 180.0 };
        assert_eq!((fan.neighbours(0.0), fan.neighbours(90.0), fan.nearest(0.0)), ((1, 2), (3, 3), 1));
        let fan = ScanFan { beams: 5, view_deg: 360.0 };
        assert_eq!(fan.neighbours(0.0), (2, 3));
    }
}
