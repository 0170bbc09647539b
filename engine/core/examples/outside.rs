//! Lends a behaviour's robot to a learner in another program, line by line over standard input and output:
//! `cargo run --release -p engine --example outside -- scripts/wall.rhai 7 learning`.
//!
//! It first writes `actions N cells M states S`, then what the robot sees: `0 0 STATE SHARE SHARE ...`, the share of each cell that is
//! filled. For each line with the number of an action it writes `REWARD ENDED STATE SHARE ...`; `ENDED` is 1 after an attempt that the
//! script ended, and what is seen is then the beginning of the next one. `docs/learners/compare.py` is such a program.

#![allow(clippy::print_stdout, reason = "standard output is the link")]

use std::io::{BufRead, Write, stdin, stdout};
use std::path::Path;
use std::sync::Arc;

use engine::experiment::{Cycle, Overrides, Phase, Plan};
use engine::robot::SimulatedRobot;
use engine::script::Behaviour;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, script, seed, phase] = &arguments[..] else {
        return Err("write: outside SCRIPT SEED learning|test".into());
    };
    let phase = if phase == "test" { Phase::Test } else { Phase::Learning };
    let plan = Plan::new(Arc::new(Behaviour::load(Path::new(script))?), &Overrides::default())?;
    let mut cycle = Cycle::new(&plan, phase.robot(&plan, seed.parse()?)?)?;
    let (actions, cells) = (plan.motions().len(), cycle.grid().counts().len());
    println!("actions {actions} cells {cells} states {}", plan.state_map()?.states());
    tell(&cycle, 0.0, false)?;
    for line in stdin().lock().lines() {
        let action: usize = line?.trim().parse()?;
        if action >= actions {
            return Err(format!("there is no action {action}: write a number from 0 to {}", actions - 1).into());
        }
        let step = cycle.step(cycle.instead_of(action))?;
        if step.moves() {
            cycle.recover()?;
        }
        tell(&cycle, step.reward, step.then.is_some())?;
    }
    Ok(())
}

/// One line: what the last step brought, and what is seen now.
fn tell(cycle: &Cycle<SimulatedRobot>, reward: f64, ended: bool) -> std::io::Result<()> {
    let grid = cycle.grid();
    let shares = grid.counts().iter().enumerate().map(|(cell, count)| f64::from(*count) / grid.area_px(cell) as f64);
    let shares: Vec<String> = shares.map(|share| format!("{share:.4}")).collect();
    let mut out = stdout().lock();
    writeln!(out, "{reward} {} {} {}", u8::from(ended), cycle.state(), shares.join(" "))?;
    out.flush()
}
