//! Where a place in the image lies: its ray in the robot's axes, its bearing, and the floor that it shows.

use crate::geometry::{Point2, Vector3};
use crate::settings::{CameraSettings, Lens};

/// The rays of a camera as it is mounted: x ahead, y left, z up, from the robot's centre on the floor.
#[derive(Debug, Clone, Copy)]
pub struct CameraRays {
    half_px: (f64, f64),
    focal_px: f64,
    fisheye: bool,
    mount: Vector3,
    sin: f64,
    cos: f64,
}

impl CameraRays {
    /// Of a camera with these settings.
    #[must_use]
    pub fn new(camera: &CameraSettings) -> Self {
        let half_px = (0.5 * camera.width_px as f64, 0.5 * camera.height_px as f64);
        let view_rad = camera.field_of_view_deg.to_radians();
        let fisheye = camera.lens == Lens::Fisheye;
        let focal_px = if fisheye { 2.0 * half_px.0 / view_rad } else { half_px.0 / libm::tan(0.5 * view_rad) };
        let (sin, cos) = libm::sincos(camera.tilt_deg.to_radians());
        let mount = Vector3::new(camera.forward_m, 0.0, camera.height_m);
        Self { half_px, focal_px, fisheye, mount, sin, cos }
    }

    /// The direction of a place in the image, pixels from its top left corner; of no fixed length.
    #[must_use]
    pub fn ray(&self, x_px: f64, y_px: f64) -> Vector3 {
        let (x, y) = (x_px - self.half_px.0, y_px - self.half_px.1);
        let (right, down, ahead) = if self.fisheye {
            let radius = (x * x + y * y).sqrt();
            let (sin, cos) = libm::sincos(radius / self.focal_px);
            // In the very middle the sine is the angle.
            let stretch = if radius < 1e-9 { 1.0 / self.focal_px } else { sin / radius };
            (x * stretch, y * stretch, cos)
        } else {
            (x / self.focal_px, y / self.focal_px, 1.0)
        };
        // Tilted down: what is down in the image points back, what is ahead of the lens points down.
        Vector3::new(ahead * self.cos - down * self.sin, -right, -ahead * self.sin - down * self.cos)
    }

    /// From the middle of the image so far, a ray of a pinhole leaves at 45 degrees; of a fisheye, at 1 radian.
    #[must_use]
    pub const fn focal_px(&self) -> f64 {
        self.focal_px
    }

    /// Bearing and elevation of a place in the image, degrees, positive to the left and above the horizon.
    #[must_use]
    pub fn bearing_deg(&self, x_px: f64, y_px: f64) -> (f64, f64) {
        let ray = self.ray(x_px, y_px);
        let flat = libm::hypot(ray.x, ray.y);
        (libm::atan2(ray.y, ray.x).to_degrees(), libm::atan2(ray.z, flat).to_degrees())
    }

    /// The place on flat floor that is seen there, in the robot's axes, metres; nothing on and above the horizon.
    #[must_use]
    pub fn floor_m(&self, x_px: f64, y_px: f64) -> Option<Point2> {
        let ray = self.ray(x_px, y_px);
        let length = (ray.z < 0.0).then(|| -self.mount.z / ray.z)?;
        Some(Point2::new(self.mount.x + length * ray.x, self.mount.y + length * ray.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    fn rays(lens: Lens, tilt_deg: f64) -> CameraRays {
        let camera = CameraSettings {
            width_px: 200,
            height_px: 100,
            field_of_view_deg: 90.0,
            lens,
            forward_m: 0.1,
            height_m: 0.5,
            tilt_deg,
            noise: 0.0,
            ..Settings::default().camera
        };
        assert_ne!(camera, Settings::default().camera);
        CameraRays::new(&camera)
    }

    #[test]
    fn the_middle_of_an_image_looks_where_the_camera_does() {
        for lens in [Lens::Pinhole, Lens::Fisheye] {
            let (bearing, elevation) = rays(lens, 30.0).bearing_deg(100.0, 50.0);
            assert!(bearing.abs() < 1e-9 && (elevation + 30.0).abs() < 1e-9, "{bearing} {elevation}");
        }
    }

    #[test]
    fn the_edges_look_half_the_field_of_view_aside_left_positive() {
        for lens in [Lens::Pinhole, Lens::Fisheye] {
            let rays = rays(lens, 0.0);
            let (left, right) = (rays.bearing_deg(0.0, 50.0).0, rays.bearing_deg(200.0, 50.0).0);
            assert!((left - 45.0).abs() < 1e-9 && (right + 45.0).abs() < 1e-9, "{left} {right}");
        }
    }

    #[test]
    fn the_floor_lies_where_the_ray_meets_it() {
        // Straight ahead, 45 degrees down, from half a metre: half a metre before the lens.
        let at = rays(Lens::Pinhole, 45.0).floor_m(100.0, 50.0).unwrap();
        assert!((at.x - 0.6).abs() < 1e-12 && at.y == 0.0, "{at:?}");
        assert_eq!(rays(Lens::Pinhole, 0.0).floor_m(100.0, 50.0), None);
        // At the left edge a pinhole's ray goes one aside for each one ahead.
        let at = rays(Lens::Pinhole, 45.0).floor_m(0.0, 50.0).unwrap();
        assert!((at.y - 0.5 * std::f64::consts::SQRT_2).abs() < 1e-12, "{at:?}");
    }
}
