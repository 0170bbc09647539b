//! Worlds made by rule: a family and a number are a world, the same on every machine.
//!
//! What is made is the text of a world file, which goes through the same reader as any other.

mod corridors;
mod lines;
mod obstacles;
mod outline;
mod rooms;

use crate::diagnostic::{nearest_name, printable};
use crate::random::{Random, Stream};
use std::fmt::Write;
use std::ops::RangeInclusive;

/// The families by name.
pub const FAMILIES: [&str; 3] = ["rooms", "corridors", "lines"];
/// Format numbers: whoever changes what a family makes raises its own, so that no number stands for two worlds.
const FORMATS: [u32; 3] = [1, 1, 1];
/// The most worlds of one range, and the greatest number.
const MOST_WORLDS: u64 = 4_096;
const MOST_NUMBER: u64 = 999_999;

/// Some worlds of one family: `corridors:7` or `corridors:1-12`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FamilyRange {
    family: usize,
    numbers: RangeInclusive<u64>,
}

impl FamilyRange {
    /// What a name stands for; nothing if it is that of a file. What is wrong with it comes with what to write instead.
    #[must_use]
    pub fn of(name: &str) -> Option<Result<Self, (String, String)>> {
        let (family, numbers) = name.split_once(':')?;
        if name.contains(['/', '\\']) {
            return None;
        }
        let Some(index) = FAMILIES.iter().position(|known| *known == family) else {
            let help = match nearest_name(family, FAMILIES) {
                Some(near) => format!("did you mean \"{near}:{}\"?", printable(numbers)),
                None => format!("the families are: {}", FAMILIES.join(", ")),
            };
            return Some(Err((format!("there is no family of worlds '{}'", printable(family)), help)));
        };
        let number = |text: &str| text.parse().ok().filter(|number: &u64| *number <= MOST_NUMBER);
        let (first, last) = numbers.split_once('-').unwrap_or((numbers, numbers));
        let range = number(first).zip(number(last)).filter(|(first, last)| first <= last && last - first < MOST_WORLDS);
        let Some((first, last)) = range else {
            let message = format!("'{}' is no world, and no range of worlds", printable(name));
            let help = format!(
                "write {family}:7 or {family}:1-12, with whole numbers up to {MOST_NUMBER}, at most {MOST_WORLDS} of them"
            );
            return Some(Err((message, help)));
        };
        Some(Ok(Self { family: index, numbers: first..=last }))
    }

    /// How many worlds a name stands for: one, unless it is that of a range.
    #[must_use]
    pub fn count_of(name: &str) -> usize {
        Self::of(name).and_then(Result::ok).map_or(1, |range| range.count())
    }

    /// Numbers of worlds in a whole family: 0 and on.
    pub const NUMBERS: u32 = MOST_NUMBER as u32 + 1;

    /// As it is written: `corridors:1-12`.
    #[must_use]
    pub fn name(&self) -> String {
        let (first, last) = (self.numbers.start(), self.numbers.end());
        let last = if first == last { String::new() } else { format!("-{last}") };
        format!("{}:{first}{last}", FAMILIES[self.family])
    }

    /// The name of one of its worlds, counted from 0.
    #[must_use]
    pub fn nth(&self, index: u32) -> String {
        format!("{}:{}", FAMILIES[self.family], self.numbers.start() + u64::from(index))
    }

    /// How many worlds they are.
    #[must_use]
    pub fn count(&self) -> usize {
        (self.numbers.end() - self.numbers.start() + 1) as usize
    }

    /// Each world's name, and the text of its file.
    pub fn texts(&self) -> impl Iterator<Item = (String, String)> + use<> {
        let family = self.family;
        self.numbers.clone().map(move |number| (format!("{}:{number}", FAMILIES[family]), text(family, number)))
    }
}

/// The text of one world's file.
fn text(family: usize, number: u64) -> String {
    let mut random = Random::of_body(number, Stream::Families, (family as u32) << 16 | FORMATS[family]);
    let body = match family {
        0 => rooms::room(&mut random),
        1 => corridors::corridor(&mut random),
        _ => lines::line(&mut random),
    };
    let (name, format) = (FAMILIES[family], FORMATS[family]);
    format!("description = \"World {number} of the family '{name}', format {format}: made by rule.\"\n\n{body}")
}

/// Floor, light and the material `wall`; one of two lights.
fn surroundings(random: &mut Random) -> String {
    let (towards, ambient) = [("[0.68, 0.52, 0.52]", 0.34), ("[-0.35, 0.62, 0.7]", 0.45)][random.below(2) as usize];
    let (floor, wall) = (160 + random.below(30), 205 + random.below(30));
    format!(
        "[floor]\nmaterial = \"floor\"\n\n[light]\ntowards = {towards}\nambient = {ambient}\n\n\
         [[material]]\nname = \"floor\"\ncolour = [{floor}, {floor}, {floor}]\n\n\
         [[material]]\nname = \"wall\"\ncolour = [{wall}, {wall}, {wall}]\n\n"
    )
}

/// `[[x, y], ...]`, to the centimetre.
fn points(points: &[[f64; 2]]) -> String {
    let all: Vec<String> = points.iter().map(|[x, y]| format!("[{x:.2}, {y:.2}]")).collect();
    format!("[{}]", all.join(", "))
}

fn wall(closed: &[[f64; 2]]) -> String {
    let points = points(closed);
    format!("[[wall]]\npoints_m = {points}\nclosed = true\nheight_m = 1.0\nthickness_m = 0.1\nmaterial = \"wall\"\n\n")
}

fn lap(closed: &[[f64; 2]]) -> String {
    format!("[[route]]\nname = \"lap\"\npoints_m = {}\nclosed = true\n\n", points(closed))
}

/// A start on every `every`th side of a closed way, in its middle and along it.
fn starts(closed: &[[f64; 2]], every: usize) -> String {
    let mut text = String::new();
    for (from, to) in sides(closed).step_by(every) {
        let (x, y) = (0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]));
        let yaw_deg = libm::atan2(to[1] - from[1], to[0] - from[0]).to_degrees();
        let _ = write!(text, "[[start]]\nposition_m = [{x:.2}, {y:.2}]\nyaw_deg = {yaw_deg:.1}\n\n");
    }
    text
}

/// The sides of a closed way, the first from its first point to its second.
fn sides(closed: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    closed.iter().zip(closed.iter().cycle().skip(1)).map(|(from, to)| (*from, *to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::digest::Digest;
    use crate::settings::BodyShape;
    use crate::world::Layout;

    fn worlds(name: &str) -> Vec<Layout> {
        let texts = FamilyRange::of(name).unwrap().unwrap().texts();
        let body = BodyShape::pioneer2at();
        let parse = |(name, text)| Layout::parse(SourceText::new(name, text), &body);
        texts.map(|text| parse(text).unwrap_or_else(|error| panic!("{error:?}"))).collect()
    }

    #[test]
    fn every_world_made_by_rule_can_be_read_with_its_lap_and_its_starts() {
        for family in FAMILIES {
            let worlds = worlds(&format!("{family}:0-199"));
            assert_eq!(worlds.len(), 200);
            for world in &worlds {
                assert!(world.lap.is_some() && world.starts.len() >= 3, "{}", world.name);
                let length_m = world.routes[0].length_m();
                assert!((20.0..60.0).contains(&length_m), "{}: {length_m}", world.name);
            }
        }
        assert_eq!(worlds("corridors:7")[0].name, "corridors:7");
    }

    #[test]
    fn a_number_stands_for_one_world_for_ever() {
        let digest = |name: &str| {
            let texts: Vec<String> = FamilyRange::of(name).unwrap().unwrap().texts().map(|(_, text)| text).collect();
            Digest::of(texts.concat().as_bytes()).to_string()[..16].to_owned()
        };
        let found = FAMILIES.map(|family| digest(&format!("{family}:1-50")));
        // Whoever changes one of these raises the format of its family.
        assert_eq!(found, ["4b310da2a63eefba", "cafbae46ce1acbb0", "201d2f3f48100b06"]);
    }

    #[test]
    fn what_is_no_family_or_no_number_is_told_with_what_to_write() {
        let help = |name: &str| FamilyRange::of(name).unwrap().unwrap_err().1;
        assert_eq!(help("corridor:7"), "did you mean \"corridors:7\"?");
        for name in ["corridors:", "corridors:9-3", "rooms:1-5000", "lines:1000000", "rooms:-3", "rooms:1.5"] {
            assert!(help(name).starts_with("write "), "{name}");
        }
        assert!(FamilyRange::of("room").is_none() && FamilyRange::of("C:/worlds/room.toml").is_none());
        assert_eq!(FamilyRange::of("rooms:3-5").unwrap().unwrap().count(), 3);
    }
}
