//! The pictures of a run: curve, paths, frame, policy.

use std::path::Path;

use super::SeedResult;
use super::pages::failures;
use crate::page::median_seed;
use crate::report::{
    CurveData, PathsData, PolicyData, PolicyState, TrajectoryData, WorldPanel, WorldPlan, learning_curve, paths,
    policy, snapshot_frame, trajectories, world_trajectories,
};
use engine::diagnostic::Result;
use engine::experiment::{Learned, Plan, Spread, TestRun, Trail, WINDOW_STEPS};
use engine::learner::PolicyRow;

/// The pictures that a run's folder may hold, without their endings.
pub(super) const PICTURES: [&str; 5] = ["learning-curve", "paths", "trajectories", "policy", "frame"];

pub(super) fn draw_curve(folder: &Path, plan: &Plan, results: &[SeedResult]) -> Result<()> {
    let summary = |result: &SeedResult| result.run.summary.clone();
    let curves: Vec<Vec<f64>> = results.iter().map(|result| summary(result).reinforcement_per_400).collect();
    let (learned_at, seeds) = match results {
        [result] => (result.run.summary.learned_at, format!("seed {}", result.run.summary.seed)),
        _ => (Spread::new(results.iter().map(summary).collect()).median.learned_at, format!("{} seeds", results.len())),
    };
    let title = format!("{} in {}, {seeds}", plan.behaviour.name(), plan.worlds.title());
    learning_curve(&CurveData { title: &title, window_steps: WINDOW_STEPS, curves: &curves, learned_at })?
        .write(folder, "learning-curve")
}

pub(super) fn draw_seed(folder: &Path, plan: &Plan, result: &SeedResult) -> Result<()> {
    let seed = result.run.summary.seed;
    let title = format!("{} in {}, seed {seed}", plan.behaviour.name(), plan.worlds.title());
    let trail = &result.run.tested.trail;
    let tested = ("test: first 800 steps", trail);
    let several = !plan.worlds.further().is_empty();
    if several {
        draw_worlds(folder, plan, &format!("{title}: the first 800 steps of the test in each world"), trail)?;
    }
    match &result.run.learned {
        Some(learned) if several => draw_policy(folder, plan, learned)?,
        None if several => {}
        Some(learned) => {
            draw_trails(folder, plan, &title, &[("learning: first 400 steps", &learned.early), tested])?;
            draw_policy(folder, plan, learned)?;
        }
        None => draw_trails(folder, plan, &title, &[tested])?,
    }
    draw_frame(folder, plan, &result.run.tested)
}

/// Draws the paths in each of several worlds.
pub(super) fn draw_worlds(folder: &Path, plan: &Plan, title: &str, trail: &Trail) -> Result<()> {
    let plans: Vec<Plan> = (0..plan.worlds.layouts().len()).map(|world| plan.in_world(world)).collect();
    let panel = |(world, plan)| -> WorldPanel<'_> {
        let plan: &Plan = plan;
        let path = trail.in_world(world).filter(|path| path.steps() > 0);
        let steps = path.map_or_else(|| "never there".to_owned(), |path| format!("{} steps", path.steps()));
        WorldPanel { name: format!("{}: {steps}", plan.layout.name), world: WorldPlan::of(plan), path }
    };
    let panels: Vec<WorldPanel<'_>> = plans.iter().enumerate().map(panel).collect();
    world_trajectories(title, &panels)?.write(folder, "trajectories")
}

/// Draws panels of the world from above.
pub(super) fn draw_trails(folder: &Path, plan: &Plan, title: &str, panels: &[(&str, &Trail)]) -> Result<()> {
    trajectories(&TrajectoryData { title, world: &WorldPlan::of(plan), panels })?.write(folder, "trajectories")
}

/// Draws the test's path of every seed, the median one strong.
pub(super) fn draw_paths(folder: &Path, plan: &Plan, results: &[SeedResult]) -> Result<()> {
    let Some(median) = median_seed(&failures(results), |_| true) else { return Ok(()) };
    let trails: Vec<&Trail> = results.iter().map(|result| &result.run.tested.trail).collect();
    let own = if plan.worlds.further().is_empty() { String::new() } else { format!(", those in {}", plan.layout.name) };
    let title = format!(
        "{} in {}, {} seeds: first 800 steps of the test{own}",
        plan.behaviour.name(),
        plan.worlds.title(),
        results.len()
    );
    let strong = (median, results[median].run.summary.seed);
    paths(&PathsData { title: &title, world: &WorldPlan::of(plan), paths: &trails, strong })?.write(folder, "paths")
}

pub(super) fn draw_frame(folder: &Path, plan: &Plan, tested: &TestRun) -> Result<()> {
    if tested.snapshot.image.pixels.is_empty() {
        // A robot that is not asked for an image, and has no other.
        return Ok(());
    }
    let title = format!("{} in {}: what the robot sees", plan.behaviour.name(), plan.worlds.title());
    snapshot_frame(&title, &tested.snapshot)?.write(folder, "frame")
}

fn draw_policy(folder: &Path, plan: &Plan, learned: &Learned) -> Result<()> {
    let (map, (rows, columns)) = (plan.state_map()?, plan.drawn_grid()?);
    let policy_of = &learned.policy;
    let state = |(state, row): (usize, &PolicyRow)| {
        let (best, value) = policy_of.best(state)?;
        let best = plan.settings.actions[best];
        let cells = map.describe(state).cells.map_or_else(Vec::new, |cells| cells.filled);
        Some(PolicyState { state, cells, visits: row.visits, best, value })
    };
    let states: Vec<PolicyState> = policy_of.rows().filter(|(_, row)| row.visits > 0).filter_map(state).collect();
    let title = format!("{}, seed {}: best action of each state", plan.behaviour.name(), learned.seed);
    policy(&PolicyData { title: &title, rows, columns, states: &states })?.write(folder, "policy")
}
