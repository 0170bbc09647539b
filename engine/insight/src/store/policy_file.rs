//! `policy.toml`: a learned table with the filter, grid and actions that it belongs to.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::filter_entry::{FilterEntry, ViewEntry};
use super::parts::belongs;
use super::toml_error;
use crate::markup::{base64, from_base64};
use engine::diagnostic::{Diagnostic, Result, SourceText};
use engine::digest::Digest;
use engine::experiment::Plan;
use engine::filter::Catalogue;
use engine::geometry::Twist;
use engine::learner::{Policy, PolicyRow, PooledSums, Pools};
use engine::settings::{FilterSettings, GridSettings, Settings, ViewSettings};
use engine::state::{GridMap, MAX_POOLED_STATES, MAX_STATES, StateMap};

/// The name of the file in a run's folder.
pub const POLICY_FILE: &str = "policy.toml";
const FORMAT: u32 = 2;
/// The format of a policy whose states have several parts.
const FORMAT_OF_PARTS: u32 = 3;
/// The format of a policy of the learner `memory`.
const FORMAT_OF_MEMORY: u32 = 4;
/// The format of a policy whose filters keep something.
const FORMAT_OF_KEPT: u32 = 5;

#[derive(Deserialize)]
struct PolicyFormat {
    format: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PolicyFile {
    format: u32,
    behaviour: String,
    /// SHA-256 of the `run.toml` that it was learned under; absent where there is none, as in a pack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    run_sha256: Option<String>,
    /// The grid, if it alone is the state; of several parts each view has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rows: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    columns: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    occupied: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fill: Option<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    remember_s: Option<f64>,
    /// What it was learned in: several worlds by their names, and what was drawn for each attempt.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    worlds: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    randomise: Vec<String>,
    states: usize,
    /// At which it chooses, if not at the settings' lowest one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    /// Forward speed in m/s and turning speed in rad/s.
    actions: Vec<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    filter: Vec<FilterEntry>,
    /// What the parts of the state look through, if it has several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    view: Vec<ViewEntry>,
    /// The parts of the state, the lowest digit first; none if the grid alone is the state.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    part: Vec<toml::Table>,
    #[serde(default)]
    state: Vec<StateEntry>,
    /// What answers for states that are not listed, if anything does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pools: Option<PooledSums>,
    /// What the filters kept when learning ended, as letters of RFC 4648.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kept: Option<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StateEntry {
    index: usize,
    visits: u64,
    best: usize,
    values: Vec<f64>,
}

/// A policy as it was stored, with what it perceives and does.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredPolicy {
    /// The behaviour that it learned.
    pub behaviour: String,
    /// Its filter chain.
    pub filters: Vec<FilterSettings>,
    /// Its grid.
    pub grid: GridSettings,
    /// Its actions.
    pub actions: Vec<Twist>,
    /// The parts of its states; none if the grid alone is the state.
    pub parts: Vec<toml::Table>,
    /// The views that the parts are of; none if the grid alone is the state.
    pub views: Vec<ViewSettings>,
    /// What it learned.
    pub policy: Policy,
    /// SHA-256 of the `run.toml` of the run that learned it, if it names one.
    pub run_sha256: Option<String>,
    /// Its filter chain as it was written, digests included.
    pub(super) entries: Vec<FilterEntry>,
}

/// The text of `policy.toml`; states that were never visited are left out. `run` is the text of the `run.toml` beside it.
///
/// # Errors
/// If the plan's states do not come from a grid, which is what this format has room for.
pub fn policy_to_toml(plan: &Plan, policy: &Policy, run: Option<&str>) -> Result<String> {
    let worlds = worlds_of(plan);
    text_of(plan.behaviour.name(), (&plan.settings, worlds), &plan.filters, (&*plan.state_map()?, policy), run)
}

fn text_of(
    behaviour: &str,
    (settings, worlds): (&Settings, Vec<String>),
    filters: &Catalogue,
    (map, policy): (&dyn StateMap, &Policy),
    run: Option<&str>,
) -> Result<String> {
    let unwritten =
        |why: String| Box::new(Diagnostic::new("E-POLICY-FILE", format!("the policy cannot be written: {why}")));
    let part = parts_of(map);
    let (grid, filter, view) = if part.is_empty() {
        let grid = GridMap::settings_from(&map.to_table())
            .map_err(|key| unwritten(format!("its states do not come from a grid, which has '{key}'")))?;
        (Some(grid), settings.view.filters.iter().map(|filter| FilterEntry::new(filter, filters)).collect(), Vec::new())
    } else {
        (None, Vec::new(), settings.views().map(|view| ViewEntry::new(view, filters)).collect())
    };
    let state = policy.rows().filter_map(|(index, row)| {
        let best = policy.best(index)?.0;
        Some(StateEntry { index, visits: row.visits, best, values: row.values.clone() })
    });
    let file = PolicyFile {
        format: match part.is_empty() {
            _ if !policy.kept().is_empty() => FORMAT_OF_KEPT,
            _ if policy.temperature().is_some() => FORMAT_OF_MEMORY,
            true => FORMAT,
            false => FORMAT_OF_PARTS,
        },
        part,
        behaviour: behaviour.to_owned(),
        run_sha256: run.map(|run| Digest::of(run.as_bytes()).to_string()),
        rows: grid.as_ref().map(|grid| grid.rows),
        columns: grid.as_ref().map(|grid| grid.columns),
        occupied: grid.as_ref().map(|grid| grid.occupied),
        fill: grid.as_ref().map(|grid| grid.fill),
        remember_s: grid.as_ref().map(|grid| grid.remember_s).filter(|seconds| *seconds > 0.0),
        worlds,
        randomise: settings.randomise.iter().map(|varied| format!("{}: {}", varied.key, varied.from.words())).collect(),
        states: policy.states(),
        temperature: policy.temperature(),
        pools: policy.pools().map(Pools::to_sums),
        kept: Some(policy.kept()).filter(|kept| !kept.is_empty()).map(base64),
        actions: settings.actions.iter().map(|twist| [twist.linear_m_per_s, twist.angular_rad_per_s]).collect(),
        filter,
        view,
        state: state.collect(),
    };
    toml::to_string(&file)
        .map_err(|error| Box::new(Diagnostic::new("E-POLICY-FILE", format!("the policy cannot be written: {error}"))))
}

/// Of several worlds each with its weight: `room: 3`.
/// Several worlds by name with their weights, those of the home world first.
fn worlds_of(plan: &Plan) -> Vec<String> {
    if plan.worlds.further().is_empty() {
        return Vec::new();
    }
    let mut layouts = plan.worlds.layouts().iter();
    let share = |(weight, count): (u32, usize)| {
        let first = layouts.by_ref().take(count).map(|layout| layout.name.as_str()).reduce(|first, _| first);
        let more = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
        format!("{}{more}: {weight}", first.unwrap_or_default())
    };
    plan.worlds.shares().into_iter().map(share).collect()
}

impl StoredPolicy {
    /// Reads `policy.toml`.
    ///
    /// # Errors
    /// If the file is damaged or of another format.
    pub fn parse(source: &SourceText) -> Result<Self> {
        let format: PolicyFormat = toml::from_str(&source.text).map_err(|error| toml_error(source, &error))?;
        if !(FORMAT..=FORMAT_OF_KEPT).contains(&format.format) {
            let message =
                format!("has format {}, this engine reads formats {FORMAT} to {FORMAT_OF_KEPT}", format.format);
            return Err(unfit(source, &message, "learn the behaviour again"));
        }
        let file: PolicyFile = toml::from_str(&source.text).map_err(|error| toml_error(source, &error))?;
        let whole = |rows, columns, occupied, fill| {
            let remember_s = file.remember_s.unwrap_or(0.0);
            Some(GridSettings { rows: rows?, columns: columns?, occupied: occupied?, fill: fill?, remember_s })
        };
        let own = whole(file.rows, file.columns, file.occupied, file.fill);
        let first = file.view.first().map(ViewEntry::settings);
        let (Some(grid), true) = (own.or(first.map(|view| view.grid)), file.part.is_empty() == file.view.is_empty())
        else {
            return Err(unfit(source, "has neither a grid nor views", "learn the behaviour again"));
        };
        let most = if format.format >= FORMAT_OF_MEMORY { MAX_POOLED_STATES } else { MAX_STATES };
        if file.states > most || file.actions.is_empty() {
            return Err(unfit(source, "has no actions or too many states", "learn the behaviour again"));
        }
        let mut rows = BTreeMap::new();
        for StateEntry { index, visits, values, .. } in file.state {
            let finite = values.iter().all(|value| value.is_finite());
            let fits = index < file.states && values.len() == file.actions.len() && finite;
            if !fits || rows.insert(index, PolicyRow { visits, values }).is_some() {
                let message = format!("has a damaged entry for state {index}");
                return Err(unfit(source, &message, "learn the behaviour again"));
            }
        }
        let policy =
            remembering(Policy::of_states(file.actions.len(), file.states, rows), file.temperature, file.pools)
                .ok_or_else(|| unfit(source, "has damaged sums or no temperature", "learn the behaviour again"))?;
        let kept = file.kept.as_deref().map_or(Some(Vec::new()), from_base64);
        let Some(kept) = kept else {
            return Err(unfit(source, "has damaged bytes of its filters in 'kept'", "learn the behaviour again"));
        };
        let policy = policy.keeping(kept);
        let entries = file.view.first().map_or(file.filter, |view| view.filter.clone());
        Ok(Self {
            behaviour: file.behaviour,
            run_sha256: file.run_sha256,
            filters: entries.iter().map(FilterEntry::settings).collect(),
            entries,
            grid,
            parts: file.part,
            views: file.view.iter().map(ViewEntry::settings).collect(),
            policy,
            actions: file.actions.iter().map(|[linear, angular]| Twist::new(*linear, *angular)).collect(),
        })
    }

    /// Whether it suits the grid shape, the states of the map and the actions of these settings.
    ///
    /// # Errors
    /// What differs: its own value, then the settings'.
    pub fn suits(&self, settings: &Settings, map: &dyn StateMap) -> std::result::Result<(), [String; 2]> {
        let (own, grid, states) = (&self.grid, &settings.view.grid, map.states());
        let shape = |rows: u64, columns: u64| format!("a grid of {rows}x{columns}");
        let fill = |fill: bool| format!("a grid {} column fill", if fill { "with" } else { "without" });
        if (own.rows, own.columns) != (grid.rows, grid.columns) {
            return Err([shape(own.rows, own.columns), shape(grid.rows, grid.columns)]);
        }
        if own.fill != grid.fill {
            return Err([fill(own.fill), fill(grid.fill)]);
        }
        if own.remember_s != grid.remember_s {
            let remembers = |seconds: f64| format!("a grid that remembers for {seconds} s");
            return Err([remembers(own.remember_s), remembers(grid.remember_s)]);
        }
        let (own_parts, parts) = (&self.parts, &parts_of(map));
        if own_parts != parts {
            return Err([own_parts, parts].map(|parts| in_words(parts)));
        }
        let looks =
            |view: &ViewSettings| format!("view \"{}\" of {}", view.name, shape(view.grid.rows, view.grid.columns));
        let differs = |(own, view): (&ViewSettings, &ViewSettings)| {
            (own.name != view.name || own.grid != view.grid).then(|| [looks(own), looks(view)])
        };
        if let Some(differing) = self.views.iter().zip(settings.views()).find_map(differs) {
            return Err(differing);
        }
        if self.policy.states() != states {
            return Err([format!("{} states", self.policy.states()), format!("{states} states")]);
        }
        if self.actions.len() != settings.actions.len() {
            return Err([format!("{} actions", self.actions.len()), format!("{} actions", settings.actions.len())]);
        }
        let motion = |action: usize, twist: &Twist| {
            format!("[{}, {}] as action {action}", twist.linear_m_per_s, twist.angular_rad_per_s)
        };
        let pairs = self.actions.iter().zip(&settings.actions).enumerate();
        match pairs.into_iter().find(|(_, (own, twist))| own != twist) {
            Some((action, (own, twist))) => Err([motion(action, own), motion(action, twist)]),
            None => Ok(()),
        }
    }
}

/// A policy with what only the learner `memory` leaves; nothing if that is damaged.
fn remembering(policy: Policy, temperature: Option<f64>, pools: Option<PooledSums>) -> Option<Policy> {
    let Some(temperature) = temperature else { return pools.is_none().then_some(policy) };
    let pools = match pools {
        Some(sums) => Some(Arc::new(Pools::from_sums(&sums, policy.actions())?)),
        None => None,
    };
    let finite = temperature.is_finite() && temperature > 0.0;
    finite.then(|| policy.at_temperature(temperature).answering(pools))
}

/// The parts of a map's states; none if it has one.
fn parts_of(map: &dyn StateMap) -> Vec<toml::Table> {
    let parts = map.to_table().get("part").and_then(toml::Value::as_array).cloned().unwrap_or_default();
    parts.iter().filter_map(toml::Value::as_table).cloned().collect()
}

/// `states of a grid alone`, `states of camera, laser.front [0.5, 1.0], stages ["search", "approach"]`.
fn in_words(parts: &[toml::Table]) -> String {
    let name = |part: &toml::Table| {
        let text = |key: &str| part.get(key).map(toml::Value::to_string);
        let view = text("view").map(|view| view.trim_matches('"').to_owned());
        let bins = || Some(format!("{} {}", text("bins")?.trim_matches('"'), text("edges")?));
        let stages = || Some(format!("stages {}", text("stages")?));
        view.or_else(bins).or_else(stages).unwrap_or_else(|| "?".to_owned())
    };
    match parts {
        [] => "states of a grid alone".to_owned(),
        parts => format!("states of {}", parts.iter().map(name).collect::<Vec<_>>().join(", ")),
    }
}

/// Reads the text of a `policy.toml` for a plan.
///
/// # Errors
/// If the file is damaged, or was learned with another grid or other actions.
pub fn policy_from_toml(source: &SourceText, plan: &Plan) -> Result<Policy> {
    fitting(source, &plan.settings, &*plan.state_map()?).map(|stored| stored.policy)
}

/// The policy of a run's folder, whose `run.toml` has the text `run`.
///
/// # Errors
/// As [`policy_from_toml`], and if the policy belongs to another run.
pub(super) fn policy_of_run(source: &SourceText, plan: &Plan, run: &SourceText) -> Result<Policy> {
    let stored = fitting(source, &plan.settings, &*plan.state_map()?)?;
    belongs(source, stored.run_sha256.as_deref(), run)?;
    Ok(stored.policy)
}

fn fitting(source: &SourceText, settings: &Settings, map: &dyn StateMap) -> Result<StoredPolicy> {
    let stored = StoredPolicy::parse(source)?;
    stored.suits(settings, map).map_err(|[own, wanted]| {
        unfit(source, &format!("was learned with {own}, this run has {wanted}"), "learn the behaviour again")
    })?;
    Ok(stored)
}

fn unfit(source: &SourceText, message: &str, help: &str) -> Box<Diagnostic> {
    let message = format!("'{}' {message}", source.path.display());
    Box::new(Diagnostic::new("E-POLICY-FILE", message).help(help))
}

#[cfg(test)]
mod tests;
