//! Which states want another action: by majority of the seeds of a run.

use std::collections::BTreeMap;

use serde::Serialize;

use super::side::Side;

/// States that are kept.
const MOST_STATES: usize = 60;

/// Fewer seeds say nothing of what seeds agree on.
const FEW_SEEDS: usize = 3;

/// A run's states held against those of the first run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateComparison {
    /// Why the states cannot be compared; null if they can.
    pub unlike: Option<String>,
    /// States that both runs met.
    pub both_met: usize,
    /// How many of them want another action.
    pub differ: usize,
    /// In how many of these three seeds or more met the state and more than half of them agree, on both sides.
    pub clear: usize,
    /// Those that differ, the clear ones first, of these the most visited; 60 at most.
    pub states: Vec<ComparedState>,
}

/// A state whose best action is another one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedState {
    /// Its number.
    pub state: usize,
    /// What it stands for, in words.
    pub text: String,
    /// Rows and columns, and which cells are filled, row by row from the top left; null if it is no pattern of cells.
    pub cells: Option<(usize, usize, Vec<bool>)>,
    /// What the first run does.
    pub before: StateChoice,
    /// What this run does.
    pub after: StateChoice,
}

/// What the seeds of a run do in a state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StateChoice {
    /// Forward speed, m/s, and turning speed, rad/s, of the action that most seeds hold for the best.
    pub motion: [f64; 2],
    /// How many seeds do.
    pub seeds: usize,
    /// How many seeds met the state.
    pub met: usize,
    /// Visits of all seeds together.
    pub visits: u64,
}

/// Of one state: visits, and how many seeds hold each action for the best.
#[derive(Default)]
struct Votes {
    visits: u64,
    by_action: BTreeMap<usize, usize>,
}

impl StateComparison {
    pub(super) fn new(first: &Side, other: &Side) -> Self {
        let nothing = |unlike: &str| Self {
            unlike: Some(unlike.to_owned()),
            both_met: 0,
            differ: 0,
            clear: 0,
            states: Vec::new(),
        };
        let (a, b) = (&first.plan.settings, &other.plan.settings);
        if !first.plan.learns() || !other.plan.learns() {
            return nothing("one of the runs combines policies: it has no table of its own");
        }
        let grids = |side: &Side| side.plan.settings.views().map(|view| view.grid.clone()).collect::<Vec<_>>();
        if grids(first) != grids(other) {
            return nothing("the grids differ, so the states have other meanings");
        }
        if a.state != b.state || a.stages != b.stages {
            return nothing("the parts of the states differ, so these have other meanings");
        }
        let (Ok(map), [own, others]) = (first.plan.state_map(), [first, other].map(votes)) else {
            return nothing("the grid of these runs cannot be made");
        };
        let both = own.iter().filter_map(|(state, votes)| Some((*state, votes, others.get(state)?)));
        let (mut both_met, mut states) = (0, Vec::new());
        for (state, before, after) in both {
            both_met += 1;
            let choice = |votes: &Votes, side: &Side| votes.choice(side);
            if let (Some(before), Some(after)) = (choice(before, first), choice(after, other))
                && before.motion != after.motion
            {
                let described = map.describe(state);
                let cells = described.cells.map(|cells| (cells.rows, cells.columns, cells.filled));
                states.push(ComparedState { state, text: described.text, cells, before, after });
            }
        }
        let differ = states.len();
        let clear = states.iter().filter(|state: &&ComparedState| state.is_clear()).count();
        states.sort_by_key(|state| std::cmp::Reverse((state.is_clear(), state.before.visits + state.after.visits)));
        states.truncate(MOST_STATES);
        Self { unlike: None, both_met, differ, clear, states }
    }
}

impl ComparedState {
    /// Whether at least three seeds met it and more than half of these agree, on both sides: else seeds of one run differ as
    /// much.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        [&self.before, &self.after].iter().all(|choice| choice.met >= FEW_SEEDS && 2 * choice.seeds > choice.met)
    }
}

fn votes(side: &Side) -> BTreeMap<usize, Votes> {
    let mut all: BTreeMap<usize, Votes> = BTreeMap::new();
    for policy in side.seeds.iter().filter_map(|seed| seed.policy.as_ref()) {
        for (state, row) in policy.rows().filter(|(_, row)| row.visits > 0) {
            if let Some((action, _)) = policy.best(state) {
                let votes = all.entry(state).or_default();
                votes.visits += row.visits;
                *votes.by_action.entry(action).or_default() += 1;
            }
        }
    }
    all
}

impl Votes {
    /// What most seeds do; of equals the first in the order of the actions.
    fn choice(&self, side: &Side) -> Option<StateChoice> {
        let best = self.by_action.iter().fold(None, |best: Option<(usize, usize)>, (action, seeds)| match best {
            Some((_, most)) if most >= *seeds => best,
            _ => Some((*action, *seeds)),
        });
        let (action, seeds) = best?;
        let twist = side.plan.settings.actions.get(action)?;
        let motion = [twist.linear_m_per_s, twist.angular_rad_per_s];
        Some(StateChoice { motion, seeds, met: self.by_action.values().sum(), visits: self.visits })
    }
}
