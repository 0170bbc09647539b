//! A line over the floor: where laps are measured and movers drive.

use crate::geometry::{Point2, Pose, wrap_angle};

/// How far from a route is still on it where the world file does not say, metres.
const HALF_WIDTH_M: f64 = 1.0;
/// A corner is rounded by pieces that turn at most this much.
const PIECE_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// A polyline over the floor plan, open or closed, measured by the distance along it.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// The name in the world file.
    pub name: String,
    /// Whether its end is joined to its beginning.
    pub closed: bool,
    /// How far from it is still on it, metres.
    pub half_width_m: f64,
    points: Vec<Point2>,
    segments: Vec<Segment>,
    length_m: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Segment {
    from: Point2,
    /// Unit direction.
    direction: [f64; 2],
    length_m: f64,
    /// Distance along the route at `from`.
    start_m: f64,
    yaw_rad: f64,
}

impl Route {
    /// A route through `points`, of which there must be at least two, none equal to the one before it.
    #[must_use]
    pub(super) fn new(name: impl Into<String>, points: Vec<Point2>, closed: bool) -> Self {
        let mut segments: Vec<Segment> = Vec::with_capacity(points.len());
        let mut length_m = 0.0;
        let ends = points.iter().skip(1).chain(points.first().filter(|_| closed));
        for (from, to) in points.iter().zip(ends) {
            let (x, y) = (to.x - from.x, to.y - from.y);
            let length = (x * x + y * y).sqrt();
            let (direction, yaw_rad) = ([x / length, y / length], libm::atan2(y, x));
            segments.push(Segment { from: *from, direction, length_m: length, start_m: length_m, yaw_rad });
            length_m += length;
        }
        Self { name: name.into(), closed, half_width_m: HALF_WIDTH_M, points, segments, length_m }
    }

    /// The points in order; the first is not repeated at the end of a closed route.
    #[must_use]
    pub fn points(&self) -> &[Point2] {
        &self.points
    }

    /// The points as a line to draw: a closed route ends where it begins.
    pub fn drawn(&self) -> impl Iterator<Item = Point2> {
        self.points.iter().chain(self.points.first().filter(|_| self.closed)).copied()
    }

    /// The length, metres; of a closed route, that of one lap.
    #[must_use]
    pub(crate) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// The place and heading `along_m` metres from the beginning. A closed route repeats; an open one ends.
    #[must_use]
    pub(crate) fn pose_at(&self, along_m: f64) -> Pose {
        let along_m = if self.closed {
            along_m - self.length_m * (along_m / self.length_m).floor()
        } else {
            along_m.clamp(0.0, self.length_m)
        };
        let next = self.segments.partition_point(|segment| segment.start_m <= along_m);
        let Some(segment) = self.segments.get(next.saturating_sub(1)) else { return Pose::default() };
        let rest = (along_m - segment.start_m).min(segment.length_m);
        let [x, y] = segment.direction;
        Pose::new(segment.from.x + rest * x, segment.from.y + rest * y, segment.yaw_rad)
    }

    /// A distance along the route brought within its length, metres.
    #[must_use]
    pub(super) fn within(&self, along_m: f64) -> f64 {
        if self.closed {
            along_m - self.length_m * (along_m / self.length_m).floor()
        } else {
            along_m.min(self.length_m)
        }
    }

    /// The nearest place of the route: its distance along the route and its distance from `point`, both metres.
    #[must_use]
    pub(crate) fn nearest(&self, point: Point2) -> (f64, f64) {
        self.nearest_between(point, 0.0, self.length_m)
    }

    /// The nearest place of the stretch from `low_m` to `high_m`; on a closed route these may lie up to one lap outside.
    pub(super) fn nearest_between(&self, point: Point2, low_m: f64, high_m: f64) -> (f64, f64) {
        let mut best = (low_m, f64::MAX);
        for lap in [0.0, -1.0, 1.0] {
            let (low_m, high_m, lap_m) =
                (low_m - lap * self.length_m, high_m - lap * self.length_m, lap * self.length_m);
            if (lap != 0.0 && !self.closed) || high_m < 0.0 || low_m > self.length_m {
                continue;
            }
            let first = self.segments.partition_point(|segment| segment.start_m + segment.length_m < low_m);
            for segment in self.segments[first..].iter().take_while(|segment| segment.start_m <= high_m) {
                let (low, high) =
                    ((low_m - segment.start_m).max(0.0), (high_m - segment.start_m).min(segment.length_m));
                if low > high {
                    continue;
                }
                let (x, y) = (point.x - segment.from.x, point.y - segment.from.y);
                let [dx, dy] = segment.direction;
                let rest = (x * dx + y * dy).clamp(low, high);
                let (x, y) = (x - rest * dx, y - rest * dy);
                let square = x * x + y * y;
                if square < best.1 {
                    best = (lap_m + segment.start_m + rest, square);
                }
            }
        }
        (best.0, best.1.sqrt())
    }
}

/// The points of a line whose corners are rounded with `radius_m`.
///
/// # Errors
/// The index of the first corner with no room for the arc, and the radius that both neighbours leave room for.
pub(crate) fn rounded(points: &[Point2], closed: bool, radius_m: f64) -> Result<Vec<Point2>, (usize, f64)> {
    let count = points.len();
    if radius_m <= 0.0 || count < 3 {
        return Ok(points.to_vec());
    }
    let mut out = Vec::with_capacity(count * 8);
    for index in 0..count {
        let here = points[index];
        if !closed && (index == 0 || index + 1 == count) {
            out.push(here);
            continue;
        }
        let (before, after) = (points[(index + count - 1) % count] - here, points[(index + 1) % count] - here);
        let (shortest, incoming) = (before.norm().min(after.norm()), libm::atan2(-before.y, -before.x));
        let turn = wrap_angle(libm::atan2(after.y, after.x) - incoming);
        if turn.abs() < 1e-9 {
            out.push(here);
            continue;
        }
        // Each corner may use half of a segment, so that two corners never meet.
        let per_radius = libm::tan(0.5 * turn.abs());
        let tangent = radius_m * per_radius;
        if tangent > 0.5 * shortest {
            return Err((index, 0.5 * shortest / per_radius));
        }
        let side = turn.signum();
        let (sin, cos) = libm::sincos(incoming);
        let begin = Point2::new(here.x - tangent * cos, here.y - tangent * sin);
        let centre = Point2::new(begin.x - side * radius_m * sin, begin.y + side * radius_m * cos);
        let pieces = (turn.abs() / PIECE_RAD).ceil().max(1.0);
        for piece in 0..=pieces as usize {
            let (sin, cos) = libm::sincos(incoming + turn * piece as f64 / pieces);
            out.push(Point2::new(centre.x + side * radius_m * sin, centre.y - side * radius_m * cos));
        }
    }
    out.dedup_by(|a, b| (*a - *b).norm() < 1e-9);
    if closed && out.len() > 2 && (out[0] - out[out.len() - 1]).norm() < 1e-9 {
        out.pop();
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn square() -> Vec<Point2> {
        vec![Point2::new(0.0, 0.0), Point2::new(4.0, 0.0), Point2::new(4.0, 4.0), Point2::new(0.0, 4.0)]
    }

    #[test]
    fn a_closed_route_repeats_and_an_open_one_ends() {
        let closed = Route::new("lap", square(), true);
        assert_eq!(closed.length_m(), 16.0);
        let pose = closed.pose_at(16.0 + 5.0);
        assert!((pose.x_m - 4.0).abs() < 1e-12 && (pose.y_m - 1.0).abs() < 1e-12);
        assert!((pose.yaw_rad - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(closed.pose_at(-1.0).y_m, 1.0);
        let open = Route::new("line", square(), false);
        assert_eq!((open.length_m(), open.pose_at(99.0).x_m, open.pose_at(-1.0).x_m), (12.0, 0.0, 0.0));
    }

    #[test]
    fn the_nearest_place_is_found_on_the_closing_segment_too() {
        let (along, distance) = Route::new("lap", square(), true).nearest(Point2::new(-0.5, 1.0));
        assert_eq!((along, distance), (15.0, 0.5));
    }

    #[test]
    fn rounding_replaces_each_corner_by_a_quarter_circle() {
        let points = rounded(&square(), true, 1.0).unwrap();
        let length = Route::new("lap", points.clone(), true).length_m();
        // Four straights of 2 m and one full circle of radius 1 m; 18 chords a quarter are 0.03 % short.
        assert!((length - (8.0 + 2.0 * PI)).abs() < 0.003, "{length}");
        assert!(points.iter().all(|point| (*point - Point2::new(4.0, 0.0)).norm() > 0.41));
    }

    #[test]
    fn a_right_turn_is_rounded_on_its_right_side() {
        let line = [Point2::new(0.0, 0.0), Point2::new(2.0, 0.0), Point2::new(2.0, -2.0)];
        let points = rounded(&line, false, 0.5).unwrap();
        let (first, last) = (points[1], points[points.len() - 2]);
        assert!((first - Point2::new(1.5, 0.0)).norm() < 1e-9 && (last - Point2::new(2.0, -0.5)).norm() < 1e-9);
    }

    #[test]
    fn a_radius_that_does_not_fit_is_answered_with_the_greatest_that_does() {
        let (corner, greatest) = rounded(&square(), true, 2.5).unwrap_err();
        assert_eq!(corner, 0);
        assert!((greatest - 2.0).abs() < 1e-9);
    }
}
