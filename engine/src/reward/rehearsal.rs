//! A script tried once at load, so that what must fail fails before learning starts.

use super::judge::Judge;
use crate::diagnostic::{Diagnostic, Result};
use crate::settings::Settings;

/// Tries every rule and function on an empty place and in a tight corner.
///
/// # Errors
/// For what is wrong whatever is measured: kinds of values that do not fit, names, limits. What depends on the values
/// measured, such as a division by zero, is left to the run.
pub(super) fn rehearse(mut judge: Judge, settings: &Settings) -> Result<()> {
    for (range_m, sees) in [(settings.laser.max_range_m, false), (settings.laser.min_range_m, true)] {
        let (rows, columns) = (settings.grid.rows as usize, settings.grid.columns as usize);
        let facts = judge.facts_mut();
        facts.ranges_m.fill(range_m as f32);
        facts.grid = (rows, columns);
        facts.cells = vec![f32::from(u8::from(sees)); rows * columns];
        facts.coverage = f64::from(u8::from(sees));
        (facts.seen, facts.contact, facts.fallen) = (sees, sees, sees);
        (facts.step, facts.since_recovery) = (1, 1);
        (facts.action_linear, facts.linear) = (0.2, 0.2);
        certain(judge.calibrate())?;
        certain(everything(&judge))?;
    }
    Ok(())
}

fn everything(judge: &Judge) -> Result<()> {
    let present = judge.present();
    for rule in &present.loaded.rules {
        certain(present.condition(rule))?;
        certain(present.value(rule))?;
    }
    present.loaded.reward.as_ref().map_or(Ok(()), |span| certain(present.reward(span)))
}

fn certain<T>(result: Result<T>) -> Result<()> {
    let is_chance = |wrong: &Diagnostic| wrong.code == "E-SCRIPT-RUN";
    match result {
        Err(wrong) if !is_chance(&wrong) => Err(wrong),
        _ => Ok(()),
    }
}
