//! From what was written to what can run: the behaviour's settings, the command line's changes, the world, all checked.

use std::path::Path;
use std::sync::Arc;

use super::changes::{changed, with_params};
use super::doors::check_states;
use super::parts::Parts;
use super::plan_worlds::load_worlds;
use super::{Eyes, Leg, Member, Origin, UsedPolicy, outlook};
use crate::diagnostic::{Diagnostic, Mistakes, Result};
use crate::filter::{Catalogue, Chain};
use crate::judge::Judge;
use crate::learner::{Mirror, Task};
use crate::random::{Random, Stream};
use crate::script::{Behaviour, Draft, Unread};
use crate::settings::{PartSettings, Settings};
use crate::state::{Grid, StateMap};
use crate::verdict::Success;
use crate::world::{Layout, WorldSet};

/// What the command line changes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Overrides {
    /// Another world: a name, or the path of a file.
    pub world: Option<String>,
    /// Other worlds, equally likely; none to leave them as they are.
    pub worlds: Vec<String>,
    /// Nothing is drawn: one world, or of several the home world, and no values.
    pub plain: bool,
    /// Another number of learning steps.
    pub steps: Option<u64>,
    /// Another number of test steps.
    pub test_steps: Option<u64>,
    /// `KEY=VALUE` pairs, such as `camera.tilt_deg=40` or `filter.sobel.threshold=80`.
    pub set: Vec<String>,
}

/// A behaviour that is ready to be learned, under any seed.
#[derive(Clone)]
pub struct Plan {
    /// The script.
    pub behaviour: Arc<Behaviour>,
    /// Its settings, with the command line's changes.
    pub settings: Settings,
    /// The world; of several, the home world.
    pub layout: Arc<Layout>,
    /// All worlds, the home world first.
    pub worlds: WorldSet,
    /// The policies that its script combines, once they are loaded; none of a behaviour that learns.
    pub members: Vec<Member>,
    /// The policies that its script uses, once they are loaded, in the order in which it names them.
    pub used: Vec<Arc<UsedPolicy>>,
    /// The filters that its chain may use.
    pub filters: Arc<Catalogue>,
    /// What is learned under other rewards first; none unless the reward was swapped while the robot learned.
    pub earlier: Vec<Leg>,
    /// The runs that learning goes on from: one for all seeds, or one for each; none if it begins with nothing.
    pub origins: Vec<Arc<Origin>>,
}

impl Plan {
    /// Resolves a behaviour that uses linked-in filters, and tries everything that can fail before learning starts.
    ///
    /// # Errors
    /// If a setting, a filter, the grid, the world or the script is wrong.
    pub fn new(behaviour: Arc<Behaviour>, overrides: &Overrides) -> Result<Self> {
        Self::with_filters(behaviour, overrides, Arc::new(Catalogue::linked_in()))
    }

    /// Resolves a behaviour that may use other filters too.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_filters(behaviour: Arc<Behaviour>, overrides: &Overrides, filters: Arc<Catalogue>) -> Result<Self> {
        let behaviour = with_params(behaviour, overrides)?;
        let mistakes = Mistakes::new(behaviour.source());
        Self::resolve(behaviour, &Unread::default(), mistakes, overrides, filters)
    }

    /// Loads a script and resolves it, with all that is wrong in it, in its settings and in its world as one error.
    ///
    /// # Errors
    /// As [`Behaviour::load`] and [`Plan::new`]; or if the catalogue of filters cannot be made.
    pub fn load(
        script: &Path,
        overrides: &Overrides,
        filters: impl FnOnce() -> Result<Arc<Catalogue>>,
    ) -> Result<Self> {
        let Draft { behaviour, mistakes, unread } = Draft::load(script, &overrides.params())?.not_empty()?;
        match filters() {
            Ok(filters) => Self::resolve(Arc::new(behaviour), &unread, mistakes, overrides, filters),
            Err(error) => Err(mistakes.ended_by(*error)),
        }
    }

    fn resolve(
        behaviour: Arc<Behaviour>,
        unread: &Unread,
        mut mistakes: Mistakes,
        overrides: &Overrides,
        filters: Arc<Catalogue>,
    ) -> Result<Self> {
        let settings = match changed(behaviour.settings(), behaviour.params(), overrides) {
            Ok(settings) => settings,
            // It may be about something that the script could not say.
            Err(error) => return mistakes.end().and(Err(error)),
        };
        let named = overrides.world.is_some() || !overrides.worlds.is_empty();
        let worlds = if !named && (unread.any_of("world") || unread.any_of("worlds")) {
            None
        } else {
            let worlds = load_worlds(&behaviour, &settings, named, &mut mistakes);
            worlds.map(|worlds| if overrides.plain { WorldSet::alone(Arc::clone(worlds.home())) } else { worlds })
        };
        Self::checked(behaviour, settings, worlds, filters, unread, mistakes)
    }

    /// This plan with changes; it keeps its world unless another is named.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_changes(self, overrides: &Overrides) -> Result<Self> {
        let behaviour = with_params(Arc::clone(&self.behaviour), overrides)?;
        let followed = self.settings.clone().following(self.behaviour.settings(), behaviour.settings());
        let settings = changed(&followed, behaviour.params(), overrides)?;
        let named = overrides.world.is_some() || !overrides.worlds.is_empty();
        let others = (&settings.world, &settings.worlds) != (&self.settings.world, &self.settings.worlds);
        let worlds = if named || others {
            let mut mistakes = Mistakes::new(behaviour.source());
            let worlds = load_worlds(&behaviour, &settings, true, &mut mistakes);
            mistakes.end()?;
            worlds.unwrap_or(self.worlds)
        } else if overrides.plain {
            WorldSet::alone(self.layout)
        } else {
            self.worlds
        };
        let plan = Self::with_worlds(behaviour, settings, worlds, self.filters)?;
        let plan = Self { origins: self.origins, ..plan };
        Ok(plan.with_members(self.members).with_used(self.used).after(self.earlier))
    }

    /// A plan from parts that were resolved before.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_layout(
        behaviour: Arc<Behaviour>,
        settings: Settings,
        layout: Arc<Layout>,
        filters: Arc<Catalogue>,
    ) -> Result<Self> {
        Self::with_worlds(behaviour, settings, WorldSet::alone(layout), filters)
    }

    /// A plan in several worlds, from parts that were resolved before.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_worlds(
        behaviour: Arc<Behaviour>,
        settings: Settings,
        worlds: WorldSet,
        filters: Arc<Catalogue>,
    ) -> Result<Self> {
        let mistakes = Mistakes::new(behaviour.source());
        Self::checked(behaviour, settings, Some(worlds), filters, &Unread::default(), mistakes)
    }

    /// Every check whose settings are read, whatever the others find.
    fn checked(
        behaviour: Arc<Behaviour>,
        settings: Settings,
        worlds: Option<WorldSet>,
        filters: Arc<Catalogue>,
        unread: &Unread,
        mut mistakes: Mistakes,
    ) -> Result<Self> {
        let parts = Parts { behaviour: &behaviour, settings: &settings, filters: &filters };
        let sees = parts.check(unread, &mut mistakes);
        let Some(worlds) = worlds else {
            let unknown = Diagnostic::new("E-WORLD-FILE", "the script does not say which world");
            return mistakes.end().and(Err(Box::new(unknown)));
        };
        let layout = Arc::clone(worlds.home());
        let (members, used, earlier, origins) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let plan = Self { behaviour, settings, layout, worlds, members, used, filters, earlier, origins };
        plan.find_out_of_reach(unread, &mut mistakes);
        plan.find_unnamed(&mut mistakes);
        plan.find_unvaried(&mut mistakes);
        let robot = ["camera", "laser", "light", "movers", "recovery", "robot", "run"];
        if !robot.iter().any(|call| unread.any_of(call)) && plan.try_worlds(&mut mistakes) && sees {
            for world in 0..plan.worlds.layouts().len() {
                mistakes.take(outlook::check_outlook(&plan.in_world(world)));
            }
        }
        mistakes.end().map(|()| plan)
    }

    pub(super) fn parts(&self) -> Parts<'_> {
        Parts { behaviour: &self.behaviour, settings: &self.settings, filters: &self.filters }
    }

    /// Whether anything reads what the camera sees: the states, or the script. If nothing does, the camera is not drawn.
    #[must_use]
    pub fn looks(&self) -> bool {
        self.parts().looks()
    }

    /// A fresh filter chain of the first view.
    ///
    /// # Errors
    /// If the chain cannot be built; the error points at the script's line.
    pub fn chain(&self) -> Result<Chain> {
        self.parts().chain(&self.settings.view)
    }

    /// Fresh filter chains, one for each view.
    pub(super) fn chains(&self) -> Result<Vec<Chain>> {
        self.settings.views().map(|view| self.parts().chain(view)).collect()
    }

    /// A fresh grid of the first view.
    ///
    /// # Errors
    /// If it would have too many states, or cells without pixels.
    pub fn grid(&self) -> Result<Grid> {
        self.parts().grid(&self.settings.view)
    }

    /// A fresh map from the grid to states.
    ///
    /// # Errors
    /// As [`Plan::grid`].
    pub fn state_map(&self) -> Result<Box<dyn StateMap>> {
        self.parts().state_map()
    }

    /// Rows and columns of the cells by which states are drawn: those of the first view in the state.
    ///
    /// # Errors
    /// As [`Plan::grid`].
    pub fn drawn_grid(&self) -> Result<(usize, usize)> {
        let own = self.grid()?.size();
        let map = self.state_map()?;
        let cells = (map.states() > 0).then(|| map.describe(0).cells).flatten();
        Ok(cells.map_or(own, |cells| (cells.rows, cells.columns)))
    }

    /// Fresh eyes: chain, grid and state map.
    ///
    /// # Errors
    /// As [`Plan::chain`] and [`Plan::grid`].
    pub fn eyes(&self) -> Result<Eyes> {
        self.parts().eyes()
    }

    /// The mirror that `learner.mirror` asks for, over the states of a map.
    ///
    /// # Errors
    /// If an action has no counterpart that turns the other way, or the map has no sides.
    pub(super) fn mirror(&self, map: &dyn StateMap) -> Result<Option<Mirror>> {
        self.parts().mirror(map)
    }

    /// What a learner is made for: the states of a map, the plan's actions, and the stream of a seed.
    ///
    /// # Errors
    /// If `learner.mirror` is set, and an action has no counterpart that turns the other way or the map has no sides; `E-DOOR` if
    /// the map has no states, too many, or others than its digits tell apart.
    pub fn task(&self, map: &dyn StateMap, seed: u64) -> Result<Task> {
        check_states(map)?;
        Ok(Task {
            digits: map.digits(),
            states: map.states(),
            actions: self.settings.actions.clone(),
            mirror: self.mirror(map)?,
            random: Random::new(seed, Stream::Learner),
        })
    }

    /// Whether the behaviour learns; if not, policies that were learned before do all of it: combined, or one of those used
    /// always drives.
    #[must_use]
    pub fn learns(&self) -> bool {
        if self.behaviour.hands_over() {
            return !self.behaviour.always_hands_over();
        }
        self.settings.policies.is_empty()
    }

    /// What is called success.
    #[must_use]
    pub fn success(&self) -> Success {
        let run = &self.settings.run;
        let success = self.behaviour.success(self.worlds.have_laps(), run);
        let parts = &self.settings.state;
        let blind = self.learns() && !parts.is_empty() && parts.iter().all(PartSettings::is_blind);
        if blind { success.of_a_blind_robot() } else { success }
    }

    /// The plan with the policies that its script combines.
    #[must_use]
    pub fn with_members(self, members: Vec<Member>) -> Self {
        Self { members, ..self }
    }

    /// The names of the starts of each world.
    pub(super) fn names_of_starts(&self) -> impl Iterator<Item = Vec<String>> {
        let starts = |layout: &Arc<Layout>| layout.starts.iter().map(|start| start.name.clone()).collect();
        self.worlds.layouts().iter().map(starts)
    }

    /// A fresh judge.
    ///
    /// # Errors
    /// If a rule does not fit the settings, such as a beam that the laser does not have.
    pub fn judge(&self) -> Result<Judge> {
        let judge = self.parts().judge()?.in_worlds(self.names_of_starts());
        if self.used.is_empty() {
            return Ok(judge);
        }
        Ok(judge.with_actions(&self.motions(), self.settings.actions.len()))
    }
}
