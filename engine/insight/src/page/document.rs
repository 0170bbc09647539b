//! Everything that the page knows about a run, except what each seed did: that is [`SeedView`].

use serde::Serialize;

use super::checked::{CheckView, FindingView};
use super::ground::Ground;
use super::seed::{SeedData, SeedView};
use super::shot::Shot;
use super::track::{Moments, ScanShape};
use crate::lint::{self, Report};
use engine::diagnostic::Result;
use engine::experiment::{Plan, WINDOW_STEPS};
use engine::geometry::Twist;
use engine::learner::Carry;
use engine::script::Param;
use engine::settings::{SETTINGS, Settings, Value};
use engine::stats::Sorted;

/// The version of the contract; a page shows only documents of its own version.
const FORMAT: u32 = 2;
/// The most beams of the laser that are drawn.
const MOST_SCAN_BEAMS: usize = 37;
/// The most bytes of tracks and pictures in one document; seeds beyond it have curve and policy only.
const MOST_EMBEDDED_BYTES: usize = 2_300_000;
/// The largest coordinate of a track, a little less than 16 bits can hold.
const REACH: f64 = 32_000.0;

/// One run, of one seed or many.
#[derive(Debug, Clone, Serialize)]
pub struct Document {
    /// The version of the contract.
    pub format: u32,
    /// The program's version.
    pub engine: &'static str,
    /// Name of the behaviour.
    pub behaviour: String,
    /// Path of the script as the user gave it.
    pub script_path: String,
    /// The script's text.
    pub script: String,
    /// What stands in the world, from above.
    pub world: Ground,
    /// What stands in the other worlds of the run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further_worlds: Vec<Ground>,
    /// Length of one unit of a track's coordinates, metres.
    pub unit_m: f64,
    /// Half of the robot's length and width, metres.
    pub robot_half_m: [f64; 2],
    /// The robot's outline in its own axes, metres.
    pub robot_outline_m: Vec<[f64; 2]>,
    /// Time between two steps, seconds.
    pub period_s: f64,
    /// Steps in a window of the curve.
    pub window_steps: u64,
    /// Steps of learning that are planned, in all legs.
    pub planned_steps: u64,
    /// The run that learning went on from, and what was carried on, in words; of many seeds, that of the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// Where the reward was swapped while the robot learned.
    pub swaps: Vec<Swap>,
    /// Forward speed, m/s, and turning speed, rad/s, of each action.
    pub actions: Vec<[f64; 2]>,
    /// Rows and columns of the grid.
    pub grid: [usize; 2],
    /// The laser's beams in tracks.
    pub scan: ScanShape,
    /// The rules in their order, `fn reward` last.
    pub rules: Vec<RuleView>,
    /// The script's uses of learned policies, in their order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub uses: Vec<UseView>,
    /// The names of the script's measures, in their order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<String>,
    /// The script's stages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stages: Option<StagesView>,
    /// The settings that differ from their defaults first, then the others.
    pub settings: Vec<SettingView>,
    /// The script's parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub params: Vec<ParamView>,
    /// The seeds.
    pub seeds: Vec<SeedView>,
    /// Moments with their pictures.
    pub shots: Vec<Shot>,
    /// What reading the script found, and trying it out, where that was done.
    pub findings: Vec<FindingView>,
    /// The outcome of trying it out; null if it was only read.
    pub checked: Option<CheckView>,
}

/// A swap of the reward while the robot learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Swap {
    /// The first step under the new reward.
    pub step: u64,
    /// What became of the table.
    pub table: Carry,
}

/// One rule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RuleView {
    /// Its name.
    pub name: String,
    /// Its first line in the script, from 1.
    pub line: usize,
    /// How many lines it has.
    pub lines: usize,
    /// What it adds whenever it fires; null if that depends on the step.
    pub value: Option<f64>,
}

/// The stages of a script, the highest digit of its states.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StagesView {
    /// Their names.
    pub names: Vec<String>,
    /// How many states there are within one stage.
    pub states: usize,
}

impl StagesView {
    fn of(plan: &Plan) -> Result<Option<Self>> {
        let names = plan.settings.stages.clone();
        if names.is_empty() {
            return Ok(None);
        }
        Ok(Some(Self { states: plan.state_map()?.states() / names.len(), names }))
    }

    /// The number of the stage that a state stands in.
    #[must_use]
    pub fn of_state(&self, state: u32) -> usize {
        (state as usize / self.states.max(1)).min(self.names.len().saturating_sub(1))
    }
}

/// One use of a learned policy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UseView {
    /// What the script calls the policy.
    pub name: String,
    /// Its line in the script, from 1.
    pub line: usize,
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SettingView {
    /// Its name, such as `camera.tilt_deg`.
    pub name: String,
    /// Its value.
    pub value: String,
    /// Its unit, in words.
    pub unit: &'static str,
    /// Whether it differs from the default.
    pub changed: bool,
}

/// One parameter of the script.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParamView {
    /// Its name.
    pub name: String,
    /// What it is in this run.
    pub value: f64,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// Whether it is a whole number.
    pub whole: bool,
}

impl From<&Param> for ParamView {
    fn from(param: &Param) -> Self {
        let Param { name, value, low, high, whole, .. } = param;
        Self { name: name.clone(), value: *value, low: *low, high: *high, whole: *whole }
    }
}

impl Document {
    /// A run as the page shows it; `moments` says which steps bring pictures and scans with them.
    ///
    /// # Errors
    /// If a recorded step cannot be played again.
    pub fn new(plan: &Plan, seeds: &[SeedData<'_>], moments: Moments) -> Result<Self> {
        let mut document = Self::without_seeds(plan)?;
        for data in seeds {
            document.seeds.push(SeedView::new(plan, data)?);
        }
        let mut bytes = 0;
        // The median robot is the one to look at; then the others in their order.
        let first = if moments.seeds.is_some() { Some(0) } else { first_seed(&document.seeds) };
        let order = first.into_iter().chain((0..seeds.len()).filter(|index| Some(*index) != first));
        for index in order.take(moments.seeds.unwrap_or(usize::MAX)) {
            if bytes > MOST_EMBEDDED_BYTES / 2 && bytes + bytes_of_next(bytes, &document) > MOST_EMBEDDED_BYTES {
                break;
            }
            let shots =
                document.seeds[index].add_tracks(plan, &seeds[index], document.unit_m, document.scan, moments)?;
            bytes += document.seeds[index].bytes() + shots.iter().map(Shot::bytes).sum::<usize>();
            document.shots.extend(shots);
        }
        document.first_shown(first);
        Ok(document)
    }

    /// One seed with its steps, to complete a document that left them out; `None` if there is no such seed.
    #[must_use]
    pub fn tracks_of(plan: &Plan, data: &SeedData<'_>) -> Option<Result<SeedView>> {
        let moments = Moments { shots: 0, scans: true, seeds: Some(1) };
        let made = Self::new(plan, std::slice::from_ref(data), moments);
        made.map(|mut document| document.seeds.pop()).transpose()
    }

    /// The plan's side of a document.
    ///
    /// # Errors
    /// If the grid cannot be made.
    pub fn without_seeds(plan: &Plan) -> Result<Self> {
        let Settings { run, robot, laser, .. } = &plan.settings;
        let world = Ground::new(plan);
        let further_worlds: Vec<Ground> =
            (1..plan.worlds.layouts().len()).map(|world| Ground::new(&plan.in_world(world))).collect();
        let bounds_m = further_worlds.iter().chain([&world]).flat_map(|world| world.bounds_m);
        let far = bounds_m.fold(1.0, |far: f64, at| far.max(at.abs()));
        let fan = laser.fan();
        let every = fan.beams.saturating_sub(1).div_ceil(MOST_SCAN_BEAMS - 1).max(1);
        let (rows, columns) = plan.drawn_grid()?;
        let rules = plan.behaviour.rules().iter().enumerate();
        Ok(Self {
            format: FORMAT,
            engine: env!("CARGO_PKG_VERSION"),
            behaviour: plan.behaviour.name().to_owned(),
            script_path: plan.behaviour.source().path.display().to_string(),
            script: plan.behaviour.source().text.to_string(),
            // Room for a robot that falls off the edge of the world.
            unit_m: (2.0 * far / REACH).max(0.001),
            world,
            further_worlds,
            robot_half_m: robot.body.footprint.half_m(),
            robot_outline_m: robot.body.footprint.outline_m(),
            period_s: run.period_s,
            window_steps: WINDOW_STEPS,
            planned_steps: plan.learning_steps(),
            from: goes_on_from(plan),
            swaps: plan.swaps().map(|(step, table, ..)| Swap { step, table }).collect(),
            actions: plan.motions().iter().map(|twist| [twist.linear_m_per_s, twist.angular_rad_per_s]).collect(),
            grid: [rows, columns],
            uses: plan.behaviour.uses().map(|(text, _)| UseView { name: text.name.clone(), line: text.line }).collect(),
            measures: plan.behaviour.measures().map(str::to_owned).collect(),
            stages: StagesView::of(plan)?,
            scan: ScanShape {
                beams: fan.beams,
                first_rad: fan.bearing_rad(0),
                apart_rad: fan.apart_rad(),
                whole: fan.is_whole(),
                every,
                kept: fan.beams.saturating_sub(1) / every + 1,
                max_range_m: laser.max_range_m,
                forward_m: laser.forward_m,
                tilt_rad: laser.tilt_deg.to_radians(),
            },
            rules: rules
                .map(|(index, rule)| RuleView {
                    name: rule.name.clone(),
                    line: rule.line,
                    lines: rule.text.lines().count().max(1),
                    value: plan.behaviour.fixed_value(index),
                })
                .collect(),
            settings: settings(plan),
            params: plan.behaviour.params().iter().map(ParamView::from).collect(),
            seeds: Vec::new(),
            shots: Vec::new(),
            findings: lint::read(plan).iter().map(FindingView::from).collect(),
            checked: None,
        })
    }

    /// This document with what a full check found, instead of what reading the script did.
    #[must_use]
    pub fn with_check(self, report: &Report) -> Self {
        Self { findings: report.findings.iter().map(FindingView::from).collect(), checked: Some(report.into()), ..self }
    }

    fn first_shown(&mut self, first: Option<usize>) {
        if let Some(seed) = first.and_then(|index| self.seeds.get_mut(index)) {
            seed.shown_first = true;
        }
    }
}

/// The seed to look at first: among those that bring their steps, the one nearest to the median of all.
fn first_seed(seeds: &[SeedView]) -> Option<usize> {
    let failures: Vec<f64> =
        seeds.iter().map(|seed| seed.test.as_ref().map_or(0.0, |test| test.failures_per_1000)).collect();
    median_seed(&failures, |index| seeds[index].brings_steps)
}

/// Of the seeds that are `at_hand`, the first whose failures are nearest to the median of all.
pub(crate) fn median_seed(failures: &[f64], at_hand: impl Fn(usize) -> bool) -> Option<usize> {
    let median = failures.iter().copied().collect::<Sorted>().upper_median()?;
    let away = |index: &usize| (failures[*index] - median).abs();
    (0..failures.len()).filter(|index| at_hand(*index)).min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// The run that learning went on from, and what was carried on, in words.
fn goes_on_from(plan: &Plan) -> Option<String> {
    let first = plan.first_leg();
    first.origins.first().map(|origin| format!("{}: {}", origin.name(), origin.carried(first)))
}

/// A seed takes about as much room as those before it.
fn bytes_of_next(bytes: usize, document: &Document) -> usize {
    bytes / document.seeds.iter().filter(|seed| seed.bytes() > 0).count().max(1)
}

fn settings(plan: &Plan) -> Vec<SettingView> {
    let defaults = Settings::default();
    let params = plan.behaviour.params().iter().map(|param| SettingView {
        name: param.name.clone(),
        value: param.shown(),
        unit: "",
        changed: true,
    });
    let of_views = plan.settings.views().flat_map(|view| view.filters.iter().map(move |filter| (view, filter)));
    let filters = of_views.map(|(view, filter)| {
        let parameters = filter.shown();
        SettingView {
            name: view.place(&format!("filter.{}", filter.name)),
            value: if parameters.is_empty() { "as it is".to_owned() } else { parameters.join(", ") },
            unit: "",
            changed: true,
        }
    });
    let rows = SETTINGS.iter().map(|row| {
        let value = (row.get)(&plan.settings);
        let changed = value != (row.get)(&defaults);
        let value = match value {
            Value::Number(number) => number.to_string(),
            Value::Flag(flag) => flag.to_string(),
            Value::Text(text) => text,
        };
        SettingView { name: row.name(), value, unit: row.unit, changed }
    });
    let mut all: Vec<SettingView> = params.chain(robot(plan)).chain(filters).chain(rows).collect();
    all.sort_by_key(|setting| !setting.changed);
    all
}

/// The body that the script names, and the actions if they are not those of every script.
fn robot(plan: &Plan) -> Vec<SettingView> {
    let view = |name: &str, value: String, unit| SettingView { name: name.to_owned(), value, unit, changed: true };
    let body = plan.behaviour.body().and_then(|body| body.path.file_stem());
    let mut robot: Vec<SettingView> =
        body.map(|name| view("robot", name.to_string_lossy().into_owned(), "")).into_iter().collect();
    let actions = &plan.settings.actions;
    if *actions != Settings::default().actions {
        let pair = |twist: &Twist| format!("[{}, {}]", twist.linear_m_per_s, twist.angular_rad_per_s);
        let cut = plan.behaviour.place_of("actions").is_none()
            && actions.iter().all(|action| Settings::default().actions.contains(action));
        let unit = if cut { "(m/s, rad/s), those of every script that it can do" } else { "(m/s, rad/s)" };
        robot.push(view("actions", actions.iter().map(pair).collect::<Vec<_>>().join(" "), unit));
    }
    robot
}
