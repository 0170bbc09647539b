//! A script tried once at load, so that what must fail fails before learning starts.

use super::spoilt::Spoilt;
use crate::diagnostic::{Kind, Mistakes, Result};
use crate::judge::{Judge, ViewFacts};
use crate::settings::{Settings, ViewSettings};

/// After so many mistakes nothing more is tried: each may take as long as the limits allow.
const MOST_TRIED: usize = 100;

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
    for (range_m, sees) in [(settings.laser.max_range_m, false), (settings.laser.min_range_m, true)] {
        let facts = judge.facts_mut();
        facts.ranges_m.fill(range_m as f32);
        facts.views = settings.views().map(|view| seen(view, sees)).collect();
        (facts.contact, facts.fallen) = (sees, sees);
        (facts.step, facts.since_recovery) = (1, 1);
        (facts.action_linear_m_per_s, facts.linear_m_per_s) = (0.2, 0.2);
        if !spoilt.has("calibrate") && !certain(judge.calibrate(), mistakes)? {
            spoilt.insert("calibrate");
            spoilt.insert("calibrated");
        }
        everything(&judge, spoilt, mistakes)?;
    }
    Ok(())
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

fn everything(judge: &Judge, spoilt: &Spoilt<'_>, mistakes: &mut Mistakes) -> Result<()> {
    let present = judge.present();
    for rule in &present.compiled.rules {
        if mistakes.count() > MOST_TRIED {
            return Ok(());
        }
        if !spoilt.touches(&rule.condition_span, mistakes) {
            certain(present.condition(rule), mistakes)?;
        }
        if !spoilt.touches(&rule.value_span, mistakes) {
            certain(present.value(rule), mistakes)?;
        }
    }
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
