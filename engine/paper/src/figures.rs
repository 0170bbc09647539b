//! The paper's figures, redrawn from our runs.

use std::sync::atomic::AtomicBool;

use super::campaign::{JobResult, Measured, Outcome};
use super::claims::{ALIASES, CORRIDOR, OBJECT, PLATFORM, WALL};
use super::job::Learn;
use engine::diagnostic::Result;
use engine::experiment::{
    CertaintyGrid, Cycle, Each, Overrides, Plan, Snapshot, Spread, Step, Trail, WINDOW_STEPS, test_and_watch,
};
use insight::report::{
    CurveData, Picture, TrajectoryData, WorldPlan, certainty_grid, learning_curve, snapshot_frame, trajectories,
};

/// Steps of the drive that the certainty grid is made from.
const MAP_STEPS: u64 = 1_500;

/// One picture of the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// A name without spaces.
    pub id: String,
    /// The row at the head of the group that it belongs to.
    pub beside: &'static str,
    /// The heading, such as "Figure 3".
    pub title: String,
    /// What it shows.
    pub caption: String,
    /// A whole SVG document.
    pub svg: String,
    /// Whether its greys and colours mean something, so that a dark page must not turn them round.
    pub is_photograph: bool,
}

/// Draws all figures whose jobs were done, in the order of the paper, and the states that look alike.
///
/// # Errors
/// If a picture cannot be drawn or a policy cannot be driven.
pub fn figures(measured: &Measured) -> Result<Vec<Figure>> {
    let mut all = Vec::new();
    let behaviours = [
        (WALL, "wall-learned", "wall following", 3),
        (CORRIDOR, "corridor-learned", "corridor following", 5),
        (PLATFORM, "platform-learned", "platform following", 7),
        (OBJECT, "object-learned", "object following", 9),
    ];
    if let Some(outcome) = richest(measured, WALL) {
        let picture = snapshot_frame("From image to state", &outcome.tested.snapshot)?;
        let caption = "The camera's image, its edges, and the grid of 3 x 3 cells that becomes the state. A cell above an \
                       occupied one counts as occupied.";
        all.push(figure("states", "figure-2", "Figure 2", caption, picture, true));
    }
    for (learn, beside, name, number) in behaviours {
        let Some((plan, outcome)) = typical(measured, learn) else { continue };
        let Some(job) = measured.job(learn) else { continue };
        all.push(curve(job, beside, name, number)?);
        all.push(paths(plan, outcome, beside, name, number + 1)?);
    }
    all.extend(map(measured)?);
    all.extend(alike(measured)?);
    Ok(all)
}

fn figure(beside: &'static str, id: &str, title: &str, caption: &str, picture: Picture, is_photograph: bool) -> Figure {
    Figure {
        beside,
        id: id.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        svg: picture.svg,
        is_photograph,
    }
}

/// The seed with the median failures in its test: neither the best nor the worst is typical.
fn typical(measured: &Measured, learn: Learn) -> Option<(&Plan, &Outcome)> {
    let job = measured.job(learn)?;
    let plan = job.plan.as_ref().ok()?;
    let mut outcomes: Vec<&Outcome> = job.outcomes.iter().collect();
    outcomes.sort_by_key(|outcome| (outcome.tested.figures.failures, outcome.summary.seed));
    Some((plan, *outcomes.get(outcomes.len() / 2)?))
}

/// The seed whose one kept frame has the most occupied cells, since an empty frame shows nothing.
fn richest(measured: &Measured, learn: Learn) -> Option<&Outcome> {
    let occupied = |outcome: &&Outcome| {
        outcome.tested.snapshot.views.iter().flat_map(|view| &view.occupied).filter(|cell| **cell).count()
    };
    measured.job(learn)?.outcomes.iter().rev().max_by_key(occupied)
}

fn curve(job: &JobResult, beside: &'static str, name: &str, number: u32) -> Result<Figure> {
    let summaries: Vec<_> = job.outcomes.iter().map(|outcome| outcome.summary.clone()).collect();
    let curves: Vec<Vec<f64>> = summaries.iter().map(|summary| summary.reinforcement_per_400.clone()).collect();
    let learned_at = Spread::new(summaries).median.learned_at;
    let title = format!("Learning of {name}");
    let picture =
        learning_curve(&CurveData { title: &title, window_steps: WINDOW_STEPS, curves: &curves, learned_at })?;
    let caption =
        format!("Reinforcement accumulated while learning {name}, {} seeds. The paper draws one run.", curves.len());
    Ok(figure(beside, &format!("figure-{number}"), &format!("Figure {number}"), &caption, picture, false))
}

fn paths(plan: &Plan, outcome: &Outcome, beside: &'static str, name: &str, number: u32) -> Result<Figure> {
    let panels: [(&str, &Trail); 2] =
        [("a) first 400 steps of learning", &outcome.early), ("b) test: 800 steps", &outcome.tested.trail)];
    let title = format!("Paths of {name}");
    let picture = trajectories(&TrajectoryData { title: &title, world: &WorldPlan::of(plan), panels: &panels })?;
    let prey = if plan.layout.movers.is_empty() { "" } else { " The dashed line is the prey's path." };
    let caption = format!(
        "Seed {}, the one with the median failures in its test. Crosses are failures, small dots where recovery put the \
         robot.{prey}",
        outcome.summary.seed
    );
    Ok(figure(beside, &format!("figure-{number}"), &format!("Figure {number}"), &caption, picture, false))
}

fn map(measured: &Measured) -> Result<Option<Figure>> {
    let Some((plan, outcome)) = typical(measured, WALL) else { return Ok(None) };
    let steps = if measured.options.quick { 200 } else { MAP_STEPS };
    let elsewhere = |world: Option<&str>| {
        let world = world.map(str::to_owned);
        plan.clone().with_changes(&Overrides { world, test_steps: Some(steps), ..Overrides::default() })
    };
    let (plan, place) = match elsewhere(Some("hallway")) {
        Ok(plan) => (plan, "a hallway that it never saw while learning"),
        Err(_) => (elsewhere(None)?, "the room that it learned in, for want of a hallway"),
    };
    let Some(mut grid) = CertaintyGrid::new(&plan.layout, &plan.settings.laser) else { return Ok(None) };
    let never = AtomicBool::new(false);
    let seed = outcome.summary.seed;
    let tested = test_and_watch(&plan, &outcome.policy, seed, &never, &mut grid)?;
    let title = "Certainty grid of wall following";
    let picture = certainty_grid(title, &grid.greys(), grid.columns(), grid.cell_m(), grid.origin_m(), &tested.trail)?;
    let caption = format!(
        "Seed {seed} in {place}: white is free, black occupied, grey unknown, from the laser while the frozen policy \
         drives {steps} steps. A simulated robot; the paper's was real."
    );
    Ok(Some(figure("hallway", "figure-11", "Figure 11", &caption, picture, true)))
}

/// Two frames of one state that went on differently under the same action.
fn alike(measured: &Measured) -> Result<Vec<Figure>> {
    let Some(job) = measured.job(WALL) else { return Ok(Vec::new()) };
    let Some(at) = job.trials.iter().position(|(trial, _)| *trial == ALIASES) else { return Ok(Vec::new()) };
    let twins = |outcome: &Outcome| outcome.trials[at].as_ref().and_then(|(_, seen)| seen.twins);
    let least = (job.outcomes.iter())
        .filter_map(|outcome| Some((outcome, twins(outcome)?)))
        .min_by(|(_, a), (_, b)| a.agreement.total_cmp(&b.agreement));
    let (Some((outcome, twins)), (_, Ok(plan))) = (least, &job.trials[at]) else { return Ok(Vec::new()) };
    let mut taken = Vec::new();
    let never = AtomicBool::new(false);
    let mut take = Each(|cycle: &Cycle<_>, step: &Step| {
        if twins.frames.contains(&step.index) {
            taken.push(Snapshot::of(cycle));
        }
    });
    test_and_watch(plan, &outcome.policy, outcome.summary.seed, &never, &mut take)?;
    let action = plan.settings.actions[twins.action];
    let mut all = Vec::new();
    for (index, snapshot) in taken.iter().enumerate() {
        let letter = ["a", "b"][index.min(1)];
        let caption = format!(
            "State {}, action {} ({} m/s, {} rad/s) in both; state {} followed here. The commonest next state follows in \
             {:.0} % of such cases only: the grid cannot tell these situations apart. Seed {}.",
            twins.state,
            twins.action,
            action.linear_m_per_s,
            action.angular_rad_per_s,
            twins.next[index.min(1)],
            100.0 * twins.agreement,
            outcome.summary.seed
        );
        let picture = snapshot_frame(&format!("One state, two situations: {letter}"), snapshot)?;
        all.push(figure(
            "hallway",
            &format!("alike-{letter}"),
            &format!("States that look alike, {letter}"),
            &caption,
            picture,
            true,
        ));
    }
    Ok(all)
}
