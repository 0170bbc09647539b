//! What the present step shows to whoever looks on.

use super::Cycle;
use crate::experiment::{SeenView, ViewStage};
use crate::judge::{Facts, Judge};
use crate::robot::Robot;
use crate::sensors::observation::Observation;
use crate::state::{Grid, StateMap};

impl<R> Cycle<R> {
    /// What the script's measures came to in the last step, in their order; true is 1, false 0.
    pub fn measures(&self) -> impl Iterator<Item = f64> {
        self.judge.measures()
    }
}

impl<R: Robot> Cycle<R> {
    /// By rule: what each added in the last step, if it fired.
    #[must_use]
    pub fn fired(&self) -> &[Option<f64>] {
        self.judge.fired()
    }

    /// The beam behind the last rule that fired in the last step, if it read the laser.
    #[must_use]
    pub(crate) fn fired_beam(&self) -> Option<usize> {
        self.judge.fired_beam()
    }

    /// What judged the last step.
    #[must_use]
    pub fn judge(&self) -> &Judge {
        &self.judge
    }

    /// The share of the last image that the filters of the first view left, 0 to 1; 0 if the script reads nothing of the camera.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        self.facts().views.first().filter(|_| self.looks).map_or(0.0, |view| view.coverage)
    }

    /// What the script was told in the last step.
    #[must_use]
    pub fn facts(&self) -> &Facts {
        self.judge.facts()
    }

    /// The robot behind the door.
    #[must_use]
    pub fn robot(&self) -> &R {
        &self.robot
    }

    /// The last observation.
    #[must_use]
    pub fn observation(&self) -> &Observation {
        &self.observation
    }

    /// What each of the script's own views made of the last image; nothing if nobody reads what the camera sees.
    pub fn views(&self) -> impl Iterator<Item = SeenView> {
        self.eyes[0].views()
    }

    /// The last mask of the script's own filters.
    #[must_use]
    pub fn mask(&self) -> &[u8] {
        self.eyes[0].chain().mask()
    }

    /// What each of the script's own filters made of the last image, view by view, in order; nothing if nobody reads what the
    /// camera sees.
    pub fn stages(&self) -> impl Iterator<Item = ViewStage<'_>> {
        self.eyes[0].stages()
    }

    /// What the script's own filters keep, in words: the filter's name, and what it says.
    pub fn kept_in_words(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.eyes[0].words()
    }

    /// The map that makes the script's own states.
    #[must_use]
    pub fn state_map(&self) -> &dyn StateMap {
        &*self.eyes[0].map
    }

    /// The script's own grid, with its last counts.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        self.eyes[0].grid()
    }
}
