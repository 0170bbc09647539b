//! Where attempts begin: the list of starts, and whether the world has the places that a script names.

use super::behaviour::Behaviour;
use super::measurable::Nameable;
use super::setup::SetupReader;
use crate::diagnostic::{Diagnostic, Mistakes, Result, nearest_name, printable};
use crate::judge::views::number;
use crate::outcome::Destination;
use crate::settings::{RecoverTo, Settings, StartSettings};
use rhai::{Dynamic, Map};
use std::ops::Range;

/// Most starts in a list.
const MAX_STARTS: usize = 64;

impl SetupReader<'_> {
    /// The list of `starts([...], #{ widen: 0.8 })`.
    pub(super) fn starts(&self, names: Dynamic, options: Option<Dynamic>, form: &str) -> Result<StartSettings> {
        let list = names.into_array().unwrap_or_default();
        if !(1..=MAX_STARTS).contains(&list.len()) {
            let message = format!("there must be 1 to {MAX_STARTS} starts, found {}", list.len());
            return self.wrong(self.call, message, "set here", form);
        }
        let mut names: Vec<String> = Vec::new();
        for name in list {
            let name = self.word(name, form)?;
            if names.contains(&name) {
                let message = format!("the start \"{}\" is listed twice", printable(&name));
                return self.wrong(self.call, message, "set here", form);
            }
            names.push(name);
        }
        let widen = match options.map(|options| options.try_cast::<Map>()) {
            None => None,
            Some(Some(map)) => Some(self.widen(&map, form)?),
            Some(None) => return self.wrong(self.call, "'starts' is written otherwise".to_owned(), "found this", form),
        };
        if widen.is_some() && names.len() == 1 {
            return self.wrong(self.call, "one start alone cannot be widened".to_owned(), "set here", form);
        }
        Ok(StartSettings { names, widen })
    }

    fn widen(&self, map: &Map, form: &str) -> Result<f64> {
        if let Some(key) = map.keys().find(|key| *key != "widen") {
            let message = format!("'starts' has no setting '{}'", printable(key));
            return self.wrong(self.entry(key).0, message, "not known", form);
        }
        let share = map.get("widen").and_then(number).filter(|share| (0.05..=1.0).contains(share));
        match share {
            Some(share) => Ok(share),
            None => {
                let message = "'widen' must be a share of good attempts, 0.05 to 1".to_owned();
                self.wrong(self.entry("widen").1, message, "found something else", form)
            }
        }
    }
}

impl Behaviour {
    /// Adds every place that the script names and the world does not have, or cannot put a robot at; and a list of starts that
    /// nothing uses.
    pub(crate) fn find_unplaced(&self, settings: &Settings, world: &Nameable<'_>, mistakes: &mut Mistakes) {
        let named = settings.recovery.at.iter().filter(|_| settings.recovery.to == RecoverTo::Start);
        for name in named {
            self.look_up(name, self.place_of("recovery.to"), world, true, mistakes);
        }
        for name in &settings.starts.names {
            self.look_up(name, self.place_of("starts"), world, false, mistakes);
        }
        let rules = || self.compiled().rules.iter().filter_map(|rule| rule.to_place.as_ref());
        for (name, span) in rules() {
            self.look_up(name, Some(span.clone()), world, true, mistakes);
        }
        let any = settings.recovery.to == RecoverTo::Start && settings.recovery.at.is_none();
        let by_reward = self.outline().reward_recovers;
        if !settings.starts.names.is_empty() && !any && !by_reward && !rules().any(|(name, _)| name == "start") {
            let wrong = Diagnostic::new("E-SCRIPT-PLACE", "no attempt begins at one of these starts");
            let wrong = wrong.help("write recovery(\"start\");, which puts the robot at one of them");
            mistakes.add(match self.place_of("starts") {
                Some(span) => wrong.at(self.source(), span, "has no effect"),
                None => wrong,
            });
        }
    }

    fn look_up(
        &self,
        name: &str,
        span: Option<Range<usize>>,
        world: &Nameable<'_>,
        words: bool,
        mistakes: &mut Mistakes,
    ) {
        let Nameable { starts, movers, has_route, .. } = *world;
        let world = printable(world.world);
        let (message, help) = match Destination::of(name, starts) {
            Some(Destination::Start(_)) => return,
            Some(Destination::Word(word)) if words => match word {
                RecoverTo::Nearest | RecoverTo::Random if !has_route => (
                    format!("to \"{name}\" needs the route 'lap', and the world '{world}' has none"),
                    format!("name one of its starts: {}", printable(&starts.join(", "))),
                ),
                RecoverTo::Behind if movers.is_empty() => (
                    format!("to \"behind\" needs a mover, and the world '{world}' has none"),
                    format!("name one of its starts: {}", printable(&starts.join(", "))),
                ),
                _ => return,
            },
            _ => {
                let own = if words { RecoverTo::WORDS } else { &[] };
                let known = || starts.iter().chain(own).copied();
                let help = match nearest_name(name, known()) {
                    Some(near) => format!("did you mean \"{}\"?", printable(near)),
                    None => format!("there are: {}", printable(&known().collect::<Vec<_>>().join(", "))),
                };
                (format!("the world '{world}' has no start \"{}\"", printable(name)), help)
            }
        };
        let wrong = Diagnostic::new("E-SCRIPT-PLACE", message).help(help);
        mistakes.add(match span {
            Some(span) => wrong.at(self.source(), span, "not in this world"),
            None => wrong,
        });
    }
}
