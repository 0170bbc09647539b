//! What is marked on the floor plan and seen by nobody: where robots start, places to visit, gates to pass.

use crate::geometry::{Point2, Pose};

/// Where a robot can start.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The name in the world file; without one `start 1`, `start 2` and so on, by its number there.
    pub name: String,
    /// Place and heading.
    pub pose: Pose,
    /// Index of the gate that is next from here.
    pub gate: usize,
}

/// A circle on the floor that can be visited.
#[derive(Debug, Clone, PartialEq)]
pub struct Circle {
    /// The name in the world file.
    pub name: String,
    /// Its middle, metres.
    pub centre: Point2,
    /// Its radius, metres.
    pub radius_m: f64,
}

impl Circle {
    /// Whether a point lies in it.
    #[must_use]
    pub(crate) fn holds(&self, point: Point2) -> bool {
        (point - self.centre).norm() <= self.radius_m
    }
}

/// Two posts between which a robot can drive, one on its right and one on its left.
#[derive(Debug, Clone, PartialEq)]
pub struct Gate {
    /// The name in the world file; without one `gate 1`, `gate 2` and so on, by its number there.
    pub name: String,
    /// The post on the right, metres.
    pub right: Point2,
    /// The post on the left, metres.
    pub left: Point2,
}

/// In which direction a gate was passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passage {
    Forward,
    Backward,
}

impl Gate {
    /// How the straight way from one point to another passes between the posts, if it does.
    #[must_use]
    pub(crate) fn passage(&self, from: Point2, to: Point2) -> Option<Passage> {
        let across = self.left - self.right;
        // Ahead of the line through the posts, and how far along it from the right post.
        let ahead = |point: Point2| (point.x - self.right.x) * across.y - (point.y - self.right.y) * across.x;
        let (before, after) = (ahead(from), ahead(to));
        let passage = match (before < 0.0, after < 0.0) {
            (true, false) => Passage::Forward,
            (false, true) => Passage::Backward,
            _ => return None,
        };
        let share = before / (before - after);
        let along = (from + (to - from) * share - self.right).dot(&across) / across.norm_squared();
        (0.0..=1.0).contains(&along).then_some(passage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_is_passed_between_its_posts_with_the_right_one_on_the_right() {
        let point = Point2::new;
        let gate = Gate { name: "first".to_owned(), right: point(2.0, -1.0), left: point(2.0, 1.0) };
        assert_eq!(gate.passage(point(1.9, 0.5), point(2.1, 0.5)), Some(Passage::Forward));
        assert_eq!(gate.passage(point(2.1, 0.5), point(1.9, 0.5)), Some(Passage::Backward));
        // Standing on the line is behind it already; the way must lead between the posts.
        assert_eq!(gate.passage(point(2.0, 0.5), point(2.1, 0.5)), None);
        assert_eq!(gate.passage(point(1.9, 0.9), point(2.1, 1.2)), None);
        assert_eq!(gate.passage(point(1.9, 0.8), point(2.1, 1.1)), Some(Passage::Forward));
        assert_eq!(gate.passage(point(1.0, 0.0), point(1.9, 0.0)), None);
    }

    #[test]
    fn a_circle_ends_at_its_radius() {
        let circle = Circle { name: "red".to_owned(), centre: Point2::new(1.0, 1.0), radius_m: 0.5 };
        assert!(circle.holds(Point2::new(1.3, 1.4)) && !circle.holds(Point2::new(1.3, 1.41)));
    }
}
