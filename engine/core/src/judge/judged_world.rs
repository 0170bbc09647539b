//! What a judge knows of one of several worlds.

use super::compiled::CompiledScript;
use super::evaluate::Present;
use super::expression::Slot;
use crate::outcome::Destination;
use rhai::Dynamic;
use std::mem::swap;
use std::sync::Arc;

/// Where its rules put the robot there, and what was calibrated there.
#[derive(Debug)]
pub(super) struct JudgedWorld {
    destinations: Vec<Option<Destination>>,
    starts: Option<Vec<String>>,
    calibrated: Option<Arc<Dynamic>>,
    slots: Vec<Slot>,
}

impl JudgedWorld {
    /// A world whose starts have these names; nothing is calibrated there.
    pub(super) fn new(compiled: &CompiledScript, starts: Vec<String>) -> Self {
        let place = |place: &str| Destination::of(place, &starts);
        let rules = compiled.rules.iter();
        Self {
            destinations: rules.map(|rule| rule.to_place.as_ref().and_then(|(name, _)| place(name))).collect(),
            calibrated: compiled.calibrate.is_none().then(Arc::default),
            slots: Vec::new(),
            starts: Some(starts),
        }
    }

    /// What was calibrated there, and what native trees read of it.
    pub(super) fn calibration_mut(&mut self) -> (&mut Option<Arc<Dynamic>>, &mut Vec<Slot>) {
        (&mut self.calibrated, &mut self.slots)
    }

    /// Puts it in the place of what is present, and that in its place.
    pub(super) fn swap(&mut self, destinations: &mut Vec<Option<Destination>>, present: &mut Present) {
        swap(&mut self.destinations, destinations);
        swap(&mut self.starts, &mut present.starts);
        swap(&mut self.calibrated, &mut present.calibrated);
        swap(&mut self.slots, &mut present.slots);
    }
}
