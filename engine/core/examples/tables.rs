//! Learns behaviours by several learners on many seeds, and writes the table of what came of it, in Markdown:
//! `cargo run --release -p engine --example tables -- 8100 30 memory,ttd scripts/wall.rhai scripts/corridor.rhai`.
//!
//! The arguments: the first seed, how many seeds, the learners, then scripts, and settings such as `camera.noise=8`. *Punished* are the
//! failures of learning until a step, the mean of all seeds. Tests are the script's own, of the policy as it is at the end of
//! learning, and as it was frozen after 400 and after 800 steps. *Untrained* is a robot that knows nothing, in the same test.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::Result;
use engine::experiment::{Learning, Ledger, Overrides, Plan, Summary, WINDOW_STEPS, base_lines, in_parallel, test};
use engine::script::Behaviour;
use engine::stats::Sorted;

/// Steps after which a policy is frozen while learning goes on.
const FROZEN_AT: [u64; 2] = [400, 800];
/// Steps until which punishments are told.
const PUNISHED_BY: [u64; 3] = [400, 2_000, 4_000];
/// So many failures in 1,000 steps of the test are few.
const FEW: f64 = 1.5;

/// What one seed came to.
struct Seed {
    summary: Summary,
    punished: [u64; 3],
    /// Failures in 1,000 steps of the test of each policy that was frozen early.
    frozen: [f64; 2],
}

impl Seed {
    fn of(plan: &Plan, seed: u64) -> Result<Self> {
        let never = AtomicBool::new(false);
        let mut learning = Learning::new(plan, seed)?;
        let mut frozen = [0.0; 2];
        for (at, failures) in FROZEN_AT.into_iter().zip(&mut frozen) {
            learning.run(at - learning.steps(), &never, &|_| (), &mut Ledger::off())?;
            *failures = test(plan, &learning.snapshot().policy, seed, &never)?.figures.failures_per_1000;
        }
        learning.run(plan.settings.run.steps - learning.steps(), &never, &|_| (), &mut Ledger::off())?;
        let learned = learning.finish();
        let windows = &learned.tally.windows;
        let until = |step: u64| {
            let within = windows.iter().take((step / WINDOW_STEPS) as usize);
            within.map(|window| window.endings.failures).sum()
        };
        let punished = PUNISHED_BY.map(until);
        let tested = test(plan, &learned.policy, seed, &never)?;
        let lines = base_lines(plan, seed, &tested, &never)?;
        Ok(Self { summary: Summary::new(plan, seed, Some(&learned), &tested, &lines), punished, frozen })
    }
}

/// `0.2 / 1.6`: the median and the worst seed.
fn spread(seeds: &[Seed], of: impl Fn(&Seed) -> f64) -> String {
    let all: Sorted = seeds.iter().map(of).collect();
    let worst = all.upper_quantile(1.0).unwrap_or(f64::NAN);
    format!("{:.1} / {worst:.1}", all.upper_median().unwrap_or(f64::NAN))
}

/// One line of the table.
fn row(script: &str, learner: &str, seeds: &[Seed]) -> String {
    let count = |is: &dyn Fn(&Seed) -> bool| seeds.iter().filter(|seed| is(seed)).count();
    let learned: Sorted =
        seeds.iter().map(|seed| seed.summary.learned_at.map_or(f64::INFINITY, |step| step as f64)).collect();
    let at = learned.upper_median().filter(|step| step.is_finite()).map_or("never".to_owned(), |step| step.to_string());
    let mean = |index: usize| seeds.iter().map(|seed| seed.punished[index] as f64).sum::<f64>() / seeds.len() as f64;
    format!(
        "| `{script}` | `{learner}` | {} of {} | {}, {at} | {:.1} / {:.1} / {:.1} | {} | {} | {} | {} | {} |",
        count(&|seed| seed.summary.verdict.is_success()),
        seeds.len(),
        count(&|seed| seed.summary.learned_at.is_some()),
        mean(0),
        mean(1),
        mean(2),
        spread(seeds, |seed| seed.summary.test.failures_per_1000),
        count(&|seed| seed.summary.test.failures_per_1000 < FEW),
        spread(seeds, |seed| seed.summary.base_lines.untrained.failures_per_1000),
        spread(seeds, |seed| seed.frozen[0]),
        spread(seeds, |seed| seed.frozen[1]),
    )
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [first, count, learners, rest @ ..] = &arguments[..] else {
        return Err("write: tables FIRST_SEED SEEDS LEARNER,LEARNER SCRIPT... [KEY=VALUE...]".into());
    };
    let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
    let seeds: Vec<u64> = (first..first + count).collect();
    let (set, scripts): (Vec<&String>, Vec<&String>) = rest.iter().partition(|word| word.contains('='));
    println!(
        "| script | learner | success | learned, at step (median) | punished by 400 / 2,000 / 4,000 | failures per 1,000, median / worst \
         | below {FEW} | untrained | frozen at 400 | frozen at 800 |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    for script in scripts {
        let behaviour = Arc::new(Behaviour::load(Path::new(script))?);
        for learner in learners.split(',') {
            let own = set.iter().map(|word| (*word).clone());
            let set = own.chain([format!("learner.kind={learner}")]).collect();
            let plan = Plan::new(behaviour.clone(), &Overrides { set, ..Overrides::default() })?;
            let all = in_parallel(&seeds, 0, |seed| Seed::of(&plan, seed))?;
            println!("{}", row(behaviour.name(), learner, &all));
        }
    }
    Ok(())
}
