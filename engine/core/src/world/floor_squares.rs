//! The floor in squares: which of them a body can reach, and which it has covered.

use super::layout::Layout;
use crate::geometry::{Point2, Pose};
use crate::settings::{BodyShape, Footprint};
use std::f64::consts::TAU;

/// Side of a square, metres.
const SIDE_M: f64 = 0.25;
/// The floor around all solids, starts and routes that still counts, metres.
const MARGIN_M: f64 = 1.0;
/// Headings in which a body is tried on a square.
const HEADINGS: u32 = 8;
/// Worlds of more squares than these, 12,500 square metres, are too large to be looked at so closely.
const MOST_SQUARES: f64 = 200_000.0;

/// Squares of 0.25 m: those that a body can cover when it drives from square to square, beginning at the starts; and those of
/// them that it has covered. A body covers a square whose middle is under it.
#[derive(Debug, Clone)]
pub(crate) struct FloorSquares {
    corner: Point2,
    columns: usize,
    squares: Vec<Square>,
    reachable: u64,
    covered: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Square {
    OutOfReach,
    Reachable,
    Covered,
}

impl FloorSquares {
    /// The squares that `body` can reach; nothing in a world that is too large.
    #[must_use]
    pub(crate) fn new(layout: &Layout, body: &BodyShape) -> Option<Self> {
        let (corner, columns, rows) = Self::lattice(layout)?;
        let squares = vec![Square::OutOfReach; columns * rows];
        let mut floor = Self { corner, columns, squares, reachable: 0, covered: 0 };
        floor.reach(layout, body);
        Some(floor)
    }

    /// Whether a world is small enough.
    #[must_use]
    pub(crate) fn fit(layout: &Layout) -> bool {
        Self::lattice(layout).is_some()
    }

    /// The lower left corner of all squares, and how many columns and rows they are.
    fn lattice(layout: &Layout) -> Option<(Point2, usize, usize)> {
        let [low, high] = bounds(layout);
        let along = |from: f64, to: f64| ((to - from) / SIDE_M).ceil().max(1.0);
        let (columns, rows) = (along(low.x, high.x), along(low.y, high.y));
        (columns * rows <= MOST_SQUARES).then_some((low, columns as usize, rows as usize))
    }

    /// Floods the floor from the starts, over the squares on whose middle the body can stand.
    fn reach(&mut self, layout: &Layout, body: &BodyShape) {
        let mut seen = vec![false; self.squares.len()];
        let mut next: Vec<usize> =
            layout.starts.iter().filter_map(|start| self.square_at(start.pose.x_m, start.pose.y_m)).collect();
        while let Some(index) = next.pop() {
            if std::mem::replace(&mut seen[index], true) {
                continue;
            }
            let middle = self.middle(index);
            let headings = (0..HEADINGS).map(|turn| TAU * f64::from(turn) / f64::from(HEADINGS));
            let poses = headings.map(|yaw_rad| Pose { x_m: middle.x, y_m: middle.y, yaw_rad });
            let mut stands = false;
            for pose in poses.filter(|pose| layout.obstruction(body, *pose).is_none()) {
                stands = true;
                self.mark(body, pose, Square::OutOfReach, Square::Reachable);
            }
            if stands {
                let (column, row) = (index % self.columns, index / self.columns);
                next.extend((column > 0).then(|| index - 1));
                next.extend((column + 1 < self.columns).then(|| index + 1));
                next.extend((row > 0).then(|| index - self.columns));
                next.extend(Some(index + self.columns).filter(|below| *below < self.squares.len()));
            }
        }
        self.reachable = self.squares.iter().filter(|square| **square == Square::Reachable).count() as u64;
    }

    /// Counts what is under a body now.
    pub(crate) fn cover(&mut self, body: &BodyShape, pose: Pose) {
        self.covered += self.mark(body, pose, Square::Reachable, Square::Covered);
    }

    /// Covered squares as a share of the reachable ones, over the floors on which the body has been; nothing without a floor.
    #[must_use]
    pub(crate) fn covered_of<'a>(floors: impl Iterator<Item = &'a Self> + Clone) -> Option<f64> {
        let been = || floors.clone().filter(|floor| floor.covered > 0);
        let (covered, reachable): (u64, u64) =
            (been().map(|floor| floor.covered).sum(), been().map(|floor| floor.reachable).sum());
        floors.clone().next().map(|_| covered as f64 / reachable.max(1) as f64)
    }

    /// Turns the squares under a body that are `from` into `to`, and counts them.
    fn mark(&mut self, body: &BodyShape, pose: Pose, from: Square, to: Square) -> u64 {
        let (reach, mut marked) = (body.radius_m(), 0);
        let (sin, cos) = libm::sincos(pose.yaw_rad);
        let first = |from: f64| (from / SIDE_M).floor().max(0.0) as usize;
        let (left, below) = (first(pose.x_m - reach - self.corner.x), first(pose.y_m - reach - self.corner.y));
        let span = (2.0 * reach / SIDE_M) as usize + 2;
        let rows = self.squares.len() / self.columns;
        for row in below..(below + span).min(rows) {
            for column in left..(left + span).min(self.columns) {
                let index = row * self.columns + column;
                let middle = self.middle(index);
                let (x, y) = (middle.x - pose.x_m, middle.y - pose.y_m);
                if self.squares[index] == from && covers(&body.footprint, x * cos + y * sin, y * cos - x * sin) {
                    self.squares[index] = to;
                    marked += 1;
                }
            }
        }
        marked
    }

    fn middle(&self, index: usize) -> Point2 {
        let at = |cell: usize| (cell as f64 + 0.5) * SIDE_M;
        Point2::new(self.corner.x + at(index % self.columns), self.corner.y + at(index / self.columns))
    }

    fn square_at(&self, x_m: f64, y_m: f64) -> Option<usize> {
        let (column, row) = (((x_m - self.corner.x) / SIDE_M).floor(), ((y_m - self.corner.y) / SIDE_M).floor());
        let rows = self.squares.len() / self.columns;
        let inside = column >= 0.0 && row >= 0.0 && (column as usize) < self.columns && (row as usize) < rows;
        inside.then(|| row as usize * self.columns + column as usize)
    }
}

/// Whether a point in the body's axes lies under it.
fn covers(footprint: &Footprint, x: f64, y: f64) -> bool {
    let [half_x, half_y] = footprint.half_m();
    match footprint {
        Footprint::Rectangle { ahead_m, .. } => (x - ahead_m).abs() <= half_x && y.abs() <= half_y,
        Footprint::Round { radius_m } => x * x + y * y <= radius_m * radius_m,
    }
}

/// A rectangle around all solids, starts and routes, and one metre more.
fn bounds(layout: &Layout) -> [Point2; 2] {
    let solids = layout.scene.parts().solids.iter().flat_map(|solid| {
        let (low, high) = solid.bounds();
        [Point2::new(low.x, low.y), Point2::new(high.x, high.y)]
    });
    let starts = layout.starts.iter().map(|start| Point2::new(start.pose.x_m, start.pose.y_m));
    let routes = layout.routes.iter().flat_map(|route| route.points().iter().copied());
    let none = [Point2::new(f64::MAX, f64::MAX), Point2::new(f64::MIN, f64::MIN)];
    let [low, high] = solids.chain(starts).chain(routes).fold(none, |[low, high], at| {
        [Point2::new(low.x.min(at.x), low.y.min(at.y)), Point2::new(high.x.max(at.x), high.y.max(at.y))]
    });
    let margin = MARGIN_M;
    [Point2::new(low.x - margin, low.y - margin), Point2::new(high.x + margin, high.y + margin)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;

    /// A room of 4 x 2 m inside, its walls 0.2 m thick, with the robot in the middle of it.
    fn room() -> Layout {
        let wall = |x: f64, y: f64, length: f64, width: f64| {
            format!("[[box]]\ncentre_m = [{x}, {y}]\nsize_m = [{length}, {width}, 1.0]\n")
        };
        let walls =
            [wall(0.0, 1.1, 4.4, 0.2), wall(0.0, -1.1, 4.4, 0.2), wall(2.1, 0.0, 0.2, 2.4), wall(-2.1, 0.0, 0.2, 2.4)];
        let text = format!("[[start]]\nposition_m = [0, 0]\nyaw_deg = 0\n{}", walls.concat());
        Layout::parse(SourceText::new("room.toml", text), &round()).unwrap()
    }

    fn round() -> BodyShape {
        BodyShape { footprint: Footprint::Round { radius_m: 0.3 }, ..BodyShape::pioneer2at() }
    }

    #[test]
    fn a_body_reaches_the_floor_of_its_room_but_for_the_corners() {
        let floor = FloorSquares::new(&room(), &round()).unwrap();
        // The lattice begins at (-3.2, -2.2), so there are 16 by 8 middles in the room; a round body cannot get into corners.
        assert!((110..=128).contains(&floor.reachable), "{}", floor.reachable);
        assert_eq!(FloorSquares::covered_of([&floor].into_iter()), Some(0.0));
    }

    #[test]
    fn covered_floor_counts_once_and_only_where_the_body_has_been() {
        let mut floor = FloorSquares::new(&room(), &round()).unwrap();
        let (body, at) = (round(), |x_m: f64| Pose { x_m, y_m: 0.0, yaw_rad: 0.0 });
        floor.cover(&body, at(0.0));
        let share = |floor: &FloorSquares| FloorSquares::covered_of([floor].into_iter()).unwrap();
        let once = share(&floor);
        floor.cover(&body, at(0.0));
        assert_eq!(share(&floor), once);
        // 0.28 square metres are 4.5 squares.
        assert!((3..=6).contains(&floor.covered), "{}", floor.covered);
        floor.cover(&body, at(1.0));
        assert!(share(&floor) > 1.5 * once);
        // Where it has not been does not count, and one floor as large with nothing covered would halve it.
        let other = FloorSquares::new(&room(), &round()).unwrap();
        assert_eq!(FloorSquares::covered_of([&floor, &other].into_iter()), Some(share(&floor)));
    }

    #[test]
    fn a_world_that_is_too_large_has_no_squares() {
        let text = "[[start]]\nposition_m = [0, 0]\nyaw_deg = 0\n[[start]]\nposition_m = [400, 400]\nyaw_deg = 0\n";
        let layout = Layout::parse(SourceText::new("vast.toml", text.to_owned()), &round()).unwrap();
        assert!(FloorSquares::new(&layout, &round()).is_none());
    }
}
