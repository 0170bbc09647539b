//! From what was written to what can run: the behaviour's settings, the command line's changes, the world, all checked.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::changes::{changed, with_params};
use super::parts::Parts;
use super::{Eyes, Leg, Member, outlook};
use crate::diagnostic::{Diagnostic, Mistakes, Result, nearest_name, printable};
use crate::filter::{Catalogue, Chain};
use crate::judge::Judge;
use crate::learner::{Mirror, Task};
use crate::random::{Random, Stream};
use crate::robot::SimulatedRobot;
use crate::script::{Behaviour, Draft, Nameable, Unread};
use crate::settings::Settings;
use crate::state::{Grid, StateMap};
use crate::verdict::Success;
use crate::world::{FloorSquares, Layout};

/// What the command line changes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Overrides {
    /// Another world: a name, or the path of a file.
    pub world: Option<String>,
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
    /// The world.
    pub layout: Arc<Layout>,
    /// The policies that its script combines, once they are loaded; none of a behaviour that learns.
    pub members: Vec<Member>,
    /// The filters that its chain may use.
    pub filters: Arc<Catalogue>,
    /// What is learned under other rewards first; none unless the reward was swapped while the robot learned.
    pub earlier: Vec<Leg>,
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
        let layout = if overrides.world.is_none() && unread.any_of("world") {
            None
        } else {
            let place = if overrides.world.is_some() { None } else { behaviour.place_of("world") };
            let path = find_world(&behaviour, &settings.world, place);
            mistakes.take(path.and_then(|path| Layout::load(&path, &settings.robot.body)))
        };
        Self::checked(behaviour, settings, layout.map(Arc::new), filters, unread, mistakes)
    }

    /// This plan with changes; it keeps its world unless another is named.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_changes(self, overrides: &Overrides) -> Result<Self> {
        let behaviour = with_params(Arc::clone(&self.behaviour), overrides)?;
        let followed = self.settings.clone().following(self.behaviour.settings(), behaviour.settings());
        let settings = changed(&followed, behaviour.params(), overrides)?;
        let layout = if overrides.world.is_some() || settings.world != self.settings.world {
            Arc::new(Layout::load(&find_world(&behaviour, &settings.world, None)?, &settings.robot.body)?)
        } else {
            self.layout
        };
        let plan = Self::with_layout(behaviour, settings, layout, self.filters)?;
        Ok(plan.with_members(self.members).after(self.earlier))
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
        let mistakes = Mistakes::new(behaviour.source());
        Self::checked(behaviour, settings, Some(layout), filters, &Unread::default(), mistakes)
    }

    /// Every check whose settings are read, whatever the others find.
    fn checked(
        behaviour: Arc<Behaviour>,
        settings: Settings,
        layout: Option<Arc<Layout>>,
        filters: Arc<Catalogue>,
        unread: &Unread,
        mut mistakes: Mistakes,
    ) -> Result<Self> {
        let parts = Parts { behaviour: &behaviour, settings: &settings, filters: &filters };
        let sees = parts.check(unread, &mut mistakes);
        let Some(layout) = layout else {
            let unknown = Diagnostic::new("E-WORLD-FILE", "the script does not say which world");
            return mistakes.end().and(Err(Box::new(unknown)));
        };
        let plan = Self { behaviour, settings, layout, members: Vec::new(), filters, earlier: Vec::new() };
        if !unread.any_of("laser") {
            let height_m = plan.layout.level_height_m(&plan.settings.robot.body);
            plan.behaviour.find_unreachable(&plan.settings.laser, height_m, &mut mistakes);
        }
        plan.find_unnamed(&mut mistakes);
        let robot = ["camera", "laser", "movers", "recovery", "robot", "run"];
        if !robot.iter().any(|call| unread.any_of(call))
            && mistakes.take(SimulatedRobot::new(&plan.layout, &plan.settings, 0)).is_some()
            && sees
        {
            mistakes.take(outlook::check_outlook(&plan));
        }
        mistakes.end().map(|()| plan)
    }

    /// Adds what the script names, or is measured by, and the world does not have.
    fn find_unnamed(&self, mistakes: &mut Mistakes) {
        let Layout { name, starts, movers, places, gates, lap, .. } = &*self.layout;
        let starts: Vec<&str> = starts.iter().map(|start| start.name.as_str()).collect();
        let movers: Vec<&str> = movers.iter().map(|mover| mover.name.as_str()).collect();
        let places: Vec<&str> = places.iter().map(|place| place.name.as_str()).collect();
        let world = Nameable {
            world: name,
            starts: &starts,
            has_route: lap.is_some(),
            movers: &movers,
            places: &places,
            has_gates: !gates.is_empty(),
            has_squares: FloorSquares::fit(&self.layout),
        };
        self.behaviour.find_unmeasurable(&world, mistakes);
        self.behaviour.find_unplaced(&self.settings, &world, mistakes);
    }

    fn parts(&self) -> Parts<'_> {
        Parts { behaviour: &self.behaviour, settings: &self.settings, filters: &self.filters }
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
    /// If `learner.mirror` is set, and an action has no counterpart that turns the other way or the map has no sides.
    pub fn task(&self, map: &dyn StateMap, seed: u64) -> Result<Task> {
        Ok(Task {
            digits: map.digits(),
            states: map.states(),
            actions: self.settings.actions.clone(),
            mirror: self.mirror(map)?,
            random: Random::new(seed, Stream::Learner),
        })
    }

    /// Whether the behaviour learns; if not, it combines policies that were learned before.
    #[must_use]
    pub fn learns(&self) -> bool {
        self.settings.policies.is_empty()
    }

    /// What is called success.
    #[must_use]
    pub fn success(&self) -> Success {
        let run = &self.settings.run;
        self.behaviour.success(self.layout.lap.is_some(), run)
    }

    /// The plan with the policies that its script combines.
    #[must_use]
    pub fn with_members(self, members: Vec<Member>) -> Self {
        Self { members, ..self }
    }

    /// A fresh judge.
    ///
    /// # Errors
    /// If a rule does not fit the settings, such as a beam that the laser does not have.
    pub fn judge(&self) -> Result<Judge> {
        let starts = self.layout.starts.iter().map(|start| start.name.clone()).collect();
        Ok(self.parts().judge()?.in_world(starts))
    }
}

/// The file of a world: a path as it is, a name in the folders where worlds are kept.
fn find_world(behaviour: &Behaviour, name: &str, place: Option<std::ops::Range<usize>>) -> Result<PathBuf> {
    let script = &behaviour.source().path;
    let folder = script.parent().unwrap_or(Path::new(""));
    let is_path = name.contains(['/', '\\']) || name.ends_with(".toml");
    let tried: Vec<PathBuf> = if is_path {
        // A path in a script is meant from the script, a path on the command line from where the user stands.
        vec![if place.is_some() { folder.join(name) } else { PathBuf::from(name) }]
    } else {
        let file = format!("{name}.toml");
        ["../worlds", "worlds", ""]
            .iter()
            .map(|part| folder.join(part).join(&file))
            .chain([Path::new("worlds").join(&file)])
            .collect()
    };
    if let Some(found) = tried.iter().find(|path| path.exists()) {
        return Ok(found.clone());
    }
    let known = known_worlds(&tried);
    let help = match nearest_name(name, known.iter().map(String::as_str)) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None if known.is_empty() => "write the path of a world file, such as worlds/room.toml".to_owned(),
        None => format!("there are: {}", known.join(", ")),
    };
    let message = format!("there is no world '{}'", printable(name));
    let error = Diagnostic::new("E-WORLD-FILE", message).help(help);
    match place {
        Some(span) => error.at(behaviour.source(), span, "not found").fail(),
        None => error.fail(),
    }
}

fn known_worlds(tried: &[PathBuf]) -> Vec<String> {
    let folders = tried.iter().filter_map(|path| path.parent()).filter(|folder| folder.ends_with("worlds"));
    let files = folders.filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let mut names: Vec<String> =
        files.filter_map(|entry| entry.file_name().to_str()?.strip_suffix(".toml").map(str::to_owned)).collect();
    names.sort();
    names.dedup();
    names
}
