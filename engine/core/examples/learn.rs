//! Learns a behaviour from its script, tests what was learned, and says whether it does what the script asks for:
//! `cargo run --release -p engine --example learn`.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::experiment::{Overrides, Plan, RunLog, run_seed};
use engine::script::Behaviour;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/corridor.rhai");
    let plan = Plan::new(Arc::new(Behaviour::load(&script)?), &Overrides::default())?;
    let run = run_seed(&plan, 1, &AtomicBool::new(false), &|_| (), &mut RunLog::off())?;
    let verdict = &run.summary.verdict;
    println!("success: {}", verdict.success.map_or("cannot be told", |yes| if yes { "yes" } else { "no" }));
    for figure in verdict.conditions.iter().flat_map(|condition| &condition.figures) {
        let told = |value: Option<f64>| value.map_or("not measured".to_owned(), |value| value.to_string());
        println!("{}: {}, untrained {}", figure.name, told(figure.value), told(figure.untrained));
    }
    Ok(())
}
