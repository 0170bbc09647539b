//! Whether a world has what the conditions of success are measured by.

use super::behaviour::Behaviour;
use crate::diagnostic::{Diagnostic, Mistakes, nearest_name, printable};
use crate::verdict::{FigureUse, Probe};

/// What a world has that a script can name, or be measured by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nameable<'a> {
    /// Its own name.
    pub world: &'a str,
    /// The names of its starts.
    pub starts: &'a [&'a str],
    /// A route named `lap`.
    pub has_route: bool,
    /// The names of its movers.
    pub movers: &'a [&'a str],
    /// The names of its places.
    pub places: &'a [&'a str],
    /// Gates to pass.
    pub has_gates: bool,
    /// A floor that is small enough to be counted in squares.
    pub has_squares: bool,
}

impl Nameable<'_> {
    /// Why a figure cannot be measured, and what to do; nothing if it can.
    fn missing(&self, asked: &FigureUse) -> Option<(String, String)> {
        let answer = |message: &str, help: &str| Some((message.to_owned(), help.to_owned()));
        if asked.figure.needs_route() && !self.has_route {
            let message = format!("this world has no route \"lap\": '{}' cannot be measured", asked.figure.name);
            return answer(&message, "add a [[route]] named \"lap\" to the world file, or ask for another figure");
        }
        let of = asked.of.request().and_then(|request| request.of.as_deref());
        match asked.figure.probe()? {
            Probe::FloorCovered if !self.has_squares => answer(
                "this world is too large: its floor cannot be counted in squares of 0.25 m",
                "ask for another figure, such as test.distance_m",
            ),
            Probe::Gates | Probe::GateErrors if !self.has_gates => {
                let message = format!("this world has no gates: '{}' cannot be measured", asked.figure.name);
                answer(&message, "add a [[gate]] with 'right_m' and 'left_m' to the world file")
            }
            Probe::FloorCovered | Probe::Gates | Probe::GateErrors => None,
            Probe::Visits => not_among("place", self.places, of?),
            Probe::Gap | Probe::GapError | Probe::ContactsWith => not_among("mover", self.movers, of?),
        }
    }
}

fn not_among(kind: &str, names: &[&str], name: &str) -> Option<(String, String)> {
    if names.contains(&name) {
        return None;
    }
    let help = match (nearest_name(name, names.iter().copied()), names) {
        (Some(near), _) => format!("did you mean \"{}\"?", printable(near)),
        (None, []) => format!("add a [[{kind}]] to the world file, or ask for another figure"),
        (None, names) => format!("there are: {}", printable(&names.join(", "))),
    };
    Some((format!("this world has no {kind} \"{}\"", printable(name)), help))
}

impl Behaviour {
    /// Adds every condition of success that reads a figure which the world cannot give.
    pub(crate) fn find_unmeasurable(&self, world: &Nameable<'_>, mistakes: &mut Mistakes) {
        for condition in self.conditions() {
            let missing = condition.term.figures().into_iter().find_map(|asked| world.missing(&asked));
            if let (Some((message, help)), Some(span)) = (missing, &condition.span) {
                let wrong = Diagnostic::new("E-SCRIPT-SUCCESS", message);
                mistakes.add(wrong.at(self.source(), span.clone(), "not in this world").help(help));
            }
        }
    }
}
