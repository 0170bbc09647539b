//! The recorded runs that learning is to go on from.

use std::path::Path;
use std::sync::Arc;

use super::log::{LOG_FILE, RecordedRun};
use super::parts::{RUN_FILE, seed_folders};
use super::read_stored;
use super::run_file::{MOST_LEG_STEPS, StoredRun, TextEntry};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use engine::experiment::{Origin, Plan};
use engine::filter::Catalogue;
use engine::learner::Carry;
use serde::{Deserialize, Serialize};

/// At most so many runs go on from one another.
pub(super) const MOST_ORIGINS: usize = 8;

/// The run that learning goes on from, in `run.toml`: its own `run.toml`, and how far it came.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OriginEntry {
    steps: u64,
    state_hash: String,
    /// What is carried on of what it learned.
    carry: Carry,
    run: TextEntry,
}

impl OriginEntry {
    pub(super) fn new(origin: &Origin) -> Self {
        let (steps, run) = (origin.plan.settings.run.steps, TextEntry::new(&origin.source));
        Self { steps, state_hash: origin.state_hash.clone(), carry: origin.carry, run }
    }

    /// The run as it stands in the `run.toml` of one that goes on from it; so many more may stand in its own.
    pub(super) fn origin(&self, file: &SourceText, filters: Arc<Catalogue>, deep: usize) -> Result<Origin> {
        let Some(deep) = deep.checked_sub(1) else {
            let message = format!("in '{}' too many runs go on from one another", file.path.display());
            return Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again").fail();
        };
        let source = self.run.check(file)?;
        let (before, seed) = StoredRun::parse_plan(&source, filters, deep)?;
        let plan = with_steps(before, self.steps.min(MOST_LEG_STEPS));
        Ok(Origin { plan, seed, source, state_hash: self.state_hash.clone(), carry: self.carry })
    }
}

/// A plan whose last leg has so many steps: as far as the run came.
fn with_steps(mut plan: Plan, steps: u64) -> Plan {
    plan.settings.run.steps = steps;
    plan
}

/// The plan, going on from a recorded run: of one seed for all, or of many, each seed from its own.
///
/// # Errors
/// If a run is missing or damaged, was not finished, or has other states, actions or another way of learning.
pub fn going_on_from(plan: Plan, folder: &Path, seeds: &[u64], filters: &Arc<Catalogue>) -> Result<Plan> {
    let many = seed_folders(folder)?;
    if many.is_empty() || crate::disk::is_there(&folder.join(LOG_FILE))? {
        let origin = origin(&plan, folder, filters)?;
        return plan.going_on_from(vec![origin]);
    }
    let one = |seed: &u64| match many.iter().find(|(number, _)| number == seed) {
        Some((_, folder)) => origin(&plan, folder, filters),
        None => {
            let shown = printable(&folder.display().to_string());
            let message = format!("'{shown}' has no seed {seed} to go on from");
            let [first, last] = [many.first(), many.last()].map(|seed| seed.map_or(0, |(number, _)| *number));
            let help = format!(
                "it has seeds {first} to {last}: choose --seed and --seeds among them, or give one: {shown}/{first}"
            );
            Diagnostic::new("E-FROM", message).help(help).fail()
        }
    };
    let origins = seeds.iter().map(one).collect::<Result<Vec<_>>>()?;
    plan.going_on_from(origins)
}

fn origin(plan: &Plan, folder: &Path, filters: &Arc<Catalogue>) -> Result<Origin> {
    let RecordedRun { stored, log, summary } = RecordedRun::load(folder, Arc::clone(filters))?;
    let Some(summary) = summary else {
        let message = format!("'{}' was ended by a failure", printable(&folder.display().to_string()));
        return Diagnostic::new("E-FROM", message).help("go on from a run that was finished").fail();
    };
    let before = with_steps(stored.plan, log.learning.last_leg().0);
    let file = folder.join(RUN_FILE);
    let source = SourceText::new(file.clone(), read_stored(&file)?.text);
    let carry = before.carries_to(plan);
    Ok(Origin { plan: before, seed: stored.seed, source, state_hash: summary.state_hash, carry })
}
