//! The paper's state: the code of the grid, and nothing else.

use super::{Cells, Described, Digit, Grid, Percept, StateMap};
use crate::settings::GridSettings;

/// The grid's own number is the state.
#[derive(Debug, Clone)]
pub struct GridMap {
    grid: Grid,
    settings: GridSettings,
}

impl GridMap {
    /// The map of a grid that was made with these settings.
    #[must_use]
    pub fn new(settings: &GridSettings, grid: Grid) -> Self {
        Self { grid, settings: settings.clone() }
    }

    /// The settings of a stored map, see [`StateMap::to_table`].
    ///
    /// # Errors
    /// The key that is missing or of another type.
    pub fn settings_from(table: &toml::Table) -> Result<GridSettings, &'static str> {
        let whole = |key| table.get(key).and_then(toml::Value::as_integer).and_then(|value| u64::try_from(value).ok());
        Ok(GridSettings {
            rows: whole("rows").ok_or("rows")?,
            columns: whole("columns").ok_or("columns")?,
            occupied: table.get("occupied").and_then(toml::Value::as_float).ok_or("occupied")?,
            fill: table.get("fill").and_then(toml::Value::as_bool).ok_or("fill")?,
            remember_s: table.get("remember_s").and_then(toml::Value::as_float).unwrap_or(0.0),
        })
    }
}

impl StateMap for GridMap {
    fn encode(&mut self, percept: Percept<'_>) -> usize {
        percept.grid.state()
    }

    fn states(&self) -> usize {
        self.grid.states()
    }

    /// With column fill one digit for each column: its height. Without, one for each cell.
    fn digits(&self) -> Vec<Digit> {
        let (rows, columns) = self.grid.size();
        let heights = rows + 1 + usize::from(self.grid.remembers());
        let (values, count) = if self.settings.fill { (heights, columns) } else { (2, rows * columns) };
        (0..count).map(|digit| Digit { part: 0, column: digit % columns, values }).collect()
    }

    fn describe(&self, state: usize) -> Described {
        let (rows, columns) = self.grid.size();
        let filled = self.grid.cells(state);
        let base = rows + 2;
        let is_gone = |column: usize| self.grid.remembers() && state / base.pow(column as u32) % base == rows + 1;
        let height = |column: usize| match is_gone(column) {
            true => "gone".to_owned(),
            false => (0..rows).filter(|row| filled[row * columns + column]).count().to_string(),
        };
        let text = format!("columns {}", (0..columns).map(height).collect::<Vec<_>>().join(" "));
        Described { text, cells: Some(Cells { rows, columns, filled }) }
    }

    fn mirrored(&self, state: usize) -> Option<usize> {
        Some(self.grid.mirrored(state))
    }

    fn to_table(&self) -> toml::Table {
        let GridSettings { rows, columns, occupied, fill, remember_s } = self.settings;
        let mut table = toml::Table::new();
        table.insert("rows".to_owned(), toml::Value::Integer(rows as i64));
        table.insert("columns".to_owned(), toml::Value::Integer(columns as i64));
        table.insert("occupied".to_owned(), toml::Value::Float(occupied));
        table.insert("fill".to_owned(), toml::Value::Boolean(fill));
        if remember_s > 0.0 {
            table.insert("remember_s".to_owned(), toml::Value::Float(remember_s));
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(fill: bool) -> GridMap {
        let settings = GridSettings { rows: 3, columns: 2, occupied: 0.25, fill, remember_s: 0.0 };
        GridMap::new(&settings, Grid::new(&settings, 6, 6).unwrap())
    }

    #[test]
    fn the_digits_multiply_to_the_number_of_states() {
        for fill in [true, false] {
            let map = map(fill);
            assert_eq!(map.digits().iter().map(|digit| digit.values).product::<usize>(), map.states());
        }
    }

    #[test]
    fn a_state_is_described_by_the_heights_of_its_columns() {
        // 2 + 4 * 1: the left column down to the middle row, the right one at the top only.
        let described = map(true).describe(6);
        assert_eq!(described.text, "columns 2 1");
        assert_eq!(described.cells.unwrap().filled, [true, true, true, false, false, false]);
    }

    #[test]
    fn a_table_gives_the_settings_back() {
        for fill in [true, false] {
            let map = map(fill);
            assert_eq!(GridMap::settings_from(&map.to_table()), Ok(map.settings));
        }
        assert_eq!(GridMap::settings_from(&toml::Table::new()), Err("rows"));
    }
}
