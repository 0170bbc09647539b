//! Places that are visited and gates that are passed, as a test counts them.

use std::sync::Arc;

use crate::geometry::Point2;
use crate::world::Layout;
use crate::world::marks::Passage;

/// The robot's way past the marks of a world.
#[derive(Debug)]
pub(super) struct Course {
    layout: Arc<Layout>,
    last: Option<Point2>,
    /// For each place: whether the robot was in it, and how often it has come in.
    places: Vec<(bool, u64)>,
    /// The gate that is next; where the robot was put elsewhere than at a start, whichever comes first is.
    next: Option<usize>,
    /// Gates passed in order and direction, and all others.
    pub(super) passed: u64,
    pub(super) errors: u64,
}

impl Course {
    /// With a robot that is not there yet.
    pub(super) fn new(layout: &Arc<Layout>) -> Self {
        let places = vec![(false, 0); layout.places.len()];
        Self { layout: Arc::clone(layout), last: None, places, next: None, passed: 0, errors: 0 }
    }

    /// The robot was put somewhere, at a start or elsewhere: no way, no visit.
    pub(super) fn put(&mut self, here: Point2, start: Option<usize>) {
        self.last = Some(here);
        for ((inside, _), place) in self.places.iter_mut().zip(&self.layout.places) {
            *inside = place.holds(here);
        }
        self.next = start.and_then(|start| self.layout.starts.get(start)).map(|start| start.gate);
    }

    /// The robot has driven on.
    pub(super) fn go(&mut self, here: Point2) {
        for ((inside, visits), place) in self.places.iter_mut().zip(&self.layout.places) {
            let was_inside = std::mem::replace(inside, place.holds(here));
            *visits += u64::from(*inside && !was_inside);
        }
        let Some(from) = self.last.replace(here) else { return };
        let (count, first) = (self.layout.gates.len(), self.next.unwrap_or(0));
        // From the next one on, so that a step through two gates counts both.
        for gate in (first..count).chain(0..first) {
            match self.layout.gates[gate].passage(from, here) {
                None => {}
                Some(Passage::Backward) => self.errors += 1,
                Some(Passage::Forward) => {
                    let is_next = self.next.is_none_or(|next| next == gate);
                    self.passed += u64::from(is_next);
                    self.errors += u64::from(!is_next);
                    self.next = Some((gate + 1) % count);
                }
            }
        }
    }

    /// How often a place was entered.
    pub(super) fn visits(&self, name: &str) -> Option<u64> {
        let place = self.layout.places.iter().position(|place| place.name == name)?;
        self.places.get(place).map(|(_, visits)| *visits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::settings::BodyShape;

    /// Gates across x at 1, 2 and 3 m, and a place round the second.
    fn course() -> Course {
        let gate = |x: i32| format!("[[gate]]\nright_m = [{x}, -1]\nleft_m = [{x}, 1]\n");
        let text = format!(
            "[[start]]\nposition_m = [0, 0]\n[[start]]\nposition_m = [1.5, 0]\ngate = \"gate 2\"\n{}{}{}\
             [[place]]\nname = \"middle\"\nposition_m = [2, 0]\nradius_m = 0.4\n",
            gate(1),
            gate(2),
            gate(3)
        );
        let layout = Layout::parse(SourceText::new("test.toml", text), &BodyShape::pioneer2at());
        Course::new(&Arc::new(layout.unwrap_or_else(|error| panic!("{error:?}"))))
    }

    fn drive(course: &mut Course, places: &[f64]) -> (u64, u64) {
        let before = (course.passed, course.errors);
        places.iter().for_each(|x| course.go(Point2::new(*x, 0.0)));
        (course.passed - before.0, course.errors - before.1)
    }

    #[test]
    fn gates_count_in_order_and_direction_and_begin_again_after_the_last() {
        let mut course = course();
        course.put(Point2::new(0.0, 0.0), Some(0));
        assert_eq!(drive(&mut course, &[0.9, 1.1, 2.1, 3.1]), (3, 0));
        course.put(Point2::new(0.0, 0.0), Some(0));
        // The second is left out, so the third is wrong; the first one follows on the third.
        course.go(Point2::new(1.1, 0.0));
        course.last = Some(Point2::new(2.5, 0.0));
        assert_eq!(drive(&mut course, &[3.1]), (0, 1));
        course.last = Some(Point2::new(0.5, 0.0));
        assert_eq!(drive(&mut course, &[1.1]), (1, 0));
    }

    #[test]
    fn to_and_fro_through_a_gate_is_wrong_every_time_but_the_first() {
        let mut course = course();
        course.put(Point2::new(0.0, 0.0), Some(0));
        assert_eq!(drive(&mut course, &[1.1, 0.9, 1.1, 0.9]), (1, 3));
    }

    #[test]
    fn a_start_says_which_gate_is_next_and_elsewhere_any_may_be_first() {
        let mut course = course();
        course.put(Point2::new(1.5, 0.0), Some(1));
        assert_eq!(drive(&mut course, &[2.1, 3.1]), (2, 0));
        course.put(Point2::new(2.5, 0.0), None);
        assert_eq!(drive(&mut course, &[3.1]), (1, 0));
    }

    #[test]
    fn a_visit_is_coming_in_and_being_put_there_is_none() {
        let mut course = course();
        course.put(Point2::new(2.0, 0.0), None);
        drive(&mut course, &[2.1, 2.6, 2.3, 2.2, 2.7, 2.1]);
        assert_eq!((course.visits("middle"), course.visits("nowhere")), (Some(2), None));
    }
}
