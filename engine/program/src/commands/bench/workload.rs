//! What is measured: a behaviour, with other pixels, textures or boxes than it has.

use std::fmt::Write;
use std::sync::Arc;

use engine::diagnostic::{Diagnostic, Result, SourceText};
use engine::experiment::{Cycle, Overrides, Plan};
use engine::geometry::Twist;
use engine::robot::Robot;
use engine::sensors::observation::Observation;
use engine::world::Layout;
use engine::world::scene::{Scene, Texture};

use crate::cli::BenchArguments;

/// What `--texture` draws on plain surfaces: speckles like those of a carpet.
const TEXTURE: Texture = Texture::Noise { amplitude: 6.0, scale_m: 0.15 };
/// Deviation of the pixel noise that `--texture` asks for at least, grey levels.
const PIXEL_NOISE: f64 = 2.0;
/// Three windows: two that can be timed, after one that warms up.
const LEAST_STEPS: u64 = 3 * engine::experiment::WINDOW_STEPS;
/// Where boxes stand that are never in sight, metres from the world's origin.
const FAR_M: f64 = 500.0;
/// Such boxes in a row.
const ROW: usize = 100;

/// The plan that the arguments ask for.
///
/// # Errors
/// If it cannot be made, or combines policies instead of learning.
pub(super) fn plan(arguments: &BenchArguments) -> Result<Plan> {
    let mut set = Vec::new();
    if let Some((width_px, height_px)) = arguments.size {
        set.extend([format!("camera.width_px={width_px}"), format!("camera.height_px={height_px}")]);
    }
    set.extend(arguments.lens.iter().map(|lens| format!("camera.lens={lens}")));
    set.extend_from_slice(arguments.changes.set());
    let overrides = Overrides { steps: Some(arguments.steps.max(LEAST_STEPS)), set, ..arguments.changes.overrides() };
    let filters = || crate::commands::sources::catalogue(&arguments.filters);
    let plan = Plan::load(&arguments.behaviour, &overrides, filters)?;
    if !plan.learns() {
        let message = format!("'{}' combines policies and learns nothing", plan.behaviour.name());
        return Diagnostic::new("E-COMBINES", message).help("measure a behaviour that learns").fail();
    }
    if arguments.texture { textured(plan) } else { Ok(plan) }
}

/// A plan with speckles on every plain surface and noise on every pixel.
pub(super) fn textured(mut plan: Plan) -> Result<Plan> {
    let mut parts = plan.layout.scene.parts().clone();
    for material in parts.materials.iter_mut().filter(|material| material.texture == Texture::Plain) {
        material.texture = TEXTURE;
    }
    let mut layout = (*plan.layout).clone();
    layout.scene = Arc::new(Scene::new(parts));
    plan.settings.camera.noise = plan.settings.camera.noise.max(PIXEL_NOISE);
    Plan::with_layout(plan.behaviour, plan.settings, Arc::new(layout), plan.filters)
}

/// A plan with boxes far away, so that there are `solids` in all.
pub(super) fn with_boxes(plan: &Plan, solids: usize) -> Result<Plan> {
    let own = plan.layout.scene.parts().solids.len();
    let mut text = plan.layout.source.text.to_string();
    for index in 0..solids.saturating_sub(own) {
        let (x_m, y_m) = (FAR_M + (index % ROW) as f64, FAR_M + (index / ROW) as f64);
        // Writing to a String cannot fail.
        let _ = write!(text, "\n[[box]]\ncentre_m = [{x_m}, {y_m}]\nsize_m = [0.5, 0.5, 1]\n");
    }
    let layout = Layout::parse(SourceText::new(&plan.layout.source.path, text), &plan.settings.robot.body)?;
    Plan::with_layout(Arc::clone(&plan.behaviour), plan.settings.clone(), Arc::new(layout), Arc::clone(&plan.filters))
}

/// A plan with other settings.
pub(super) fn with_settings(plan: &Plan, pairs: &[(&str, u64)]) -> Result<Plan> {
    let set = pairs.iter().map(|(key, value)| format!("{key}={value}")).collect();
    plan.clone().with_changes(&Overrides { set, ..Overrides::default() })
}

/// A plan for another number of steps.
pub(super) fn with_steps(plan: &Plan, steps: u64) -> Plan {
    let mut plan = plan.clone();
    plan.settings.run.steps = steps;
    plan
}

/// What a step costs without sensors: the smallest image, and a robot that does and senses nothing.
///
/// # Errors
/// If the behaviour cannot look at images of that size.
pub(super) fn empty_cycle(plan: &Plan) -> Result<Cycle<impl Robot>> {
    let mut plan = plan.clone();
    (plan.settings.camera.width_px, plan.settings.camera.height_px) = (16, 12);
    Cycle::new(&plan, Still)
}

struct Still;

impl Robot for Still {
    fn observe(&mut self, observation: &mut Observation) -> Result<()> {
        observation.scan.ranges_m.fill(1.0);
        Ok(())
    }

    fn act(&mut self, _: Twist) -> Result<()> {
        Ok(())
    }

    fn recover(&mut self) -> Result<()> {
        Ok(())
    }
}
