//! A state of several parts: grids, and numbers that are told apart elsewhere, such as the stage.

use super::{Described, Digit, GridMap, Percept, StateMap};

/// One part of a composed state.
#[derive(Debug, Clone)]
pub enum StatePart {
    /// The number of a grid, by its place in [`Percept::grids`].
    View {
        /// What the script calls the view.
        name: String,
        /// Its place among the grids.
        view: usize,
        /// Its map.
        map: Box<GridMap>,
    },
    /// A small number, by its place in [`Percept::digits`].
    Digit {
        /// What it is of, such as `stage` or `laser.front`.
        name: String,
        /// Its place among the digits.
        digit: usize,
        /// What each of its values stands for.
        labels: Vec<String>,
        /// How it comes about.
        kind: DigitKind,
    },
}

/// How a small number of a state comes about.
#[derive(Debug, Clone, PartialEq)]
pub enum DigitKind {
    /// It is how many of these edges a value has reached; of what is true or false there are none.
    Bins(Vec<f64>),
    /// It is the number of a stage.
    Stages(Vec<String>),
}

impl StatePart {
    fn values(&self) -> usize {
        match self {
            Self::View { map, .. } => map.states(),
            Self::Digit { labels, .. } => labels.len(),
        }
    }

    fn read(&self, percept: &Percept<'_>) -> usize {
        let read = match self {
            Self::View { view, .. } => percept.grids.get(*view).map_or(0, super::Grid::state),
            Self::Digit { digit, .. } => percept.digits.get(*digit).copied().unwrap_or(0),
        };
        read.min(self.values().saturating_sub(1))
    }

    fn describe(&self, value: usize, alone: bool) -> String {
        match self {
            Self::View { map, .. } if alone => map.describe(value).text,
            Self::View { name, map, .. } => format!("{name} {}", map.describe(value).text),
            Self::Digit { name, labels, .. } => {
                format!("{name} {}", labels.get(value).map_or("?", String::as_str))
            }
        }
    }
}

/// The parts of a state as one number: the first part is the lowest digit.
#[derive(Debug, Clone)]
pub struct ComposedMap {
    parts: Vec<StatePart>,
}

impl ComposedMap {
    /// Of these parts, in this order.
    #[must_use]
    pub fn new(parts: Vec<StatePart>) -> Self {
        Self { parts }
    }

    /// How many states there are, if they can be counted.
    #[must_use]
    pub fn count(&self) -> Option<usize> {
        self.parts.iter().try_fold(1_usize, |product, part| product.checked_mul(part.values()))
    }

    /// `red (27) x laser.front (3) x stage (2)`: its parts, with how many values each has.
    #[must_use]
    pub fn factors(&self) -> String {
        let part = |part: &StatePart| match part {
            StatePart::View { name, .. } | StatePart::Digit { name, .. } => format!("{name} ({})", part.values()),
        };
        self.parts.iter().map(part).collect::<Vec<_>>().join(" x ")
    }

    /// The value of each part in a state.
    fn values(&self, mut state: usize) -> impl Iterator<Item = (&StatePart, usize)> {
        self.parts.iter().map(move |part| {
            let value = state % part.values().max(1);
            state /= part.values().max(1);
            (part, value)
        })
    }
}

impl StateMap for ComposedMap {
    fn encode(&mut self, percept: Percept<'_>) -> usize {
        self.parts.iter().rev().fold(0, |state, part| state * part.values() + part.read(&percept))
    }

    fn states(&self) -> usize {
        self.count().unwrap_or(usize::MAX)
    }

    fn digits(&self) -> Vec<Digit> {
        let digits = self.parts.iter().enumerate().flat_map(|(part, own)| match own {
            StatePart::View { map, .. } => map.digits().into_iter().map(|digit| Digit { part, ..digit }).collect(),
            StatePart::Digit { labels, .. } => vec![Digit { part, column: 0, values: labels.len() }],
        });
        digits.collect()
    }

    /// Each part in words; the cells are those of the first view.
    fn describe(&self, state: usize) -> Described {
        let views = self.parts.iter().filter(|part| matches!(part, StatePart::View { .. })).count();
        let words: Vec<String> = self.values(state).map(|(part, value)| part.describe(value, views == 1)).collect();
        let cells = self.values(state).find_map(|(part, value)| match part {
            StatePart::View { map, .. } => map.describe(value).cells,
            StatePart::Digit { .. } => None,
        });
        Described { text: words.join(" | "), cells }
    }

    /// Only a state of views alone has a mirror image: what else it holds may have sides that nobody knows.
    fn mirrored(&self, state: usize) -> Option<usize> {
        let mirrored = self.values(state).map(|(part, value)| match part {
            StatePart::View { map, .. } => map.mirrored(value),
            StatePart::Digit { .. } => None,
        });
        let values = mirrored.collect::<Option<Vec<usize>>>()?;
        let parts = self.parts.iter().zip(values).rev();
        Some(parts.fold(0, |state, (part, value)| state * part.values() + value))
    }

    fn to_table(&self) -> toml::Table {
        let text = |text: &str| toml::Value::String(text.to_owned());
        let part = |part: &StatePart| {
            let mut table = match part {
                StatePart::View { name, .. } => toml::Table::from_iter([("view".to_owned(), text(name))]),
                StatePart::Digit { kind: DigitKind::Stages(stages), .. } => {
                    let stages: Vec<toml::Value> = stages.iter().map(|stage| text(stage)).collect();
                    toml::Table::from_iter([("stages".to_owned(), stages.into())])
                }
                StatePart::Digit { name, kind: DigitKind::Bins(edges), .. } => toml::Table::from_iter([
                    ("bins".to_owned(), text(name)),
                    ("edges".to_owned(), edges.clone().into()),
                ]),
            };
            table.insert("values".to_owned(), toml::Value::Integer(part.values() as i64));
            toml::Value::Table(table)
        };
        let mut table = toml::Table::new();
        table.insert("part".to_owned(), toml::Value::Array(self.parts.iter().map(part).collect()));
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::observation::Image;
    use crate::settings::GridSettings;
    use crate::state::Grid;

    fn grid() -> (GridSettings, Grid) {
        let settings = GridSettings { rows: 2, columns: 2, occupied: 0.5, fill: true, remember_s: 0.0 };
        let grid = Grid::new(&settings, 4, 4).unwrap();
        (settings, grid)
    }

    fn map() -> ComposedMap {
        let (settings, grid) = grid();
        let labels = |labels: &[&str]| labels.iter().map(|label| (*label).to_owned()).collect::<Vec<String>>();
        let stages = labels(&["search", "dock", "leave"]);
        ComposedMap::new(vec![
            StatePart::View { name: "red".to_owned(), view: 0, map: Box::new(GridMap::new(&settings, grid)) },
            StatePart::Digit {
                name: "laser.front".to_owned(),
                digit: 0,
                labels: labels(&["below 0.6", "0.6 on"]),
                kind: DigitKind::Bins(vec![0.6]),
            },
            StatePart::Digit {
                name: "stage".to_owned(),
                digit: 1,
                labels: stages.clone(),
                kind: DigitKind::Stages(stages),
            },
        ])
    }

    #[test]
    fn the_first_part_is_the_lowest_digit_and_the_stage_the_highest() {
        let (mut map, (_, mut grid)) = (map(), grid());
        // Two columns of heights 0 to 2 are nine states; the mask fills the left column to the bottom: state 2.
        let mask: Vec<u8> = (0..16).map(|pixel| if pixel % 4 < 2 { 255 } else { 0 }).collect();
        grid.encode(&mask);
        let image = Image::new(4, 4);
        let percept =
            Percept { image: &image, mask: &mask, grid: &grid, grids: std::slice::from_ref(&grid), digits: &[1, 2] };
        assert_eq!(map.states(), 9 * 2 * 3);
        assert_eq!(map.encode(percept), 2 + 9 * (1 + 2 * 2));
        assert_eq!(map.describe(47).text, "columns 2 0 | laser.front 0.6 on | stage leave");
        assert_eq!(
            map.digits().iter().map(|digit| (digit.part, digit.values)).collect::<Vec<_>>(),
            [(0, 3), (0, 3), (1, 2), (2, 3)]
        );
        assert_eq!(map.mirrored(47), None);
    }

    #[test]
    fn a_table_says_how_each_digit_comes_about() {
        let text = toml::to_string(&map().to_table()).unwrap();
        let of = |key: &str| text.lines().find(|line| line.starts_with(key)).map(str::to_owned);
        assert_eq!(of("view").as_deref(), Some("view = \"red\""));
        assert_eq!(of("edges").as_deref(), Some("edges = [0.6]"));
        assert_eq!(of("stages").as_deref(), Some("stages = [\"search\", \"dock\", \"leave\"]"));
    }
}
