//! What a chain of filters is told besides images, and what it keeps from one to the next.

use filter_api::{Format, Mount, Moved};

use super::Chain;
use crate::diagnostic::{Diagnostic, Result};
use crate::settings::{CameraSettings, Lens};

/// How a camera is mounted, as filters are told.
#[must_use]
pub fn mount_of(camera: &CameraSettings) -> Mount {
    let view_rad = camera.field_of_view_deg.to_radians();
    let half_px = 0.5 * camera.width_px as f64;
    let fisheye = camera.lens == Lens::Fisheye;
    let focal_px = if fisheye { 2.0 * half_px / view_rad } else { half_px / libm::tan(0.5 * view_rad) };
    let (tilt_sin, tilt_cos) = libm::sincos(camera.tilt_deg.to_radians());
    Mount { focal_px, fisheye, forward_m: camera.forward_m, height_m: camera.height_m, tilt_sin, tilt_cos }
}

impl Chain {
    /// This chain behind a camera: its filters are told how that is mounted.
    ///
    /// # Errors
    /// If one of them cannot work with this camera.
    pub fn mounted(mut self, camera: &CameraSettings) -> Result<Self> {
        let mount = mount_of(camera);
        self.stages.iter_mut().try_for_each(|stage| stage.filter.mount(&mount))?;
        Ok(self)
    }

    /// Whether it reads depth images, and not the camera's colours.
    #[must_use]
    pub fn reads_depth(&self) -> bool {
        self.likes() == Format::Depth
    }

    /// How many bytes its filters keep from image to image; 0 if none keeps anything.
    #[must_use]
    pub fn keeps(&self) -> usize {
        self.stages.iter().map(|stage| stage.filter.keeps()).sum()
    }

    /// Tells the filters that keep something how the robot moved since the last image.
    ///
    /// # Errors
    /// If one of them fails.
    pub fn moved(&mut self, moved: &Moved) -> Result<()> {
        let keepers = self.stages.iter_mut().filter(|stage| stage.filter.keeps() > 0);
        keepers.map(|stage| &mut stage.filter).try_for_each(|filter| filter.moved(moved))
    }

    /// What its filters keep, in words: a sentence for each that has something to say.
    pub(crate) fn words(&self) -> impl Iterator<Item = (&'static str, String)> {
        let say = |stage: &super::chain::Stage| (stage.descriptor.name, stage.filter.words());
        self.stages.iter().map(say).filter(|(_, words)| !words.is_empty())
    }

    /// All that its filters keep, one after the other.
    ///
    /// # Errors
    /// If one of them fails.
    pub fn save(&mut self) -> Result<Vec<u8>> {
        let mut all = vec![0; self.keeps()];
        let mut rest = all.as_mut_slice();
        for stage in &mut self.stages {
            let (own, others) = rest.split_at_mut(stage.filter.keeps());
            if !own.is_empty() {
                stage.filter.save(own)?;
            }
            rest = others;
        }
        Ok(all)
    }

    /// Goes on from what such a chain kept.
    ///
    /// # Errors
    /// If these bytes are not what such a chain keeps.
    pub fn load(&mut self, kept: &[u8]) -> Result<()> {
        if kept.len() != self.keeps() {
            let message = format!("the filters keep {} bytes, and are given {}", self.keeps(), kept.len());
            let help = "what is kept belongs to the filters and the parameters that it was learned with";
            return Diagnostic::new("E-FILTER", message).help(help).fail();
        }
        let mut rest = kept;
        for stage in &mut self.stages {
            let (own, others) = rest.split_at(stage.filter.keeps());
            if !own.is_empty() {
                stage.filter.load(own)?;
            }
            rest = others;
        }
        Ok(())
    }
}
