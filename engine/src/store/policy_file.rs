//! `policy.toml`: a learned table with the filter, grid and actions that it belongs to.

use serde::{Deserialize, Serialize};

use super::toml_error;
use crate::diagnostic::{Diagnostic, Kind, Result, SourceText};
use crate::learner::{Policy, PolicyRow};
use crate::settings::Settings;

const FORMAT: u32 = 1;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PolicyFile {
    format: u32,
    behaviour: String,
    filters: Vec<String>,
    rows: u64,
    columns: u64,
    occupied: f64,
    fill: bool,
    states: usize,
    /// Forward speed in m/s and turning speed in rad/s.
    actions: Vec<[f64; 2]>,
    state: Vec<StateEntry>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StateEntry {
    index: usize,
    visits: u64,
    best: usize,
    values: Vec<f64>,
}

/// The text of `policy.toml`; states that were never visited are left out.
///
/// # Errors
/// Never in practice: only if the table cannot be written as TOML.
pub fn policy_to_toml(behaviour: &str, settings: &Settings, policy: &Policy) -> Result<String> {
    let state = policy.rows().iter().enumerate().filter_map(|(index, row)| {
        let row = row.as_ref()?;
        let best = policy.best(index)?.0;
        Some(StateEntry { index, visits: row.visits, best, values: row.values.clone() })
    });
    let file = PolicyFile {
        format: FORMAT,
        behaviour: behaviour.to_owned(),
        filters: filters(settings),
        rows: settings.grid.rows,
        columns: settings.grid.columns,
        occupied: settings.grid.occupied,
        fill: settings.grid.fill,
        states: policy.rows().len(),
        actions: actions(settings),
        state: state.collect(),
    };
    toml::to_string(&file).map_err(|error| {
        Box::new(Diagnostic::new(Kind::State, "E-POLICY", format!("the policy cannot be written: {error}")))
    })
}

/// Reads `policy.toml` for a plan with these settings and so many states.
///
/// # Errors
/// If the file is damaged, or was learned with another grid or other actions.
pub fn policy_from_toml(source: &SourceText, settings: &Settings, states: usize) -> Result<Policy> {
    let file: PolicyFile = toml::from_str(&source.text).map_err(|error| toml_error(source, &error))?;
    let unfit = |message: String| -> Box<Diagnostic> {
        Box::new(Diagnostic::new(Kind::State, "E-POLICY", format!("'{}' {message}", source.path.display())))
    };
    if file.format != FORMAT {
        return Err(unfit(format!("has format {}, this engine reads format {FORMAT}", file.format)));
    }
    let grid = &settings.grid;
    if (file.rows, file.columns, file.fill, file.states) != (grid.rows, grid.columns, grid.fill, states) {
        return Err(unfit(format!(
            "was learned on a grid of {}x{}, this run has {}x{}",
            file.rows, file.columns, grid.rows, grid.columns
        )));
    }
    if file.actions != actions(settings) {
        return Err(unfit("was learned with other actions than this run has".to_owned()));
    }
    let mut rows = vec![None; states];
    for StateEntry { index, visits, values, .. } in file.state {
        let fits = index < states && values.len() == file.actions.len() && values.iter().all(|value| value.is_finite());
        if !fits || rows[index].is_some() {
            return Err(unfit(format!("has a damaged entry for state {index}")));
        }
        rows[index] = Some(PolicyRow { visits, values });
    }
    Ok(Policy::new(file.actions.len(), rows))
}

fn actions(settings: &Settings) -> Vec<[f64; 2]> {
    settings.actions.iter().map(|twist| [twist.linear_m_per_s, twist.angular_rad_per_s]).collect()
}

fn filters(settings: &Settings) -> Vec<String> {
    let text = |filter: &crate::settings::FilterSettings| {
        let parameters: Vec<_> = filter.parameters.iter().map(|(name, value)| format!("{name}: {value}")).collect();
        format!("{}({})", filter.name, parameters.join(", "))
    };
    settings.filters.iter().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn policy() -> Policy {
        let values: Vec<f64> = (0..14).map(|action| -0.1 - f64::from(action) / 3.0).collect();
        let mut rows = vec![None; 64];
        rows[5] = Some(PolicyRow { visits: 17, values });
        Policy::new(14, rows)
    }

    #[test]
    fn a_policy_is_read_back_bit_for_bit() {
        let settings = Settings::default();
        let text = policy_to_toml("wall", &settings, &policy()).unwrap();
        let read = policy_from_toml(&SourceText::new("policy.toml", text), &settings, 64).unwrap();
        assert_eq!(read, policy());
    }

    #[test]
    fn another_grid_or_other_actions_are_refused() {
        let mut settings = Settings::default();
        let source = SourceText::new("policy.toml", policy_to_toml("wall", &settings, &policy()).unwrap());
        settings.grid.rows = 4;
        assert!(policy_from_toml(&source, &settings, 125).unwrap_err().message.contains("grid of 3x3"));
        settings.grid.rows = 3;
        settings.actions.pop();
        assert!(policy_from_toml(&source, &settings, 64).unwrap_err().message.contains("other actions"));
    }

    #[test]
    fn damage_is_an_error_and_not_a_guess() {
        let settings = Settings::default();
        let text = policy_to_toml("wall", &settings, &policy()).unwrap();
        for damaged in [text.replace("index = 5", "index = 64"), text.replace("-0.1,", "nan,"), text[..200].to_owned()]
        {
            assert!(policy_from_toml(&SourceText::new("policy.toml", damaged), &settings, 64).is_err());
        }
    }
}
