//! Learns a behaviour from its script and tests what was learned: `cargo run --release -p engine --example learn`.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::experiment::{Overrides, Plan, learn, test};
use engine::script::Behaviour;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/corridor.rhai");
    let plan = Plan::new(Arc::new(Behaviour::load(&script)?), &Overrides::default())?;
    let never = AtomicBool::new(false);
    let learned = learn(&plan, 1, &never, &|_| ())?;
    let tested = test(&plan, &learned.policy, 1, &never)?;
    println!("{} states met, {} failures in the test", learned.policy.states_met(), tested.figures.failures);
    Ok(())
}
