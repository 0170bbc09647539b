//! A script tried once at load, so that what must fail fails before learning starts.

use super::spoilt::Spoilt;
use crate::diagnostic::{Kind, Mistakes, Result};
use crate::judge::sandbox::MAX_OPERATIONS;
use crate::judge::{Judge, ViewFacts, budget};
use crate::settings::{Settings, ViewSettings};

/// After so many mistakes nothing more is tried: each may take as long as the limits allow.
const MOST_TRIED: usize = 100;
/// After so many operations nothing more is tried: a script of the dearest rules loads within two seconds all the same.
const MOST_OPERATIONS: u64 = 10 * MAX_OPERATIONS;

/// Tries every rule and function that is not `spoilt` on an empty place and in a tight corner. Adds to `mistakes` what is
/// wrong whatever is measured: kinds of values that do not fit, names. What depends on the values measured, such as a
/// division by zero, is left to the run.
///
/// # Errors
/// If a limit stops the script.
pub(super) fn rehearse(
    mut judge: Judge,
    settings: &Settings,
    spoilt: &mut Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Result<()> {
    let mut operations = MOST_OPERATIONS;
    for cornered in [false, true] {
        place(&mut judge, settings, cornered);
        if !spoilt.has("calibrate") && !certain(judge.calibrate(), mistakes)? {
            spoilt.insert("calibrate");
            spoilt.insert("calibrated");
        }
        everything(&judge, spoilt, mistakes, &mut operations)?;
    }
    Ok(())
}

/// Fills in what is measured on an empty place, or in a tight corner.
pub(super) fn place(judge: &mut Judge, settings: &Settings, cornered: bool) {
    let facts = judge.facts_mut();
    let range_m = if cornered { settings.laser.min_range_m } else { settings.laser.max_range_m };
    facts.ranges_m.fill(range_m as f32);
    facts.views = settings.views().map(|view| seen(view, cornered)).collect();
    (facts.contact, facts.fallen) = (cornered, cornered);
    (facts.step, facts.since_recovery) = (1, 1);
    (facts.action_linear_m_per_s, facts.linear_m_per_s) = (0.2, 0.2);
}

/// A view that is full of foreground, or empty.
fn seen(view: &ViewSettings, sees: bool) -> ViewFacts {
    let (rows, columns) = (view.grid.rows as usize, view.grid.columns as usize);
    ViewFacts {
        cells: vec![f32::from(u8::from(sees)); rows * columns],
        areas_px: vec![1; rows * columns],
        grid: (rows, columns),
        coverage: f64::from(u8::from(sees)),
        seen: sees,
        ..ViewFacts::default()
    }
}

fn everything(judge: &Judge, spoilt: &Spoilt<'_>, mistakes: &mut Mistakes, operations: &mut u64) -> Result<()> {
    let present = judge.present();
    for rule in &present.compiled.rules {
        if mistakes.count() > MOST_TRIED || *operations == 0 {
            return Ok(());
        }
        budget::refill(MAX_OPERATIONS);
        if !spoilt.touches(&rule.condition_span, mistakes) {
            certain(present.condition(rule), mistakes)?;
        }
        if !spoilt.touches(&rule.value_span, mistakes) {
            certain(present.value(rule), mistakes)?;
        }
        *operations = operations.saturating_sub(MAX_OPERATIONS - budget::left());
    }
    budget::refill(MAX_OPERATIONS);
    match &present.compiled.reward {
        Some(span) if !spoilt.has("reward") => certain(present.reward(span), mistakes).map(drop),
        _ => Ok(()),
    }
}

/// Whether it went well, or failed by chance.
fn certain<T>(result: Result<T>, mistakes: &mut Mistakes) -> Result<bool> {
    match result {
        Err(wrong) if wrong.kind() == Kind::Limit => Err(wrong),
        Err(wrong) if wrong.code != "E-SCRIPT-RUN" => {
            mistakes.add(*wrong);
            Ok(false)
        }
        _ => Ok(true),
    }
}
