//! Brings a face into the view: culls, clips and projects it.

use super::painting::Drawn;
use super::spans::Spans;
use super::surface::{CYLINDER_SIDES, Face, Surfaces};
use super::texture::Looks;
use super::view::{Affine, CameraView, NEAR_M};
use crate::geometry::Vector3;

/// Corners of the largest polygon: a cylinder's cap, clipped twice.
const MOST_CORNERS: usize = CYLINDER_SIDES + 4;

/// Where faces are drawn to.
pub(super) struct Drawing<'a> {
    pub(super) view: &'a CameraView,
    pub(super) looks: &'a Looks,
    pub(super) spans: &'a mut Spans,
    pub(super) drawn: &'a mut Vec<Drawn>,
    pub(super) nearness: &'a mut Vec<Affine>,
}

impl Drawing<'_> {
    /// Draws the part of a face that is in sight; `look` is the index of its look.
    pub(super) fn face(&mut self, surfaces: &Surfaces, face: &Face, look: usize) {
        let view = self.view;
        let Some(nearness) = view.nearness(&face.normal, face.offset_m) else {
            return;
        };
        let mut polygon = Polygon::new(surfaces.vertices(face));
        if face.sunk {
            polygon.clip(|point| point.z);
        }
        let mut nearest = f64::INFINITY;
        for point in polygon.points_mut() {
            *point = view.local(point);
            nearest = nearest.min(point.z);
        }
        if nearest < NEAR_M {
            polygon.clip(|point| point.z - NEAR_M);
        }
        let mut corners = [[0.0; 2]; MOST_CORNERS];
        let points = polygon.points_mut();
        let count = points.len();
        if count < 3 {
            return;
        }
        for (corner, point) in corners.iter_mut().zip(points) {
            *corner = view.project(point);
        }
        let plain = self.looks.get(look).is_plain();
        let coordinates = if plain { [Affine::default(); 2] } else { view.coordinates(face, nearness) };
        self.nearness.push(nearness);
        self.drawn.push(Drawn { look, plain, coordinates });
        self.spans.draw(&corners[..count], self.drawn.len() as u32 - 1, self.nearness);
    }
}

/// A convex polygon on its way through the clipping planes.
pub(super) struct Polygon {
    points: [Vector3; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    pub(super) fn new(vertices: &[Vector3]) -> Self {
        let mut points = [Vector3::zeros(); MOST_CORNERS];
        points[..vertices.len()].copy_from_slice(vertices);
        Self { points, count: vertices.len() }
    }

    pub(super) fn points_mut(&mut self) -> &mut [Vector3] {
        &mut self.points[..self.count]
    }

    /// Keeps the part where `inside`, which is affine, is not negative (Sutherland and Hodgman 1974).
    pub(super) fn clip(&mut self, inside: impl Fn(&Vector3) -> f64) {
        let (points, count) = (self.points, self.count);
        self.count = 0;
        for index in 0..count {
            let (from, to) = (&points[index], &points[(index + 1) % count]);
            let (here, there) = (inside(from), inside(to));
            if here >= 0.0 {
                self.push(*from);
            }
            if (here < 0.0) != (there < 0.0) {
                // From the inner end, whichever way round: neighbours that share the edge get the same point.
                let (inner, outer, a, b) = if here >= 0.0 { (from, to, here, there) } else { (to, from, there, here) };
                self.push(inner + (outer - inner) * (a / (a - b)));
            }
        }
    }

    fn push(&mut self, point: Vector3) {
        if let Some(slot) = self.points.get_mut(self.count) {
            *slot = point;
            self.count += 1;
        }
    }
}
