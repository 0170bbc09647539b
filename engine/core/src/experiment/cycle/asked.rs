//! Which images a cycle asks the robot for.

use super::Cycle;
use crate::experiment::Eyes;
use crate::robot::Robot;
use crate::sensors::observation::{Image, Observation};
use crate::settings::Settings;
use filter_api::Format;

impl<R: Robot> Cycle<R> {
    /// From the next observation on the image is asked for in another format: in colour, for whoever wants to look at it
    /// though the filters look at brightness alone. States and rewards stay the same.
    ///
    /// ```
    /// use engine::experiment::{Cycle, Overrides, Phase, Plan};
    /// use engine::script::Behaviour;
    ///
    /// # let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/wall.rhai");
    /// # /*
    /// let script = "scripts/wall.rhai";
    /// # */
    /// let plan = Plan::new(Behaviour::load(script.as_ref())?.into(), &Overrides::default())?;
    /// let cycle = || Cycle::new(&plan, Phase::Learning.robot(&plan, 1)?);
    /// let (mut grey, mut colour) = (cycle()?, cycle()?);
    /// colour.ask_for(filter_api::Format::Rgb);
    /// assert_eq!(grey.step(3)?, colour.step(3)?);
    /// assert_eq!(grey.observation().image.pixels.len() * 3, colour.observation().image.pixels.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn ask_for(&mut self, format: Format) {
        let (width_px, height_px) = self.eyes[0].size_px();
        self.observation.image = Image::of(format, width_px, height_px);
    }

    /// What all filters read.
    pub(super) fn likes(&self) -> Vec<Format> {
        self.eyes.iter().flat_map(Eyes::likes).chain(self.co_drivers.like()).collect()
    }
}

/// An observation of the images that filters like: grey if that is all that they look at, depth if one does, no image if
/// nobody looks.
pub(super) fn asking_for(settings: &Settings, likes: &[Format]) -> Observation {
    let beams = settings.laser.beams as usize;
    if likes.is_empty() {
        return Observation::asking_for(Format::Grey, 0, 0, beams);
    }
    let (width_px, height_px) = (settings.camera.width_px as usize, settings.camera.height_px as usize);
    let mut in_light = likes.iter().filter(|format| **format != Format::Depth);
    let (depth, alone) = (likes.contains(&Format::Depth), in_light.clone().next().is_none());
    let format = if in_light.all(|format| *format == Format::Grey) { Format::Grey } else { Format::Rgb };
    let observation = Observation::asking_for(format, width_px, height_px, beams);
    if depth { observation.with_depth(alone) } else { observation }
}
