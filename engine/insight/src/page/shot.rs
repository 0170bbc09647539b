//! One moment in pictures: what the camera saw at the end of a step, what each filter and the grid made of it, and why the
//! step was rewarded.

use serde::Serialize;

use super::picture::data_address;
use super::track::MOST_PLAYED;
use engine::diagnostic::Result;
use engine::experiment::{Ledger, Phase, Plan, Playback, Recall, SeenView, Snapshot, StepReasons};

/// Of the steps behind a value a moment names so many.
const MOST_TRIES: usize = 8;

/// One moment.
#[derive(Debug, Clone, Serialize)]
pub struct Shot {
    /// The seed.
    pub seed: u64,
    /// `learning` or `test`.
    pub phase: &'static str,
    /// The step's number, from 0; the pictures are those at its end, before any recovery.
    pub step: usize,
    /// Pixels in a row of every picture, and rows.
    pub size_px: [usize; 2],
    /// The camera's image, then each filter's, in order.
    pub stages: Vec<StagePicture>,
    /// The grid of each view.
    pub grids: Vec<ShownGrid>,
    /// The state.
    pub state: usize,
    /// Why the step was rewarded as it was.
    pub reasons: StepReasons,
    /// Every range of the laser, millimetres; only on demand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan_mm: Option<Vec<u32>>,
}

/// A grid with what lay in its cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownGrid {
    /// The view's name; null if it has none.
    pub view: Option<String>,
    /// Rows and columns.
    pub size: [usize; 2],
    /// Share of foreground of each cell, row by row from the top left, 0 to 1.
    pub shares: Vec<f32>,
    /// Whether each cell has enough foreground.
    pub occupied: Vec<bool>,
    /// Whether each cell counts as filled in the grid's number.
    pub filled: Vec<bool>,
    /// The number of this grid alone.
    pub number: usize,
}

impl From<SeenView> for ShownGrid {
    fn from(seen: SeenView) -> Self {
        let SeenView { name, grid, shares, occupied, filled, number, .. } = seen;
        let thousandths = |share: f32| (share * 1000.0).round() / 1000.0;
        let shares = shares.into_iter().map(thousandths).collect();
        Self { view: name, size: [grid.0, grid.1], shares, occupied, filled, number }
    }
}

/// One picture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StagePicture {
    /// `camera`, or the filter's name.
    pub name: String,
    /// A `data:` address.
    pub picture: String,
}

/// Makes shots of one recorded phase.
pub struct ShotMaker<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// The seed.
    pub seed: u64,
    /// The phase.
    pub phase: Phase,
}

impl ShotMaker<'_> {
    /// The moment that a playback has come to, with the reasons of the step that led there.
    ///
    /// # Errors
    /// If a picture cannot be encoded.
    pub fn shot(&self, playback: &Playback<'_>, reasons: StepReasons) -> Result<Shot> {
        let value = reasons.value.map(|value| value.brief(MOST_TRIES));
        let reasons = StepReasons { value, ..reasons };
        let cycle = playback.cycle();
        let Snapshot { image, views, state } = Snapshot::of(cycle);
        let size_px = (image.width_px, image.height_px);
        let camera = data_address(&image.pixels, size_px, image.format)?;
        let mut stages = vec![StagePicture { name: "camera".to_owned(), picture: camera }];
        for stage in cycle.stages() {
            let picture = data_address(stage.pixels, size_px, stage.filter.writes)?;
            stages.push(StagePicture { name: stage.name(), picture });
        }
        Ok(Shot {
            seed: self.seed,
            phase: name(self.phase),
            step: reasons.step,
            size_px: [size_px.0, size_px.1],
            stages,
            grids: views.into_iter().map(ShownGrid::from).collect(),
            state,
            reasons,
            scan_mm: None,
        })
    }
}

impl Shot {
    /// Its approximate size in the page, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        1500 + self.stages.iter().map(|stage| stage.picture.len()).sum::<usize>()
    }
}

/// One moment of a recorded phase, with the whole scan; nothing if there is no such step. What was learned is told of by the
/// steps of learning.
///
/// # Errors
/// If the phase cannot be played.
pub fn shot_of(
    plan: &Plan,
    seed: u64,
    [learning, test]: [&Ledger; 2],
    phase: Phase,
    step: usize,
) -> Result<Option<Shot>> {
    let ledger = if phase == Phase::Learning { learning } else { test };
    if step >= ledger.len() {
        return Ok(None);
    }
    let mut playback = Playback::new(plan, seed, phase, ledger)?;
    playback = match phase {
        Phase::Learning => playback.recalling()?,
        Phase::Test => playback.with_recall(recall_of(plan, seed, learning)?),
    };
    playback.seek(step)?;
    let Some(reasons) = StepReasons::of_next(&mut playback)? else { return Ok(None) };
    let ranges_m = &playback.cycle().observation().scan.ranges_m;
    let scan_mm = ranges_m.iter().map(|range_m| (range_m * 1000.0).round() as u32).collect();
    let shot = ShotMaker { plan, seed, phase }.shot(&playback, reasons)?;
    Ok(Some(Shot { scan_mm: Some(scan_mm), ..shot }))
}

/// What a learner that remembers its steps had learned at the end of the recorded steps of learning, if these are not very
/// many.
///
/// # Errors
/// If the steps cannot be played.
pub fn recall_of(plan: &Plan, seed: u64, learning: &Ledger) -> Result<Option<Recall>> {
    if learning.is_empty() || learning.len() > MOST_PLAYED {
        return Ok(None);
    }
    Playback::new(plan, seed, Phase::Learning, learning)?.recalling()?.into_recall()
}

/// The phase's name in the contract.
pub(super) fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Learning => "learning",
        Phase::Test => "test",
    }
}
