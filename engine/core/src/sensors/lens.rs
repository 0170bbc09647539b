//! The equidistant fisheye: a map from its pixels to a wider pinhole view.

use super::view::Pinhole;

/// Pixels further off the axis than this lie outside the lens and stay black, radians (80 degrees).
const EDGE_RAD: f64 = 1.396_263_401_595_463_6;
/// Pinhole pixels per fisheye pixel in the middle of the image.
const DENSITY: f64 = 1.5;
/// Most rows or columns of the pinhole view.
const MOST_PX: f64 = 8192.0;

/// Where each pixel of a fisheye image lies in the pinhole view.
#[derive(Debug, Clone)]
pub(super) struct Fisheye {
    /// The view to draw.
    pub(super) pinhole: Pinhole,
    /// Places in it, pixels from its top left corner; not a number outside the lens.
    pub(super) xs: Vec<f32>,
    pub(super) ys: Vec<f32>,
}

impl Fisheye {
    /// Whether the image has corners outside the lens.
    pub(super) fn has_outside(&self) -> bool {
        self.xs.iter().any(|x| x.is_nan())
    }

    /// The map of a `width_px` x `height_px` image whose rows span `field_of_view_rad`.
    pub(super) fn new(width_px: usize, height_px: usize, field_of_view_rad: f64) -> Self {
        let focal_px = width_px as f64 / field_of_view_rad;
        let mut slopes = Vec::with_capacity(width_px * height_px);
        let (mut widest, mut highest) = (0.0_f64, 0.0_f64);
        for row in 0..height_px {
            for column in 0..width_px {
                let x = column as f64 + 0.5 - width_px as f64 * 0.5;
                let y = row as f64 + 0.5 - height_px as f64 * 0.5;
                let radius = (x * x + y * y).sqrt();
                let angle = radius / focal_px;
                if angle > EDGE_RAD {
                    slopes.push([f64::NAN; 2]);
                    continue;
                }
                // In the very middle the tangent is the angle.
                let stretch = if radius < 1e-9 { 1.0 / focal_px } else { libm::tan(angle) / radius };
                (widest, highest) = (widest.max((x * stretch).abs()), highest.max((y * stretch).abs()));
                slopes.push([x * stretch, y * stretch]);
            }
        }
        let pinhole_focal_px = (focal_px * DENSITY).min((MOST_PX * 0.5 - 2.0) / widest.max(highest));
        let size = |slope: f64| 2 * ((slope * pinhole_focal_px) as usize + 2);
        let pinhole = Pinhole { width_px: size(widest), height_px: size(highest), focal_px: pinhole_focal_px };
        let place = |axis: usize, size: usize| {
            slopes.iter().map(|slope| (slope[axis] * pinhole_focal_px + size as f64 * 0.5) as f32).collect()
        };
        Self { pinhole, xs: place(0, pinhole.width_px), ys: place(1, pinhole.height_px) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_at_an_angle_lands_at_the_focal_length_times_the_angle() {
        let lens = Fisheye::new(160, 120, 2.0);
        // Focal length 80 pixels: 40.5 pixels right of the middle is 0.50625 rad, half a pixel down nearly nothing.
        let pixel = 60 * 160 + 120;
        let x = f64::from(lens.xs[pixel]) - lens.pinhole.width_px as f64 * 0.5;
        let y = f64::from(lens.ys[pixel]) - lens.pinhole.height_px as f64 * 0.5;
        let angle = libm::atan((x * x + y * y).sqrt() / lens.pinhole.focal_px);
        assert!((angle * 80.0 - (40.5_f64 * 40.5 + 0.25).sqrt()).abs() < 1e-4);
    }

    #[test]
    fn far_off_the_axis_there_is_no_lens() {
        let lens = Fisheye::new(16, 960, 1.0);
        assert!(lens.xs[0].is_nan());
        assert!(lens.pinhole.height_px <= MOST_PX as usize);
    }
}
