//! `run.toml`: all that is needed to do a run again, script and world included.

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Table;

use super::filter_entry::{FilterEntry, ViewEntry};
use super::going_on::{MOST_ORIGINS, OriginEntry};
use super::members::{PolicyText, with_policy_texts};
use super::parts::{RUN_FILE, check_parts};
use super::policy_file::{POLICY_FILE, policy_of_run};
use super::{read_stored, toml_error};
use engine::diagnostic::{Diagnostic, Result, SourceText};
use engine::digest::Digest;
use engine::experiment::{Decider, Leg, Plan};
use engine::filter::Catalogue;
use engine::geometry::Twist;
use engine::learner::Carry;
use engine::script::{Behaviour, ParamValues};
use engine::settings::{Edition, LearnerKind, SETTINGS, Settings, Value, ViewSettings, apply};
use engine::world::{Layout, WorldSet};

const FORMAT: u32 = 1;
/// The format of a run whose reward was swapped while it learned.
const FORMAT_OF_LEGS: u32 = 2;
/// The format of a run with more views than one.
const FORMAT_OF_VIEWS: u32 = 3;
/// The format of a run in more worlds than one.
const FORMAT_OF_WORLDS: u32 = 4;
/// The format of a run that goes on from another.
const FORMAT_OF_ORIGIN: u32 = 5;
/// As many as `run.steps` may be.
pub(super) const MOST_LEG_STEPS: u64 = 1_000_000_000;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RunFile {
    format: u32,
    engine: String,
    behaviour: String,
    /// The edition whose defaults the script has; a run of version 0.1 does not say it.
    #[serde(default = "first_edition")]
    edition: u32,
    seed: u64,
    actions: Vec<[f64; 2]>,
    filters: Vec<FilterEntry>,
    /// The views after the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    view: Vec<ViewEntry>,
    settings: Table,
    /// The script's parameters with their values.
    #[serde(default, skip_serializing_if = "ParamValues::is_empty")]
    params: ParamValues,
    script: TextEntry,
    world: TextEntry,
    /// Of several worlds: those after the home world, in the order in which they are drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    further_world: Vec<TextEntry>,
    /// The shares of several worlds: weight, and how many worlds have it together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    world_share: Vec<(u32, usize)>,
    /// The body that the script names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    body: Option<TextEntry>,
    /// Of a combination: the policies, in the order of the script.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    policy: Vec<TextEntry>,
    /// The policies that the script uses, in its order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    used: Vec<UsedEntry>,
    /// What was learned before under other scripts, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    leg: Vec<LegEntry>,
    /// The run that it goes on from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    from: Option<OriginEntry>,
}

/// Learning under one script, until the reward was swapped. Only rules and the learner's settings may differ from leg to leg.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LegEntry {
    steps: u64,
    /// What became of the table then.
    table: Carry,
    settings: Table,
    #[serde(default, skip_serializing_if = "ParamValues::is_empty")]
    params: ParamValues,
    script: TextEntry,
}

/// A policy that the script uses: its own `policy.toml`, and the `run.toml` of the run that learned it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct UsedEntry {
    policy: TextEntry,
    run: TextEntry,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TextEntry {
    path: String,
    sha256: String,
    text: String,
}

impl UsedEntry {
    fn new([policy, run]: &[SourceText; 2]) -> Self {
        Self { policy: TextEntry::new(policy), run: TextEntry::new(run) }
    }

    fn check(&self, file: &SourceText) -> Result<PolicyText> {
        Ok(PolicyText { policy: self.policy.check(file)?, run: Some(self.run.check(file)?) })
    }
}

impl TextEntry {
    pub(super) fn new(source: &SourceText) -> Self {
        let path = source.path.display().to_string();
        Self { path, sha256: sha256(&source.text), text: source.text.to_string() }
    }

    pub(super) fn check(&self, file: &SourceText) -> Result<SourceText> {
        if sha256(&self.text) != self.sha256 {
            let message = format!("'{}' holds a changed copy of '{}'", file.path.display(), self.path);
            return Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again").fail();
        }
        Ok(SourceText::new(self.path.clone(), self.text.clone()))
    }
}

fn first_edition() -> u32 {
    Edition::FIRST.number()
}

fn sha256(text: &str) -> String {
    Digest::of(text.as_bytes()).to_string()
}

/// The text of `run.toml`.
///
/// # Errors
/// Never in practice: only if the settings cannot be written as TOML.
pub fn run_to_toml(plan: &Plan, seed: u64) -> Result<String> {
    let (settings, origin) = (&plan.settings, plan.origin_of(seed));
    let legs = plan.earlier.iter().map(|leg| LegEntry {
        steps: leg.steps,
        table: leg.then,
        settings: settings_table(&leg.plan),
        params: leg.plan.behaviour.param_values(),
        script: TextEntry::new(leg.plan.behaviour.source()),
    });
    let file = RunFile {
        format: match origin {
            Some(_) => FORMAT_OF_ORIGIN,
            None => {
                format(!plan.earlier.is_empty(), !settings.further_views.is_empty(), !plan.worlds.further().is_empty())
            }
        },
        engine: env!("CARGO_PKG_VERSION").to_owned(),
        behaviour: plan.behaviour.name().to_owned(),
        edition: plan.behaviour.edition().number(),
        seed,
        actions: settings.actions.iter().map(|twist| [twist.linear_m_per_s, twist.angular_rad_per_s]).collect(),
        filters: settings.view.filters.iter().map(|filter| FilterEntry::new(filter, &plan.filters)).collect(),
        view: settings.further_views.iter().map(|view| ViewEntry::new(view, &plan.filters)).collect(),
        settings: settings_table(plan),
        params: plan.behaviour.param_values(),
        script: TextEntry::new(plan.behaviour.source()),
        world: TextEntry::new(&plan.layout.source),
        further_world: plan.worlds.further().iter().map(|layout| TextEntry::new(&layout.source)).collect(),
        world_share: if plan.worlds.further().is_empty() { Vec::new() } else { plan.worlds.shares() },
        body: plan.behaviour.body().map(TextEntry::new),
        policy: plan.members.iter().map(|member| TextEntry::new(&member.source)).collect(),
        used: plan.used.iter().map(|used| UsedEntry::new(&used.texts)).collect(),
        leg: legs.collect(),
        from: origin.map(OriginEntry::new),
    };
    toml::to_string_pretty(&file)
        .map_err(|error| Box::new(Diagnostic::new("E-RUN-FILE", format!("the settings cannot be written: {error}"))))
}

fn format(legs: bool, views: bool, worlds: bool) -> u32 {
    match (worlds, views, legs) {
        (true, ..) => FORMAT_OF_WORLDS,
        (false, true, _) => FORMAT_OF_VIEWS,
        (false, false, true) => FORMAT_OF_LEGS,
        (false, false, false) => FORMAT,
    }
}

fn settings_table(plan: &Plan) -> Table {
    let (settings, varies) = (&plan.settings, plan.varies());
    let mut table = Table::new();
    // How long an attempt may stay says nothing where it may stay for ever.
    for row in SETTINGS.iter().filter(|row| varies || row.key != "stay_steps") {
        let group = table.entry(row.group).or_insert_with(|| toml::Value::Table(Table::new()));
        let value = match (row.get)(settings) {
            Value::Flag(flag) => toml::Value::Boolean(flag),
            Value::Text(text) => toml::Value::String(text),
            Value::Number(number) => toml::Value::Float(number),
        };
        if let Some(group) = group.as_table_mut() {
            group.insert(row.key.to_owned(), value);
        }
    }
    table
}

/// A run read back from its folder.
pub struct StoredRun {
    /// The plan as it was, with its own world and, if it combines policies, with them.
    pub plan: Plan,
    /// The seed.
    pub seed: u64,
    /// What decides.
    pub decider: Decider,
}

/// The plan of a run that need not be finished, and its seed, from the `run.toml` of its folder.
///
/// # Errors
/// If the file is missing, damaged or of another format.
pub fn plan_of_run(folder: &Path, filters: Arc<Catalogue>) -> Result<(Plan, u64)> {
    StoredRun::parse_plan(&read_stored(&folder.join(RUN_FILE))?, filters, MOST_ORIGINS)
}

impl StoredRun {
    /// Reads `run.toml` of a run's folder, and `policy.toml` unless the run combined policies and so holds them.
    ///
    /// # Errors
    /// If a file is missing, damaged, or of another format.
    pub fn load(folder: &Path) -> Result<Self> {
        Self::load_with(folder, Arc::new(Catalogue::linked_in()))
    }

    /// Reads a run that used other filters than those linked in.
    ///
    /// # Errors
    /// As [`StoredRun::load`], and if a filter is missing or another than it was.
    pub fn load_with(folder: &Path, filters: Arc<Catalogue>) -> Result<Self> {
        let (stored, source) = Self::read(folder, filters)?;
        check_parts(folder, &source, &stored.decider)?;
        Ok(stored)
    }

    /// The run and its `run.toml`, for whoever reads log and summary too and so sees whether they belong to it.
    pub(super) fn read(folder: &Path, filters: Arc<Catalogue>) -> Result<(Self, SourceText)> {
        let source = read_stored(&folder.join(RUN_FILE))?;
        let stored = Self::parse(&source, || read_stored(&folder.join(POLICY_FILE)), filters)?;
        Ok((stored, source))
    }

    /// A run from the texts of its files; `policy` gives that of `policy.toml`, which a run that learned nothing does not have.
    pub(super) fn parse(
        source: &SourceText,
        policy: impl FnOnce() -> Result<SourceText>,
        filters: Arc<Catalogue>,
    ) -> Result<Self> {
        let (plan, seed) = Self::parse_plan(source, filters, MOST_ORIGINS)?;
        let decider = match plan.learns() {
            true => Decider::Learned(policy_of_run(&policy()?, &plan, source)?),
            false => Decider::Combined,
        };
        Ok(Self { plan, seed, decider })
    }

    /// The plan and the seed; at most so many runs may go on from one another.
    pub(super) fn parse_plan(source: &SourceText, filters: Arc<Catalogue>, deep: usize) -> Result<(Plan, u64)> {
        let file: RunFile = toml::from_str(&source.text).map_err(|error| toml_error(source, &error))?;
        let expected = match &file.from {
            Some(_) => FORMAT_OF_ORIGIN,
            None => format(!file.leg.is_empty(), !file.view.is_empty(), !file.further_world.is_empty()),
        };
        if file.format != expected {
            let message = format!(
                "'{}' has format {}; this engine reads format {expected} with {} earlier legs, {} further views and {} further worlds",
                source.path.display(),
                file.format,
                file.leg.len(),
                file.view.len(),
                file.further_world.len()
            );
            return Diagnostic::new("E-RUN-FILE", message).fail();
        }
        let Some(edition) = Edition::of(file.edition) else {
            let message =
                format!("'{}' is of edition {}, which this engine does not know", source.path.display(), file.edition);
            return Diagnostic::new("E-RUN-FILE", message).help("use a newer engine").fail();
        };
        let body = file.body.as_ref().map(|body| body.check(source)).transpose()?;
        let behaviour_of = |script: &TextEntry, params: &ParamValues| {
            // The run has the file of the one body that its script names.
            let bodies = |_: &str| Ok(body.clone());
            Behaviour::parse_in(edition, &file.behaviour, script.check(source)?, &bodies, params).map(Arc::new)
        };
        let behaviour = behaviour_of(&file.script, &file.params)?;
        let worlds = stored_worlds(source, &file, behaviour.settings())?;
        let further = file.view.iter().flat_map(|view| &view.filter);
        file.filters.iter().chain(further).try_for_each(|filter| filter.check(&filters))?;
        let plan_of = |behaviour: Arc<Behaviour>, table: &Table| {
            let settings = settings(source, behaviour.settings(), &file, table)?;
            Plan::with_worlds(behaviour, settings, worlds.clone(), Arc::clone(&filters))
        };
        let plan = plan_of(behaviour, &file.settings)?;
        let leg = |leg: &LegEntry| {
            if leg.steps > MOST_LEG_STEPS {
                let message = format!("'{}' has a leg of {} steps", source.path.display(), leg.steps);
                return Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again").fail();
            }
            if leg.table == Carry::Rescore && plan.settings.learner.kind != LearnerKind::Memory {
                let message = format!("'{}' judges the steps of a table, which remembers none", source.path.display());
                return Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again").fail();
            }
            let earlier = plan_of(behaviour_of(&leg.script, &leg.params)?, &leg.settings)?;
            match plan.differs_beyond_reward(&earlier) {
                None => Ok(Leg { plan: earlier, steps: leg.steps, then: leg.table }),
                Some(what) => Err(Box::new(not_one_run(source, &what))),
            }
        };
        let legs = file.leg.iter().map(leg).collect::<Result<Vec<_>>>()?;
        let combined = file.policy.iter().map(|policy| policy.check(source).map(PolicyText::alone));
        let texts = combined.chain(file.used.iter().map(|used| used.check(source))).collect::<Result<Vec<_>>>()?;
        let plan = with_policy_texts(plan.after(legs), texts)?;
        let Some(from) = &file.from else { return Ok((plan, file.seed)) };
        let origin = from.origin(source, filters, deep)?;
        Ok((plan.going_on_from(vec![origin])?, file.seed))
    }
}

/// Whether the text of a `run.toml` holds policies that its script uses.
pub(super) fn uses_policies(source: &SourceText) -> bool {
    #[derive(Deserialize)]
    struct Uses {
        #[serde(default)]
        used: Vec<toml::Value>,
    }
    toml::from_str(&source.text).is_ok_and(|Uses { used }| !used.is_empty())
}

/// The worlds of a run.
fn stored_worlds(source: &SourceText, file: &RunFile, settings: &Settings) -> Result<WorldSet> {
    let mut all = Vec::with_capacity(1 + file.further_world.len());
    for entry in std::iter::once(&file.world).chain(&file.further_world) {
        all.push(Arc::new(Layout::parse(entry.check(source)?, &settings.robot.body)?));
    }
    let alone = [(1, 1)];
    let shares = if file.further_world.is_empty() { &alone[..] } else { &file.world_share };
    WorldSet::stored(shares, all).ok_or_else(|| {
        let message = format!("the worlds of '{}' are not those that it shares out", source.path.display());
        Box::new(Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again"))
    })
}

fn not_one_run(source: &SourceText, what: &str) -> Diagnostic {
    let message = format!("the legs of '{}' differ in {what}: only the reward may change", source.path.display());
    Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again")
}

fn settings(source: &SourceText, written: &Settings, file: &RunFile, table: &Table) -> Result<Settings> {
    let mut settings = written.clone();
    if file.further_world.is_empty() {
        // Another world was named than the script does.
        settings.worlds.clear();
    }
    settings.actions = file.actions.iter().map(|[linear, angular]| Twist::new(*linear, *angular)).collect();
    settings.view.filters = file.filters.iter().map(FilterEntry::settings).collect();
    let names = |views: &[ViewSettings]| views.iter().map(|view| view.name.clone()).collect::<Vec<_>>();
    let further: Vec<ViewSettings> = file.view.iter().map(ViewEntry::settings).collect();
    if names(&further) != names(&settings.further_views) {
        let message = format!("the views of '{}' are not those of its script", source.path.display());
        return Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again").fail();
    }
    settings.further_views = further;
    for (group, keys) in table {
        for (key, value) in keys.as_table().into_iter().flatten() {
            let value = match value {
                toml::Value::Boolean(flag) => Value::Flag(*flag),
                toml::Value::String(text) => Value::Text(text.clone()),
                other => Value::Number(other.as_float().unwrap_or(f64::NAN)),
            };
            apply(&mut settings, group, key, &value).map_err(|error| {
                let message = format!("'{}': {} ({})", source.path.display(), error.message, error.found);
                Box::new(Diagnostic::new("E-RUN-FILE", message))
            })?;
        }
    }
    Ok(settings)
}
