//! The light of a world: one sun, and light from everywhere.

use crate::geometry::Vector3;
use crate::settings::LightSettings;
use std::f64::consts::FRAC_PI_2;

/// Widest sun, degrees.
pub(crate) const WIDEST_SUN_DEG: f64 = 20.0;

/// One sun and the light that comes from everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Unit vector from the scene towards the light.
    pub towards: Vector3,
    /// Share of the light that comes from everywhere, 0 to 1.
    pub ambient: f64,
    /// Brightness of the whole picture; 1 is normal.
    pub gain: f64,
    /// Whether the camera sees shadows.
    pub shadows: bool,
    /// Angle over the sun's disc, degrees: how soft the edges of shadows are; 0 is a point.
    pub softness_deg: f64,
}

impl Light {
    /// Light from a direction, of any length, without shadows.
    #[must_use]
    pub fn from_direction(towards: Vector3, ambient: f64, gain: f64) -> Self {
        Self { towards: towards.normalize(), ambient, gain, shadows: false, softness_deg: 0.0 }
    }

    /// Brightness of a surface with the unit normal `normal`: gain * (ambient + (1 - ambient) * max(0, cos)).
    #[must_use]
    pub fn on(&self, normal: &Vector3) -> f64 {
        self.partly_on(normal, 1.0)
    }

    /// Brightness of such a surface from where `share` of the sun is seen.
    #[must_use]
    pub(crate) fn partly_on(&self, normal: &Vector3, share: f64) -> f64 {
        self.gain * (self.ambient + (1.0 - self.ambient) * self.towards.dot(normal).max(0.0) * share)
    }

    /// This light with what the settings change.
    #[must_use]
    pub fn changed(&self, by: &LightSettings) -> Self {
        let mut light = *self;
        if by.turn_deg != 0.0 || by.raise_deg != 0.0 {
            let flat = libm::hypot(self.towards.x, self.towards.y);
            let bearing = libm::atan2(self.towards.y, self.towards.x) + by.turn_deg.to_radians();
            let height = libm::atan2(self.towards.z, flat);
            let raised = (height + by.raise_deg.to_radians()).clamp(height.min(0.0), FRAC_PI_2);
            let (sin, cos) = libm::sincos(raised);
            let (aside, ahead) = libm::sincos(bearing);
            light.towards = Vector3::new(cos * ahead, cos * aside, sin);
        }
        light.ambient = (self.ambient + by.ambient).clamp(0.0, 1.0);
        light.gain *= by.gain;
        light.shadows |= by.shadows;
        light.softness_deg = (self.softness_deg + by.softness_deg).min(WIDEST_SUN_DEG);
        light
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    fn changed(change: impl Fn(&mut LightSettings)) -> Light {
        let mut by = Settings::default().camera.light;
        change(&mut by);
        Light::from_direction(Vector3::new(0.6, 0.0, 0.8), 0.4, 1.0).changed(&by)
    }

    #[test]
    fn settings_that_say_nothing_leave_the_light_as_the_file_says() {
        assert_eq!(changed(|_| ()), Light::from_direction(Vector3::new(0.6, 0.0, 0.8), 0.4, 1.0));
    }

    #[test]
    fn the_sun_is_turned_about_the_vertical_and_raised_to_the_zenith_at_most() {
        let turned = changed(|by| by.turn_deg = 90.0).towards;
        assert!((turned - Vector3::new(0.0, 0.6, 0.8)).norm() < 1e-12, "{turned:?}");
        // It stands 53.13 degrees high; 30 more are 83.13, whose sine is 0.8 cos 30 + 0.6 sin 30.
        let raised = changed(|by| by.raise_deg = 30.0).towards.z;
        assert!((raised - (0.8 * 0.75_f64.sqrt() + 0.3)).abs() < 1e-12, "{raised}");
        assert!((changed(|by| by.raise_deg = 60.0).towards - Vector3::z()).norm() < 1e-12);
        assert!(changed(|by| by.raise_deg = -80.0).towards.z.abs() < 1e-12);
    }

    #[test]
    fn ambient_light_is_added_and_brightness_multiplied() {
        let light = changed(|by| (by.ambient, by.gain) = (0.9, 0.5));
        assert_eq!((light.ambient, light.gain), (1.0, 0.5));
    }

    #[test]
    fn a_place_in_the_shade_has_the_light_from_everywhere_alone() {
        let light = changed(|_| ());
        assert_eq!(light.partly_on(&Vector3::z(), 0.0), 0.4);
        // Half of the sun: 0.4 + 0.6 x 0.8 / 2.
        assert!((light.partly_on(&Vector3::z(), 0.5) - 0.64).abs() < 1e-12);
        assert_eq!(light.partly_on(&Vector3::z(), 1.0), light.on(&Vector3::z()));
    }
}
