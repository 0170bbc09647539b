//! The movers of a world file: their bodies, their routes, and how they drive.

use super::build::{Builder, error, is_lost, yaw};
use super::reader::FileRow;
use crate::diagnostic::{Result, printable};
use crate::geometry::{Point3, Vector3};
use crate::world::mover::Mover;
use crate::world::route::Route;
use crate::world::scene::{Shape, Solid};
use crate::world::schedule::{Pace, Pause, Schedule};

/// The keys of a mover without which the time alone says where it is.
const KEYS: [&str; 5] = ["speeds", "pauses", "returns", "starts_within_m", "at_recovery"];

impl Builder<'_> {
    pub(super) fn movers(&mut self, file: &FileRow, routes: &[Route]) -> Vec<Mover> {
        let mut movers: Vec<Mover> = Vec::new();
        for row in file.sound_rows("mover") {
            let name = row.text("name").unwrap_or_default();
            if movers.iter().any(|mover| mover.name == name) {
                self.mistakes.add(self.twice("mover", row));
            }
            let wanted = row.text("route").unwrap_or_default();
            let route = routes.iter().position(|route| route.name == wanted);
            let names = routes.iter().map(|route| route.name.as_str());
            // A route that is there and not in this list has a mistake of its own.
            let written = file.rows("route").iter().any(|route| route.text("name") == Some(wanted));
            if route.is_none() && !written && !is_lost(file, "route", wanted) {
                self.mistakes.add(self.no_such("route", wanted, row, names));
            }
            let way = route.map(|index| &routes[index]);
            let schedule = self.schedule(row, way);
            let schedule = self.mistakes.take(schedule).flatten();
            let solids = self.bodies(file, row);
            let (speed_m_per_s, offset_m) =
                (row.number("speed_m_per_s").unwrap_or(0.0), row.number("offset_m").unwrap_or(0.0));
            let (name, route) = (name.to_owned(), route.unwrap_or(0));
            movers.push(Mover { name, route, speed_m_per_s, offset_m, schedule, solids });
        }
        movers
    }

    fn bodies(&mut self, file: &FileRow, row: &FileRow) -> Vec<Solid> {
        let mut solids = Vec::new();
        for part in row.rows("boxes") {
            let (place, size) = (part.numbers("centre_m"), part.numbers("size_m"));
            solids.push(Solid {
                shape: Shape::Box { half_m: 0.5 * Vector3::new(size[0], size[1], size[2]) },
                centre: Point3::new(place[0], place[1], place[2]),
                yaw_rad: yaw(part),
                material: self.material(file, part),
                collides: true,
            });
        }
        solids
    }

    /// What a mover does beside following its route at one speed, if anything.
    fn schedule(&self, row: &FileRow, route: Option<&Route>) -> Result<Option<Schedule>> {
        let (speeds, span) = (row.rows("speeds"), row.numbers("speed_m_per_s"));
        let help = "write 'speed_m_per_s = 0.2', or 'speeds = [{ from_m = 0, m_per_s = 0.2 }]' to change it on the way";
        match (speeds.first(), span.first()) {
            (None, None) => {
                let wrong = error("E-WORLD-KEY", "[[mover]] has no speed");
                return wrong.at(self.source, row.span.clone(), "how fast?").help(help).fail();
            }
            (Some(_), Some(_)) => {
                let wrong = error("E-WORLD-KEY", "[[mover]] has 'speed_m_per_s' and 'speeds'");
                return wrong.at(self.source, row.span_of("speeds"), "the second of the two").help(help).fail();
            }
            _ => {}
        }
        let Some(route) = route else { return Ok(None) };
        if !KEYS.iter().any(|key| row.has(key)) && span.len() < 2 {
            return Ok(None);
        }
        if row.flag("returns") == Some(true) && route.closed {
            return error(
                "E-WORLD-VALUE",
                format!("the route '{}' is closed: nothing comes back on it", printable(&route.name)),
            )
            .at(self.source, row.span_of("returns"), "only on an open route")
            .help("leave 'returns' out, or leave 'closed = true' out of the route")
            .fail();
        }
        let place = |row: &FileRow, key: &str| self.place(row, key, route);
        let paces = speeds
            .iter()
            .map(|row| Ok(Pace { from_m: place(row, "from_m")?, m_per_s: row.number("m_per_s").unwrap_or(0.0) }));
        let paces = paces.collect::<Result<Vec<_>>>()?;
        let pauses = row
            .rows("pauses")
            .iter()
            .map(|row| Ok(Pause { at_m: place(row, "at_m")?, for_s: row.number("for_s").unwrap_or(0.0) }));
        let pauses = pauses.collect::<Result<Vec<_>>>()?;
        if let Some(first) = paces.first().filter(|first| first.from_m != 0.0) {
            return error("E-WORLD-VALUE", format!("'speeds' says nothing of the route's first {} m", first.from_m))
                .at(self.source, speeds[0].span_of("from_m"), "must be 0")
                .help("begin with { from_m = 0, m_per_s = ... }")
                .fail();
        }
        self.rises(speeds, "from_m")?;
        self.rises(row.rows("pauses"), "at_m")?;
        let (low, high) = (span.first().copied().unwrap_or(0.0), span.last().copied().unwrap_or(0.0));
        Ok(Some(Schedule {
            speed_m_per_s: [low, high],
            paces,
            pauses,
            returns: row.flag("returns").unwrap_or(false),
            starts_within_m: row.number("starts_within_m"),
            begins: row.text("at_recovery") == Some("begins"),
        }))
    }

    /// A place on a route; the end of a closed one is its beginning.
    fn place(&self, row: &FileRow, key: &str, route: &Route) -> Result<f64> {
        let (place_m, length_m) = (row.number(key).unwrap_or(0.0), route.length_m());
        if place_m < length_m || (place_m == length_m && !route.closed) {
            return Ok(place_m);
        }
        let length_m = (length_m * 1000.0).floor() / 1000.0;
        error("E-WORLD-VALUE", format!("the route '{}' is {length_m} m long", printable(&route.name)))
            .at(self.source, row.span_of(key), "lies beyond its end")
            .help(format!("'{key}' is metres along the route, less than {length_m}"))
            .fail()
    }

    fn rises(&self, rows: &[FileRow], key: &str) -> Result<()> {
        let at = |row: &FileRow| row.number(key).unwrap_or(0.0);
        let Some(pair) = rows.windows(2).find(|pair| at(&pair[1]) <= at(&pair[0])) else { return Ok(()) };
        error("E-WORLD-VALUE", format!("'{key}' must rise from table to table"))
            .at(self.source, pair[1].span_of(key), format!("not above the {} before it", at(&pair[0])))
            .help("write the tables in the order of the way, each place once")
            .fail()
    }
}

/// Why a key that asks for a body that can be pushed is not known.
pub(super) fn pushable(key: &str) -> Option<&'static str> {
    let words = ["pushable", "push", "pushed", "movable", "mass_kg", "mass", "friction", "dynamic"];
    words.contains(&key).then_some(
        "nothing can be pushed here: that needs friction and tipping, and a guess would teach what no real box obeys; \
         a [[mover]] drives by itself",
    )
}
