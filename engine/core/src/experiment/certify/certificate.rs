//! The statement: figures over all draws, each with its interval, and the draws in which the policy did worst.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::bounds::{rate_bounds, share_bounds};
use super::draws::{Draw, Draws};
use super::{Asked, Test, Tested};
use crate::digest::hex;

/// The version of the statement.
const FORMAT: u32 = 1;
/// So many of the worst draws are named.
const WORST: usize = 12;

/// What a policy does in worlds that it has not seen. Intervals hold the true value in 95 % of all samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// The version of the statement.
    pub format: u32,
    /// The behaviour's name.
    pub behaviour: String,
    /// What the worlds are drawn from.
    pub worlds: Vec<String>,
    /// Whether each draw has a world of its own; else the statement is about these worlds alone.
    pub each_its_own_world: bool,
    /// Settings that are others than when it was learned, as `KEY=VALUE`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// What worlds and seeds are drawn by.
    pub seed: u64,
    /// Draws: a world and a seed each.
    pub draws: u64,
    /// Steps of the test in each.
    pub steps: u64,
    /// Draws in worlds in which the policy was learned: unseen are only the seeds.
    pub learned_in: u64,
    /// Draws in which the script's success conditions hold.
    pub success: CertifiedShare,
    /// Failures in 1,000 steps.
    pub failures: CertifiedRate,
    /// Draws with a failure.
    pub failing: CertifiedShare,
    /// What was aimed at, and whether it is reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aim: Option<Aim>,
    /// Draws in which the conditions hold for a robot that knows nothing.
    pub untrained_success: CertifiedShare,
    /// Failures in 1,000 steps of a robot that knows nothing, in the same draws.
    pub untrained_failures: CertifiedRate,
    /// How many draws had so many failures: failures and draws, failures rising.
    pub spread: Vec<[u64; 2]>,
    /// That of the robot that knows nothing.
    pub untrained_spread: Vec<[u64; 2]>,
    /// The draws with most failures, the worst first.
    pub worst: Vec<HardDraw>,
    /// Hash over every step of every test of the policy.
    pub state_hash: String,
}

/// A share of the draws.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedShare {
    /// How many.
    pub draws: u64,
    /// That as a share.
    pub share: f64,
    /// Its exact interval (Clopper and Pearson).
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// Failures in 1,000 steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedRate {
    /// Failures of all draws.
    pub failures: u64,
    /// Steps of all draws.
    pub steps: u64,
    /// Failures in 1,000 steps.
    pub per_1000: f64,
    /// Its interval over the draws, see [`rate_bounds`].
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// A bound that was aimed at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aim {
    /// Failures in 1,000 steps below which the upper end was to come.
    pub per_1000: f64,
    /// Draws of a pilot that said how many are needed, and that count for nothing else; 0 if their number was asked for.
    pub pilot_draws: u64,
    /// Failures in 1,000 steps of the pilot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pilot_per_1000: Option<f64>,
    /// Whether the upper end is below it.
    pub reached: bool,
}

/// A draw that went badly: `engine test RUN --world WORLD --seed SEED --steps STEPS` does it again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HardDraw {
    /// The world.
    pub world: String,
    /// The seed.
    pub seed: u64,
    /// Failures in it.
    pub failures: u64,
    /// Failures in 1,000 of its steps.
    pub per_1000: f64,
    /// Those of a robot that knows nothing.
    pub untrained_per_1000: f64,
    /// Whether the success conditions hold.
    pub success: bool,
}

impl Certificate {
    pub(super) fn new(
        test: &Test<'_>,
        draws: &Draws,
        asked: &Asked,
        aim: Option<Aim>,
        drawn: &[Draw],
        tested: &[Tested],
    ) -> Self {
        let all = tested.len() as u64;
        let share = |holds: &dyn Fn(&Tested) -> bool| {
            CertifiedShare::of(tested.iter().filter(|one| holds(one)).count() as u64, all)
        };
        let failures = CertifiedRate::over(tested.iter().map(|one| (one.failures, one.steps)).collect());
        let mut hasher = Sha256::new();
        tested.iter().for_each(|one| hasher.update(one.hash.as_bytes()));
        Self {
            format: FORMAT,
            behaviour: test.plan.behaviour.name().to_owned(),
            worlds: draws.names(),
            each_its_own_world: draws.are_worlds(),
            set: asked.set.clone(),
            seed: asked.seed,
            draws: all,
            steps: test.steps,
            learned_in: drawn.iter().filter(|draw| draws.is_known(&draw.world)).count() as u64,
            success: share(&|one| one.success),
            aim: aim.map(|aim| Aim { reached: failures.high < aim.per_1000, ..aim }),
            failures,
            failing: share(&|one| one.failures > 0),
            untrained_success: share(&|one| one.untrained_success),
            untrained_failures: CertifiedRate::over(
                tested.iter().map(|one| (one.untrained_failures, one.untrained_steps)).collect(),
            ),
            spread: spread(tested.iter().map(|one| one.failures)),
            untrained_spread: spread(tested.iter().map(|one| one.untrained_failures)),
            worst: worst(drawn, tested),
            state_hash: hex(&hasher.finalize()),
        }
    }

    /// Whether the policy does better than a robot that knows nothing by more than chance, and the aim, if there was one, is
    /// reached.
    #[must_use]
    pub fn holds(&self) -> bool {
        let better = self.success.low > self.untrained_success.high && self.failures.high < self.untrained_failures.low;
        better && self.aim.is_none_or(|aim| aim.reached)
    }
}

impl Certificate {
    /// What was asked, to draw it again.
    #[must_use]
    pub fn asked(&self) -> Asked {
        // A pilot says the number of draws again.
        let counted = self.aim.is_none_or(|aim| aim.pilot_draws == 0);
        Asked {
            worlds: self.worlds.clone(),
            draws: counted.then_some(self.draws),
            steps: Some(self.steps),
            seed: self.seed,
            aim: self.aim.map(|aim| aim.per_1000),
            set: self.set.clone(),
        }
    }
}

impl Aim {
    pub(super) fn new(per_1000: f64, pilot: Option<(u64, f64)>) -> Self {
        let (pilot_draws, pilot_per_1000) = pilot.unzip();
        Self { per_1000, pilot_draws: pilot_draws.unwrap_or(0), pilot_per_1000, reached: false }
    }
}

impl CertifiedShare {
    fn of(draws: u64, all: u64) -> Self {
        let [low, high] = share_bounds(draws, all);
        Self { draws, share: draws as f64 / all.max(1) as f64, low, high }
    }
}

impl CertifiedRate {
    fn over(draws: Vec<(u64, u64)>) -> Self {
        let (rate, [low, high]) = rate_bounds(&draws);
        let sum = |of: fn(&(u64, u64)) -> u64| draws.iter().map(of).sum();
        let (failures, steps) = (sum(|draw| draw.0), sum(|draw| draw.1));
        Self { failures, steps, per_1000: 1000.0 * rate, low: 1000.0 * low, high: 1000.0 * high }
    }
}

/// How many draws had each number of failures.
fn spread(failures: impl Iterator<Item = u64>) -> Vec<[u64; 2]> {
    let mut counts = std::collections::BTreeMap::new();
    failures.for_each(|failures| *counts.entry(failures).or_insert(0) += 1);
    counts.into_iter().map(|(failures, draws)| [failures, draws]).collect()
}

/// The draws with most failures; of equals, first those that are no success, then the first drawn.
fn worst(drawn: &[Draw], tested: &[Tested]) -> Vec<HardDraw> {
    let mut order: Vec<usize> = (0..tested.len()).collect();
    order.sort_by_key(|at| (std::cmp::Reverse(tested[*at].failures), tested[*at].success, *at));
    let per_1000 = |failures: u64, steps: u64| 1000.0 * failures as f64 / steps.max(1) as f64;
    let hard = |at: usize| HardDraw {
        world: drawn[at].world.clone(),
        seed: drawn[at].seed,
        failures: tested[at].failures,
        per_1000: per_1000(tested[at].failures, tested[at].steps),
        untrained_per_1000: per_1000(tested[at].untrained_failures, tested[at].untrained_steps),
        success: tested[at].success,
    };
    order.into_iter().take(WORST).map(hard).collect()
}
