//! Steps many robots side by side, each as an environment of its own:
//! `cargo run --release -p engine --example step_many`.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use std::sync::Arc;

use engine::experiment::{Cycle, Overrides, Phase, Plan, in_parallel};
use engine::random::{Random, Stream};
use engine::script::Behaviour;

/// Steps of each robot.
const STEPS: u64 = 500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/wall.rhai");
    let plan = Plan::new(Arc::new(Behaviour::load(&script)?), &Overrides::default())?;
    let seeds: Vec<u64> = (1..=8).collect();
    let failures = in_parallel(&seeds, 0, |seed| {
        let mut cycle = Cycle::new(&plan, Phase::Learning.robot(&plan, seed)?)?;
        let mut random = Random::new(seed, Stream::Test);
        let mut failures = 0;
        for _ in 0..STEPS {
            let step = cycle.step(random.below(plan.settings.actions.len() as u32) as usize)?;
            if step.then.is_some() {
                failures += 1;
                cycle.recover()?;
            }
        }
        Ok(failures)
    })?;
    println!("failures of eight robots that act at random for {STEPS} steps: {failures:?}");
    Ok(())
}
