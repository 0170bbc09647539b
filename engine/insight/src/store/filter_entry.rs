//! A filter stage as run and policy files hold it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::filter::Catalogue;
use engine::settings::{FilterSettings, GridSettings, ViewSettings};

/// A filter stage with the parameters that were set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilterEntry {
    name: String,
    /// The digest of the file that the filter came from; none for those linked in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    /// The condition of a filter that marks by one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    is: Option<String>,
    parameters: BTreeMap<String, f64>,
}

impl FilterEntry {
    pub(super) fn new(filter: &FilterSettings, filters: &Catalogue) -> Self {
        let sha256 = filters.find(&filter.name).ok().and_then(|entry| entry.sha256.clone());
        let parameters = filter.parameters.iter().cloned().collect();
        Self { name: filter.name.clone(), sha256, is: filter.condition.clone(), parameters }
    }

    /// Refuses another file of the same name than was used then.
    pub(super) fn check(&self, filters: &Catalogue) -> Result<()> {
        let found = filters.find(&self.name).map_err(|mut error| {
            if self.sha256.is_some() && error.code == "E-FILTER-SETTING" {
                error.help = Some("the run used it from a folder; give that folder: --filter-dir DIR".to_owned());
            }
            error
        })?;
        if found.sha256 == self.sha256 {
            return Ok(());
        }
        let digest = |sha256: &Option<String>| {
            sha256.as_ref().map_or("linked in".to_owned(), |sha256| format!("sha256:{sha256}"))
        };
        let message = format!(
            "filter '{}' is not the one that was used: then {}, now {}",
            printable(&self.name),
            digest(&self.sha256),
            digest(&found.sha256)
        );
        Diagnostic::new("E-RUN-FILTER", message).help("give the folder of that filter: --filter-dir DIR").fail()
    }

    pub(super) fn settings(&self) -> FilterSettings {
        let parameters = self.parameters.iter().map(|(key, value)| (key.clone(), *value)).collect();
        FilterSettings { name: self.name.clone(), parameters, condition: self.is.clone() }
    }
}

/// A view as run and policy files hold it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ViewEntry {
    pub name: String,
    grid: GridEntry,
    pub filter: Vec<FilterEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct GridEntry {
    rows: u64,
    columns: u64,
    occupied: f64,
    fill: bool,
    #[serde(default, skip_serializing_if = "is_off")]
    remember_s: f64,
}

fn is_off(remember_s: &f64) -> bool {
    *remember_s == 0.0
}

impl ViewEntry {
    pub(super) fn new(view: &ViewSettings, filters: &Catalogue) -> Self {
        let GridSettings { rows, columns, occupied, fill, remember_s } = view.grid;
        let filter = view.filters.iter().map(|filter| FilterEntry::new(filter, filters)).collect();
        Self { name: view.name.clone(), grid: GridEntry { rows, columns, occupied, fill, remember_s }, filter }
    }

    pub(super) fn settings(&self) -> ViewSettings {
        let GridEntry { rows, columns, occupied, fill, remember_s } = self.grid;
        let filters = self.filter.iter().map(FilterEntry::settings).collect();
        ViewSettings {
            name: self.name.clone(),
            filters,
            grid: GridSettings { rows, columns, occupied, fill, remember_s },
        }
    }
}
