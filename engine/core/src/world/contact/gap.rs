//! How far two outlines are apart on the floor plan.

use super::nearest_within;
use crate::world::obstacle::{FloorArea, Obstacle};

impl Obstacle {
    /// Least distance to another outline, seen from above, metres; 0 where they overlap. Heights do not matter.
    pub(in crate::world) fn gap_m(&self, other: &Self) -> f64 {
        match (self.area, other.area) {
            (FloorArea::Circle { radius }, _) => (other.distance_m(self.x, self.y) - radius).max(0.0),
            (_, FloorArea::Circle { radius }) => (self.distance_m(other.x, other.y) - radius).max(0.0),
            _ if !self.is_beside(other) && !other.is_beside(self) => 0.0,
            // Two rectangles that lie apart are nearest at a corner of one of them.
            _ => {
                let corners = other.corners().map(|(x, y)| self.distance_m(x, y));
                let own = self.corners().map(|(x, y)| other.distance_m(x, y));
                corners.into_iter().chain(own).fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Distance of a point from the outline, metres; 0 within it.
    fn distance_m(&self, x: f64, y: f64) -> f64 {
        let (x, y) = self.local(x, y);
        match self.area {
            FloorArea::Rectangle { half_x, half_y, .. } => {
                let (x, y) = (x - nearest_within(x, half_x), y - nearest_within(y, half_y));
                (x * x + y * y).sqrt()
            }
            FloorArea::Circle { radius } => ((x * x + y * y).sqrt() - radius).max(0.0),
        }
    }

    /// The corners of a rectangle; of a circle those of the square around it.
    fn corners(&self) -> [(f64, f64); 4] {
        let (x, y) = match self.area {
            FloorArea::Rectangle { half_x, half_y, .. } => (half_x, half_y),
            FloorArea::Circle { radius } => (radius, radius),
        };
        [(x, y), (x, -y), (-x, -y), (-x, y)].map(|(x, y)| self.world(x, y))
    }

    /// Whether one of this rectangle's sides has the other rectangle wholly on its far side.
    fn is_beside(&self, other: &Self) -> bool {
        let FloorArea::Rectangle { half_x, half_y, .. } = self.area else { return false };
        let corners = other.corners().map(|(x, y)| self.local(x, y));
        let all = |beyond: &dyn Fn((f64, f64)) -> bool| corners.iter().all(|corner| beyond(*corner));
        all(&|(x, _)| x > half_x)
            || all(&|(x, _)| x < -half_x)
            || all(&|(_, y)| y > half_y)
            || all(&|(_, y)| y < -half_y)
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Point3, Vector3};
    use crate::world::obstacle::Obstacle;
    use crate::world::scene::{Shape, Solid};

    fn solid(shape: Shape, x: f64, y: f64, yaw_rad: f64) -> Obstacle {
        Obstacle::new(&Solid { shape, centre: Point3::new(x, y, 0.5), yaw_rad, material: 0, collides: true })
    }

    fn block(x: f64, y: f64, yaw_rad: f64, half_x: f64, half_y: f64) -> Obstacle {
        solid(Shape::Box { half_m: Vector3::new(half_x, half_y, 0.5) }, x, y, yaw_rad)
    }

    fn post(x: f64, y: f64, radius_m: f64) -> Obstacle {
        solid(Shape::Cylinder { radius_m, half_height_m: 0.5 }, x, y, 0.0)
    }

    #[test]
    fn outlines_that_lie_apart_have_the_gap_of_their_nearest_points() {
        let unit = block(0.0, 0.0, 0.0, 1.0, 0.5);
        let close = |a: &Obstacle, b: &Obstacle, gap_m: f64| {
            assert!((a.gap_m(b) - gap_m).abs() < 1e-12 && (b.gap_m(a) - gap_m).abs() < 1e-12, "{}", a.gap_m(b));
        };
        close(&unit, &block(3.0, 0.0, 0.0, 0.5, 0.5), 1.5);
        // From corner to corner: 3 and 4 apart.
        close(&unit, &block(5.0, 5.0, 0.0, 1.0, 0.5), 5.0);
        // Turned by an eighth, a square's corner comes nearer by its half diagonal.
        close(&unit, &block(3.0, 0.0, std::f64::consts::FRAC_PI_4, 1.0, 1.0), 2.0 - 2.0_f64.sqrt());
        close(&unit, &post(4.0, 4.5, 1.0), 4.0);
        close(&post(0.0, 0.0, 1.0), &post(3.0, 4.0, 1.5), 2.5);
    }

    #[test]
    fn outlines_that_overlap_have_no_gap_though_no_corner_lies_in_the_other() {
        let (wide, tall) = (block(0.0, 0.0, 0.0, 2.0, 0.2), block(0.0, 0.0, 0.0, 0.2, 2.0));
        assert_eq!((wide.gap_m(&tall), wide.gap_m(&post(0.0, 0.5, 0.4)), wide.gap_m(&wide)), (0.0, 0.0, 0.0));
    }
}
