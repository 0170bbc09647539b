//! What the robot saw before and after a step: drawn by `engine explain`, and drawn again by `engine replay --verify`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Phase, Plan, Playback, RunLog, SeenView, ViewStage};
use engine::robot::Robot;
use insight::folder::{ExplainedStep, Redrawn, Side};
use insight::report::{FrameData, FramePanel, Picture, frame};

/// Camera, each filter, grid, as the playback stands.
pub(super) fn draw_step(shown: ExplainedStep, playback: &Playback<'_>, side: Side) -> Result<Picture> {
    let (plan, cycle) = (playback.plan(), playback.cycle());
    let phase = match shown.phase {
        Phase::Learning => "learning",
        Phase::Test => "test",
    };
    let when = match side {
        Side::Before => "when it chose",
        Side::After => "at its end",
    };
    let behaviour = plan.behaviour.name();
    let title = format!("{behaviour}, step {} of {phase}: what the robot saw {when}", shown.step);
    let image = &cycle.robot().photograph().unwrap_or_else(|| cycle.observation().sight().clone());
    let mut panels = vec![FramePanel::image("camera", image)];
    panels.extend(cycle.observation().depth.iter().map(|depth| FramePanel::image("depth", depth)));
    let stages: Vec<ViewStage<'_>> = cycle.stages().collect();
    let names: Vec<String> = stages.iter().map(ViewStage::name).collect();
    panels.extend(stages.iter().zip(&names).map(|(stage, name)| FramePanel {
        name,
        format: stage.filter.writes,
        pixels: stage.pixels,
    }));
    let views: Vec<SeenView> = cycle.views().collect();
    frame(&FrameData {
        title: &title,
        width_px: image.width_px,
        height_px: image.height_px,
        panels: &panels,
        views: &views,
        state: cycle.state(),
    })
}

/// Draws again what a run's folder has of explained steps, and compares it byte for byte.
///
/// # Errors
/// If the folder cannot be read, or the run not be led so far.
pub(super) fn redraw_steps(folder: &Path, plan: &Plan, seed: u64, log: &RunLog) -> Result<Redrawn> {
    let mut redrawn = Redrawn::default();
    for shown in steps_in(folder)? {
        let ledger = match shown.phase {
            Phase::Learning => &log.learning,
            Phase::Test => &log.test,
        };
        let mut playback = Playback::new(plan, seed, shown.phase, ledger)?;
        let there = shown.step < ledger.len();
        if there {
            playback.seek(shown.step)?;
        }
        for side in [Side::Before, Side::After] {
            // A step that the run does not have was never drawn of it.
            let picture = if there { Some(draw_step(shown, &playback, side)?) } else { None };
            for (ending, drawn) in
                [("svg", picture.as_ref().map(|p| p.svg.as_bytes())), ("png", picture.as_ref().map(|p| &p.png[..]))]
            {
                let file = PathBuf::from(format!("{}.{ending}", shown.stem(side)));
                match std::fs::read(folder.join(&file)) {
                    Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
                    Ok(old) if drawn == Some(&old[..]) => redrawn.same += 1,
                    _ => redrawn.different.push(file),
                }
            }
            if there && side == Side::Before {
                playback.advance()?;
            }
        }
    }
    Ok(redrawn)
}

/// The steps that a folder has pictures of, in order.
fn steps_in(folder: &Path) -> Result<BTreeSet<ExplainedStep>> {
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("read the folder", folder, &error));
    let mut steps = BTreeSet::new();
    for entry in std::fs::read_dir(folder).map_err(disk)? {
        let name = entry.map_err(disk)?.file_name();
        steps.extend(name.to_str().and_then(ExplainedStep::of_file));
    }
    Ok(steps)
}
