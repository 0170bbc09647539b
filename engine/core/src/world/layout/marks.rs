//! The starts, places and gates of a world file.

use super::build::{Builder, error, is_lost, yaw};
use super::reader::FileRow;
use crate::diagnostic::{Result, printable};
use crate::geometry::{Point2, Pose};
use crate::settings::RecoverTo;
use crate::world::marks::{Circle, Gate, Start};

/// Least distance between the posts of a gate, metres.
const NARROW_M: f64 = 0.1;

impl Builder<'_> {
    /// Every start, in the order of the file, those with a mistake too.
    pub(super) fn starts(&mut self, file: &FileRow, gates: &[Gate]) -> Vec<Start> {
        let mut starts: Vec<Start> = Vec::new();
        for (index, row) in file.rows("start").iter().enumerate() {
            let [x_m, y_m] = *row.numbers("position_m") else { continue };
            let name = self.name("start", row, index, starts.iter().map(|start| start.name.as_str()));
            let wanted = row.text("gate").unwrap_or_default();
            let gate = gates.iter().position(|gate| gate.name == wanted);
            if gate.is_none() && row.has("gate") && !is_lost(file, "gate", wanted) {
                let names = gates.iter().map(|gate| gate.name.as_str());
                self.mistakes.add(self.no_such("gate", wanted, row, names));
            }
            starts.push(Start { name, pose: Pose::new(x_m, y_m, yaw(row)), gate: gate.unwrap_or(0) });
        }
        starts
    }

    pub(super) fn places(&mut self, file: &FileRow) -> Vec<Circle> {
        let mut places: Vec<Circle> = Vec::new();
        for (index, row) in file.sound_rows("place").enumerate() {
            let name = self.name("place", row, index, places.iter().map(|place| place.name.as_str()));
            let centre = point(row.numbers("position_m"));
            places.push(Circle { name, centre, radius_m: row.number("radius_m").unwrap_or(0.5) });
        }
        places
    }

    pub(super) fn gates(&mut self, file: &FileRow) -> Vec<Gate> {
        let mut gates: Vec<Gate> = Vec::new();
        for (index, row) in file.sound_rows("gate").enumerate() {
            let name = self.name("gate", row, index, gates.iter().map(|gate| gate.name.as_str()));
            let gate = Gate { name, right: point(row.numbers("right_m")), left: point(row.numbers("left_m")) };
            let wide = self.is_wide(row, &gate);
            self.mistakes.take(wide);
            gates.push(gate);
        }
        gates
    }

    fn is_wide(&self, row: &FileRow, gate: &Gate) -> Result<()> {
        if (gate.left - gate.right).norm() >= NARROW_M {
            return Ok(());
        }
        error("E-WORLD-VALUE", format!("the posts of a gate must be {NARROW_M} m apart at least"))
            .at(self.source, row.span_of("left_m"), "too near to 'right_m'")
            .help("'right_m' and 'left_m' are the two posts; the robot drives between them")
            .fail()
    }

    /// The name of a table, or its number; a mistake if another has it, or recovery means something else by it.
    fn name<'n>(
        &mut self,
        what: &str,
        row: &FileRow,
        index: usize,
        mut before: impl Iterator<Item = &'n str>,
    ) -> String {
        let name = row.text("name").map_or_else(|| format!("{what} {}", index + 1), str::to_owned);
        if before.any(|other| other == name) {
            self.mistakes.add(self.twice_named(what, row, &name));
        } else if what == "start" && RecoverTo::of(&name).is_some() {
            let wrong = error("E-WORLD-NAME", format!("a start cannot be called '{}'", printable(&name)))
                .at(self.source, row.span_of("name"), "a word of recovery")
                .help(format!("recovery(\"{name}\") means something else: choose another name"));
            self.mistakes.add(wrong);
        }
        name
    }
}

fn point(numbers: &[f64]) -> Point2 {
    Point2::new(numbers[0], numbers[1])
}
