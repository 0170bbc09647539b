//! A world file, read and checked: the scene, the starts, the routes and the movers.

mod build;
mod marks;
mod movers;
mod reader;
pub(crate) mod schema;
mod starts;
#[cfg(test)]
mod tests;
mod textures;

use super::marks::{Circle, Gate, Start};
use super::mover::Mover;
use super::route::Route;
use super::scene::Scene;
use super::terrain::Terrain;
use crate::diagnostic::{Diagnostic, Result, SourceText};
use crate::geometry::Pose;
use crate::outcome::Destination;
use crate::settings::BodyShape;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

pub(super) use build::PLAIN;

/// Longest world file, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// All that a world file says.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The file's name without its ending.
    pub name: String,
    /// The file as the user wrote it.
    pub source: SourceText,
    /// What stands still.
    pub scene: Arc<Scene>,
    /// Where a robot can start; never empty.
    pub starts: Vec<Start>,
    /// Every place to visit, in the order of the file.
    pub places: Vec<Circle>,
    /// Every gate, in the order in which they are to be passed.
    pub gates: Vec<Gate>,
    /// Every route of the file, in its order.
    pub routes: Vec<Route>,
    /// Index of the route on which laps are measured: the one named `lap`.
    pub lap: Option<usize>,
    /// Every mover of the file, in its order.
    pub movers: Vec<Mover>,
    terrain: Arc<Terrain>,
}

/// Why a body cannot stand somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Obstruction {
    /// It overlaps the solid with this index.
    Solid(usize),
    /// A part of its footprint has no ground below.
    NoGround,
}

impl Layout {
    /// How far above the floor a body can stand while it stands level, metres: 0 without platforms, infinite where
    /// ramps or kerbs can tip it.
    #[must_use]
    pub(crate) fn level_height_m(&self, body: &BodyShape) -> f64 {
        self.terrain.level_height_m(body)
    }

    /// For each solid, whether a body drives on it: a platform, a ramp, and what is within a step of them or of the floor.
    #[must_use]
    pub fn driven_on(&self, body: &BodyShape) -> Vec<bool> {
        self.terrain.driven_on(&self.scene, body.step_m)
    }

    /// The name of a place where an attempt can begin.
    #[must_use]
    pub fn name_of(&self, destination: Destination) -> &str {
        match destination {
            Destination::Word(word) => word.word(),
            Destination::Start(start) => self.starts.get(start).map_or("", |start| &start.name),
        }
    }

    /// Reads a world from its text. `body` is the one that must be able to stand at every start.
    ///
    /// # Errors
    /// `E-WORLD-SYNTAX`, `-KEY`, `-VALUE`, `-NAME`, `-START`: each at the place in the file.
    pub fn parse(source: SourceText, body: &BodyShape) -> Result<Self> {
        let built = build::build(source)?;
        starts::check_starts(&built, body)?;
        Ok(built.layout)
    }

    /// Reads a world file. `body` is the one that must be able to stand at every start.
    ///
    /// # Errors
    /// `E-WORLD-FILE` if it cannot be read, is longer than 1 MiB or is not UTF-8; else those of [`Layout::parse`].
    pub fn load(path: &Path, body: &BodyShape) -> Result<Self> {
        let shown = path.display();
        let wrong = |reason: &str, help: &str| {
            Box::new(Diagnostic::new("E-WORLD-FILE", format!("cannot read the world '{shown}': {reason}")).help(help))
        };
        let unreadable = |error: &std::io::Error| {
            let (reason, help) = match error.kind() {
                std::io::ErrorKind::NotFound => {
                    ("there is no such file", "give the path of a world file such as worlds/room.toml")
                }
                std::io::ErrorKind::PermissionDenied => ("permission denied", "make the file readable"),
                _ => ("the system could not read it", "check the file and its disk"),
            };
            wrong(reason, help)
        };
        let kind = std::fs::metadata(path).map_err(|error| unreadable(&error))?;
        if kind.is_dir() {
            return Err(wrong("it is a folder", "name a file in it that ends in .toml"));
        }
        // Opening a pipe would wait for its writer, perhaps for ever.
        if !kind.is_file() {
            return Err(wrong("it is not an ordinary file", "save the world as a file first"));
        }
        let file = std::fs::File::open(path).map_err(|error| unreadable(&error))?;
        let mut bytes = Vec::new();
        file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(wrong("it is longer than 1 MiB", "a world of that size must be split or simplified"));
        }
        let text = String::from_utf8(bytes).map_err(|_| wrong("it is not text in UTF-8", "save it as UTF-8"))?;
        Self::parse(SourceText::new(path, text), body)
    }

    pub(super) fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// Why a body cannot be placed at `pose`, whatever moves left aside.
    pub(super) fn obstruction(&self, body: &BodyShape, pose: Pose) -> Option<Obstruction> {
        let support = self.terrain.put(&self.scene, body, pose);
        if let Some(solid) = self.terrain.overlapped(&self.scene, body, &support.stance) {
            return Some(Obstruction::Solid(solid));
        }
        let supported = self.terrain.is_flat(body)
            || (support.hanging == 0
                && !support.centre_hangs
                && self.terrain.carries_edge(&self.scene, body, &support.stance));
        (!supported).then_some(Obstruction::NoGround)
    }
}
