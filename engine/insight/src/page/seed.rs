//! One seed as the page shows it: curve, policy, figures, and its steps.

use serde::Serialize;

use super::shot::Shot;
use super::track::{Moments, ScanShape, Track, TrackSource};
use engine::diagnostic::Result;
use engine::experiment::{Ledger, Phase, Plan, Tally, ValueReasons};
use engine::learner::Policy;
use engine::verdict::{BaseLines, ConditionVerdict, SuccessVerdict, TestFigures};

use crate::verdict_words::{figures, headline};

/// The most states of a seed in a document.
const MOST_STATES: usize = 256;
/// Of the steps behind a state's value so many are named.
const MOST_TRIES: usize = 8;

/// What is known about a seed.
#[derive(Debug, Clone, Copy)]
pub struct SeedData<'a> {
    /// The seed.
    pub seed: u64,
    /// What was counted while learning; `None` for a behaviour that combines policies.
    pub tally: Option<&'a Tally>,
    /// What was learned.
    pub policy: Option<&'a Policy>,
    /// The test's figures, once it is done.
    pub test: Option<&'a TestFigures>,
    /// What it is held against.
    pub lines: Option<&'a BaseLines>,
    /// Steps of learning.
    pub learning: &'a Ledger,
    /// Steps of the test.
    pub tested: &'a Ledger,
}

/// One seed.
#[derive(Debug, Clone, Serialize)]
pub struct SeedView {
    /// The seed.
    pub seed: u64,
    /// Whether the page begins with it.
    pub shown_first: bool,
    /// Whether its steps are at hand.
    #[serde(skip)]
    pub brings_steps: bool,
    /// The first step from which four windows in a row are good.
    pub learned_at: Option<u64>,
    /// Whether the script says anything by which that can be told.
    pub tells_learning: bool,
    /// Reinforcement of each window.
    pub curve: Vec<f64>,
    /// What each rule added, window by window; empty for a seed without steps.
    pub by_rule: Vec<Vec<f64>>,
    /// The test's figures.
    pub test: Option<TestFigures>,
    /// Whether the test is a success, in words; null until it is done.
    pub verdict: Option<VerdictView>,
    /// How many states were met.
    pub states_met: usize,
    /// The states that were met, by number; if there are very many, the most visited.
    pub states: Vec<StateRow>,
    /// Steps of learning; null if this document leaves them out.
    pub learning: Option<Track>,
    /// Steps of the test; null if this document leaves them out, or the test is not done.
    pub tested: Option<Track>,
}

/// A verdict in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerdictView {
    /// Null where it cannot be told.
    pub success: Option<bool>,
    /// Whether, and why.
    pub text: String,
    /// Each condition: its name, what must hold, whether it does, and by which figures.
    pub conditions: Vec<ConditionView>,
}

/// A condition of success in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionView {
    /// Its name.
    pub name: String,
    /// What must hold.
    pub condition: String,
    /// Whether it does.
    pub holds: bool,
    /// Its figures beside those of a robot that knows nothing.
    pub figures: String,
}

impl From<&SuccessVerdict> for VerdictView {
    fn from(verdict: &SuccessVerdict) -> Self {
        let condition = |condition: &ConditionVerdict| ConditionView {
            name: condition.name.clone(),
            condition: condition.condition.clone(),
            holds: condition.holds,
            figures: figures(condition),
        };
        Self {
            success: verdict.success,
            text: headline(verdict),
            conditions: verdict.conditions.iter().map(condition).collect(),
        }
    }
}

/// One state of the learned table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateRow {
    /// Its number.
    pub state: usize,
    /// Its cells, `1` for filled, row by row from the top left.
    pub cells: String,
    /// What it stands for, in words; absent where the cells say it all.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub text: String,
    /// How often it was visited.
    pub visits: u64,
    /// The best action.
    pub best: usize,
    /// Its value.
    pub value: f64,
    /// The value of each action; empty for a seed without steps.
    pub values: Vec<f64>,
    /// Why the best action has its value at the end of learning; absent where that is not known, as of a table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<ValueReasons>,
}

impl SeedView {
    /// A seed without its steps.
    ///
    /// # Errors
    /// If the grid cannot be made.
    pub fn new(plan: &Plan, data: &SeedData<'_>) -> Result<Self> {
        let curve = data.tally.map_or_else(Vec::new, Tally::curve);
        let brings_steps = !data.learning.is_empty();
        let windows = 0..if brings_steps { curve.len() } else { 0 };
        Ok(Self {
            seed: data.seed,
            shown_first: false,
            brings_steps: brings_steps || !data.tested.is_empty(),
            learned_at: data.tally.and_then(|tally| plan.success().learned_at(&tally.counts())),
            tells_learning: plan.success().tells_learning(),
            by_rule: data.tally.map_or_else(Vec::new, |tally| windows.map(|at| by_rule(plan, tally, at)).collect()),
            curve,
            test: data.test.cloned(),
            verdict: data
                .test
                .zip(data.lines)
                .map(|(test, lines)| VerdictView::from(&plan.success().verdict(test, lines))),
            states_met: data.policy.map_or(0, |policy| policy.states_met()),
            states: data.policy.map_or(Ok(Vec::new()), |policy| states(plan, policy, brings_steps))?,
            learning: None,
            tested: None,
        })
    }

    /// Adds the steps of both phases; the moments with pictures come back.
    ///
    /// # Errors
    /// If a recorded step cannot be played again.
    pub fn add_tracks(
        &mut self,
        plan: &Plan,
        data: &SeedData<'_>,
        unit_m: f64,
        scan: ScanShape,
        moments: Moments,
    ) -> Result<Vec<Shot>> {
        let source = |phase, ledger| TrackSource { plan, seed: data.seed, phase, ledger, unit_m, scan };
        let (mut shots, mut recall) = (Vec::new(), None);
        if !data.learning.is_empty() {
            let (track, made) = source(Phase::Learning, data.learning).track(moments, &mut recall)?;
            self.learning = Some(track);
            for row in &mut self.states {
                let why = recall.as_ref().and_then(|recall| recall.of([row.state, row.best]));
                row.why = why.map(|why| why.brief(MOST_TRIES));
            }
            shots.extend(made);
        }
        if !data.tested.is_empty() {
            let (track, made) = source(Phase::Test, data.tested).track(moments, &mut recall)?;
            self.tested = Some(track);
            shots.extend(made);
        }
        Ok(shots)
    }

    /// Approximate size of the steps in the page, bytes.
    pub(super) fn bytes(&self) -> usize {
        [&self.learning, &self.tested].into_iter().flatten().map(Track::bytes).sum()
    }
}

/// What the plan's own rules added in a window; those that only earlier legs had follow them and are left out.
fn by_rule(plan: &Plan, tally: &Tally, window: usize) -> Vec<f64> {
    tally.by_rule(window).iter().take(plan.behaviour.rules().len()).copied().collect()
}

fn states(plan: &Plan, policy: &Policy, with_values: bool) -> Result<Vec<StateRow>> {
    let map = plan.state_map()?;
    let visits = policy.rows().map(|(state, row)| (state, row.visits));
    let mut met: Vec<(usize, u64)> = visits.filter(|(_, visits)| *visits > 0).collect();
    met.sort_by_key(|(state, visits)| (std::cmp::Reverse(*visits), *state));
    met.truncate(MOST_STATES);
    met.sort_unstable();
    let rounded = |value: f64| (value * 1e4).round() / 1e4;
    let rows = met.into_iter().filter_map(|(state, visits)| {
        let (row, (best, value)) = (policy.row(state)?, policy.best(state)?);
        let described = map.describe(state);
        let filled = described.cells.map_or_else(Vec::new, |cells| cells.filled);
        let text = if plan.settings.has_parts() { described.text } else { String::new() };
        let cells = filled.iter().map(|filled| if *filled { '1' } else { '0' }).collect();
        let values = if with_values { row.values.iter().copied().map(rounded).collect() } else { Vec::new() };
        Some(StateRow { state, cells, text, visits, best, value: rounded(value), values, why: None })
    });
    Ok(rows.collect())
}
