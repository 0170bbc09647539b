//! A pinhole view: where it stands, what it can see, and how planes appear in it.

use super::surface::Face;
use crate::geometry::Vector3;

/// Nothing nearer to the image plane than this is drawn, metres.
pub(super) const NEAR_M: f64 = 0.02;

/// A value over the image that is `x * .0[0] + y * .0[1] + .0[2]` at the place (x, y), pixels from the top left corner.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Affine(pub(super) [f64; 3]);

impl Affine {
    #[inline(always)]
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        self.0[0] * x + self.0[1] * y + self.0[2]
    }

    fn scaled(self, by: f64) -> Self {
        Self(self.0.map(|value| value * by))
    }

    /// The value minus `other` times `by`.
    fn without(self, other: Self, by: f64) -> Self {
        Self([self.0[0] - other.0[0] * by, self.0[1] - other.0[1] * by, self.0[2] - other.0[2] * by])
    }

    /// The value minus `other`.
    pub(super) fn minus(self, other: &Self) -> Self {
        self.without(*other, 1.0)
    }
}

/// Size and focal length of a pinhole image, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pinhole {
    pub(super) width_px: usize,
    pub(super) height_px: usize,
    pub(super) focal_px: f64,
}

/// A pinhole camera at its place in the world.
#[derive(Debug, Clone)]
pub(super) struct CameraView {
    pub(super) pinhole: Pinhole,
    pub(super) position: Vector3,
    /// Unit vectors along the image's rows, along its columns, and out of the lens.
    pub(super) right: Vector3,
    pub(super) down: Vector3,
    pub(super) forward: Vector3,
}

impl CameraView {
    /// A point in the view's own axes: right, down, forward.
    pub(super) fn local(&self, point: &Vector3) -> Vector3 {
        let from = point - self.position;
        Vector3::new(self.right.dot(&from), self.down.dot(&from), self.forward.dot(&from))
    }

    /// The pixel place of a point in the view's own axes.
    pub(super) fn project(&self, local: &Vector3) -> [f64; 2] {
        let scale = self.pinhole.focal_px / local.z;
        [self.pinhole.width_px as f64 * 0.5 + local.x * scale, self.pinhole.height_px as f64 * 0.5 + local.y * scale]
    }

    /// `axis` times the ray through each pixel; a ray's forward component is 1.
    fn along_rays(&self, axis: &Vector3) -> Affine {
        let a = axis.dot(&self.right) / self.pinhole.focal_px;
        let b = axis.dot(&self.down) / self.pinhole.focal_px;
        let centre = a * self.pinhole.width_px as f64 * 0.5 + b * self.pinhole.height_px as f64 * 0.5;
        Affine([a, b, axis.dot(&self.forward) - centre])
    }

    /// One over the forward distance to the plane `normal * point = offset_m`, if the view is above the plane.
    pub(super) fn nearness(&self, normal: &Vector3, offset_m: f64) -> Option<Affine> {
        let height = normal.dot(&self.position) - offset_m;
        (height > 1e-9).then(|| self.along_rays(normal).scaled(-1.0 / height))
    }

    /// The coordinate of the seen point of a plane along `axis`, counted from `origin`, times the plane's nearness.
    pub(super) fn coordinate(&self, axis: &Vector3, origin: &Vector3, nearness: Affine) -> Affine {
        self.along_rays(axis).without(nearness, axis.dot(&(origin - self.position)))
    }

    /// The two texture coordinates of a face, each times its nearness.
    pub(super) fn coordinates(&self, face: &Face, nearness: Affine) -> [Affine; 2] {
        [self.coordinate(&face.along, &face.origin, nearness), self.coordinate(&face.across(), &face.origin, nearness)]
    }

    /// The part of the world that the view can see.
    pub(super) fn frustum(&self) -> Frustum {
        let across = self.pinhole.width_px as f64 * 0.5 / self.pinhole.focal_px;
        let upright = self.pinhole.height_px as f64 * 0.5 / self.pinhole.focal_px;
        let inwards = [
            self.forward,
            self.forward * across + self.right,
            self.forward * across - self.right,
            self.forward * upright + self.down,
            self.forward * upright - self.down,
        ];
        Frustum { planes: inwards.map(|normal| HalfSpace::new(&normal, normal.dot(&self.position))) }
    }
}

/// The points with `normal * point >= offset`, in single precision and a millimetre wider.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfSpace {
    normal: [f32; 3],
    offset: f32,
}

impl HalfSpace {
    pub(super) fn new(normal: &Vector3, offset: f64) -> Self {
        let normal = [normal.x as f32, normal.y as f32, normal.z as f32];
        Self { normal, offset: (offset - 1e-3 - offset.abs() * 1e-5) as f32 }
    }

    /// Whether some point of the box lies within.
    pub(super) fn meets(&self, min: &[f32; 3], max: &[f32; 3]) -> bool {
        let mut most = 0.0;
        for axis in 0..3 {
            let normal = self.normal[axis];
            most += (normal * min[axis]).max(normal * max[axis]);
        }
        most >= self.offset
    }
}

/// The five half spaces of a view; the far side is open.
#[derive(Debug, Clone)]
pub(super) struct Frustum {
    planes: [HalfSpace; 5],
}

impl Frustum {
    /// Whether the box may be in sight.
    pub(super) fn meets(&self, min: &[f32; 3], max: &[f32; 3]) -> bool {
        self.planes.iter().all(|plane| plane.meets(min, max))
    }
}
