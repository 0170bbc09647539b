//! What an author claims, measured by the engine when the pack is built, and measured again by who doubts it.

use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::certified::certificate_difference;
use super::marks::{Marks, STEPS};
use super::{Digest, MAX_EVIDENCE_STEPS, MAX_SEED_STEPS, MAX_SEEDS, Pack, Runnable, fingerprint, malformed};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{
    Certificate, Plan, Progress, RunLog, SeedRun, Summary, TestRun, Trail, WINDOW_STEPS, in_parallel, run_seed,
};
use engine::learner::Policy;

/// The present definition of the figures. By the first one, a robot made laps from anywhere in the world, was lost in a
/// restart, and had learned by its rewards alone; of such evidence only what both definitions have in common is compared.
const FIGURES: u32 = 2;

fn first_figures() -> u32 {
    1
}

/// The claims of a pack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evidence {
    /// The version of the engine that measured.
    pub engine: String,
    /// What that engine does in a short run of its own: [`fingerprint`].
    pub behaves: Digest,
    /// Which definition the figures have; 1 if the evidence does not say.
    #[serde(default = "first_figures")]
    pub figures: u32,
    /// Steps of learning of each seed; 0 for a behaviour that combines policies.
    pub steps: u64,
    /// Steps of each test.
    pub test_steps: u64,
    /// The script's parameters, each with its value and range in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub params: Vec<(String, String)>,
    /// The seed whose policy the pack carries.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy_seed: Option<u64>,
    /// One claim for each seed.
    #[serde(rename = "seed")]
    pub seeds: Vec<SeedClaim>,
    /// A bound in worlds that the policy has not seen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificate>,
}

/// The figures of one seed, as in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeedClaim {
    /// The seed.
    pub seed: u64,
    /// Hash over every step of learning and the table; for a combination, over every step of its test.
    pub state_hash: String,
    /// Hash over every step of the test.
    pub test_hash: String,
    /// The step from which it counts as learned; absent if it never does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learned_at: Option<u64>,
    /// States that were visited.
    pub states_seen: usize,
    /// Failures in 1,000 steps of the test.
    pub failures_per_1000: f64,
    /// Laps of the test, signed; absent without a route.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laps: Option<f64>,
    /// Contacts of the test.
    pub contacts: u64,
    /// Mean speed of the test, m/s.
    pub mean_speed: f64,
    /// Share of the test's spells that were spent spinning.
    pub spinning: f64,
    /// Whether it is a success; absent where that cannot be told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub success: Option<bool>,
    /// Failures in 1,000 steps of a robot that knows nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub untrained_failures_per_1000: Option<f64>,
    /// Of evidence by the first definition: whether it gets along its route.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub does_task: Option<bool>,
    /// Reinforcement of every 400 steps of learning.
    pub reinforcement_per_400: Vec<f64>,
}

/// What was measured for one seed.
pub struct Proof {
    /// The figures.
    pub claim: SeedClaim,
    /// What was learned; nothing for a combination.
    pub policy: Option<Policy>,
    /// The path of the first steps of learning; nothing for a combination.
    pub early: Option<Trail>,
    /// The test.
    pub tested: TestRun,
    /// A mark for every step.
    pub(super) marks: Marks,
}

/// Where a pack and its replay part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The seed.
    pub seed: u64,
    /// The first step that differs, counted from 1; nothing if every step agrees, or the pack does not say.
    pub step: Option<u64>,
    /// In words.
    pub what: String,
}

/// Steps of learning and of the test of one seed.
fn steps_of_seed(runnable: &Runnable) -> [u64; 2] {
    let run = &runnable.plan.settings.run;
    [if runnable.plan.learns() { run.steps } else { 0 }, run.test_steps]
}

/// Refuses evidence that nobody could measure again in reasonable time: a stranger's claim must not hold a machine for
/// days, nor an author claim what no stranger may check.
pub(super) fn check_length(runnable: &Runnable, seeds: usize) -> Result<()> {
    let [learning, test] = steps_of_seed(runnable);
    let each = learning + test;
    let all = each.saturating_mul(seeds as u64);
    let (what, limit) = match () {
        () if seeds > MAX_SEEDS => (format!("has {seeds} seeds"), format!("{MAX_SEEDS} seeds")),
        () if each > MAX_SEED_STEPS => {
            (format!("takes {each} steps for each seed"), format!("{MAX_SEED_STEPS} steps for each seed"))
        }
        () if all > MAX_EVIDENCE_STEPS => {
            (format!("takes {all} steps for {seeds} seeds"), format!("{MAX_EVIDENCE_STEPS} steps in all"))
        }
        () => return Ok(()),
    };
    malformed("E-PACK-LIMIT", format!("the evidence of this behaviour {what}; the limit is {limit}"))
        .help("its author names fewer steps in the script's run(), or fewer seeds in pack.toml")
        .fail()
}

/// Measures seeds; `stop` ends it early with an error, since half a measurement proves nothing.
///
/// # Errors
/// `E-PACK-LIMIT` if that takes too many steps; if the behaviour fails, or was stopped.
pub fn measure(
    runnable: &Runnable,
    seeds: &[u64],
    threads: usize,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Proof>> {
    check_length(runnable, seeds.len())?;
    let proofs = in_parallel(seeds, threads, |seed| proof(&runnable.plan, seed, stop, report))?;
    if stop.load(Ordering::Relaxed) {
        return Diagnostic::new("E-PACK-STOPPED", "stopped before every seed was measured").fail();
    }
    Ok(proofs)
}

fn proof(plan: &Plan, seed: u64, stop: &AtomicBool, report: &(dyn Fn(Progress) + Sync)) -> Result<Proof> {
    let mut log = RunLog::new(plan);
    let SeedRun { learned, tested, summary } = run_seed(plan, seed, stop, report, &mut log)?;
    let marks = Marks::new(&log.learning, &log.test);
    let claim = claim(summary, &tested);
    let (policy, early) = learned.map(|learned| (learned.policy, learned.early)).unzip();
    Ok(Proof { claim, policy, early, tested, marks })
}

fn claim(summary: Summary, tested: &TestRun) -> SeedClaim {
    let Summary { seed, state_hash, states_seen, learned_at, reinforcement_per_400, test: figures, .. } = summary;
    let (success, untrained) = (summary.verdict.success, summary.base_lines.untrained.failures_per_1000);
    SeedClaim {
        seed,
        state_hash,
        test_hash: tested.state_hash.clone(),
        learned_at,
        states_seen,
        failures_per_1000: figures.failures_per_1000,
        laps: figures.laps,
        contacts: figures.contacts,
        mean_speed: figures.mean_speed,
        spinning: figures.spinning,
        success,
        untrained_failures_per_1000: Some(untrained),
        does_task: None,
        reinforcement_per_400,
    }
}

impl SeedClaim {
    /// Takes over what an older definition of the figures means by other numbers.
    fn take_figures_of(&mut self, older: &Self) {
        self.learned_at = older.learned_at;
        self.failures_per_1000 = older.failures_per_1000;
        self.laps = older.laps;
        self.success = older.success;
        self.untrained_failures_per_1000 = older.untrained_failures_per_1000;
        self.does_task = older.does_task;
    }
}

impl Evidence {
    /// The evidence of some measured seeds.
    ///
    /// # Errors
    /// Never in practice: only if the engine's own probe fails.
    pub fn new(runnable: &Runnable, proofs: &[Proof]) -> Result<Self> {
        let [steps, test_steps] = steps_of_seed(runnable);
        // Of the seeds that are a success and fail least, the first: a user tests the best that was measured.
        let idle = |proof: &Proof| proof.claim.success != Some(true);
        let failures = |proof: &Proof| proof.claim.failures_per_1000;
        let learned = proofs.iter().filter(|proof| proof.policy.is_some());
        let best = learned.min_by(|a, b| idle(a).cmp(&idle(b)).then(failures(a).total_cmp(&failures(b))));
        Ok(Self {
            engine: env!("CARGO_PKG_VERSION").to_owned(),
            behaves: fingerprint()?,
            figures: FIGURES,
            steps,
            test_steps,
            params: runnable.plan.behaviour.params().iter().map(|param| (param.name.clone(), param.shown())).collect(),
            policy_seed: best.map(|proof| proof.claim.seed),
            seeds: proofs.iter().map(|proof| proof.claim.clone()).collect(),
            certificate: None,
        })
    }

    /// The claim that is shown first: that of the policy, or the first.
    #[must_use]
    pub fn shown(&self) -> Option<&SeedClaim> {
        let carried = self.seeds.iter().find(|claim| Some(claim.seed) == self.policy_seed);
        carried.or_else(|| self.seeds.first())
    }
}

/// Measures everything that a pack claims again; the differences are empty if it was reproduced bit for bit.
///
/// # Errors
/// `E-PACK-EVIDENCE` if the pack claims nothing; else those of [`measure`].
pub fn replay(
    pack: &Pack,
    runnable: &Runnable,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Difference>> {
    let Some(evidence) = pack.manifest().evidence.as_ref().filter(|evidence| !evidence.seeds.is_empty()) else {
        return malformed("E-PACK-EVIDENCE", format!("{} carries no evidence to replay", pack.title())).fail();
    };
    let seeds: Vec<u64> = evidence.seeds.iter().map(|claim| claim.seed).collect();
    let mut proofs = measure(runnable, &seeds, 0, stop, report)?;
    if evidence.figures < FIGURES {
        proofs.iter_mut().zip(&evidence.seeds).for_each(|(proof, claim)| proof.claim.take_figures_of(claim));
    }
    let steps = pack.file(STEPS).and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or_default();
    let mut differences: Vec<Difference> =
        evidence.seeds.iter().zip(&proofs).filter_map(|(claim, proof)| difference(claim, proof, steps)).collect();
    let [learning, test] = steps_of_seed(runnable);
    if [evidence.steps, evidence.test_steps] != [learning, test] {
        let what = format!(
            "{} steps of learning and {} of the test are claimed, the script has {learning} and {test}",
            evidence.steps, evidence.test_steps
        );
        differences.push(Difference { seed: seeds[0], step: None, what });
    }
    differences.extend(policy_difference(pack, runnable, evidence, &proofs)?);
    differences.extend(certificate_difference(pack, runnable, stop)?);
    Ok(differences)
}

/// The policy that the pack carries is the one that the seed learns for which it is claimed.
fn policy_difference(
    pack: &Pack,
    runnable: &Runnable,
    evidence: &Evidence,
    proofs: &[Proof],
) -> Result<Option<Difference>> {
    let Some(path) = &pack.manifest().entry.policy else { return Ok(None) };
    let carried = proofs.iter().find(|proof| Some(proof.claim.seed) == evidence.policy_seed);
    let difference = |seed, what| Ok(Some(Difference { seed, step: None, what }));
    match carried.and_then(|proof| Some((proof.claim.seed, proof.policy.as_ref()?))) {
        None => difference(evidence.seeds[0].seed, format!("no seed is claimed to learn '{path}'")),
        Some((seed, policy))
            if runnable.policy_text(policy)?.as_bytes() != pack.file(path.as_str()).unwrap_or_default() =>
        {
            difference(seed, format!("'{path}' is not the policy that this seed learns"))
        }
        Some(_) => Ok(None),
    }
}

fn difference(claimed: &SeedClaim, proof: &Proof, steps: &str) -> Option<Difference> {
    let measured = &proof.claim;
    if claimed == measured {
        return None;
    }
    let same_steps = claimed.state_hash == measured.state_hash && claimed.test_hash == measured.test_hash;
    // Marks only say where; that something differs, the hashes say.
    let marked = Marks::of_seed(steps, claimed.seed).filter(|_| !same_steps);
    if let Some((part, step)) = marked.and_then(|marks| marks.first_difference(&proof.marks)) {
        let what = format!("the first step that differs is step {step} of {part}");
        return Some(Difference { seed: claimed.seed, step: Some(step), what });
    }
    let windows = claimed.reinforcement_per_400.iter().zip(&measured.reinforcement_per_400);
    let window = windows.enumerate().find(|(_, (claimed, measured))| claimed != measured);
    let what = if let Some((index, (claimed, measured))) = window {
        let last = (index as u64 + 1) * WINDOW_STEPS;
        format!(
            "the first difference is in steps {} to {last}: reinforcement {claimed} claimed, {measured} measured",
            last - WINDOW_STEPS + 1
        )
    } else if same_steps {
        "every step agrees, but a figure that is claimed is not the one measured".to_owned()
    } else {
        "the hash over all steps differs, and the pack does not say where".to_owned()
    };
    Some(Difference { seed: claimed.seed, step: None, what })
}
