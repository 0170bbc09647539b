//! A run of one seed or of many, read from its folder.

use std::path::Path;
use std::sync::Arc;

use crate::store::{RUN_FILE, SUMMARY_FILE, StoredRun, check_policy, read_stored};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Decider, Plan, Spread, Summary};
use engine::filter::Catalogue;
use engine::learner::Policy;

/// One run of a comparison.
pub struct Side {
    /// As the user named it.
    pub name: String,
    /// What was run.
    pub plan: Plan,
    /// Its seeds.
    pub seeds: Vec<SideSeed>,
}

/// One seed of a run.
pub struct SideSeed {
    /// Its figures.
    pub summary: Summary,
    /// What was learned; nothing if policies were combined.
    pub policy: Option<Policy>,
}

impl Side {
    /// Reads the folder of a run of one seed, such as `runs/wall/1`, or of many, such as `runs/wall/1-30`.
    ///
    /// # Errors
    /// If the folder is not that of a finished run, or its parts do not belong together.
    pub fn load(folder: &Path, filters: &Arc<Catalogue>) -> Result<Self> {
        let name = folder.display().to_string();
        // First of all, so that the folder above several runs is answered with their names.
        read_stored(&folder.join(RUN_FILE))?;
        let summary = read_stored(&folder.join(SUMMARY_FILE))?;
        let seed_of = |folder: &Path, summary: Summary| {
            let StoredRun { plan, decider, .. } = StoredRun::load_with(folder, Arc::clone(filters))?;
            let policy = if let Decider::Learned(policy) = decider { Some(policy) } else { None };
            // Of many seeds, the figures are those that stand above their folders.
            policy.iter().try_for_each(|policy| check_policy(folder, summary.policy_sha256.as_deref(), policy))?;
            Ok::<_, Box<Diagnostic>>((plan, SideSeed { summary, policy }))
        };
        if let Ok(one) = serde_json::from_str::<Summary>(&summary.text) {
            let (plan, seed) = seed_of(folder, one)?;
            return Ok(Self { name, plan, seeds: vec![seed] });
        }
        let many: Spread = serde_json::from_str(&summary.text).map_err(|error| {
            let shown = printable(&summary.path.display().to_string());
            let message = format!("'{shown}' holds no figures of this engine: {error}");
            Box::new(Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again"))
        })?;
        let (mut plan, mut seeds) = (None, Vec::new());
        for summary in many.seeds {
            let folder = folder.join(summary.seed.to_string());
            let (own, seed) = seed_of(&folder, summary)?;
            plan.get_or_insert(own);
            seeds.push(seed);
        }
        match plan {
            Some(plan) => Ok(Self { name, plan, seeds }),
            None => Diagnostic::new("E-RUN-FILE", format!("'{}' holds no seed", printable(&name))).fail(),
        }
    }
}
