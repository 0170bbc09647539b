//! Loud errors instead of learning from a camera that shows nothing.

use super::camera::Camera;
use super::observation::Image;
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::{Isometry3, rotation};
use crate::saved::{Passed, Passing};
use crate::world::scene::Solid;
use nalgebra::{Translation3, UnitQuaternion};
use std::f64::consts::TAU;

/// Images, each after a move, that are judged together.
const WINDOW: u32 = 50;
/// Headings of the start-up test.
const HEADINGS: usize = 8;

/// Watches the images of a run: fifty in a row that all have one colour, or that stay the same while the robot moves,
/// are an error.
#[derive(Debug, Clone)]
pub struct CameraWatch {
    /// The first image of the window.
    reference: Vec<u8>,
    images: u32,
    blank: bool,
    frozen: bool,
}

impl Default for CameraWatch {
    fn default() -> Self {
        Self::new()
    }
}

impl CameraWatch {
    /// A watch that has seen nothing.
    #[must_use]
    pub fn new() -> Self {
        Self { reference: Vec::new(), images: 0, blank: true, frozen: true }
    }

    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.bytes(&mut self.reference)?;
        by.small(&mut self.images)?;
        by.flag(&mut self.blank)?;
        by.flag(&mut self.frozen)
    }

    /// Looks at the next image. Images count only if the body moved since the last one.
    ///
    /// # Errors
    /// `E-CAMERA-BLANK` or `E-CAMERA-FROZEN` at the end of a window in which no image was otherwise.
    pub fn check(&mut self, image: &Image, body_moved: bool) -> Result<()> {
        if !body_moved {
            return Ok(());
        }
        // Only a window that looks bad so far costs anything.
        self.blank = self.blank && is_blank(image);
        if self.images == 0 {
            self.reference.clone_from(&image.pixels);
        } else {
            self.frozen = self.frozen && self.reference == image.pixels;
        }
        self.images += 1;
        if self.images < WINDOW {
            return Ok(());
        }
        let (blank, frozen) = (self.blank, self.frozen);
        (self.images, self.blank, self.frozen) = (0, true, true);
        if blank {
            return blank_error(format!("the camera showed one colour in each of the last {WINDOW} images")).fail();
        }
        if frozen {
            return frozen_error(format!("the camera's image did not change in {WINDOW} moves of the robot")).fail();
        }
        Ok(())
    }
}

/// Tests a camera before a run: turns the robot in place and looks. Leaves the camera's noise where it was.
///
/// # Errors
/// `E-CAMERA-BLANK` if every heading shows one colour only, `E-CAMERA-FROZEN` if all show the same image.
pub(crate) fn self_test(camera: &mut Camera, world_from_robot: &Isometry3, moving: &[Solid]) -> Result<()> {
    let frames = camera.frames();
    let (mut first, mut image) = (Image::new(0, 0), Image::new(0, 0));
    let (mut blank, mut frozen) = (true, true);
    for heading in 0..HEADINGS {
        let yaw_rad = TAU * heading as f64 / HEADINGS as f64;
        let turn = UnitQuaternion::from_rotation_matrix(&rotation(yaw_rad, 0.0, 0.0));
        let turned = world_from_robot * Isometry3::from_parts(Translation3::identity(), turn);
        camera.set_frames(frames + heading as u64);
        camera.render(&turned, moving, &mut image);
        blank = blank && is_blank(&image);
        if heading == 0 {
            first.clone_from(&image);
        } else {
            frozen = frozen && image == first;
        }
    }
    camera.set_frames(frames);
    if blank {
        return blank_error(format!("the camera shows one colour only, in each of {HEADINGS} headings")).fail();
    }
    if frozen {
        return frozen_error("the camera's image stays the same when the robot turns".to_owned()).fail();
    }
    Ok(())
}

fn is_blank(image: &Image) -> bool {
    let mut pixels = image.pixels.chunks_exact(image.format.channels());
    let first = pixels.next();
    pixels.all(|pixel| Some(pixel) == first)
}

fn blank_error(message: String) -> Diagnostic {
    Diagnostic::new("E-CAMERA-BLANK", message).help(
        "check 'camera.tilt_deg' and 'camera.height_m', and that the world has something to see: \
         walls, obstacles or a textured floor",
    )
}

fn frozen_error(message: String) -> Diagnostic {
    Diagnostic::new("E-CAMERA-FROZEN", message).help(
        "check that the robot's start is not inside a solid, and that the world looks different from place to place",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: [u8; 6]) -> Image {
        Image { pixels: pixels.to_vec(), ..Image::new(2, 1) }
    }

    #[test]
    fn fifty_blank_images_are_an_error_and_one_good_one_is_forgiven() {
        let mut watch = CameraWatch::new();
        for _ in 0..WINDOW - 1 {
            watch.check(&image([7; 6]), true).unwrap();
        }
        assert_eq!(watch.check(&image([7; 6]), true).unwrap_err().code, "E-CAMERA-BLANK");
        for step in 0..WINDOW {
            let shade = if step == 20 { 8 } else { 7 };
            watch.check(&image([7, 7, 7, 7, 7, shade]), true).unwrap();
        }
    }

    #[test]
    fn a_picture_that_never_changes_is_an_error_only_while_the_robot_moves() {
        let mut watch = CameraWatch::new();
        let still = image([1, 2, 3, 4, 5, 6]);
        for _ in 0..3 * WINDOW {
            watch.check(&still, false).unwrap();
        }
        let mut last = Ok(());
        for _ in 0..WINDOW {
            last = watch.check(&still, true);
        }
        assert_eq!(last.unwrap_err().code, "E-CAMERA-FROZEN");
    }

    #[test]
    fn a_picture_that_changes_once_in_a_while_is_fine() {
        let mut watch = CameraWatch::new();
        for step in 0..10 * WINDOW {
            watch.check(&image([(step / 20) as u8, 2, 3, 4, 5, 6]), true).unwrap();
        }
    }
}
