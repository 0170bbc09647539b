//! The camera as a viewer needs it: where it stands, and how a place in its image becomes a ray.

use foxglove::messages::{CameraCalibration, FrameTransform, Quaternion, Timestamp, Vector3};

use engine::experiment::Plan;
use engine::sensors::CameraRays;
use engine::settings::{CameraSettings, Lens, VariedKey, apply};

/// The name of the camera's frame: x to the right, y down, z ahead.
pub(super) const CAMERA: &str = "camera";

/// The settings of the camera in an attempt for which these values were drawn.
pub(super) fn drawn_camera(plan: &Plan, drawn: &[f64]) -> CameraSettings {
    let mut settings = plan.settings.clone();
    for (varied, drawn) in plan.settings.randomise.iter().zip(drawn) {
        if let Some((VariedKey::Setting(row), _)) = VariedKey::of(&varied.key) {
            // The script was refused if its values were out of range.
            let _ = apply(&mut settings, row.group, row.key, &varied.value(*drawn));
        }
    }
    settings.camera
}

/// Where the camera stands on the robot, and where it looks.
pub(super) fn mount(camera: &CameraSettings, robot: &str, timestamp: Timestamp) -> FrameTransform {
    FrameTransform {
        timestamp: Some(timestamp),
        parent_frame_id: robot.to_owned(),
        child_frame_id: CAMERA.to_owned(),
        translation: Some(Vector3 { x: camera.forward_m, y: 0.0, z: camera.height_m }),
        rotation: Some(looking_down(camera.tilt_deg.to_radians())),
    }
}

/// From the axes of an image to those of the robot (x ahead, y left, z up), and down by the tilt.
fn looking_down(tilt_rad: f64) -> Quaternion {
    let (sin, cos) = libm::sincos(0.5 * tilt_rad);
    let (sum, difference) = (0.5 * (cos + sin), 0.5 * (cos - sin));
    Quaternion { x: -sum, y: sum, z: -difference, w: difference }
}

/// How its image came about. A fisheye is equidistant: Kannala and Brandt's model without its further terms.
pub(super) fn calibration(camera: &CameraSettings, timestamp: Timestamp) -> CameraCalibration {
    let focal_px = CameraRays::new(camera).focal_px();
    // The middle of the first pixel is 0 there.
    let (x_px, y_px) = (0.5 * camera.width_px as f64 - 0.5, 0.5 * camera.height_px as f64 - 0.5);
    let (distortion_model, terms) = match camera.lens {
        Lens::Pinhole => ("plumb_bob", 5),
        Lens::Fisheye => ("kannala_brandt", 4),
    };
    CameraCalibration {
        timestamp: Some(timestamp),
        frame_id: CAMERA.to_owned(),
        width: camera.width_px as u32,
        height: camera.height_px as u32,
        distortion_model: distortion_model.to_owned(),
        d: vec![0.0; terms],
        k: vec![focal_px, 0.0, x_px, 0.0, focal_px, y_px, 0.0, 0.0, 1.0],
        r: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: vec![focal_px, 0.0, x_px, 0.0, 0.0, focal_px, y_px, 0.0, 0.0, 0.0, 1.0, 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vector turned by a quaternion: v + 2 w (u x v) + 2 u x (u x v).
    fn turn(by: &Quaternion, v: [f64; 3]) -> [f64; 3] {
        let u = [by.x, by.y, by.z];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let (once, twice) = (cross(u, v), cross(u, cross(u, v)));
        [0, 1, 2].map(|axis| v[axis] + 2.0 * (by.w * once[axis] + twice[axis]))
    }

    #[test]
    fn the_camera_looks_ahead_and_down_by_its_tilt() {
        let (sin, cos) = libm::sincos(0.7);
        let by = looking_down(0.7);
        let cases = [
            // Ahead of the lens lies ahead of the robot and down.
            ([0.0, 0.0, 1.0], [cos, 0.0, -sin]),
            // Right in the image is to the robot's right.
            ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
            // Down in the image is down, and back towards the robot.
            ([0.0, 1.0, 0.0], [-sin, 0.0, -cos]),
        ];
        for (of_image, of_robot) in cases {
            let turned = turn(&by, of_image);
            assert!(turned.iter().zip(of_robot).all(|(one, other)| (one - other).abs() < 1e-12), "{turned:?}");
        }
    }
}
