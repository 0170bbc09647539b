//! How a robot looks at the camera's image, and what its states are made of.

use super::{SettingError, Settings, Value, apply};

/// What the facts of the view without a name are called.
pub const UNNAMED_VIEW: &str = "camera";

/// One way of looking at the camera's image: a chain of filters, and a grid over what they leave.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewSettings {
    /// What the script calls it; `camera` if it has no name.
    pub name: String,
    /// The filter chain, first stage first; empty means the default chain.
    pub filters: Vec<FilterSettings>,
    /// How a filtered image becomes a number.
    pub grid: GridSettings,
}

/// The parameter of a filter that holds a condition, not a number.
pub const CONDITION: &str = "is";

/// One stage of the filter chain.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterSettings {
    /// The filter's name.
    pub name: String,
    /// The parameters that the user set; the others have their defaults.
    pub parameters: Vec<(String, f64)>,
    /// The condition of a filter that marks by one, as written.
    pub condition: Option<String>,
}

impl FilterSettings {
    /// A filter as it is: with no parameter set.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), parameters: Vec::new(), condition: None }
    }

    /// What is set of it, each with its value: `threshold 60`, `is "r > 60"`.
    #[must_use]
    pub fn shown(&self) -> Vec<String> {
        let condition = self.condition.iter().map(|condition| format!("is \"{condition}\""));
        condition.chain(self.parameters.iter().map(|(name, value)| format!("{name} {value}"))).collect()
    }
}

/// How a filtered image becomes a state.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct GridSettings {
    pub rows: u64,
    pub columns: u64,
    pub occupied: f64,
    pub fill: bool,
    pub remember_s: f64,
}

/// A part of a state.
#[derive(Debug, Clone, PartialEq)]
pub enum PartSettings {
    /// The grid of the view of this name.
    View(String),
    /// A value of the script, told apart by ranges.
    Bins {
        /// As it stands in the script: `laser.front`.
        of: String,
        /// Where a range ends and the next begins, rising; nothing for what is true or false.
        edges: Vec<f64>,
    },
}

impl ViewSettings {
    /// A view with the default chain and the default grid.
    #[must_use]
    pub fn named(name: &str) -> Self {
        let grid = GridSettings { rows: 3, columns: 3, occupied: 0.015, fill: true, remember_s: 0.0 };
        Self { name: name.to_owned(), filters: Vec::new(), grid }
    }

    /// The place of one of its settings among those of a script: `filter:0` or `grid.rows` of the view without a name,
    /// `red.filter:0` of another.
    #[must_use]
    pub fn place(&self, setting: &str) -> String {
        if self.name == UNNAMED_VIEW { setting.to_owned() } else { format!("{}.{setting}", self.name) }
    }

    /// Sets a key of its grid.
    ///
    /// # Errors
    /// As [`apply`].
    pub fn set_grid(&mut self, key: &str, value: &Value) -> Result<(), SettingError> {
        let mut settings = Settings { view: self.clone(), ..Settings::default() };
        apply(&mut settings, "grid", key, value)?;
        *self = settings.view;
        Ok(())
    }
}

impl PartSettings {
    /// Whether it tells nothing of what the robot senses: the time, or what it does itself.
    #[must_use]
    pub fn is_blind(&self) -> bool {
        let Self::Bins { of, .. } = self else { return false };
        let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
        let names = || of.split(|c| !is_word(c)).filter(|word| word.starts_with(char::is_alphabetic));
        names().next().is_some() && names().all(|name| name.starts_with("time.") || name.starts_with("action."))
    }

    /// How many values it tells apart, if it is no view.
    #[must_use]
    pub fn labels(&self) -> Vec<String> {
        match self {
            Self::View(_) => Vec::new(),
            Self::Bins { edges, .. } => labels(edges),
        }
    }
}

/// The ranges between edges in words: `below 0.6`, `0.6 to 1.2`, `from 1.2`; `no` and `yes` without edges.
fn labels(edges: &[f64]) -> Vec<String> {
    let (Some(first), Some(last)) = (edges.first(), edges.last()) else {
        return vec!["no".to_owned(), "yes".to_owned()];
    };
    let between = edges.windows(2).map(|pair| format!("{} to {}", pair[0], pair[1]));
    [format!("below {first}")].into_iter().chain(between).chain([format!("from {last}")]).collect()
}

impl Settings {
    /// All views, the first one first.
    pub fn views(&self) -> impl Iterator<Item = &ViewSettings> {
        std::iter::once(&self.view).chain(&self.further_views)
    }

    /// Whether a state is more than the number of one grid.
    #[must_use]
    pub fn has_parts(&self) -> bool {
        !(self.state.is_empty() && self.stages.is_empty() && self.further_views.is_empty())
    }

    /// Whether a state shows what a view sees.
    #[must_use]
    pub fn sees(&self) -> bool {
        self.state.is_empty() || self.state.iter().any(|part| matches!(part, PartSettings::View(_)))
    }

    /// All views, to be changed.
    pub fn views_mut(&mut self) -> impl Iterator<Item = &mut ViewSettings> {
        std::iter::once(&mut self.view).chain(&mut self.further_views)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ranges_of_bins_are_said_in_words() {
        assert_eq!(labels(&[0.6, 1.2]), ["below 0.6", "0.6 to 1.2", "from 1.2"]);
        assert_eq!(labels(&[0.05]), ["below 0.05", "from 0.05"]);
        assert_eq!(labels(&[]), ["no", "yes"]);
    }

    #[test]
    fn the_grid_of_a_named_view_obeys_the_table_of_settings() {
        let mut view = ViewSettings::named("red");
        view.set_grid("columns", &Value::Number(5.0)).unwrap();
        assert_eq!((view.grid.columns, view.grid.rows, view.name.as_str()), (5, 3, "red"));
        assert!(view.set_grid("rows", &Value::Number(99.0)).is_err());
        assert_eq!(view.place("grid.rows"), "red.grid.rows");
    }

    #[test]
    fn a_part_is_blind_that_reads_nothing_but_the_time_and_its_own_doing() {
        let is_blind = |of: &str| PartSettings::Bins { of: of.to_owned(), edges: vec![1.0] }.is_blind();
        assert!(is_blind("time.attempt_s") && is_blind("action.angular + time.step"));
        assert!(!is_blind("laser.front") && !is_blind("min(laser.left, time.step)"));
        assert!(!PartSettings::View("red".to_owned()).is_blind());
    }
}
