//! The folder that a run leaves.

use std::path::{Path, PathBuf};

use super::page::write_page;
use engine::diagnostic::{Diagnostic, Kind, Result};
use engine::experiment::{CertaintyGrid, Learned, Member, Plan, Spread, Summary, TestRun, Trail, WINDOW_STEPS};
use engine::geometry::Point2;
use insight::lint::Report;
use insight::report::{
    CurveData, CurveRow, PolicyData, PolicyState, TrajectoryData, certainty_grid, curve_csv, learning_curve, policy,
    snapshot_frame, trajectories, write_atomic,
};
use insight::store::{LOG_FILE, RunLog, policy_to_toml, run_to_toml};

/// One seed's results.
pub(super) struct SeedResult {
    pub(super) learned: Learned,
    pub(super) tested: TestRun,
    pub(super) summary: Summary,
    /// Every step, of a run of one seed.
    pub(super) log: Option<RunLog>,
}

/// A folder for one run, of one seed or many.
pub(super) struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Creates the folder and writes `run.toml`, so that a folder that cannot be written is known before learning.
    pub(super) fn create(path: &Path, plan: &Plan, members: &[Member], seed: u64) -> Result<Self> {
        create(path)?;
        write_atomic(&path.join("run.toml"), run_to_toml(plan, members, seed)?.as_bytes())?;
        Ok(Self { path: path.to_owned() })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Of many seeds, each has its folder.
    fn of_seed(&self, seed: u64, many: bool) -> Result<PathBuf> {
        let folder = if many { self.path.join(seed.to_string()) } else { self.path.clone() };
        create(&folder)?;
        Ok(folder)
    }

    /// Writes the log of a seed as soon as it is done, so that no more of them are in memory than threads.
    pub(super) fn keep_log(&self, plan: &Plan, seed: u64, log: &RunLog, many: bool) -> Result<()> {
        write_log(&self.of_seed(seed, many)?, plan, &[], seed, log)
    }

    /// Writes what there is of a seed that a failure ended: its policy and its steps, not tested.
    pub(super) fn keep(&self, plan: &Plan, learned: &Learned, log: &RunLog, many: bool) -> Result<PathBuf> {
        let folder = self.of_seed(learned.seed, many)?;
        write_atomic(&folder.join("run.toml"), run_to_toml(plan, &[], learned.seed)?.as_bytes())?;
        write_log(&folder, plan, &[], learned.seed, log)?;
        let path = folder.join("policy.toml");
        write_atomic(&path, policy_text(plan, learned)?.as_bytes())?;
        // Of an older run in the same folder.
        match std::fs::remove_file(folder.join("summary.json")) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(Box::new(Diagnostic::disk("remove the old", &folder.join("summary.json"), &error)))
            }
            _ => Ok(path),
        }
    }

    /// Writes the figures, the policy and the pictures; for many seeds, a folder for each and the spread above them.
    pub(super) fn write(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
        let [result] = results else { return self.write_many(plan, results, checked) };
        write_seed(&self.path, plan, result)?;
        draw_curve(&self.path, plan, &[result])?;
        draw_seed(&self.path, plan, result)?;
        write_page(&self.path, plan, std::slice::from_ref(result), checked)
    }

    fn write_many(&self, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
        let spread = Spread::new(results.iter().map(|result| result.summary.clone()).collect());
        write_json(&self.path.join("summary.json"), &spread)?;
        for result in results {
            let folder = self.path.join(result.summary.seed.to_string());
            create(&folder)?;
            write_atomic(&folder.join("run.toml"), run_to_toml(plan, &[], result.summary.seed)?.as_bytes())?;
            write_seed(&folder, plan, result)?;
        }
        draw_curve(&self.path, plan, &results.iter().collect::<Vec<_>>())?;
        // The seed that fails most in its test is the one to look at.
        let worst =
            results.iter().max_by(|a, b| a.summary.test.failures_per_1000.total_cmp(&b.summary.test.failures_per_1000));
        match worst {
            Some(worst) => draw_seed(&self.path.join(worst.summary.seed.to_string()), plan, worst)?,
            None => return Ok(()),
        }
        write_page(&self.path, plan, results, checked)
    }
}

/// A folder for a test.
pub(super) struct TestFolder {
    path: PathBuf,
}

impl TestFolder {
    pub(super) fn create(path: &Path) -> Result<Self> {
        create(path)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Writes the figures and the pictures; the map is missing for a laser that looks down.
    pub(super) fn write(&self, plan: &Plan, tested: &TestRun, map: Option<&CertaintyGrid>) -> Result<()> {
        write_json(&self.path.join("test.json"), &tested.figures)?;
        let title = format!("{} in {}: test of the frozen policy", plan.behaviour.name(), plan.layout.name);
        draw_trails(&self.path, plan, &title, &[("first 800 steps", &tested.trail)])?;
        if let Some(map) = map {
            let title = format!("{} in {}: what the laser found", plan.behaviour.name(), plan.layout.name);
            let (columns, cell_m, origin_m) = (map.columns(), map.cell_m(), map.origin_m());
            certainty_grid(&title, &map.greys(), columns, cell_m, origin_m, &tested.trail)?
                .write(&self.path, "certainty-grid")?;
        }
        draw_frame(&self.path, plan, tested)
    }
}

pub(super) fn create(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path).map_err(|error| Box::new(Diagnostic::disk("create the folder", path, &error)))
}

pub(super) fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("cannot write '{}': {error}", path.display()))))?;
    text.push('\n');
    write_atomic(path, text.as_bytes())
}

fn write_seed(folder: &Path, plan: &Plan, result: &SeedResult) -> Result<()> {
    write_json(&folder.join("summary.json"), &result.summary)?;
    let rules = plan.rule_names();
    let mut step = 0;
    let tally = &result.learned.tally;
    let rows: Vec<CurveRow> = (tally.windows.iter().enumerate())
        .map(|(index, window)| {
            step += window.steps;
            CurveRow { step, reinforcement: window.reinforcement, by_rule: tally.by_rule(index).to_vec() }
        })
        .collect();
    write_atomic(&folder.join("curve.csv"), curve_csv(WINDOW_STEPS, &rules, &rows).as_bytes())?;
    let table = policy_text(plan, &result.learned)?;
    write_atomic(&folder.join("policy.toml"), table.as_bytes())
}

/// Writes `log.bin`, which names the run that it belongs to.
pub(super) fn write_log(folder: &Path, plan: &Plan, members: &[Member], seed: u64, log: &RunLog) -> Result<()> {
    let run = run_to_toml(plan, members, seed)?;
    write_atomic(&folder.join(LOG_FILE), &log.to_bytes(plan, seed, &run)?)
}

fn policy_text(plan: &Plan, learned: &Learned) -> Result<String> {
    policy_to_toml(plan.behaviour.name(), &plan.settings, &plan.filters, &learned.policy)
}

fn draw_curve(folder: &Path, plan: &Plan, results: &[&SeedResult]) -> Result<()> {
    let curves: Vec<Vec<f64>> = results.iter().map(|result| result.summary.reinforcement_per_400.clone()).collect();
    let learned_at = match results {
        [result] => result.summary.learned_at,
        _ => Spread::new(results.iter().map(|result| result.summary.clone()).collect()).median.learned_at,
    };
    let seeds = match results {
        [result] => format!("seed {}", result.summary.seed),
        _ => format!("{} seeds", results.len()),
    };
    let title = format!("{} in {}, {seeds}", plan.behaviour.name(), plan.layout.name);
    learning_curve(&CurveData { title: &title, window_steps: WINDOW_STEPS, curves: &curves, learned_at })?
        .write(folder, "learning-curve")
}

fn draw_seed(folder: &Path, plan: &Plan, result: &SeedResult) -> Result<()> {
    let (name, world) = (plan.behaviour.name(), &plan.layout.name);
    let title = format!("{name} in {world}, seed {}", result.summary.seed);
    let panels =
        [("learning: first 400 steps", &result.learned.early), ("test: first 800 steps", &result.tested.trail)];
    draw_trails(folder, plan, &title, &panels)?;
    draw_frame(folder, plan, &result.tested)?;
    draw_policy(folder, plan, result)
}

pub(super) fn draw_trails(folder: &Path, plan: &Plan, title: &str, panels: &[(&str, &Trail)]) -> Result<()> {
    let route: Option<Vec<Point2>> = plan.layout.lap.map(|lap| plan.layout.routes[lap].points().to_vec());
    let parts = plan.layout.scene.parts();
    trajectories(&TrajectoryData { title, parts, route: route.as_deref(), panels })?.write(folder, "trajectories")
}

pub(super) fn draw_frame(folder: &Path, plan: &Plan, tested: &TestRun) -> Result<()> {
    let title = format!("{} in {}: what the robot sees", plan.behaviour.name(), plan.layout.name);
    snapshot_frame(&title, &tested.snapshot)?.write(folder, "frame")
}

fn draw_policy(folder: &Path, plan: &Plan, result: &SeedResult) -> Result<()> {
    let grid = plan.grid()?;
    let (rows, columns) = grid.size();
    let learned = &result.learned.policy;
    let state = |(state, row): (usize, &Option<engine::learner::PolicyRow>)| {
        let row = row.as_ref()?;
        let (best, value) = learned.best(state)?;
        let best = plan.settings.actions[best];
        Some(PolicyState { state, cells: grid.cells(state), visits: row.visits, best, value })
    };
    let states: Vec<PolicyState> = learned.rows().iter().enumerate().filter_map(state).collect();
    let title = format!("{}, seed {}: best action of each state", plan.behaviour.name(), result.summary.seed);
    policy(&PolicyData { title: &title, rows, columns, states: &states })?.write(folder, "policy")
}
