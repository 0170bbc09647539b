//! Starts that never come into use: what lies there is never learned, and the test begins there all the same.

use std::sync::atomic::AtomicBool;

use super::Finding;
use super::trial::SEED;
use engine::diagnostic::{Result, printable};
use engine::experiment::{Plan, in_parallel, learn};

/// Robots that learn; what one of them reaches can be reached.
const ROBOTS: u64 = 3;
/// Scripts that learn for longer are not tried: nothing can be told of them here.
const MOST_STEPS: u64 = 40_000;

/// Learns for as long as the script says, if it widens its starts.
pub(super) fn check_starts(plan: &Plan, threads: usize, stop: &AtomicBool, findings: &mut Vec<Finding>) -> Result<()> {
    let (starts, steps) = (&plan.settings.starts, plan.learning_steps());
    let (Some(share), Some(span)) = (starts.widen, plan.behaviour.place_of("starts")) else { return Ok(()) };
    if steps > MOST_STEPS {
        return Ok(());
    }
    let seeds: Vec<u64> = (SEED..SEED + ROBOTS).collect();
    let joined = in_parallel(&seeds, threads, |seed| Ok(learn(plan, seed, stop, &|_| ())?.joined.len()))?;
    let most = joined.into_iter().max().unwrap_or(0);
    let Some(never) = starts.names.get(most).map(|name| printable(name)) else { return Ok(()) };
    let message = format!("start \"{never}\" never comes into use: {ROBOTS} robots learned for {steps} steps");
    let before = most.checked_sub(1).and_then(|last| starts.names.get(last)).map_or("", String::as_str);
    let label = format!("of 20 attempts from \"{}\" and before, fewer than {share} went well", printable(before));
    let help =
        "put a start between the two, ask for a lesser share with 'widen', or learn for longer: run(#{ steps: ... })";
    findings.push(Finding::warning(plan, "W-START-NEVER", span, message).say(label, help));
    Ok(())
}
