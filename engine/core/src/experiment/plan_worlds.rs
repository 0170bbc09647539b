//! The worlds of a plan: found, loaded, and asked whether they have what the script names.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Plan;
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, nearest_name, printable};
use crate::robot::SimulatedRobot;
use crate::script::{Behaviour, Nameable, Unread};
use crate::settings::{Settings, VariedKey, WorldShare};
use crate::world::{FAMILIES, FamilyRange, FloorSquares, Layout, WorldSet};

/// The most worlds of a script, and of a command line: each takes half a megabyte.
const MOST_WORLDS: usize = 64;
const MOST_NAMED: usize = 256;

/// Loads every world that the settings name; what is wrong with one is added to the mistakes. `named` says that the command
/// line named them.
pub(super) fn load_worlds(
    behaviour: &Behaviour,
    settings: &Settings,
    named: bool,
    mistakes: &mut Mistakes,
) -> Option<WorldSet> {
    let alone = [WorldShare { name: settings.world.clone(), weight: 1 }];
    let (call, shares) = match settings.worlds.as_slice() {
        [] => ("world", &alone[..]),
        shares => ("worlds", shares),
    };
    let place = || if named { None } else { behaviour.place_of(call) };
    let count: usize = shares.iter().map(|share| FamilyRange::count_of(&share.name)).sum();
    let most = if named { MOST_NAMED } else { MOST_WORLDS };
    if count > most {
        let wrong = Diagnostic::new("E-WORLD-FILE", format!("these are {count} worlds, at most {most} are allowed"));
        let wrong = wrong.help("take a shorter range, such as corridors:1-12");
        mistakes.add(at(wrong, behaviour, place(), "too many"));
        return None;
    }
    let mut loaded = Vec::new();
    for (number, share) in shares.iter().enumerate() {
        let own = place().map(|call| behaviour.place_of(&format!("worlds:{number}")).unwrap_or(call));
        let layouts = load_share(behaviour, &share.name, own, settings);
        loaded.extend(mistakes.take(layouts).map(|layouts| (share.weight, layouts)));
    }
    if loaded.len() < shares.len() { None } else { WorldSet::new(loaded) }
}

/// The worlds that one name stands for: a file, or worlds made by rule.
fn load_share(
    behaviour: &Behaviour,
    name: &str,
    place: Option<Range<usize>>,
    settings: &Settings,
) -> Result<Vec<Arc<Layout>>> {
    let body = &settings.robot.body;
    match FamilyRange::of(name) {
        Some(Ok(range)) => {
            range.texts().map(|(name, text)| Ok(Arc::new(Layout::parse(SourceText::new(name, text), body)?))).collect()
        }
        Some(Err((message, help))) => {
            let wrong = Diagnostic::new("E-WORLD-FILE", message).help(help);
            at(wrong, behaviour, place, "no such worlds").fail()
        }
        None => Ok(vec![Arc::new(Layout::load(&find_world(behaviour, name, place)?, body)?)]),
    }
}

fn at(wrong: Diagnostic, behaviour: &Behaviour, place: Option<Range<usize>>, label: &str) -> Diagnostic {
    match place {
        Some(span) => wrong.at(behaviour.source(), span, label),
        None => wrong,
    }
}

impl Plan {
    /// Whether attempts differ in their world, or in what is drawn for them.
    #[must_use]
    pub fn varies(&self) -> bool {
        !self.worlds.further().is_empty() || !self.settings.randomise.is_empty()
    }

    /// After how many steps an attempt is broken off, so that another world or other values have their turn.
    pub(super) fn stay_steps(&self) -> u64 {
        let steps = self.settings.run.stay_steps;
        if steps == 0 || !self.varies() { u64::MAX } else { steps }
    }

    /// This plan in one of its worlds alone.
    ///
    /// # Panics
    /// If there is no such world.
    #[must_use]
    pub fn in_world(&self, world: usize) -> Self {
        let layout = Arc::clone(&self.worlds.layouts()[world]);
        Self { worlds: WorldSet::alone(Arc::clone(&layout)), layout, ..self.clone() }
    }

    /// Puts a robot into each world, and into the home world with each end of what is drawn; adds what is wrong with each. Whether
    /// there is nothing.
    pub(super) fn try_worlds(&self, mistakes: &mut Mistakes) -> bool {
        let (settings, before) = (Settings { randomise: Vec::new(), ..self.settings.clone() }, mistakes.count());
        for layout in self.worlds.layouts() {
            mistakes.take(SimulatedRobot::new(layout, &settings, 0));
        }
        if mistakes.count() == before {
            mistakes.take(SimulatedRobot::try_extremes(&self.layout, &self.settings));
        }
        mistakes.count() == before
    }

    /// Adds rules that can never fire, unless the laser is drawn anew.
    pub(super) fn find_out_of_reach(&self, unread: &Unread, mistakes: &mut Mistakes) {
        let drawn = self.settings.randomise.iter().any(|varied| varied.key.starts_with("laser."));
        if !drawn && !unread.any_of("laser") {
            let heights_m = self.worlds.layouts().iter().map(|layout| layout.level_height_m(&self.settings.robot.body));
            self.behaviour.find_unreachable(&self.settings.laser, heights_m.fold(0.0, f64::max), mistakes);
        }
    }

    /// Adds what the script names, or is measured by, and a world does not have; of several worlds, for each place in the script the
    /// first that lacks it.
    pub(super) fn find_unnamed(&self, mistakes: &mut Mistakes) {
        for layout in self.worlds.layouts() {
            let Layout { name, starts, movers, places, gates, lap, .. } = &**layout;
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
                has_squares: FloorSquares::fit(layout),
            };
            self.behaviour.find_unmeasurable(&world, mistakes);
            self.behaviour.find_unplaced(&self.settings, &world, mistakes);
        }
    }

    /// Adds every material and mover that is to vary and that a world does not have.
    pub(super) fn find_unvaried(&self, mistakes: &mut Mistakes) {
        for varied in &self.settings.randomise {
            let missing = self.worlds.layouts().iter().find_map(|layout| {
                let colours = layout.scene.parts().materials.iter().map(|material| material.name.as_str());
                let movers = layout.movers.iter().map(|mover| mover.name.as_str());
                let (kind, name, known): (_, _, Vec<&str>) = match VariedKey::of(&varied.key)?.0 {
                    VariedKey::Colour(name) | VariedKey::Texture(name) => ("material", name, colours.collect()),
                    VariedKey::Mover(name) => ("mover", name, movers.collect()),
                    _ => return None,
                };
                (!known.contains(&name)).then(|| {
                    let help = match nearest_name(name, known.iter().copied()) {
                        Some(near) => format!("did you mean \"{}\"?", printable(near)),
                        None if known.is_empty() => format!("leave it out: there is no {kind} in this world"),
                        None => format!("there are: {}", printable(&known.join(", "))),
                    };
                    let world = printable(&layout.name);
                    let message = format!("the world '{world}' has no {kind} \"{}\"", printable(name));
                    Diagnostic::new("E-SCRIPT-PLACE", message).help(help)
                })
            });
            let place = self.behaviour.place_of(&format!("randomise.{}", varied.key));
            missing
                .into_iter()
                .for_each(|wrong| mistakes.add(at(wrong, &self.behaviour, place.clone(), "not in this world")));
        }
    }
}

/// The file of a world: a path as it is, a name in the folders where worlds are kept.
fn find_world(behaviour: &Behaviour, name: &str, place: Option<Range<usize>>) -> Result<PathBuf> {
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
        None => format!("there are: {}; worlds made by rule, such as {}:7", known.join(", "), FAMILIES[0]),
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
