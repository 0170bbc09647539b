//! What a behaviour sees with, and nothing else: no world, no robot, no rules that would have to fit.

use std::path::Path;
use std::sync::Arc;

use super::changes::changed;
use super::parts::Parts;
use super::{Overrides, Plan};
use crate::diagnostic::Result;
use crate::filter::{Catalogue, Chain};
use crate::script::Behaviour;
use crate::settings::Settings;
use crate::state::Grid;

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

    /// Whether the behaviour learns; if not, it combines policies that see with filters of their own.
    #[must_use]
    pub fn learns(&self) -> bool {
        self.settings.policies.is_empty()
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
