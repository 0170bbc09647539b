//! Whether the filters find anything at all in a world: what they never see cannot be learned from.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::Plan;
use crate::diagnostic::{Diagnostic, Result};
use crate::filter::Chain;
use crate::geometry::Pose;
use crate::random::{Random, Stream};
use crate::robot::{Robot, SimulatedRobot};
use crate::sensors::Camera;
use crate::sensors::observation::Observation;
use crate::settings::{Settings, UNNAMED_VIEW};
use crate::world::World;
use filter_api::Format;

/// Directions in which the camera looks from each place.
const HEADINGS: usize = 8;
/// Places on the lap route from which it looks.
const PLACES: usize = 16;
/// Steps at random in which something must come into sight, if nothing is at the starts.
const TRIAL_STEPS: u32 = 3_000;

/// Is content with the first pixel that the filters of each view leave: at the starts, or, since what is sought may stand round
/// a corner, in a trial.
///
/// # Errors
/// `E-FILTER-BLIND` for the first view of which they leave none anywhere.
pub(super) fn check_outlook(plan: &Plan) -> Result<()> {
    let mut blind = plan.blind_at_the_starts()?;
    if !blind.is_empty() {
        open_eyes_in_a_trial(plan, &mut blind)?;
    }
    let Some(view) = blind.first().and_then(|view| plan.settings.views().nth(*view)) else { return Ok(()) };
    let place = view.place(&format!("filter:{}", view.filters.len().saturating_sub(1)));
    let what =
        if view.name == UNNAMED_VIEW { "the filters leave".to_owned() } else { format!("view \"{}\" has", view.name) };
    let message =
        format!("{what} nothing of any image in world '{}': there is nothing to learn from", plan.layout.name);
    let error = Diagnostic::new("E-FILTER-BLIND", message).help(
        "check the filter's parameters, the camera's tilt and height, and that the world shows what the filter looks for",
    );
    match plan.behaviour.place_of(&place) {
        Some(span) => error
            .at(plan.behaviour.source(), span, format!("sees nothing from any start, nor in {TRIAL_STEPS} steps"))
            .fail(),
        None => error.fail(),
    }
}

impl Plan {
    /// The numbers of the views whose filters leave no pixel of what the camera sees, all round, from the starts and along the
    /// lap route.
    ///
    /// # Errors
    /// If a filter chain cannot be built.
    pub fn blind_at_the_starts(&self) -> Result<Vec<usize>> {
        let (settings, layout) = (&self.settings, &self.layout);
        let mut world = World::new(Arc::clone(layout), &[settings.robot], settings.run.period_s, 0);
        let mut camera = Camera::new(&layout.scene, &without_noise(settings).camera, 0);
        let mut chains = self.chains()?;
        let mut blind: Vec<usize> = (0..chains.len()).collect();
        let mut seen = asking_for_both(settings, 0);
        let lap = layout.lap.map(|lap| &layout.routes[lap]);
        let along = lap
            .into_iter()
            .flat_map(|route| (0..PLACES).map(|place| route.pose_at(route.length_m() * place as f64 / PLACES as f64)));
        for place in layout.starts.iter().map(|start| start.pose).chain(along) {
            for heading in 0..HEADINGS {
                let turn = TAU * heading as f64 / HEADINGS as f64;
                world.place(0, Pose::new(place.x_m, place.y_m, place.yaw_rad + turn));
                let (image, depth) = (Some(&mut seen.image), seen.depth.as_mut());
                camera.render_both(&world.body(0).world_from_robot(), world.seen_by(0), image, depth);
                blind.retain(|view| !leaves_any(&mut chains[*view], &seen));
                if blind.is_empty() {
                    return Ok(blind);
                }
            }
        }
        Ok(blind)
    }
}

/// Leaves the views in the list of which no pixel is left while the robot drives about at random.
fn open_eyes_in_a_trial(plan: &Plan, blind: &mut Vec<usize>) -> Result<()> {
    let settings = without_noise(&plan.settings);
    let mut robot = SimulatedRobot::new(&plan.layout, &settings, 0)?;
    let mut chains = plan.chains()?;
    let mut random = Random::new(0, Stream::Untrained);
    let mut observation = asking_for_both(&settings, settings.laser.beams as usize);
    for _ in 0..TRIAL_STEPS {
        // A sensor that fails says so itself, in the run.
        if robot.observe(&mut observation).is_err() {
            blind.clear();
        }
        blind.retain(|view| !leaves_any(&mut chains[*view], &observation));
        if blind.is_empty() {
            break;
        }
        if observation.contact || observation.fallen {
            robot.recover()?;
        } else if let Some(action) = settings.actions.get(random.below(settings.actions.len() as u32) as usize) {
            robot.act(*action)?;
        }
    }
    Ok(())
}

/// Colours, and depth where there is a camera for it.
fn asking_for_both(settings: &Settings, beams: usize) -> Observation {
    let (width_px, height_px) = (settings.camera.width_px as usize, settings.camera.height_px as usize);
    let observation = Observation::asking_for(Format::Rgb, width_px, height_px, beams);
    if settings.camera.depth { observation.with_depth(false) } else { observation }
}

/// Noise would be taken for something seen.
fn without_noise(settings: &Settings) -> Settings {
    let mut settings = settings.clone();
    settings.camera.noise = 0.0;
    settings.camera.depth_noise = 0.0;
    settings.camera.depth_holes = 0.0;
    settings
}

/// A filter that fails says so itself, in the run.
fn leaves_any(chain: &mut Chain, observation: &Observation) -> bool {
    chain.apply(observation.read_as(chain.likes())).is_ok_and(|mask| mask.contains(&255))
}
