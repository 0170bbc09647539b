//! Whether the filters find anything at all in a world: what they never see cannot be learned from.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::Plan;
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::Pose;
use crate::sensors::Camera;
use crate::sensors::observation::Image;
use crate::settings::CameraSettings;
use crate::world::World;

/// Directions in which the camera looks from each place.
const HEADINGS: usize = 8;
/// Places on the lap route from which it looks.
const PLACES: usize = 16;

/// Looks round from every start and along the lap route, and is content with the first pixel that the filters leave.
///
/// # Errors
/// `E-FILTER-BLIND` if they leave none anywhere.
pub(super) fn check_outlook(plan: &Plan) -> Result<()> {
    let (settings, layout) = (&plan.settings, &plan.layout);
    let mut world = World::new(Arc::clone(layout), &[settings.robot], settings.run.period_s, 0);
    // Noise would be taken for something seen.
    let mut camera = Camera::new(&layout.scene, &CameraSettings { noise: 0.0, ..settings.camera.clone() }, 0);
    let mut chain = plan.chain()?;
    let mut image = Image::new(settings.camera.width_px as usize, settings.camera.height_px as usize);
    let lap = layout.lap.map(|lap| &layout.routes[lap]);
    let along = lap
        .into_iter()
        .flat_map(|route| (0..PLACES).map(|place| route.pose_at(route.length_m() * place as f64 / PLACES as f64)));
    for place in layout.starts.iter().copied().chain(along) {
        for heading in 0..HEADINGS {
            let turn = TAU * heading as f64 / HEADINGS as f64;
            world.place(0, Pose::new(place.x_m, place.y_m, place.yaw_rad + turn));
            camera.render(&world.body(0).world_from_robot(), world.seen_by(0), &mut image);
            // A filter that fails says so itself, in the run.
            if chain.apply(&image).is_ok_and(|mask| mask.contains(&255)) {
                return Ok(());
            }
        }
    }
    let stages = settings.filters.len();
    let place = format!("filter:{}", stages.saturating_sub(1));
    let message =
        format!("the filters leave nothing of any image in world '{}': there is nothing to learn from", layout.name);
    let error = Diagnostic::new("E-FILTER-BLIND", message).help(
        "check the filter's parameters, the camera's tilt and height, and that the world shows what the filter looks for",
    );
    match plan.behaviour.place_of(&place) {
        Some(span) => error.at(plan.behaviour.source(), span, "sees nothing from any start").fail(),
        None => error.fail(),
    }
}
