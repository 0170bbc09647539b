//! Files of a run's folder that are read again: figures, curve, policy, log.

use std::path::Path;

use super::SeedResult;
use crate::disk::write_atomic;
use crate::report::{CurveRow, curve_csv, disagreements_csv};
use crate::store::{LOG_FILE, POLICY_FILE, RUN_FILE, SUMMARY_FILE, log_to_bytes, policy_to_toml, run_to_toml, settle};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Learned, Plan, RunLog, TestRun, WINDOW_STEPS};

/// Makes a folder and those above it.
///
/// # Errors
/// If one cannot be made.
pub fn create_folder(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path).map_err(|error| Box::new(Diagnostic::disk("create the folder", path, &error)))
}

/// Writes a value as JSON that people can read.
///
/// # Errors
/// If the file cannot be written.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("cannot write '{}': {error}", path.display()))))?;
    text.push('\n');
    write_atomic(path, text.as_bytes())
}

/// Writes `run.toml`, by which all other files of the folder name their run.
pub(super) fn write_run(folder: &Path, plan: &Plan, seed: u64) -> Result<()> {
    write_atomic(&folder.join(RUN_FILE), run_to_toml(plan, seed)?.as_bytes())
}

/// The file of the learning curve in a run's folder.
pub const CURVE_FILE: &str = "curve.csv";

/// The file of a combination in a run's folder: where its policies disagree.
pub const DISAGREEMENTS_FILE: &str = "disagreements.csv";

/// Writes `log.bin`; its segments were written while the robot learned.
pub(super) fn write_log(folder: &Path, plan: &Plan, seed: u64, log: &RunLog) -> Result<()> {
    let run = run_to_toml(plan, seed)?;
    let kept = settle(folder, log.learning.segments(), log.learning.shape().bytes())?;
    write_atomic(&folder.join(LOG_FILE), &log_to_bytes(log, plan, seed, &run, kept)?)
}

/// Writes `policy.toml`.
pub(super) fn write_policy(folder: &Path, plan: &Plan, learned: &Learned) -> Result<()> {
    let run = run_to_toml(plan, learned.seed)?;
    let text = policy_to_toml(plan, &learned.policy, Some(&run))?;
    write_atomic(&folder.join(POLICY_FILE), text.as_bytes())
}

/// Writes the figures of a seed, and its curve and policy or, if it combines policies, where they disagree.
pub(super) fn write_seed(folder: &Path, plan: &Plan, result: &SeedResult) -> Result<()> {
    write_json(&folder.join(SUMMARY_FILE), &result.run.summary)?;
    if let Some(table) = disagreements_of(plan, &result.run.tested) {
        write_atomic(&folder.join(DISAGREEMENTS_FILE), table.as_bytes())?;
    }
    let Some(learned) = &result.run.learned else { return Ok(()) };
    write_atomic(&folder.join(CURVE_FILE), curve_of(plan, learned).as_bytes())?;
    write_policy(folder, plan, learned)
}

/// What `disagreements.csv` holds; nothing of a test in which no policies were combined.
#[must_use]
pub fn disagreements_of(plan: &Plan, tested: &TestRun) -> Option<String> {
    let names: Vec<&str> = plan.members.iter().map(|member| member.name.as_str()).collect();
    let combination = tested.combination.as_ref()?;
    Some(disagreements_csv(&names, &plan.settings.actions, &combination.disagreements))
}

/// What `curve.csv` holds.
#[must_use]
pub fn curve_of(plan: &Plan, learned: &Learned) -> String {
    let (mut step, tally) = (0, &learned.tally);
    let rows: Vec<CurveRow> = (tally.windows.iter().enumerate())
        .map(|(index, window)| {
            step += window.steps;
            CurveRow { step, reinforcement: window.reinforcement, by_rule: tally.by_rule(index).to_vec() }
        })
        .collect();
    curve_csv(WINDOW_STEPS, &plan.rule_names(), &rows)
}
