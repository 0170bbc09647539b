//! The flat faces of solids in world axes: what the camera draws and the laser cuts.

use crate::geometry::Vector3;
use crate::world::scene::{Shape, Solid};
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::LazyLock;

/// Sides of the prism that stands for a cylinder in the image; its edges are within 0.5 % of the radius.
pub(super) const CYLINDER_SIDES: usize = 32;

/// A convex polygon, its vertices anticlockwise seen from outside.
#[derive(Debug, Clone)]
pub(super) struct Face {
    vertices: Range<usize>,
    /// Unit vector outwards.
    pub(super) normal: Vector3,
    /// `normal * point` for every point of the face, metres.
    pub(super) offset_m: f64,
    /// Where the texture starts: for a side its lower left corner.
    pub(super) origin: Vector3,
    /// First axis of the texture, a unit vector; horizontal on a side.
    pub(super) along: Vector3,
    /// Index of the solid's material.
    pub(super) material: usize,
    /// Part of it lies under the floor.
    pub(super) sunk: bool,
}

impl Face {
    /// Second axis of the texture, a unit vector; upwards on a side.
    pub(super) fn across(&self) -> Vector3 {
        self.normal.cross(&self.along)
    }
}

/// The faces of a list of solids.
#[derive(Debug, Clone, Default)]
pub(super) struct Surfaces {
    vertices: Vec<Vector3>,
    faces: Vec<Face>,
    solids: Vec<Range<usize>>,
}

/// Where a solid stands.
struct Placement {
    centre: Vector3,
    sin: f64,
    cos: f64,
    material: usize,
}

impl Placement {
    fn turned(&self, local: Vector3) -> Vector3 {
        Vector3::new(self.cos * local.x - self.sin * local.y, self.sin * local.x + self.cos * local.y, local.z)
    }
}

impl Surfaces {
    /// The faces of `solids`, in their order.
    pub(super) fn new<'a>(solids: impl IntoIterator<Item = &'a Solid>) -> Self {
        let mut surfaces = Self::default();
        for solid in solids {
            surfaces.push(solid);
        }
        surfaces
    }

    /// None yet, with room for a few solids, so that moving ones rarely ask for memory while the robot drives.
    pub(super) fn with_room() -> Self {
        Self { vertices: Vec::with_capacity(1024), faces: Vec::with_capacity(256), solids: Vec::with_capacity(64) }
    }

    /// Forgets everything but the memory.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.faces.clear();
        self.solids.clear();
    }

    /// Adds a solid.
    pub(super) fn push(&mut self, solid: &Solid) {
        let first = self.faces.len();
        let (sin, cos) = libm::sincos(solid.yaw_rad);
        let at = Placement { centre: solid.centre.coords, sin, cos, material: solid.material };
        match solid.shape {
            Shape::Box { half_m } => self.push_box(&at, half_m),
            Shape::Ramp { half_m } => self.push_ramp(&at, half_m),
            Shape::Cylinder { radius_m, half_height_m } => self.push_cylinder(&at, radius_m, half_height_m),
        }
        self.solids.push(first..self.faces.len());
    }

    /// Every face; its index is its name.
    pub(super) fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The indices of a solid's faces.
    pub(super) fn of_solid(&self, solid: usize) -> Range<usize> {
        self.solids[solid].clone()
    }

    /// The faces of the solid that was added last.
    pub(super) fn of_last(&self) -> &[Face] {
        self.solids.last().map_or(&[], |faces| &self.faces[faces.clone()])
    }

    /// The corners of a face.
    pub(super) fn vertices(&self, face: &Face) -> &[Vector3] {
        &self.vertices[face.vertices.clone()]
    }

    fn push_box(&mut self, at: &Placement, half: Vector3) {
        let (x, y, z) = (half.x, half.y, half.z);
        self.push_face(at, &[[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]]);
        self.push_face(at, &[[x, -y, -z], [x, y, -z], [x, y, z], [x, -y, z]]);
        self.push_face(at, &[[-x, y, -z], [-x, -y, -z], [-x, -y, z], [-x, y, z]]);
        self.push_face(at, &[[x, y, -z], [-x, y, -z], [-x, y, z], [x, y, z]]);
        self.push_face(at, &[[-x, -y, -z], [x, -y, -z], [x, -y, z], [-x, -y, z]]);
        self.push_face(at, &[[-x, y, -z], [x, y, -z], [x, -y, -z], [-x, -y, -z]]);
    }

    fn push_ramp(&mut self, at: &Placement, half: Vector3) {
        let (x, y, z) = (half.x, half.y, half.z);
        self.push_face(at, &[[-x, -y, -z], [x, -y, z], [x, y, z], [-x, y, -z]]);
        self.push_face(at, &[[x, -y, -z], [x, y, -z], [x, y, z], [x, -y, z]]);
        self.push_face(at, &[[x, y, -z], [-x, y, -z], [x, y, z]]);
        self.push_face(at, &[[-x, -y, -z], [x, -y, -z], [x, -y, z]]);
        self.push_face(at, &[[-x, y, -z], [x, y, -z], [x, -y, -z], [-x, -y, -z]]);
    }

    fn push_cylinder(&mut self, at: &Placement, radius: f64, z: f64) {
        let rim = unit_circle().map(|point| point.map(|part| part * radius));
        let mut top = [[0.0; 3]; CYLINDER_SIDES];
        let mut bottom = top;
        for index in 0..CYLINDER_SIDES {
            let ([x, y], [next_x, next_y]) = (rim[index], rim[(index + 1) % CYLINDER_SIDES]);
            top[index] = [x, y, z];
            bottom[CYLINDER_SIDES - 1 - index] = [x, y, -z];
            self.push_face(at, &[[x, y, -z], [next_x, next_y, -z], [next_x, next_y, z], [x, y, z]]);
            // The texture runs on around the prism instead of starting again at every side.
            let side_m = ((next_x - x) * (next_x - x) + (next_y - y) * (next_y - y)).sqrt();
            if let Some(face) = self.faces.last_mut() {
                face.origin -= face.along * (side_m * index as f64);
            }
        }
        for cap in [top, bottom] {
            self.push_face(at, &cap);
            if let Some(face) = self.faces.last_mut() {
                face.along = at.turned(Vector3::x());
                face.origin = at.centre + at.turned(Vector3::new(0.0, 0.0, cap[0][2]));
            }
        }
    }

    fn push_face(&mut self, at: &Placement, corners: &[[f64; 3]]) {
        let start = self.vertices.len();
        self.vertices.extend(corners.iter().map(|&corner| at.centre + at.turned(Vector3::from(corner))));
        let points = &self.vertices[start..];
        let (first, edge) = (points[0], points[1] - points[0]);
        let normal = edge.cross(&(points[2] - first)).normalize();
        self.faces.push(Face {
            vertices: start..self.vertices.len(),
            normal,
            offset_m: normal.dot(&first),
            origin: first,
            along: edge.normalize(),
            material: at.material,
            sunk: points.iter().any(|point| point.z < 0.0),
        });
    }
}

/// The corners of the prism that stands for a cylinder of radius 1.
fn unit_circle() -> &'static [[f64; 2]; CYLINDER_SIDES] {
    static CORNERS: LazyLock<[[f64; 2]; CYLINDER_SIDES]> = LazyLock::new(|| {
        std::array::from_fn(|index| {
            let (sin, cos) = libm::sincos(TAU * index as f64 / CYLINDER_SIDES as f64);
            [cos, sin]
        })
    });
    &CORNERS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    fn faces_point_outwards(shape: Shape, count: usize) {
        let centre = Point3::new(3.0, -2.0, 0.4);
        let surfaces = Surfaces::new(&[Solid { shape, centre, yaw_rad: 0.7, material: 0, collides: true }]);
        assert_eq!(surfaces.faces().len(), count);
        for face in surfaces.faces() {
            assert!(face.normal.dot(&centre.coords) < face.offset_m + 1e-12);
            assert!((face.across().norm() - 1.0).abs() < 1e-12);
            for vertex in surfaces.vertices(face) {
                assert!((face.normal.dot(vertex) - face.offset_m).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn every_face_is_flat_and_points_outwards() {
        let half_m = Vector3::new(0.5, 0.3, 0.4);
        faces_point_outwards(Shape::Box { half_m }, 6);
        faces_point_outwards(Shape::Cylinder { radius_m: 0.2, half_height_m: 0.4 }, CYLINDER_SIDES + 2);
    }

    #[test]
    fn a_ramp_falls_towards_minus_x() {
        let half_m = Vector3::new(0.5, 0.3, 0.4);
        let solid = Solid {
            shape: Shape::Ramp { half_m },
            centre: Point3::origin(),
            yaw_rad: 0.0,
            material: 0,
            collides: true,
        };
        let surfaces = Surfaces::new(&[solid]);
        assert_eq!(surfaces.faces().len(), 5);
        assert!(surfaces.faces()[0].normal.x < 0.0 && surfaces.faces()[0].normal.z > 0.0);
        for face in surfaces.faces() {
            // The middle of the ramp's body is a third in from its tall side.
            assert!(face.normal.dot(&Vector3::new(0.2, 0.0, -0.2)) < face.offset_m);
        }
    }
}
