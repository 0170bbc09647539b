//! What a behaviour sees with, and nothing else: no world, no robot, no rules that would have to fit.

use std::path::Path;
use std::sync::Arc;

use super::changes::changed;
use super::parts::Parts;
use super::{Overrides, Plan};
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use crate::filter::{Catalogue, Chain};
use crate::script::Behaviour;
use crate::sensors::CameraRays;
use crate::settings::{CameraSettings, Settings};
use crate::state::{Grid, PatchFinder};

/// A behaviour's filters, grid and camera.
#[derive(Clone)]
pub struct Sight {
    /// The script.
    pub behaviour: Arc<Behaviour>,
    /// Its settings, with the command line's changes.
    pub settings: Settings,
    /// The filters that its chain may use.
    pub filters: Arc<Catalogue>,
}

impl Sight {
    /// Loads a script for its filters and its grid; its world is not looked for, and it needs no rule.
    ///
    /// # Errors
    /// If the script cannot be loaded, a change does not fit, or the chain or the grid does not work.
    pub fn load(script: &Path, overrides: &Overrides, filters: Arc<Catalogue>) -> Result<Self> {
        let behaviour = Arc::new(Behaviour::load_to_look(script, &overrides.params())?);
        let settings = changed(behaviour.settings(), behaviour.params(), overrides)?;
        let sight = Self { behaviour, settings, filters };
        sight.chain()?;
        sight.grid()?;
        Ok(sight)
    }

    /// A fresh filter chain.
    ///
    /// # Errors
    /// As [`Plan::chain`].
    pub fn chain(&self) -> Result<Chain> {
        self.parts().chain(&self.settings.view)
    }

    /// A fresh grid.
    ///
    /// # Errors
    /// As [`Plan::grid`].
    pub fn grid(&self) -> Result<Grid> {
        self.parts().grid(&self.settings.view)
    }

    /// This sight with one of its views alone: the one of this name.
    ///
    /// # Errors
    /// If there is no such view.
    pub fn through(mut self, name: &str) -> Result<Self> {
        let Some(view) = self.settings.views().find(|view| view.name == name).cloned() else {
            let known: Vec<&str> = self.settings.views().map(|view| view.name.as_str()).collect();
            let help = match nearest_name(name, known.iter().copied()) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("it has: {}", known.join(", ")),
            };
            let message = format!("'{}' has no view '{}'", self.behaviour.name(), printable(name));
            return Diagnostic::new("E-SCRIPT-VIEW", message).help(help).fail();
        };
        self.settings.view = view;
        self.settings.further_views.clear();
        Ok(self)
    }

    /// The view's patch in the image whose mask this is: its share of the image, and its bearing in degrees, positive to the
    /// left; nothing if there is none.
    #[must_use]
    pub fn patch(&self, mask: &[u8]) -> Option<(f64, f64)> {
        let CameraSettings { width_px, height_px, .. } = self.settings.camera;
        let patch = PatchFinder::new(width_px as usize, height_px as usize).find(mask, width_px as usize);
        let (x, y) = patch.is_seen().then(|| patch.centre())?;
        let size = f64::from(patch.pixels) / (width_px * height_px) as f64;
        Some((size, CameraRays::new(&self.settings.camera).bearing_deg(x, y).0))
    }

    /// Whether the behaviour has filters of its own that count; if not, it combines policies that see with theirs.
    #[must_use]
    pub fn learns(&self) -> bool {
        match self.behaviour.hands_over() {
            true => !self.behaviour.always_hands_over(),
            false => self.settings.policies.is_empty(),
        }
    }

    fn parts(&self) -> Parts<'_> {
        Parts { behaviour: &self.behaviour, settings: &self.settings, filters: &self.filters }
    }
}

impl From<&Plan> for Sight {
    fn from(plan: &Plan) -> Self {
        let Plan { behaviour, settings, filters, .. } = plan;
        Self { behaviour: Arc::clone(behaviour), settings: settings.clone(), filters: Arc::clone(filters) }
    }
}
