//! A bound on what is unseen: a frozen policy in worlds and under seeds that are drawn for it, and what that says of all others.
//!
//! ```text
//!   draws.rs (worlds and seeds, by a stream of their own) --> a test of each, and of a robot that knows nothing -->
//!   bounds.rs (how sure the share and the rate are) --> certificate.rs (the statement)
//! ```
//!
//! A draw is the test that `engine test RUN --world WORLD --seed SEED --steps N` does, to the bit.

mod bounds;
mod certificate;
mod draws;

use std::sync::atomic::{AtomicBool, Ordering};

use super::base_lines::test_untrained;
use super::{Decider, Overrides, Plan, TestRun, in_parallel};
use crate::diagnostic::{Diagnostic, Result, printable};
use bounds::student;
pub use bounds::{count_bounds, rate_bounds, share_bounds};
pub use certificate::{Aim, Certificate, CertifiedRate, CertifiedShare, HardDraw};
use draws::{Draw, Draws};

/// Draws, unless something else is asked for.
pub const DRAWS: u64 = 1000;
/// Draws by which it is guessed how many an aim needs; they count for nothing else.
const PILOT_DRAWS: u64 = 100;
/// The fewest and the most draws that an aim takes.
const AIM_DRAWS: [u64; 2] = [200, 20_000];
/// A pilot knows the spread only roughly: so many times as many draws as it says.
const RESERVE: f64 = 1.5;
/// The most draws in one certificate.
pub const MOST_DRAWS: u64 = 100_000;

/// What is asked of a certificate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Asked {
    /// Worlds by name, path, family or rule; none for the family of the run's own worlds.
    pub worlds: Vec<String>,
    /// How many draws; nothing for as many as the aim needs, or [`DRAWS`].
    pub draws: Option<u64>,
    /// Steps of each test; nothing for those of the script's test.
    pub steps: Option<u64>,
    /// What the worlds and seeds are drawn by.
    pub seed: u64,
    /// The failures in 1,000 steps below which the upper bound is to come.
    pub aim: Option<f64>,
    /// Settings of the plan that were changed, to be kept with the statement.
    pub set: Vec<String>,
}

/// What one draw came to.
#[derive(Debug, Clone)]
struct Tested {
    steps: u64,
    failures: u64,
    success: bool,
    untrained_steps: u64,
    untrained_failures: u64,
    untrained_success: bool,
    hash: String,
}

/// Tests a policy in worlds that are drawn, over the threads (0: one for each core; their number changes nothing), beside a robot that
/// knows nothing. `report` is told the steps of each test that is done. Nothing if `stop` was set: half a sample states nothing.
///
/// # Errors
/// `E-CERTIFY` if it cannot be told which worlds are meant; if one of them cannot be, or a sensor, a filter or the script fails there.
pub fn certify(
    plan: &Plan,
    decider: &Decider,
    asked: &Asked,
    threads: usize,
    stop: &AtomicBool,
    report: &(dyn Fn(u64) + Sync),
) -> Result<Option<Certificate>> {
    let draws = Draws::new(plan, &asked.worlds)?;
    let test = Test { plan, decider, steps: asked.steps.unwrap_or(plan.settings.run.test_steps), stop, report };
    let (count, aim) = match (asked.draws, asked.aim) {
        (Some(count), aim) => (count, aim.map(|bound| Aim::new(bound, None))),
        (None, None) => (DRAWS, None),
        (None, Some(bound)) => {
            let pilot = draws.draw(asked.seed, PILOT_DRAWS, true);
            let Some(tested) = test.all(&pilot, threads, false)? else { return Ok(None) };
            let clusters: Vec<(u64, u64)> = tested.iter().map(|one| (one.failures, one.steps)).collect();
            let (needed, rate) = draws_for(bound, &clusters);
            (needed, Some(Aim::new(bound, Some((PILOT_DRAWS, 1000.0 * rate)))))
        }
    };
    let drawn = draws.draw(asked.seed, count, false);
    let Some(tested) = test.all(&drawn, threads, true)? else { return Ok(None) };
    Ok(Some(Certificate::new(&test, &draws, asked, aim, &drawn, &tested)))
}

/// How many draws bring the upper bound below `bound` failures in 1,000 steps, by what a pilot shows; and its rate.
fn draws_for(bound: f64, pilot: &[(u64, u64)]) -> (u64, f64) {
    let (rate, [_, high]) = rate_bounds(pilot);
    let aim = bound / 1000.0;
    if rate >= aim {
        // No number of draws will do, as far as the pilot can tell.
        return (DRAWS, rate);
    }
    // The upper end comes nearer to the rate as the root of the draws.
    let t = student(pilot.len() as f64 - 1.0) / 1.96;
    let needed = pilot.len() as f64 * ((high - rate) / t / (aim - rate)) * ((high - rate) / t / (aim - rate)) * RESERVE;
    ((needed.ceil() as u64).clamp(AIM_DRAWS[0], AIM_DRAWS[1]), rate)
}

/// What is tested, and for how long.
struct Test<'a> {
    plan: &'a Plan,
    decider: &'a Decider,
    steps: u64,
    stop: &'a AtomicBool,
    report: &'a (dyn Fn(u64) + Sync),
}

impl Test<'_> {
    /// Each draw; nothing if it was stopped.
    fn all(&self, draws: &[Draw], threads: usize, beside: bool) -> Result<Option<Vec<Tested>>> {
        let numbers: Vec<u64> = (0..draws.len() as u64).collect();
        let tested = in_parallel(&numbers, threads, |number| {
            if self.stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let draw = &draws[number as usize];
            self.one(draw, beside).map(Some).map_err(|error| in_draw(error, draw))
        })?;
        Ok(if self.stop.load(Ordering::Relaxed) { None } else { tested.into_iter().collect() })
    }

    fn one(&self, draw: &Draw, beside: bool) -> Result<Tested> {
        let there = Overrides { world: Some(draw.world.clone()), test_steps: Some(self.steps), ..Overrides::default() };
        let plan = self.plan.clone().with_changes(&there)?;
        let TestRun { figures, state_hash, .. } = self.decider.test(&plan, draw.seed, self.stop, &mut ())?;
        let untrained = if beside { Some(test_untrained(&plan, draw.seed, self.stop)?) } else { None };
        (self.report)(self.steps);
        let success = plan.success();
        let met = |test| untrained.as_ref().is_some_and(|untrained| success.is_met_by(test, untrained));
        Ok(Tested {
            steps: figures.steps,
            failures: figures.failures,
            success: met(&figures),
            untrained_steps: untrained.as_ref().map_or(0, |untrained| untrained.steps),
            untrained_failures: untrained.as_ref().map_or(0, |untrained| untrained.failures),
            untrained_success: untrained.as_ref().is_some_and(met),
            hash: state_hash,
        })
    }
}

fn in_draw(mut error: Box<Diagnostic>, draw: &Draw) -> Box<Diagnostic> {
    error.message = format!("{} (in the world '{}', under seed {})", error.message, printable(&draw.world), draw.seed);
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_aim_takes_the_draws_that_its_distance_needs_by_the_root() {
        // 100 worlds of 1,000 steps, 50 of them with 1 failure and 50 with 3: a rate of 2, a deviation of 1.005 over worlds. The
        // upper end of as many is 2 + 1.984 x 0.1005. For 2.1 it takes (1.96 x 1.005 / 0.1)^2 = 388 draws, 1.5 times that in reserve.
        let pilot: Vec<(u64, u64)> = (0..100).map(|world| (1 + 2 * (world % 2), 1000)).collect();
        let (needed, rate) = draws_for(2.1, &pilot);
        assert!((rate - 0.002).abs() < 1e-12);
        // The exact interval of 200 events is wider here, by a factor of 1.5 in the draws.
        let garwood = 100.0 * (29.0_f64 / 10.0) * (29.0 / 10.0) / (1.984 / 1.96) / (1.984 / 1.96) * 1.5;
        assert!((needed as f64 - garwood).abs() < 0.1 * garwood, "{needed} {garwood}");
        assert_eq!(draws_for(2.0, &pilot).0, DRAWS, "no number of draws brings the bound below the rate");
        assert_eq!(draws_for(500.0, &pilot).0, AIM_DRAWS[0]);
    }
}
